//! Cases that interpret arbitrary bytes, and the invariants that they test: with random bytes in `cargo test`, and
//! guided by coverage in `fuzz/`. Each case panics if an invariant is violated.

use std::path::Path;
use std::sync::Arc;

use scene::{FORMATS, Scene, mesh_file, shown};
use sim_core::collide::{naive, touch, tree};
use sim_core::{
    Body, BodyKind, Bvh, Collision, DQuat, DVec3, Inertia, METHODS, Mesh, Settings, Shape,
    StepError, Turn, Vec3, World,
};

use crate::oracle::segment_meets_triangle;
use crate::{hostile, meshes};

/// The name of a case and its function.
pub type Case = (&'static str, fn(&[u8]));

/// All cases.
pub const CASES: [Case; 10] = [
    ("obj", |bytes| mesh("obj", bytes)),
    ("collada", |bytes| mesh("dae", bytes)),
    ("stl", |bytes| mesh("stl", bytes)),
    ("ply", |bytes| mesh("ply", bytes)),
    ("scene", scene),
    ("values", values),
    ("pair", pair),
    ("sweep", sweep),
    ("step", step),
    ("turning", turning),
];

/// Runs the case of a name on some bytes.
pub fn try_case(name: &str, bytes: &[u8]) {
    let case = CASES.into_iter().find(|case| case.0 == name);
    case.expect("a case of that name").1(bytes);
}

/// A file of a format gives an error, or a mesh of finite numbers with a report.
fn mesh(format: &str, bytes: &[u8]) {
    let format = FORMATS.iter().find(|known| known.name == format);
    let format = format.expect("a format of that name");
    match mesh_file::read(format, Path::new("fuzz"), bytes) {
        Ok(loaded) => {
            let vertices = loaded.mesh.vertices();
            assert!(vertices.iter().all(|v| v.is_finite()));
            let mut corners = loaded.mesh.triangles().iter().flatten();
            assert!(corners.all(|&corner| (corner as usize) < vertices.len()));
            assert!(loaded.report().triangles > 0);
        }
        Err(error) => assert_message(&error.to_string()),
    }
}

/// Tests that a message is short and free of control characters for a terminal.
fn assert_message(message: &str) {
    assert!(message.len() < 1000, "{} bytes", message.len());
    assert!(!message.contains(shown::is_unsafe), "{message:?}");
}

/// Bytes as the text of a scene.
fn scene(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        scene_text(text);
    }
}

/// A scene of the gallery with other values.
fn values(bytes: &[u8]) {
    scene_text(&hostile::text(&mut Source(bytes)));
}

/// A scene text gives an error with its line, or a scene that is unchanged after it has been written and read, that
/// makes a world, and whose motion stays finite in every mode.
fn scene_text(text: &str) {
    let scene = match Scene::parse(text, Path::new("fuzz.toml")) {
        Ok(scene) => scene,
        Err(error) => return assert_placed(&error.to_string(), text),
    };
    let written = scene.to_toml();
    let again = Scene::parse(&written, Path::new("fuzz.toml"));
    let again = again.unwrap_or_else(|error| panic!("{error}: {written}"));
    assert_eq!(again.to_toml(), written);
    let world = scene.world();
    let world = world.unwrap_or_else(|error| panic!("{error}, without a line: {text}"));
    let triangles = |body| match world.shape(body) {
        Some(Shape::Mesh(mesh)) => mesh.triangles().len(),
        _ => 0,
    };
    if world.len() > MOST_BODIES {
        return;
    }
    let is_small = (0..world.len()).map(triangles).sum::<usize>() <= MOST_NAIVE;
    let modes = [Collision::Continuous, Collision::Bvh, Collision::Naive];
    for collision in modes.into_iter().take(if is_small { 3 } else { 2 }) {
        let mut world = world.clone();
        let settings = Settings {
            collision,
            ..*world.settings()
        };
        world.set_settings(settings).expect("settings");
        for _ in 0..4 {
            if let Err(error) = world.step() {
                assert_message(&error.to_string());
                // That has taken long, and would take as long in the other modes.
                if matches!(
                    error,
                    StepError::TooMuchWork { .. } | StepError::TooManySteps { .. }
                ) {
                    return;
                }
                break;
            }
            let is_finite =
                |body: usize| world.position(body).is_finite() && world.velocity(body).is_finite();
            assert!((0..world.len()).all(is_finite), "{text}");
            assert!(world.kinetic_energy().is_finite(), "{text}");
        }
    }
}

/// The most bodies of a world that is stepped here, and the most triangles of one that is searched naively.
const MOST_BODIES: usize = 40;
const MOST_NAIVE: usize = 1_000;

/// A message names file and line, except the one that the step is missing.
fn assert_placed(message: &str, text: &str) {
    assert_message(message);
    let place = message.strip_prefix("fuzz.toml:").expect("the file");
    let line = place.split(':').next().map(str::parse::<usize>);
    match line {
        Some(Ok(line)) => assert!(
            (1..=1 + text.matches('\n').count()).contains(&line),
            "{message}"
        ),
        _ => assert!(
            place.starts_with(" the step is missing"),
            "{message}: {text}"
        ),
    }
}

/// Numbers from bytes; 0 once there are none left.
pub(crate) struct Source<'a>(pub(crate) &'a [u8]);

impl Source<'_> {
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        first
    }

    /// An integer less than a count of up to 65,536.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (usize::from(self.byte()) << 8 | usize::from(self.byte())) % count
    }

    /// Mostly one of few values, so that features coincide; otherwise of any size.
    fn number(&mut self) -> f64 {
        let byte = self.byte();
        let small = f64::from(byte % 16) - 8.0;
        match byte / 16 {
            0..=9 => 0.5 * small,
            10..=12 => 0.1 * small,
            13 => small * f64::from(f32::EPSILON),
            14 => 1.0 + small * f64::EPSILON,
            _ => {
                let scale = f64::from(self.byte() % 32) - 16.0;
                small * 10_f64.powf(scale)
            }
        }
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    /// A mesh of a few triangles that share some of a few vertices.
    fn mesh(&mut self) -> Option<Arc<Mesh>> {
        let vertices: Vec<Vec3> = (0..3 + self.byte() % 6)
            .map(|_| self.vector().as_vec3())
            .collect();
        let count = vertices.len() as u8;
        let triangles = (0..1 + self.byte() % 5)
            .map(|_| [0; 3].map(|_| u32::from(self.byte() % count)))
            .collect();
        Mesh::new(vertices, triangles).ok().map(Arc::new)
    }
}

/// Whether an edge of one mesh at an offset meets a triangle of another one at its offset, in rational arithmetic.
fn edges_meet((a, at): (&Mesh, DVec3), (b, other): (&Mesh, DVec3)) -> bool {
    let corners = |mesh: &Mesh, face: &[u32; 3], at: DVec3| {
        face.map(|corner| mesh.vertices()[corner as usize].as_dvec3() + at)
    };
    a.triangles().iter().any(|face| {
        let [p, q, r] = corners(a, face, at);
        b.triangles().iter().any(|face| {
            let face = corners(b, face, other);
            [(p, q), (q, r), (r, p)]
                .into_iter()
                .any(|(p, q)| segment_meets_triangle(p, q, face))
        })
    })
}

/// Two meshes at any positions: the trees, the naive search and rational arithmetic agree.
fn pair(bytes: &[u8]) {
    let mut source = Source(bytes);
    let (Some(a), Some(b)) = (source.mesh(), source.mesh()) else {
        return;
    };
    let at = source.vector();
    let found = tree::intersect(&Bvh::build(&a), &Bvh::build(&b), at);
    assert_eq!(found, naive::intersect(&a, &b, at), "{a:?} {b:?} {at}");
    let (a, b) = ((&*a, DVec3::ZERO), (&*b, at));
    let exact = edges_meet(a, b) || edges_meet(b, a);
    assert_eq!(found, exact, "{a:?} {b:?}");
}

/// Two meshes, one of them moving: they do not meet before the first contact, or never if there is none.
fn sweep(bytes: &[u8]) {
    let mut source = Source(bytes);
    let (Some(a), Some(b)) = (source.mesh(), source.mesh()) else {
        return;
    };
    let (offset, motion) = (source.vector(), source.vector());
    let size = |v: DVec3| v.abs().max_element();
    let vertices = a.vertices().iter().chain(b.vertices());
    let largest = vertices.fold(1e3, |most, v| size(v.as_dvec3()).max(most));
    let (a, b) = (Bvh::build(&a), Bvh::build(&b));
    if tree::intersect(&a, &b, offset) {
        return;
    }
    let time = touch::time_of_impact(&a, &b, offset, motion);
    if let Some(touch) = touch::first_touch(&a, &b, offset, motion) {
        assert!((0.0..=1.0).contains(&touch.time), "{touch:?}");
        assert!(
            time.is_some_and(|time| time <= touch.time),
            "{time:?} {touch:?}"
        );
    }
    let rounding = 64.0 * f64::EPSILON * (size(offset) + size(motion) + largest);
    // Placed vertices are rounded, so only times clearly before the contact count, and meshes that clearly meet: at
    // neighbouring offsets as well.
    let clearly_meet = |there: DVec3| {
        let near = [-rounding, 0.0, rounding];
        let mut about = near.iter().flat_map(|&x| {
            near.iter()
                .flat_map(move |&y| near.map(|z| DVec3::new(x, y, z)))
        });
        about.all(|by| tree::intersect(&a, &b, there + by))
    };
    for part in 0..=32 {
        let part = f64::from(part) / 32.0;
        let clear = time.map_or(1.0, |time| time - rounding / size(motion));
        if part < clear && size(motion) > 1e3 * rounding {
            let there = offset + part * motion;
            assert!(!clearly_meet(there), "{part} before {time:?}");
        }
    }
}

/// A world of a few bodies: after each step all states are finite and all bodies apart, elastic impacts add no energy,
/// and naive and BVH agree bit for bit.
fn step(bytes: &[u8]) {
    let mut source = Source(bytes);
    let settings = Settings {
        method: METHODS[usize::from(source.byte()) % METHODS.len()],
        collision: [Collision::Continuous, Collision::Bvh, Collision::Naive]
            [usize::from(source.byte() % 3)],
        ..Settings::default()
    };
    let Ok(mut world) = World::new(settings) else {
        return;
    };
    for _ in 0..2 + source.byte() % 4 {
        let kind = source.byte();
        let shape = match kind % 4 {
            0 => Some(Shape::Sphere {
                radius: source.number().abs(),
            }),
            1 => Some(Shape::HalfSpace {
                normal: source.vector(),
            }),
            2 => source.mesh().map(Shape::Mesh),
            _ => source.mesh().map(Shape::Mesh),
        };
        let body = Body {
            shape,
            position: 4.0 * source.vector(),
            velocity: 30.0 * source.vector(),
            mass: 1.0 + f64::from(kind % 7),
            kind: if kind % 4 == 1 || kind > 200 {
                BodyKind::Static
            } else {
                BodyKind::Dynamic
            },
            ..Body::default()
        };
        // Moving immovable bodies may add energy.
        let still = body.kind == BodyKind::Static;
        let velocity = if still { DVec3::ZERO } else { body.velocity };
        let _ = world.add(Body { velocity, ..body });
    }
    let energy = world.kinetic_energy();
    for _ in 0..6 {
        if world.step().is_err() {
            return;
        }
        for body in 0..world.len() {
            assert!(world.position(body).is_finite() && world.velocity(body).is_finite());
        }
        assert_eq!(world.meeting(), [], "overlap after step {}", world.steps());
        let now = world.kinetic_energy();
        assert!(now <= energy * (1.0 + 1e-9), "energy {energy} became {now}");
    }
}

/// The same for turning bodies, some of them with a given inertia. After each step all states are finite and all bodies
/// apart. Elastic impacts, and in the discrete modes others too, add no energy, and conserve momentum if all bodies are
/// dynamic.
fn turning(bytes: &[u8]) {
    let mut source = Source(bytes);
    let settings = Settings {
        method: METHODS[usize::from(source.byte()) % METHODS.len()],
        collision: [Collision::Continuous, Collision::Bvh, Collision::Naive]
            [usize::from(source.byte() % 4 / 2)],
        ..Settings::default()
    };
    let Ok(mut world) = World::new(settings) else {
        return;
    };
    for _ in 0..2 + source.byte() % 4 {
        let body = source.turning_body();
        let _ = world.add(body);
    }
    if world.is_empty() {
        return;
    }
    let before = Kept::of(&world);
    for _ in 0..6 {
        if let Err(error) = world.step() {
            return assert_message(&error.to_string());
        }
        for body in world.bodies() {
            assert!(body.position.is_finite() && body.velocity.is_finite());
            let (rotation, spin) = (world.rotation(body.index), world.spin(body.index));
            assert!(
                rotation.is_finite() && spin.is_finite(),
                "{rotation} {spin}"
            );
        }
        assert_eq!(world.meeting(), [], "overlap after step {}", world.steps());
        before.check(&world);
    }
}

/// The motion of bodies without forces: conserved, or lost.
struct Kept {
    energy: f64,
    momentum: DVec3,
}

impl Kept {
    fn of(world: &World) -> Kept {
        Kept {
            energy: world.kinetic_energy(),
            momentum: world.momentum(),
        }
    }

    /// To nine digits, relative to the largest terms if these cancel. The contribution of an impulse to an angular
    /// momentum is rounded like its lever arm; for a needle that spins about its axis this is a large energy.
    fn check(&self, world: &World) {
        let now = Kept::of(world);
        let all = || (0..world.len()).filter(|&body| world.kind(body).is_movable());
        let moving = |body| world.mass(body) * world.velocity(body).length();
        let about = |body| {
            (world.position(body).length() + 1e2) * moving(body)
                + world.angular_momentum(body).length()
        };
        let turning = all().map(|body| about(body) * world.spin(body).length());
        // A persisting contact may add some energy if another contact begins in the meantime.
        let is_continuous = world.settings().collision == Collision::Continuous;
        let lasts = is_continuous && (0..world.len()).any(|body| world.restitution(body) < 1.0);
        let share = if lasts { 1e-3 } else { 1e-9 };
        let rounding = share * self.energy + 1e-13 * turning.sum::<f64>();
        assert!(
            now.energy <= self.energy + rounding,
            "energy {} became {}",
            self.energy,
            now.energy
        );
        // A body that does not rotate is treated as immovable after too many impacts in a step.
        let turns = |body| world.inertia(body).is_some();
        if all().count() < world.len() || lasts && !all().all(turns) {
            return;
        }
        let most = all().map(moving).sum::<f64>();
        let off = now.momentum.distance(self.momentum);
        assert!(off <= 1e-9 * most, "momentum off by {off} of {most}");
    }
}

impl Source<'_> {
    /// A ball, a box, a tetrahedron, an open set of triangles, or a half-space; a turning body if possible.
    fn turning_body(&mut self) -> Body {
        let kind = self.byte();
        let mass = 1.0 + f64::from(kind % 7);
        let shape = match kind % 5 {
            0 => Some(Shape::Sphere {
                radius: self.near().x.abs(),
            }),
            1 => {
                let half = self.near().abs().as_vec3();
                let is_solid = half.is_finite() && half.min_element() > 0.0;
                is_solid.then(|| Shape::Mesh(meshes::cuboid(half)))
            }
            2 => {
                let corners = [0; 4].map(|_| self.near().as_vec3());
                let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
                let mesh = Mesh::new(corners.to_vec(), faces);
                mesh.ok().map(|mesh| Shape::Mesh(Arc::new(mesh)))
            }
            3 => {
                let is_near = |mesh: &Arc<Mesh>| {
                    mesh.vertices()
                        .iter()
                        .all(|v| v.abs().max_element() <= 64.0)
                };
                self.mesh().filter(is_near).map(Shape::Mesh)
            }
            _ => Some(Shape::HalfSpace {
                normal: self.near(),
            }),
        };
        let kind = match kind % 5 == 4 || kind > 220 {
            true => BodyKind::Static,
            false => BodyKind::Dynamic,
        };
        // Moving immovable bodies may add energy.
        let moves = f64::from(kind == BodyKind::Dynamic);
        let inertia = match self.byte() % 3 {
            0 => {
                let [a, b, c] = self.near().abs().to_array();
                let moments = DVec3::new(a + b, b + c, c + a);
                Inertia::new(moments, self.rotation(), 0.5 * self.near()).ok()
            }
            _ => None,
        };
        let turn = Turn {
            rotation: self.rotation(),
            spin: moves * 5.0 * self.near(),
            torque: DVec3::ZERO,
            inertia,
        };
        let half_space = matches!(shape, Some(Shape::HalfSpace { .. }));
        Body {
            shape,
            position: 4.0 * self.near(),
            velocity: moves * 30.0 * self.near(),
            mass,
            kind,
            restitution: f64::from(self.byte() % 8).min(2.0) / 2.0,
            friction: f64::from(self.byte() % 4 / 3),
            turn: (!half_space && !self.byte().is_multiple_of(8)).then_some(turn),
            ..Body::default()
        }
    }

    /// Within some metres: bodies far apart never meet, and huge ones are slow to test.
    fn near(&mut self) -> DVec3 {
        self.vector().clamp(DVec3::splat(-64.0), DVec3::splat(64.0))
    }

    fn rotation(&mut self) -> DQuat {
        let [a, b] = [self.vector(), self.vector()];
        let rotation = DQuat::from_xyzw(a.x, a.y, a.z, b.x);
        match rotation.length() {
            length if length > 1e-9 && length < 1e9 => rotation.normalize(),
            _ => DQuat::IDENTITY,
        }
    }
}
