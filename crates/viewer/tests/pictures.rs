//! Pictures drawn off screen, looked at pixel by pixel. Without a graphics adapter they say so
//! and pass, but in CI, where they fail.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use glam::{DQuat, DVec3, Vec3};
use image::RgbaImage;
use sim_core::Mesh;
use viewer::camera::Camera;
use viewer::picture::{Arrow, Line, Model, Picture};
use viewer::render::offscreen::{Offscreen, ShotError};

const SIZE: [u32; 2] = [320, 200];
const RED: [f32; 3] = [0.9, 0.1, 0.1];
const GREEN: [f32; 3] = [0.1, 0.8, 0.1];
const BLUE: [f32; 3] = [0.1, 0.2, 0.9];

/// Without a graphics adapter a picture says nothing; where CI has one that is a failure.
fn skip_without_adapter() {
    assert!(std::env::var_os("CI").is_none(), "{}", ShotError::NoAdapter);
    println!("skipped: {}", ShotError::NoAdapter);
}

/// One device for all tests, if there is one.
fn offscreen() -> Option<MutexGuard<'static, Offscreen>> {
    static OFFSCREEN: OnceLock<Option<Mutex<Offscreen>>> = OnceLock::new();
    let shared = OFFSCREEN.get_or_init(|| match Offscreen::new() {
        Ok(offscreen) => Some(Mutex::new(offscreen)),
        Err(ShotError::NoAdapter) => {
            skip_without_adapter();
            None
        }
        Err(error) => panic!("{error}"),
    });
    let guard = shared.as_ref()?.lock();
    Some(guard.unwrap_or_else(PoisonError::into_inner))
}

fn shot(picture: &Picture) -> Option<RgbaImage> {
    Some(offscreen()?.shot(picture, SIZE).expect("a small picture"))
}

/// The colour where a point is seen.
fn seen(image: &RgbaImage, camera: &Camera, point: DVec3) -> [i32; 3] {
    let [width, height] = [image.width(), image.height()].map(f64::from);
    let [x, y] = camera
        .project(point, width / height)
        .expect("before the eye");
    let at = [(0.5 + 0.5 * x) * width, (0.5 - 0.5 * y) * height];
    assert!(
        at[0] >= 0.0 && at[0] < width && at[1] >= 0.0 && at[1] < height,
        "{point} is out of view"
    );
    let [red, green, blue, opacity] = image.get_pixel(at[0] as u32, at[1] as u32).0;
    assert_eq!(opacity, 255);
    [red, green, blue].map(i32::from)
}

fn brightness(colour: [i32; 3]) -> i32 {
    colour.iter().sum()
}

fn difference(a: [i32; 3], b: [i32; 3]) -> i32 {
    (0..3)
        .map(|part| (a[part] - b[part]).abs())
        .max()
        .unwrap_or(0)
}

fn cube() -> Arc<Mesh> {
    let vertices = (0..8u8)
        .map(|index| Vec3::from([1, 2, 4].map(|bit| if index & bit == 0 { -0.5 } else { 0.5 })))
        .collect();
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Arc::new(Mesh::new(vertices, triangles).expect("a cube"))
}

fn model(mesh: &Arc<Mesh>, position: DVec3, colour: [f32; 3]) -> Model {
    Model {
        mesh: Arc::clone(mesh),
        position,
        rotation: DQuat::IDENTITY,
        colour,
        selected: false,
    }
}

/// Looks along `-z` at the origin from a little above.
fn front() -> Picture {
    let camera = Camera {
        target: DVec3::ZERO,
        distance: 4.0,
        yaw: 0.0,
        pitch: 0.4,
        ..Camera::default()
    };
    Picture {
        camera,
        ..Picture::default()
    }
}

#[test]
fn faces_of_a_cube_are_flat_and_differ() {
    let mut picture = front();
    picture.models.push(model(&cube(), DVec3::ZERO, BLUE));
    let Some(image) = shot(&picture) else { return };
    let look = |x, y, z| seen(&image, &picture.camera, DVec3::new(x, y, z));
    let (face, top) = (look(0.0, 0.0, 0.5), look(0.0, 0.5, 0.0));
    for at in [-0.4, -0.2, 0.2, 0.4] {
        assert!(difference(look(at, at, 0.5), face) <= 8, "front at {at}");
        assert!(difference(look(at, 0.5, -at), top) <= 8, "top at {at}");
    }
    assert!(difference(face, top) >= 20, "front {face:?}, top {top:?}");
    assert!(face[2] > face[0] + 60, "blue: {face:?}");
}

#[test]
fn background_is_light_and_even() {
    let Some(image) = shot(&front()) else { return };
    for (x, y, pixel) in image.enumerate_pixels() {
        let [red, green, blue, opacity] = pixel.0;
        assert!(
            red.min(green).min(blue) > 150 && opacity == 255,
            "{pixel:?} at {x}, {y}"
        );
        let beside = image.get_pixel((x + 1).min(SIZE[0] - 1), y);
        assert!(pixel.0[0].abs_diff(beside.0[0]) <= 2);
    }
}

#[test]
fn grid_lines_lie_at_whole_metres() {
    let mut picture = front();
    picture.grid = true;
    let Some(image) = shot(&picture) else { return };
    let look = |x, z| seen(&image, &picture.camera, DVec3::new(x, 0.0, z));
    let between = brightness(look(0.5, 0.5));
    for (x, z) in [(1.0, 0.5), (-1.0, 0.5), (0.5, 1.0), (-0.5, -1.0)] {
        assert!(brightness(look(x, z)) < between - 20, "at {x}, {z}");
    }
    let [red, _, blue] = look(0.5, 0.0);
    assert!(red > blue + 40, "the x axis is red");
    let [red, _, blue] = look(0.0, 0.5);
    assert!(blue > red + 40, "the z axis is blue");
    let [red, green, blue] = seen(&image, &picture.camera, 0.5 * DVec3::Y);
    assert!(green > red + 20 && green > blue + 20, "the y axis is green");
}

#[test]
fn arrows_have_their_colour_and_place() {
    let mut picture = front();
    let (from, to) = (DVec3::new(-1.0, 0.2, 0.0), DVec3::new(0.8, 0.2, 0.3));
    picture.arrows.push(Arrow {
        from,
        to,
        colour: RED,
        radius: 0.08,
    });
    // Has no direction: not drawn, and no harm done.
    picture.arrows.push(Arrow {
        from,
        to: from,
        colour: GREEN,
        radius: 0.5,
    });
    let Some(image) = shot(&picture) else { return };
    for along in [0.1, 0.5, 0.9] {
        let [red, green, blue] = seen(&image, &picture.camera, from.lerp(to, along));
        assert!(
            red > green + 60 && red > blue + 60,
            "{:?} at {along}",
            [red, green, blue]
        );
    }
    // The head is wider than the shaft.
    let beside = 0.12 * DVec3::Y;
    let is_red = |at: DVec3| {
        let [red, green, _] = seen(&image, &picture.camera, at);
        red > green + 60
    };
    assert!(is_red(from.lerp(to, 0.78) + beside) && !is_red(from.lerp(to, 0.3) + beside));
}

#[test]
fn models_of_one_mesh_keep_their_own_colours() {
    let mut picture = front();
    let mesh = cube();
    let places = [(-1.3, RED), (0.0, GREEN), (1.3, BLUE)].map(|(x, colour)| (x * DVec3::X, colour));
    picture
        .models
        .extend(places.map(|(at, colour)| model(&mesh, at, colour)));
    picture.models[1].selected = true;
    picture
        .models
        .push(model(&mesh, DVec3::new(f64::NAN, 0.0, 0.0), RED));
    let Some(image) = shot(&picture) else { return };
    for (part, (at, _)) in places.into_iter().enumerate() {
        let colour = seen(&image, &picture.camera, at + DVec3::new(0.1, -0.2, 0.5));
        let strongest = (0..3).max_by_key(|&part| colour[part]);
        assert_eq!(strongest, Some(part), "{colour:?}");
    }
}

#[test]
fn selected_models_show_their_edges() {
    let mut picture = front();
    picture.models.push(model(&cube(), DVec3::ZERO, GREEN));
    let Some(plain) = shot(&picture) else { return };
    picture.models[0].selected = true;
    let Some(selected) = shot(&picture) else {
        return;
    };
    // On the edge between front and top, and within the front but off its diagonal.
    let (edge, face) = (DVec3::new(0.2, 0.5, 0.5), DVec3::new(-0.3, -0.1, 0.5));
    let look = |image, at| seen(image, &picture.camera, at)[1];
    // One of two rows of pixels has most of it.
    let darkest = |image| {
        let rows = [-0.012, 0.0, 0.012].map(|row| look(image, edge + row * DVec3::Y));
        rows.into_iter().min()
    };
    let (with, without) = (darkest(&selected), darkest(&plain));
    assert!(
        with < without.map(|without| without - 40),
        "{with:?} with, {without:?} without"
    );
    assert!(look(&selected, face) > look(&plain, face) - 10);
}

#[test]
fn lines_are_hidden_by_what_is_before_them() {
    let mut picture = front();
    picture.models.push(model(&cube(), DVec3::ZERO, BLUE));
    let line = |z| Line {
        from: DVec3::new(-1.5, 0.0, z),
        to: DVec3::new(1.5, 0.0, z),
        colour: [1.0, 0.0, 0.0, 1.0],
        width: 3.0,
    };
    // Behind, and on the face itself.
    picture.lines = vec![line(-0.8), line(0.5)];
    let Some(image) = shot(&picture) else { return };
    let is_red = |x, z| seen(&image, &picture.camera, DVec3::new(x, 0.0, z))[0] > 200;
    assert!(is_red(0.1, 0.5) && is_red(1.2, 0.5) && is_red(1.2, -0.8));
    let hidden = seen(&image, &picture.camera, DVec3::new(0.1, 0.0, -0.8));
    assert!(hidden[2] > hidden[0], "{hidden:?}");
}

#[test]
fn a_line_that_passes_the_eye_is_cut_off_there() {
    let mut picture = front();
    let ahead = picture.camera.forward();
    let start = picture.camera.eye() - 0.2 * DVec3::Y;
    picture.lines.push(Line {
        from: start - 50.0 * ahead,
        to: start + 3.0 * ahead,
        colour: [0.0, 0.0, 0.0, 1.0],
        width: 2.0,
    });
    let Some(image) = shot(&picture) else { return };
    assert!(brightness(seen(&image, &picture.camera, start + 2.0 * ahead)) < 300);
    let above = (0..SIZE[0]).flat_map(|x| (0..SIZE[1] / 2).map(move |y| (x, y)));
    for (x, y) in above {
        assert!(
            image.get_pixel(x, y).0[0] > 150,
            "nothing is drawn at {x}, {y}"
        );
    }
}

#[test]
fn a_body_over_the_ground_casts_a_shadow_straight_down() {
    let mut picture = front();
    picture.grid = true;
    let Some(empty) = shot(&picture) else { return };
    picture
        .models
        .push(model(&cube(), DVec3::new(0.5, 0.9, 0.5), RED));
    let Some(image) = shot(&picture) else { return };
    let below = DVec3::new(0.7, 0.0, 0.7);
    let aside = DVec3::new(-1.3, 0.0, 0.7);
    let darker = |at| {
        brightness(seen(&empty, &picture.camera, at))
            - brightness(seen(&image, &picture.camera, at))
    };
    assert!(darker(below) > 15, "{}", darker(below));
    assert!(darker(aside).abs() <= 3, "{}", darker(aside));
}

#[test]
fn far_from_the_origin_everything_is_drawn_alike() {
    let scene = |middle: DVec3| {
        let mut picture = front();
        picture.grid = true;
        picture.camera.target = middle;
        picture.camera.orbit(0.6, 0.1);
        let mut selected = model(&cube(), middle + DVec3::new(0.1, 0.7, 0.2), GREEN);
        selected.selected = true;
        picture.models = vec![selected, model(&cube(), middle - 1.2 * DVec3::X, RED)];
        let (from, to) = (middle, middle + DVec3::new(1.0, 1.0, 1.0));
        picture.arrows.push(Arrow {
            from,
            to,
            colour: BLUE,
            radius: 0.05,
        });
        let colour = [0.0, 0.0, 0.0, 1.0];
        picture.lines.push(Line {
            from: to,
            to: middle + DVec3::Z,
            colour,
            width: 2.0,
        });
        picture
    };
    // Away from the axes, which stay where they are.
    let near = DVec3::new(500.0, 0.0, 500.0);
    let Some(expected) = shot(&scene(near)) else {
        return;
    };
    for away in [DVec3::new(1e7, 0.0, 0.0), DVec3::new(1e8, 0.0, -1e8)] {
        let Some(image) = shot(&scene(near + away)) else {
            return;
        };
        let alike = expected.pixels().zip(image.pixels());
        let unlike = alike.filter(|(a, b)| (0..3).any(|part| a.0[part].abs_diff(b.0[part]) > 6));
        let count = unlike.count();
        // Rounding moves a sample across an edge here and there.
        assert!(count <= 20, "{count} pixels differ at {away}");
    }
}

#[test]
fn meshes_are_forgotten_once_not_drawn() {
    let Some(mut offscreen) = offscreen() else {
        return;
    };
    let mesh = cube();
    let mut picture = front();
    picture.models.push(model(&mesh, DVec3::ZERO, RED));
    offscreen.shot(&picture, SIZE).expect("a small picture");
    assert_eq!(Arc::weak_count(&mesh), 1, "known to the renderer");
    offscreen.shot(&picture, SIZE).expect("a small picture");
    assert_eq!(Arc::weak_count(&mesh), 1, "known once");
    picture.models.clear();
    offscreen.shot(&picture, SIZE).expect("a small picture");
    assert_eq!(Arc::weak_count(&mesh), 0, "forgotten");
}

#[test]
fn sizes_from_one_pixel_to_the_largest() {
    let Some(mut offscreen) = offscreen() else {
        return;
    };
    let mut picture = front();
    picture.camera.distance = 1.2;
    picture.models.push(model(&cube(), DVec3::ZERO, RED));
    for size in [[1, 1], [101, 57], [57, 101], [64, 64], [1, 300], [3, 2]] {
        let image = offscreen.shot(&picture, size).expect("a small picture");
        assert_eq!([image.width(), image.height()], size);
        let [red, green, _, _] = image.get_pixel(size[0] / 2, size[1] / 2).0;
        assert!(red > green, "the cube is in the middle at {size:?}");
    }
    for size in [
        [0, 10],
        [10, 0],
        [u32::MAX, 1],
        [1, u32::MAX],
        [u32::MAX, u32::MAX],
    ] {
        let error = offscreen.shot(&picture, size).expect_err("no such size");
        assert!(matches!(error, ShotError::Size { .. }), "{error}");
        assert!(error.to_string().contains(" from 1 to "), "{error}");
    }
}

#[test]
fn the_selection_has_a_rim_and_nothing_else_changes_outside_of_it() {
    let mut picture = front();
    let dark = [0.3, 0.3, 0.3];
    picture.models.push(model(&cube(), DVec3::ZERO, dark));
    let Some(plain) = shot(&picture) else { return };
    picture.models[0].selected = true;
    let Some(selected) = shot(&picture) else {
        return;
    };
    let is_blue = |pixel: &image::Rgba<u8>| {
        let [red, green, blue, _] = pixel.0.map(i32::from);
        blue > red + 60 && blue > green + 40
    };
    assert!(!plain.pixels().any(is_blue));
    let rim = selected.pixels().filter(|pixel| is_blue(pixel)).count();
    // The outline is some 300 pixels long.
    assert!((200..1500).contains(&rim), "{rim} pixels");
    // Far from it all is as it was.
    for (x, y) in [(5, 5), (160, 195), (315, 100)] {
        assert_eq!(plain.get_pixel(x, y), selected.get_pixel(x, y));
    }
}

#[test]
fn ghosts_are_seen_through_and_cast_no_shadow() {
    let mut picture = front();
    picture.grid = true;
    let place = DVec3::new(0.0, 1.0, 0.0);
    let Some(empty) = shot(&picture) else { return };
    picture.ghosts.push(viewer::picture::Ghost {
        mesh: cube(),
        position: place,
        rotation: DQuat::IDENTITY,
        colour: RED,
    });
    let Some(ghost) = shot(&picture) else { return };
    picture.ghosts.clear();
    picture.models.push(model(&cube(), place, RED));
    let Some(solid) = shot(&picture) else { return };
    // Beside the upright axis.
    let face = place + DVec3::new(0.25, 0.0, 0.5);
    let look = |image| seen(image, &picture.camera, face);
    let (before, through, opaque) = (look(&empty), look(&ghost), look(&solid));
    assert!(
        through[0] - through[2] > before[0] - before[2] + 8,
        "red: {through:?}"
    );
    let mixed = |part: usize| {
        let (low, high) = (
            before[part].min(opaque[part]),
            before[part].max(opaque[part]),
        );
        (low..=high).contains(&through[part])
    };
    assert!(mixed(1) && mixed(2), "{before:?}, {through:?}, {opaque:?}");
    let below = DVec3::new(0.25, 0.0, 0.2);
    let ground = |image| seen(image, &picture.camera, below);
    assert!(difference(ground(&empty), ground(&ghost)) <= 2);
    assert!(
        difference(ground(&empty), ground(&solid)) > 8,
        "a body does"
    );
}

#[test]
fn a_panel_can_be_drawn_without_a_window() {
    let context = egui::Context::default();
    viewer::ui::apply_style(&context);
    let image = match viewer::render::offscreen::panel(&context, [400, 200], |ui| {
        ui.label("a panel");
    }) {
        Err(ShotError::NoAdapter) => return skip_without_adapter(),
        image => image.expect("a panel"),
    };
    assert_eq!((image.width(), image.height()), (400, 200));
    let bright = image.pixels().filter(|pixel| pixel.0[0] > 120).count();
    assert!((50..2000).contains(&bright), "{bright} pixels of text");
}
