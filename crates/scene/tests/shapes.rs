//! Spheres, half-spaces, immovable bodies and copies in scene files.

use std::path::Path;

use glam::DVec3;
use scene::{Scene, SceneError};
use sim_core::Shape;

fn parse(text: &str) -> Result<Scene, SceneError> {
    Scene::parse(text, Path::new("shapes.toml"))
}

/// The message about a body with these fields, after file and body.
fn complaint(fields: &str) -> String {
    let error = parse(&format!("rate = 60\n[[body]]\nname = 'a'\n{fields}")).expect_err(fields);
    let error = error.to_string();
    error.strip_prefix("shapes.toml:").expect("a line").into()
}

#[test]
fn wrong_shapes_get_a_message_with_line_body_and_field() {
    for (fields, expected) in [
        (
            "",
            "3: body `a`, mesh: is missing: a body has one of `mesh`, `sphere` and `half-space`",
        ),
        (
            "mesh = 'cube.obj'\nsphere = 1",
            "5: body `a`, sphere: the body has a shape already: give one of",
        ),
        (
            "half-space = [0, 1, 0]\nsphere = 1",
            "4: body `a`, half-space: the body has a shape already: give one of",
        ),
        (
            "sphere = -1",
            "4: body `a`, sphere: must be a radius in m from 0 to 1e100, is -1",
        ),
        ("sphere = nan", "4: body `a`, sphere: must be a radius"),
        ("sphere = inf", "4: body `a`, sphere: must be a radius"),
        (
            "sphere = '1'",
            "4: body `a`, sphere: invalid type: string \"1\", expected a number",
        ),
        (
            "half-space = [0, 0, 0]",
            "4: body `a`, half-space: must be the direction that points out of it",
        ),
        (
            "half-space = [0, nan, 0]",
            "4: body `a`, half-space: must be three numbers",
        ),
        (
            "half_space = [0, 1, 0]",
            "4: body `a`, half_space: unknown field `half_space`, expected one of",
        ),
        (
            "sphere = 1\nscale = 2",
            "5: body `a`, scale: a sphere has none, `sphere` is its radius: leave it out",
        ),
        (
            "half-space = [0, 1, 0]\nrotation = [0, 0, 9]",
            "5: body `a`, rotation: a half-space has none, `half-space` is its normal",
        ),
        (
            "half-space = [0, 1, 0]\nmass = 2",
            "5: body `a`, mass: a half-space is always immovable: leave it out",
        ),
        (
            "half-space = [0, 1, 0]\nimmovable = false",
            "5: body `a`, immovable: a half-space is always immovable: leave it out",
        ),
        (
            "sphere = 1\nimmovable = true\nmass = 2",
            "6: body `a`, mass: an immovable body needs no mass: leave out one of both",
        ),
        (
            "sphere = 1\nmass = inf",
            "5: body `a`, mass: must be a mass in kg above 0 (from 1e-100 to 1e100), is inf; a \
             body that nothing moves is `immovable = true`",
        ),
        (
            "sphere = 1\nrestitution = 1.5",
            "5: body `a`, restitution: must be from 0 (keeps nothing of the approaching speed) to \
             1 (all of it), is 1.5",
        ),
        (
            "sphere = 1\nrestitution = nan",
            "5: body `a`, restitution: must be from 0",
        ),
        (
            "sphere = 1\nfriction = -0.5",
            "5: body `a`, friction: must be a coefficient from 0 (smooth) to inf (never slips), is \
             -0.5",
        ),
        (
            "sphere = 1\nfriction = nan",
            "5: body `a`, friction: must be a coefficient from 0 (smooth)",
        ),
        (
            "sphere = 1\nfriction = -inf",
            "5: body `a`, friction: must be a coefficient from 0 (smooth)",
        ),
        (
            "sphere = 1\nfriction = 'ice'",
            "5: body `a`, friction: invalid type: string \"ice\", expected a number",
        ),
    ] {
        let error = complaint(fields);
        assert!(error.starts_with(expected), "{error}\nnot\n{expected}");
    }
}

#[test]
fn wrong_copies_get_a_message_with_line_body_and_field() {
    for (fields, expected) in [
        (
            "sphere = 1\nspeed = 1",
            "5: body `a`, speed: is about copies: say how many there are, such as `copies = 100`",
        ),
        (
            "sphere = 1\ncopies = 2",
            "5: body `a`, copies: `inside` is missing: the corners of the box",
        ),
        (
            "sphere = 1\ncopies = 0\ninside = [[0, 0, 0], [9, 9, 9]]",
            "5: body `a`, copies: must be from 1 to 10000, is 0",
        ),
        (
            "sphere = 1\ncopies = -1",
            "5: body `a`, copies: invalid value: integer `-1`",
        ),
        (
            "sphere = 1\ncopies = 2\ninside = [[0, 0, 0]]",
            "6: body `a`, inside: must be two corners, such as",
        ),
        (
            "sphere = 1\ncopies = 2\ninside = [[0, 0, 0], [9, 9, nan]]",
            "6: body `a`, inside: must be two corners of numbers within",
        ),
        (
            "sphere = 1\ncopies = 2\ninside = [[0, 0, 0], [9, 1, 9]]",
            "5: body `a`, copies: the box `inside` is smaller than the body, which takes up",
        ),
        (
            "sphere = 1\ncopies = 9\ninside = [[0, 0, 0], [2.1, 2.1, 2.1]]",
            "5: body `a`, copies: only 1 fit into the box `inside` without touching: enlarge",
        ),
        (
            "sphere = 1\ncopies = 2\ninside = [[0, 0, 0], [9, 9, 9]]\nposition = [1, 1, 1]",
            "7: body `a`, position: copies are placed `inside` a box: leave it out",
        ),
        (
            "sphere = 1\ncopies = 2\ninside = [[0, 0, 0], [9, 9, 9]]\nspeed = -1",
            "7: body `a`, speed: must be a speed in m/s from 0 to 1e100, is -1",
        ),
        (
            "half-space = [0, 1, 0]\ncopies = 2\ninside = [[0, 0, 0], [9, 9, 9]]",
            "4: body `a`, half-space: half-spaces have no copies: give each a table of its own",
        ),
    ] {
        let error = complaint(fields);
        assert!(error.starts_with(expected), "{error}\nnot\n{expected}");
    }
    let text = "rate = 60\n[[body]]\nname = 'a 2'\nsphere = 1\nposition = [50, 0, 0]\n[[body]]\n\
                name = 'a'\nsphere = 1\ncopies = 3\ninside = [[0, 0, 0], [9, 9, 9]]\n";
    let error = parse(text).expect_err("a name twice").to_string();
    assert!(
        error.starts_with("shapes.toml:7: body `a 2`, name: the body in line 3 has this name too"),
        "{error}"
    );
}

#[test]
fn copies_are_apart_in_their_box_and_the_same_everywhere() {
    let text = "rate = 60
        [[body]]
        name = 'slope'
        half-space = [1, 1, 0]
        [[body]]
        name = 'cow'
        mesh = 'cow.obj'
        position = [3, 3, 3]
        [[body]]
        name = 'cube'
        mesh = 'cube.obj'
        scale = 0.5
        rotation = [10, 20, 30]
        velocity = [0, 5, 0]
        friction = 0.3
        copies = 60
        inside = [[4, -1, 4], [-1, 4, -1]]
        speed = 3
        seed = 9
        [[body]]
        name = 'ball'
        sphere = 0.2
        copies = 40
        inside = [[-1, -1, -1], [4, 4, 4]]
    ";
    let scene = parse(text).expect("a scene");
    let world = scene.world().expect("a world");
    assert_eq!((world.len(), world.overlapping()), (102, &[][..]));
    let names = [2, 61, 62, 101].map(|i| scene.bodies[i].name.as_str());
    assert_eq!(names, ["cube 1", "cube 60", "ball 1", "ball 40"]);
    for i in 2..102 {
        let half = match world.shape(i) {
            Some(Shape::Mesh(mesh)) => mesh.bounds().half_extent(),
            Some(Shape::Sphere { radius }) => DVec3::splat(*radius),
            _ => panic!("a copy"),
        };
        let (low, high) = (world.position(i) - half, world.position(i) + half);
        assert!(low.min_element() > -1.0 - 1e-6 && high.max_element() < 4.0 + 1e-6);
        let own = world.velocity(i) - DVec3::new(0.0, if i < 62 { 5.0 } else { 0.0 }, 0.0);
        let speed = if i < 62 { 3.0 } else { 0.0 };
        assert!((own.length() - speed).abs() < 1e-12);
        assert_eq!(world.friction(i), if i < 62 { 0.3 } else { 0.0 });
    }
    // By SplitMix64 from seed 0, worked out apart from this program.
    let lone = "rate = 60\n[[body]]\nname = 'a'\nsphere = 0.2\ncopies = 1\n\
                inside = [[-1, -1, -1], [4, 4, 4]]";
    let first = parse(lone).expect("a scene").bodies[0].position;
    let expected = DVec3::new(3.263229717782756, 1.1850287864231457, -0.6784046506740504);
    assert!((first - expected).length() < 1e-12, "{first}");
    let other = parse(&text.replace("seed = 9", "seed = 10")).expect("a scene");
    assert_ne!(other.bodies[2].position, scene.bodies[2].position);
    // Written out, they are single bodies.
    let again = parse(&scene.to_toml()).expect("a scene");
    assert_eq!(again.bodies, scene.bodies);
}
