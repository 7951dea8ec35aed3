//! Scene files: what they may say, errors that name line, body and field, and the gallery.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use scene::mesh_file::BUILTIN_MESHES;
use scene::{MeshRef, SCENES, Scene, SceneBody, SceneError, SceneShape};
use sim_core::{BodyKind, Collision, METHODS, Mesh, Shape};

fn mesh(name: &str) -> SceneShape {
    SceneShape::Mesh(MeshRef::builtin(name).expect("built in"))
}

fn triangles(body: &SceneBody) -> &Arc<Mesh> {
    body.mesh().expect("a mesh").mesh()
}

fn parse(text: &str) -> Result<Scene, SceneError> {
    Scene::parse(text, Path::new("no such folder/test.toml"))
}

#[test]
fn only_the_step_and_names_must_be_there() {
    let text = "dt = 0.5\n[[body]]\nname = 'a'\nmesh = 'cube.obj'\n";
    let scene = parse(text).expect("a scene");
    assert_eq!(
        (scene.name.as_str(), scene.title.as_str()),
        ("test", "test")
    );
    assert_eq!((scene.dt, scene.method.name), (0.5, "velocity-verlet"));
    assert_eq!(scene.collision, Collision::Continuous);
    let body = SceneBody::new("a".into(), mesh("cube.obj"));
    assert_eq!((body.mass, body.restitution), (1.0, 1.0));
    assert_eq!(body.friction, 0.0);
    assert_eq!((body.position, body.velocity), (DVec3::ZERO, DVec3::ZERO));
    assert_eq!((body.rotation, body.scale), (DVec3::ZERO, DVec3::ONE));
    assert_eq!(scene.bodies, [body]);
    assert_eq!(parse("rate = 60").expect("an empty scene").bodies, []);
}

#[test]
fn everything_can_be_said() {
    let text = r##"
        title = "Title"
        about = "About"
        rate = 50
        method = "rk4"
        collision = "naive"
        [[body]]
        name = "a"
        mesh = "cow.obj"
        position = [1, 2.5, -3]
        rotation = [10, 20, 30]
        scale = [1, 2, -3]
        velocity = [1e1, 0, 0]
        force = [0, 0, 7]
        mass = 2
        colour = "#ff0080"
        [[body]]
        name = "b"
        mesh = "cow.obj"
        scale = 2
        immovable = true
        [[body]]
        name = "c"
        sphere = 0.5
        restitution = 0.25
        friction = 0.3
        immovable = false
        [[body]]
        name = "d"
        half-space = [0, 2, 0]
        friction = inf
    "##;
    let scene = parse(text).expect("a scene");
    assert_eq!(
        (scene.title.as_str(), scene.about.as_str()),
        ("Title", "About")
    );
    assert_eq!((scene.dt, scene.method.name), (0.02, "rk4"));
    assert_eq!(scene.collision, Collision::Naive);
    let [a, b, c, d] = &scene.bodies[..] else {
        panic!("four bodies");
    };
    assert_eq!(a.position, DVec3::new(1.0, 2.5, -3.0));
    assert_eq!(a.rotation, DVec3::new(10.0, 20.0, 30.0));
    assert_eq!(a.scale, DVec3::new(1.0, 2.0, -3.0));
    assert_eq!(a.velocity, DVec3::new(10.0, 0.0, 0.0));
    assert_eq!(a.force, DVec3::new(0.0, 0.0, 7.0));
    assert_eq!(a.mass, 2.0);
    assert_eq!(a.colour, Some([1.0, 0.0, 128.0 / 255.0]));
    assert_eq!((b.scale, b.immovable), (DVec3::splat(2.0), true));
    assert!(Arc::ptr_eq(triangles(a), triangles(b)));
    assert_eq!(c.shape, SceneShape::Sphere { radius: 0.5 });
    assert_eq!((c.mass, c.restitution), (1.0, 0.25));
    let normal = DVec3::new(0.0, 2.0, 0.0);
    assert_eq!(d.shape, SceneShape::HalfSpace { normal });
    assert_eq!((d.immovable, d.restitution), (true, 1.0));
    let friction = [0.0, 0.0, 0.3, f64::INFINITY];
    assert_eq!([a, b, c, d].map(|body| body.friction), friction);
    let world = scene.world().expect("a world");
    assert_eq!(world.shape(2), Some(&Shape::Sphere { radius: 0.5 }));
    assert_eq!(world.shape(3), Some(&Shape::HalfSpace { normal: DVec3::Y }));
    assert_eq!(
        (world.kind(3), world.restitution(2)),
        (BodyKind::Static, 0.25)
    );
    assert_eq!([0, 1, 2, 3].map(|i| world.friction(i)), friction);
}

#[test]
fn groups_of_a_file_tell_who_collides_with_whom() {
    let text = r#"
        rate = 60
        [[body]]
        name = "spark"
        sphere = 0.5
        groups = ["sparks"]
        collides_with = ["walls"]
        [[body]]
        name = "wall"
        half-space = [0, 1, 0]
        groups = ["walls", "all else"]
        [[body]]
        name = "anything"
        sphere = 0.5
        [[body]]
        name = "ghost"
        sphere = 0.5
        collides_with = []
    "#;
    let scene = parse(text).expect("a scene");
    assert_eq!(parse(&scene.to_toml()).expect("its text"), scene);
    let world = scene.world().expect("a world");
    let collide = |i, j| world.groups(i).collide(world.groups(j));
    assert!(collide(0, 1) && collide(0, 2) && collide(1, 2) && !collide(0, 0));
    assert!((0..4).all(|other| !collide(3, other)));
    let empty = text.replace("\"walls\", ", "\" \", ");
    let error = parse(&empty).expect_err("a name").to_string();
    assert!(
        error.contains(":11:") && error.contains("groups"),
        "{error}"
    );
    // More than there are bits.
    let mut many = scene.clone();
    let names = (0..33).map(|n| n.to_string());
    many.bodies[0].groups = Some(names.collect());
    let error = many.world().expect_err("too many").to_string();
    assert!(error.contains("groups"), "{error}");
}

#[test]
fn wrong_files_get_a_message_with_line_body_and_field() {
    let good = r##"title = "T"
rate = 60
method = "rk4"
collision = "bvh"

[[body]]
name = "first"
mesh = "cube.obj"
mass = 1

[[body]]
name = "second"
mesh = "cube.obj"
position = [-5, 0, 0]
scale = 1
colour = "#c8553d"
"##;
    assert!(parse(good).is_ok());
    // What is replaced in the good file, by what, part of the message after the file name.
    let cases: &[(&str, &str, &str)] = &[
        ("rate = 60", "rate = 60 Hz", ":2: "),
        (
            "rate = 60",
            "rate = 60\ndt = 0.1",
            ":3: dt: the step has a rate as well: give either",
        ),
        (
            "rate = 60",
            "",
            ": the step is missing: give either `rate = 60` (Hz) or `dt",
        ),
        (
            "rate = 60",
            "rate = 0",
            ":2: rate: must be from 1e-3 to 1e9 Hz, is 0",
        ),
        (
            "rate = 60",
            "rate = -0.0",
            ":2: rate: must be from 1e-3 to 1e9 Hz, is -0",
        ),
        (
            "rate = 60",
            "rate = nan",
            ":2: rate: must be from 1e-3 to 1e9 Hz, is NaN",
        ),
        (
            "rate = 60",
            "dt = 0",
            ":2: dt: must be from 1e-9 to 1e3 s, is 0",
        ),
        (
            "rate = 60",
            "dt = -0.1",
            ":2: dt: must be from 1e-9 to 1e3 s, is -0.1",
        ),
        (
            "rate = 60",
            "dt = inf",
            ":2: dt: must be from 1e-9 to 1e3 s, is inf",
        ),
        (
            "rate = 60",
            "dt = '0.1'",
            ":2: dt: invalid type: string \"0.1\", expected a number",
        ),
        (
            "\"rk4\"",
            "\"rk5\"",
            ":3: method: must be one of forward-euler, backward-euler, symplectic-euler, rk4, ",
        ),
        (
            "\"rk4\"",
            "4",
            ":3: method: invalid type: integer `4`, expected a string",
        ),
        (
            "\"bvh\"",
            "\"BVH\"",
            ":4: collision: must be naive, bvh or continuous, is `BVH`",
        ),
        (
            "title",
            "titel",
            ":1: titel: unknown field `titel`, expected one of `title`",
        ),
        (
            "[[body]]\nname = \"first\"",
            "[body]\nname = \"first\"",
            ":",
        ),
        (
            "\"second\"",
            "\"first\"",
            ":12: body `first`, name: the body in line 7 has this name too",
        ),
        (
            "name = \"second\"",
            "",
            ":11: body `number 2`: missing field `name`",
        ),
        (
            "\"second\"",
            "\" \"",
            ":12: body ` `, name: must not be empty",
        ),
        (
            "\"second\"",
            "2",
            ":12: body `number 2`, name: invalid type",
        ),
        (
            "mesh = \"cube.obj\"\nposition",
            "position",
            ":12: body `second`, mesh: is missing: a body has one of `mesh`, `sphere` and `half-space`",
        ),
        (
            "mesh = \"cube.obj\"\nposition",
            "mesh = \"sphere.obj\"\nposition",
            ":13: body `second`, mesh: there is no mesh file no such folder/sphere.obj, and the built-in meshes are cube.obj, cow.obj",
        ),
        (
            "mass = 1",
            "mass = 0",
            ":9: body `first`, mass: must be a mass in kg above 0 (from 1e-100 to 1e100), is 0",
        ),
        (
            "mass = 1",
            "mass = -2.5",
            ":9: body `first`, mass: must be a mass in kg above 0",
        ),
        (
            "mass = 1",
            "mass = nan",
            ":9: body `first`, mass: must be a mass",
        ),
        (
            "mass = 1",
            "mass = inf",
            ":9: body `first`, mass: must be a mass",
        ),
        (
            "mass = 1",
            "mass = true",
            ":9: body `first`, mass: invalid type: boolean `true`, expected a number",
        ),
        (
            "mass = 1",
            "masse = 1",
            ":9: body `first`, masse: unknown field `masse`, expected one of `name`",
        ),
        ("mass = 1", "mass = 1\nmass = 2", ":10: duplicate key"),
        (
            "[-5, 0, 0]",
            "[-5, 0, nan]",
            ":14: body `second`, position: must be three numbers within ±1e100, is [-5, 0, NaN]",
        ),
        (
            "[-5, 0, 0]",
            "[inf, 0, 0]",
            ":14: body `second`, position: must be three numbers",
        ),
        (
            "[-5, 0, 0]",
            "[1e200, 0, 0]",
            ":14: body `second`, position: must be three numbers",
        ),
        (
            "[-5, 0, 0]",
            "[-5, 0]",
            ":14: body `second`, position: invalid length 2",
        ),
        (
            "[-5, 0, 0]",
            "[-5, 0, 0, 0]",
            ":14: body `second`, position: invalid length 4, expected three numbers",
        ),
        (
            "[-5, 0, 0]",
            "[-5,\n0, 'x']",
            ":15: body `second`, position: invalid type: string \"x\"",
        ),
        (
            "[-5, 0, 0]",
            "-5",
            ":14: body `second`, position: invalid type: integer `-5`",
        ),
        (
            "scale = 1",
            "scale = 0",
            ":15: body `second`, scale: must be finite and not 0, is [0, 0, 0]",
        ),
        (
            "scale = 1",
            "scale = [1, 1, inf]",
            ":15: body `second`, scale: must be finite",
        ),
        (
            "scale = 1",
            "scale = [1, 1]",
            ":15: body `second`, scale: invalid length 2, expected three numbers",
        ),
        (
            "scale = 1",
            "scale = [1, 1, 1, 1]",
            ":15: body `second`, scale: invalid length 4",
        ),
        (
            "scale = 1",
            "scale = 'big'",
            ":15: body `second`, scale: invalid type: string \"big\", expected a number or three",
        ),
        (
            "#c8553d",
            "red",
            ":16: body `second`, colour: must look like `#c8553d`, is `red`",
        ),
    ];
    for (from, to, expected) in cases {
        assert!(good.contains(from), "{from}");
        let error = parse(&good.replacen(from, to, 1))
            .expect_err(to)
            .to_string();
        let expected = format!("no such folder/test.toml{expected}");
        assert!(
            error.starts_with(&expected),
            "{to}:\n{error}\nnot\n{expected}"
        );
    }
    for bodies in ["body = 3", "body = [3]", "body = {}", "body = 'x'"] {
        let error = parse(&format!("rate = 60\n{bodies}"))
            .expect_err(bodies)
            .to_string();
        assert!(
            error.contains(":2: body: must be an array of tables: start each"),
            "{error}"
        );
    }
}

#[test]
fn load_takes_gallery_names_and_paths() {
    let error = Scene::load("cube").expect_err("no scene").to_string();
    assert!(error.contains("there is no scene `cube`"), "{error}");
    for known in SCENES {
        assert!(error.contains(known.name), "{error}");
        assert_eq!(Scene::load(known.name).expect(known.name).name, known.name);
    }
    let error = Scene::load("missing.toml")
        .expect_err("no file")
        .to_string();
    assert!(
        error.starts_with("missing.toml: cannot read the scene file: "),
        "{error}"
    );

    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("meshes")).expect("a folder");
    std::fs::write(at("meshes/flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").expect("written");
    std::fs::write(at("cow.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4").expect("written");
    std::fs::write(
        at("own.TOML"),
        "rate = 1\n[[body]]\nname = 'a'\nmesh = 'meshes/flat.obj'\n[[body]]\nname = 'b'\nmesh = 'cube.obj'",
    )
    .expect("written");
    let scene = Scene::load(at("own.TOML").to_str().expect("a path")).expect("a scene");
    assert_eq!(scene.name, "own");
    assert_eq!(triangles(&scene.bodies[0]).triangles().len(), 1);
    assert_eq!(scene.bodies[1].shape, mesh("cube.obj"));

    // A file comes before the built-in mesh of its name, and its own errors are passed on.
    std::fs::write(
        at("bad.toml"),
        "rate = 1\n[[body]]\nname = 'a'\nmesh = 'cow.obj'",
    )
    .expect("written");
    let error = Scene::load(at("bad.toml").to_str().expect("a path")).expect_err("a bad mesh");
    let error = error.to_string();
    assert!(error.contains("bad.toml:4: body `a`, mesh: "), "{error}");
    assert!(error.contains("cow.obj:4: a face uses vertex 4"), "{error}");
    // But gallery scenes open no file, wherever the program runs.
    std::fs::write(at("latin1.toml"), b"title = \"\xe9\"").expect("written");
    let error = Scene::load(at("latin1.toml").to_str().expect("a path")).expect_err("not UTF-8");
    assert!(error.to_string().contains("UTF-8"), "{error}");
}

#[test]
fn a_saved_scene_finds_its_meshes_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("other")).expect("a folder");
    std::fs::write(at("flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").expect("written");
    let text =
        "rate = 1\n[[body]]\nname = 'a'\nmesh = 'flat.obj'\n[[body]]\nname = 'b'\nmesh = 'cow.obj'";
    let scene = Scene::parse(text, &at("own.toml")).expect("a scene");
    for place in ["own.toml", "other/own.toml"] {
        scene.save(&at(place)).expect("saved");
        let again = Scene::load(at(place).to_str().expect("a path")).expect("a scene");
        for (a, b) in scene.bodies.iter().zip(&again.bodies) {
            assert_eq!(triangles(a), triangles(b), "{place}");
        }
    }
    let own = std::fs::read_to_string(at("own.toml")).expect("text");
    assert!(own.contains("mesh = \"flat.obj\""), "{own}");
    let error = scene
        .save(&at("missing/own.toml"))
        .expect_err("no folder")
        .to_string();
    assert!(error.contains("cannot write the scene file"), "{error}");
}

#[test]
fn meshes_beside_a_saved_scene_go_along_with_its_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("here/meshes")).expect("a folder");
    let flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3";
    for name in ["here/beside.obj", "here/meshes/deeper.obj", "above.obj"] {
        std::fs::write(at(name), flat).expect("written");
    }
    // As files that are dropped onto a window come, by their whole paths.
    let mut scene = parse("rate = 1").expect("a scene");
    for name in ["here/beside.obj", "here/meshes/deeper.obj", "above.obj"] {
        let mesh = MeshRef::load(&at(name)).expect("a mesh");
        let shape = SceneShape::Mesh(mesh);
        scene.bodies.push(SceneBody::new(name.to_owned(), shape));
    }
    scene.name = "own".to_owned();
    scene.save(&at("here/own.toml")).expect("saved");
    let text = std::fs::read_to_string(at("here/own.toml")).expect("text");
    for name in ["\"beside.obj\"", "\"meshes/deeper.obj\""] {
        assert!(text.contains(&format!("mesh = {name}")), "{text}");
    }
    let again = Scene::load(at("here/own.toml")).expect("a scene");
    assert_eq!(again.bodies, scene.bodies);
    std::fs::rename(at("here"), at("there")).expect("moved");
    Scene::load(at("there/own.toml")).expect("it has its meshes with it");
}

#[test]
fn saved_text_is_short() {
    let scene =
        parse("rate = 60\n[[body]]\nname = 'a'\nmesh = 'cube.obj'\nposition = [-5.0, 0.5, 0]");
    let text = scene.expect("a scene").to_toml();
    assert!(text.contains("rate = 60\n"), "{text}");
    assert!(text.contains("position = [-5, 0.5, 0]\n"), "{text}");
    assert!(text.contains("scale = 1\n"), "{text}");
    let text = parse("dt = 0.3").expect("a scene").to_toml();
    assert!(text.contains("dt = 0.3\n"), "{text}");
}

#[test]
fn the_gallery_and_its_meshes_are_valid() {
    for known in SCENES {
        let scene = known.scene().unwrap_or_else(|error| panic!("{error}"));
        assert!(
            !scene.title.is_empty() && !scene.about.is_empty(),
            "{}",
            known.name
        );
        assert!(
            known.text.starts_with("# "),
            "{} starts with a comment",
            known.name
        );
        let meshes = scene.bodies.iter().filter_map(SceneBody::mesh);
        assert!(meshes.into_iter().all(|mesh| mesh.path().is_none()));
        let world = scene.world().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(world.overlapping(), [], "{}", known.name);
        let again = parse(&scene.to_toml()).expect("a scene");
        assert_eq!(again.bodies, scene.bodies);
    }
    for builtin in &BUILTIN_MESHES {
        let mesh = builtin.mesh();
        assert!(mesh.is_closed() && mesh.is_oriented(), "{}", builtin.name);
        assert!(
            mesh.volume().is_some_and(|volume| volume > 0.0),
            "{}",
            builtin.name
        );
        assert!(Arc::ptr_eq(&mesh, &builtin.mesh()), "read once");
    }
}

#[test]
fn bodies_of_one_shape_share_a_mesh() {
    let text = "rate = 60\n".to_owned()
        + &[
            "mesh = 'cube.obj'",
            "mesh = 'cube.obj'\nposition = [9, 0, 0]\nrotation = [-0.0, 0, 0]",
            "mesh = 'cube.obj'\nposition = [18, 0, 0]\nscale = 2",
            "mesh = 'cube.obj'\nposition = [27, 0, 0]\nscale = [2, 2, 2]",
            "mesh = 'cube.obj'\nposition = [36, 0, 0]\nscale = 2\nrotation = [0, 0, 45]",
            "mesh = 'cow.obj'\nposition = [45, 0, 0]",
        ]
        .iter()
        .enumerate()
        .map(|(i, body)| format!("[[body]]\nname = 'b{i}'\n{body}\n"))
        .collect::<String>();
    let scene = parse(&text).expect("a scene");
    let world = scene.world().expect("a world");
    let mesh = |i| world.mesh(i).expect("a mesh");
    assert!(
        Arc::ptr_eq(mesh(0), triangles(&scene.bodies[0])),
        "as loaded"
    );
    assert!(Arc::ptr_eq(mesh(0), mesh(1)));
    assert!(!Arc::ptr_eq(mesh(0), mesh(2)));
    assert!(Arc::ptr_eq(mesh(2), mesh(3)));
    assert!(!Arc::ptr_eq(mesh(2), mesh(4)));
    assert!(Arc::ptr_eq(mesh(5), triangles(&scene.bodies[5])));
}

#[test]
fn rotation_is_about_x_then_y_then_z() {
    // A thin box along x: turned about x nothing moves, about y it points to -z, about z that
    // stays.
    let text = "rate = 60\n[[body]]\nname = 'a'\nmesh = 'cube.obj'\nscale = [8, 2, 1]\nrotation = [90, 90, 0]";
    let mut scene = parse(text).expect("a scene");
    let size = |scene: &Scene| {
        let world = scene.world().expect("a world");
        let bounds = world.mesh(0).expect("a mesh").bounds();
        bounds.max - bounds.min
    };
    // About x: y to z, so (8, 1, 2); about y: x to -z, so (2, 1, 8).
    assert!((size(&scene) - Vec3::new(2.0, 1.0, 8.0)).length() < 1e-6);
    scene.bodies[0].rotation = DVec3::new(0.0, 90.0, 90.0);
    // About y: (1, 2, 8); about z: (2, 1, 8).
    assert!((size(&scene) - Vec3::new(2.0, 1.0, 8.0)).length() < 1e-6);
    scene.bodies[0].rotation = DVec3::new(90.0, 0.0, 90.0);
    // About x: (8, 1, 2); about z: (1, 8, 2). The other order would give (2, 1, 8).
    assert!((size(&scene) - Vec3::new(1.0, 8.0, 2.0)).length() < 1e-6);
}

#[test]
fn a_scene_changed_for_the_worse_names_scene_and_body() {
    let text = "rate = 60\n[[body]]\nname = 'a'\nmesh = 'cube.obj'";
    let good = parse(text).expect("a scene");
    let change = |change: fn(&mut Scene)| {
        let mut scene = good.clone();
        change(&mut scene);
        scene.world().expect_err("no world").to_string()
    };
    for (error, expected) in [
        (change(|s| s.dt = 0.0), "scene `test`: dt is 0 s"),
        (
            change(|s| s.bodies[0].mass = -1.0),
            "scene `test`: body `a`: mass",
        ),
        (
            change(|s| s.bodies[0].velocity.x = f64::NAN),
            "scene `test`: body `a`: velocity",
        ),
        (
            change(|s| s.bodies[0].scale.x = 0.0),
            "scene `test`: body `a`, scale: ",
        ),
        (
            change(|s| s.bodies[0].rotation.x = f64::NAN),
            "scene `test`: body `a`, rotation: ",
        ),
    ] {
        assert!(error.starts_with(expected), "{error}");
    }
}

fn vector() -> impl Strategy<Value = DVec3> {
    let number = prop_oneof![
        -1e100..1e100_f64,
        -10.0..10.0_f64,
        (-20..20_i32).prop_map(f64::from),
        Just(-0.0),
        Just(f64::MIN_POSITIVE),
        Just(9_007_199_254_740_993.0),
    ];
    [number.clone(), number.clone(), number].prop_map(DVec3::from)
}

fn shape() -> impl Strategy<Value = SceneShape> {
    let normal = vector().prop_filter("a direction", |v| *v != DVec3::ZERO);
    prop_oneof![
        Just(mesh("cube.obj")),
        Just(mesh("cow.obj")),
        prop_oneof![Just(0.0), 0.0..1e100_f64].prop_map(|radius| SceneShape::Sphere { radius }),
        normal.prop_map(|normal| SceneShape::HalfSpace { normal }),
    ]
}

fn body() -> impl Strategy<Value = SceneBody> {
    // What a mesh of some metres can be scaled by.
    let (least, most) = (DVec3::splat(1e-9), DVec3::splat(1e9));
    let scale = vector().prop_map(move |v| v.abs().clamp(least, most).copysign(v));
    let moved = (vector(), vector(), vector());
    let turned = (vector(), scale);
    let colour = proptest::option::of(any::<[u8; 3]>());
    // The mass of an immovable body has no text.
    let mass = prop_oneof![
        (1e-100..1e100_f64).prop_map(|mass| (mass, false)),
        Just((1.0, true))
    ];
    let restitution = prop_oneof![0.0..=1.0_f64, Just(1.0)];
    let friction = prop_oneof![0.0..1e100_f64, Just(0.0), Just(f64::INFINITY)];
    let groups = || proptest::option::of(proptest::collection::vec("[a-c]{1,2}", 0..3));
    let impact = (mass, restitution, (friction, groups(), groups()));
    (any::<String>(), shape(), moved, turned, impact, colour).prop_map(
        |(
            name,
            shape,
            moved,
            (rotation, scale),
            ((mass, immovable), restitution, (friction, groups, collides)),
            colour,
        )| {
            let mut body = SceneBody::new(name, shape);
            (body.position, body.velocity, body.force) = moved;
            (body.restitution, body.friction) = (restitution, friction);
            (body.groups, body.collides_with) = (groups, collides);
            body.colour = colour.map(|bytes| bytes.map(|byte| f32::from(byte) / 255.0));
            if body.mesh().is_some() {
                (body.rotation, body.scale) = (rotation, scale);
            }
            if !matches!(body.shape, SceneShape::HalfSpace { .. }) {
                (body.mass, body.immovable) = (mass, immovable);
            }
            body
        },
    )
}

fn scene() -> impl Strategy<Value = Scene> {
    let dt = prop_oneof![
        1e-9..1e3_f64,
        (1..1000_u32).prop_map(|rate| 1.0 / f64::from(rate))
    ];
    let collision = prop_oneof![
        Just(Collision::Naive),
        Just(Collision::Bvh),
        Just(Collision::Continuous)
    ];
    let bodies = proptest::collection::vec(body(), 0..4);
    (
        any::<[String; 2]>(),
        dt,
        0..METHODS.len(),
        collision,
        bodies,
    )
        .prop_map(|([title, about], dt, method, collision, mut bodies)| {
            for (i, body) in bodies.iter_mut().enumerate() {
                body.name += &i.to_string();
            }
            Scene {
                name: "test".into(),
                title,
                about,
                dt,
                method: METHODS[method],
                collision,
                tolerance: 1e-9,
                ends: dt.lt(&1.0).then_some(8.0 * dt),
                bodies,
                forces: Vec::new(),
            }
        })
}

proptest! {
    #[test]
    fn a_scene_survives_its_text(scene in scene()) {
        let text = scene.to_toml();
        let again = parse(&text).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        prop_assert_eq!(again, scene);
    }
}

#[test]
fn gallery_titles_are_those_of_the_scenes() {
    for entry in scene::SCENES {
        let whole = entry.scene().expect("a scene of the gallery");
        assert_eq!(entry.title(), whole.title);
    }
}

#[test]
fn bodies_that_turn_are_where_their_origin_is_put() {
    let text = r#"
        rate = 60
        [[body]]
        name = "cow"
        mesh = "cow.obj"
        position = [1, 2, 3]
        rotation = [0, 90, 0]
        scale = 0.5
        mass = 3
        turns = true
        spin = [1, -2, 0.5]
        torque = [0, 0, 4]
        [[body]]
        name = "plate"
        mesh = "cube.obj"
        position = [9, 0, 0]
        turns = true
        inertia = [1, 2, 2.5]
        [[body]]
        name = "ball"
        sphere = 2
        position = [0, 9, 0]
        mass = 5
        turns = true
        [[body]]
        name = "still"
        mesh = "cow.obj"
        position = [-9, 0, 0]
        scale = 0.5
        turns = false
    "#;
    let scene = parse(text).expect("a scene");
    let turn = scene.bodies[0].turn.expect("it turns");
    assert_eq!(turn.spin, DVec3::new(1.0, -2.0, 0.5));
    assert_eq!(turn.torque, DVec3::new(0.0, 0.0, 4.0));
    assert_eq!(scene.bodies[3].turn, None);
    let world = scene.world().expect("a world");
    assert_eq!(
        [0, 1, 2, 3].map(|i| world.turns(i)),
        [true, true, true, false]
    );
    let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-12, "{a} is not {b}");
    near(world.origin(0), DVec3::new(1.0, 2.0, 3.0));
    // A quarter turn about y takes x to -z.
    near(world.rotation(0) * DVec3::X, -DVec3::Z);
    near(world.spin(0), turn.spin);
    // The centre of mass is not the origin of the cow, and is turned with it.
    let centre = world.inertia(0).expect("it turns").centre();
    assert!(centre.length() > 0.01);
    near(
        world.position(0),
        world.origin(0) + world.rotation(0) * centre,
    );
    // Meshes are shared, however they are turned.
    let [cow, still] = [0, 3].map(|i| world.mesh(i).expect("a mesh"));
    assert!(Arc::ptr_eq(cow, still));
    let plate = world.inertia(1).expect("it turns");
    assert_eq!(
        (plate.moments(), plate.centre()),
        (DVec3::new(1.0, 2.0, 2.5), DVec3::ZERO)
    );
    let ball = world.inertia(2).expect("it turns");
    near(ball.moments(), DVec3::splat(8.0));
    assert_eq!(parse(&scene.to_toml()).expect("the same scene"), scene);
}

#[test]
fn what_cannot_turn_is_refused_with_its_line_and_field() {
    let head = "rate = 60\n[[body]]\nname = 'b'\n";
    for (body, message) in [
        (
            "mesh = 'cube.obj'\nspin = [0, 1, 0]",
            ":5: body `b`, spin: is of a body that turns",
        ),
        (
            "mesh = 'cube.obj'\nturns = false\ntorque = [0, 1, 0]",
            ":6: body `b`, torque: is of a body that turns: say `turns = true`",
        ),
        (
            "half-space = [0, 1, 0]\nturns = true",
            ":5: body `b`, turns: a half-space cannot turn",
        ),
        (
            "mesh = 'cube.obj'\nturns = true\ninertia = [1, 1, 3]",
            ":6: body `b`, inertia: moments of inertia",
        ),
        (
            "mesh = 'cube.obj'\nturns = true\nspin = [nan, 1, 3]",
            ":6: body `b`, spin: must be three numbers",
        ),
        (
            "sphere = 0\nturns = true",
            ":5: body `b`, turns: a ball of radius",
        ),
        (
            "mesh = 'open.obj'\nturns = true",
            ":5: body `b`, turns: the mesh is open: close it, or give its inertia",
        ),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let open = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        std::fs::write(folder.path().join("open.obj"), open).expect("a file");
        let found = Scene::parse(&format!("{head}{body}\n"), &folder.path().join("s.toml"));
        let error = found.expect_err(body).to_string();
        assert!(error.contains(message), "{error}");
    }
}
