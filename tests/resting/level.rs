//! Slides over level surfaces, for any triangles and bodies that form them.

use kit::random::Random;
use kit::shapes::{ball, cube, mesh, scaled};
use kit::worlds::{GRAVITY, step};
use sim_core::{Body, DVec3, METHODS, Settings, Shape, Vec3, World};

use crate::meshes::{fan, grid};
use crate::scenes::{fixed, rk4, world};

/// The sliding bodies, each with its extent downwards.
fn sliders(size: f64) -> [(&'static str, Shape, f64); 3] {
    let edge = scaled(&cube(), DVec3::splat(size));
    // It stands on one vertex.
    let half = 0.5 * size as f32;
    let corners = [[0, -1, 0], [1, 1, 0], [-1, 1, 1], [-1, 1, -1]];
    let corners = corners.map(|c| half * Vec3::from_array(c.map(|x: i8| f32::from(x))));
    let top = mesh(
        corners.to_vec(),
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    );
    [
        ("cube", edge, 0.5 * f64::from(size as f32)),
        ("ball", ball(0.5 * size), 0.5 * size),
        ("top", top, f64::from(half)),
    ]
}

fn slider(shape: &Shape, position: DVec3, velocity: DVec3) -> Body {
    Body {
        shape: Some(shape.clone()),
        position,
        velocity,
        restitution: 0.0,
        ..Body::default()
    }
}

/// Slides the last body of a world, whose velocity must stay constant bit for bit.
fn slides_on(world: &mut World, steps: u32) -> Result<(), String> {
    let body = world.len() - 1;
    let velocity = world.velocity(body);
    for count in 0..steps {
        world.step().map_err(|error| error.to_string())?;
        let mut off = world.velocity(body) - velocity;
        // It is lifted to its gap, some 1e-12 of its coordinates, if the gap has become smaller.
        if off.y.abs() < 1e-9 * world.position(body).length() {
            off.y = 0.0;
        }
        let (impacts, contacts) = (world.impacts(), world.contacts().count());
        if off != DVec3::ZERO || impacts > 0 || contacts == 0 {
            return Err(format!(
                "step {count}: {off} m/s off, {impacts} impacts, {contacts} contacts"
            ));
        }
    }
    Ok(())
}

/// The errors, and the number of slides.
#[derive(Default)]
struct Tally {
    slides: usize,
    wrong: Vec<String>,
}

impl Tally {
    fn note(&mut self, what: &str, outcome: Result<(), String>) {
        self.slides += 1;
        if let Err(error) = outcome {
            self.wrong.push(format!("{what}: {error}"));
        }
    }

    fn check(self, slides: usize) {
        let few: Vec<_> = self.wrong.iter().take(FEW).cloned().collect();
        let count = self.wrong.len();
        assert_eq!(count, 0, "of {}:\n{}", self.slides, few.join("\n"));
        assert_eq!(self.slides, slides);
    }
}

const FEW: usize = 30;

/// Sixteen tiles of different sizes, side by side: as bodies, or as one mesh.
fn tiles() -> Vec<(&'static str, Vec<Body>)> {
    let tile = scaled(&cube(), DVec3::new(0.5, 0.25, 0.5));
    let places = (0..16).map(|i| {
        let (x, z) = (f64::from(i / 4), f64::from(i % 4));
        DVec3::new(0.5 * x - 0.75, -0.125, 0.5 * z - 0.75)
    });
    let bodies = places.clone().map(|at| fixed(&tile, at)).collect();
    let Shape::Mesh(one) = &tile else {
        unreachable!()
    };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for at in places {
        let first = vertices.len() as u32;
        vertices.extend(one.vertices().iter().map(|&v| v + at.as_vec3()));
        triangles.extend(one.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    let together = fixed(&mesh(vertices, triangles), DVec3::ZERO);
    vec![("bodies", bodies), ("one mesh", vec![together])]
}

#[test]
fn seams_of_tiles_stop_nothing() {
    let ways = [
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(1.0, 0.0, 1.0),
        DVec3::new(0.7, 0.0, 0.31),
        DVec3::new(0.25, 0.0, -0.01),
    ];
    let mut tally = Tally::default();
    for method in METHODS {
        for (kind, floor) in tiles() {
            for (name, shape, reach) in sliders(0.25) {
                for way in ways {
                    let mut world = world(method);
                    for tile in &floor {
                        world.add(tile.clone()).expect("a tile");
                    }
                    // A body that stands on a corner does not start on a corner of the tiles.
                    let aside = if name == "top" { 0.01 } else { 0.0 };
                    let at = DVec3::new(-0.5, reach, aside - 0.5 * way.z.signum());
                    world.add(slider(&shape, at, way)).expect("a slider");
                    let what = format!("{}, {kind}, {name}, {way}", method.name);
                    tally.note(&what, slides_on(&mut world, 50));
                }
            }
        }
    }
    tally.check(11 * 2 * 3 * 4);
}

/// Through the vertex that all triangles share, past it, and along an edge.
#[test]
fn vertices_of_many_triangles_stop_nothing() {
    let mut tally = Tally::default();
    for triangles in [3, 64, 1000] {
        for scale in [1e-6, 1.0, 1e6] {
            let disc = fan(triangles, 2.0 * scale);
            for (name, shape, reach) in sliders(0.25 * scale) {
                for (aside, way) in [
                    (0.0, DVec3::X),
                    (0.0, DVec3::new(0.3, 0.0, 0.7)),
                    (0.01, DVec3::X),
                    (-0.125, DVec3::X),
                ] {
                    let mut world = world(rk4());
                    world.add(fixed(&disc, DVec3::ZERO)).expect("a disc");
                    let at = scale * (aside * DVec3::Z - 0.5 * way) + reach * DVec3::Y;
                    let way = scale * way;
                    world.add(slider(&shape, at, way)).expect("a slider");
                    let what = format!("{triangles} triangles, {name}, {aside}, {way}");
                    tally.note(&what, slides_on(&mut world, 60));
                }
            }
        }
    }
    tally.check(3 * 3 * 3 * 4);
}

/// At positions and sizes that are no short numbers.
#[test]
fn floors_of_many_triangles_stop_nothing() {
    let mut random = Random::splitmix(5);
    let mut tally = Tally::default();
    let kinds = [((100, 100), [3.0, 3.0]), ((1, 10_000), [3.0, 3.0])];
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for (cells, size) in kinds {
            let floor = grid(cells, size.map(|size| size * scale), &mut random);
            for (name, shape, reach) in sliders(0.1 * scale) {
                for way in [DVec3::new(0.7, 0.0, 0.3), DVec3::new(-0.4, 0.0, 1.0)] {
                    let mut world = world(rk4());
                    let far = scale * DVec3::new(0.1, 0.3, 1.7);
                    world.add(fixed(&floor, far)).expect("a floor");
                    let at = far + reach * DVec3::Y - 0.5 * scale * way;
                    let way = scale * way;
                    world.add(slider(&shape, at, way)).expect("a slider");
                    let what = format!("{cells:?} cells at {scale:e}, {name}, {way}");
                    tally.note(&what, slides_on(&mut world, 60));
                }
            }
        }
    }
    tally.check(5 * 2 * 3 * 2);
}

/// A tile that is higher by a millionth of the sliding body's size is a wall.
#[test]
fn a_ledge_is_a_wall() {
    for method in METHODS {
        for scale in [1e-6, 1.0, 1e6] {
            for (height, stops) in [(1e-6, true), (-1e-6, false)] {
                let mut world = world(method);
                let tile = scaled(&cube(), DVec3::splat(scale));
                let half = 0.5 * f64::from(scale as f32);
                let low = DVec3::new(-half, -half, 0.0);
                let high = DVec3::new(half, -half + height * scale, 0.0);
                world.add(fixed(&tile, low)).expect("a tile");
                world.add(fixed(&tile, high)).expect("a ledge");
                let at = DVec3::new(-2.0 * half, half, 0.0);
                let velocity = scale * DVec3::X;
                let brick = slider(&tile, at, velocity);
                world.add(brick).expect("a brick");
                step(&mut world, 60);
                let what = format!("{}, {scale:e}, {height:e}", method.name);
                if stops {
                    let off = (world.position(2).x + half).abs();
                    assert!(off <= 1e-9 * scale, "{what}: {off:e}");
                    assert_eq!(world.velocity(2), DVec3::ZERO, "{what}");
                } else {
                    assert_eq!(world.velocity(2), velocity, "{what}");
                }
            }
        }
    }
}

/// Tops of tiles that are level up to the rounding of their vertices and positions, at any scale: speeds are those of
/// falls from the height of a tile.
#[test]
fn ledges_of_rounding_are_none() {
    let mut random = Random::splitmix(9);
    let mut tally = Tally::default();
    for scale in [0.1, 1.0, 1e6] {
        let unit = (GRAVITY * scale).sqrt();
        for (name, shape, reach) in sliders(0.5 * scale) {
            for (speed, restitution) in [(0.4, 0.0), (0.05, 0.0), (0.4, 0.5), (0.4, 1.0)] {
                // A slow tip may fall beside a ledge while it is lifted.
                if name == "top" && speed < 0.1 {
                    continue;
                }
                let mut world = world(rk4());
                let settings = Settings {
                    dt: 0.05 * scale / unit,
                    ..*world.settings()
                };
                world.set_settings(settings).expect("settings");
                let top = 0.3;
                for i in 0..8 {
                    let height = [0.1, 0.3, 0.7, 1.7][i % 4] * random.from(0.9, 1.1);
                    let size = scale * DVec3::new(0.5, height, 2.0);
                    let at = scale * DVec3::new(0.5 * i as f64 - 0.5, top - 0.5 * height, 0.1);
                    let tile = Body {
                        restitution,
                        ..fixed(&scaled(&cube(), size), at)
                    };
                    world.add(tile).expect("a tile");
                }
                let velocity = speed * unit * DVec3::new(1.0, 0.0, 0.1);
                let at = DVec3::new(0.1 * scale, top * scale + reach, 0.0);
                let slider = Body {
                    restitution,
                    ..slider(&shape, at, velocity)
                };
                world.add(slider).expect("a slider");
                let slid = (0..150).try_for_each(|count| {
                    world.step().map_err(|error| error.to_string())?;
                    let off = (world.velocity(8) - velocity) / unit;
                    let is_level = off.y.abs() < 1e-3 && off.x.hypot(off.z) < 1e-4;
                    match is_level && world.overlapping().is_empty() {
                        true => Ok(()),
                        false => Err(format!("step {count}: {off} off at {}", world.position(8))),
                    }
                });
                tally.note(
                    &format!("{name} at {scale:e}, {speed}, e {restitution}"),
                    slid,
                );
            }
        }
    }
    tally.check(3 * (3 * 4 - 1));
}
