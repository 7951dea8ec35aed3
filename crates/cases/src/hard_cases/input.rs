//! Case 28: input that every world must refuse.

use sim_core::{Body, DVec3, Force, Mesh, Settings, Vec3, World};

use super::{Finding, Tried};

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

pub(super) fn test() -> Tried {
    let mut tally = Tally::default();
    for bad in BAD {
        let vector = DVec3::new(0.0, bad, 0.0);
        for (field, body) in [
            (
                "position",
                Body {
                    position: vector,
                    ..Body::default()
                },
            ),
            (
                "velocity",
                Body {
                    velocity: vector,
                    ..Body::default()
                },
            ),
            (
                "force",
                Body {
                    force: vector,
                    ..Body::default()
                },
            ),
        ] {
            tally.refused(field, |world| world.add(body).map(drop));
        }
        tally.refused("position", |world| world.set_position(0, vector));
        tally.refused("velocity", |world| world.set_velocity(0, vector));
        tally.refused("force", |world| world.set_force(0, vector));
        let acceleration = Force::Gravity {
            acceleration: vector,
        };
        tally.refused("acceleration", |world| {
            world.add_force(acceleration).map(drop)
        });
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let body = Body {
            mass: bad,
            ..Body::default()
        };
        tally.refused("mass", |world| world.add(body).map(drop));
        tally.refused("mass", |world| world.set_mass(0, bad));
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        tally.refused("dt", |world| {
            world.set_settings(Settings {
                dt: bad,
                ..Settings::default()
            })
        });
        let coefficient = if bad == 0.0 { -0.5 } else { bad };
        let drag = Force::LinearDrag {
            body: None,
            coefficient,
        };
        tally.refused("coefficient", |world| world.add_force(drag).map(drop));
    }
    for bad in [0.0, -1.0, f64::NAN, 2.0] {
        tally.refused("tolerance", |world| {
            world.set_settings(Settings {
                tolerance: bad,
                ..Settings::default()
            })
        });
    }
    meshes(&mut tally);
    let why = match tally.wrong.as_slice() {
        [] => format!("{} inputs refused by name, the world unharmed", tally.tried),
        wrong => format!("{} of {}: {}", wrong.len(), tally.tried, wrong.join(", ")),
    };
    Ok(Finding::within(tally.wrong.len() as f64, 0.0, why))
}

#[derive(Default)]
struct Tally {
    tried: u32,
    wrong: Vec<String>,
}

impl Tally {
    /// Tests that a world refuses an input, names the field, and continues as if nothing had happened.
    fn refused<E: ToString>(&mut self, field: &str, bad: impl FnOnce(&mut World) -> Result<(), E>) {
        self.tried += 1;
        let [mut world, mut unharmed] = [(); 2].map(|()| stone());
        let named = bad(&mut world)
            .err()
            .is_some_and(|error| error.to_string().contains(field));
        let _ = (world.step(), unharmed.step());
        let same = world.position(0) == unharmed.position(0) && world.len() == unharmed.len();
        if !(named && same) {
            self.wrong.push(field.into());
        }
    }
}

fn stone() -> World {
    let mut world = World::new(Settings::default()).expect("the default settings are good");
    let body = Body {
        velocity: DVec3::X,
        force: -DVec3::Y,
        ..Body::default()
    };
    world.add(body).expect("a stone is a body");
    world
}

/// Triangles that do not form a mesh.
fn meshes(tally: &mut Tally) {
    let corners = |x: f32| vec![Vec3::new(x, 0.0, 0.0), Vec3::X, Vec3::Y];
    let broken = [
        ("no triangle", corners(0.0), vec![]),
        ("not finite", corners(f32::NAN), vec![[0, 1, 2]]),
        ("not finite", corners(f32::INFINITY), vec![[0, 1, 2]]),
        ("uses vertex 3", corners(0.0), vec![[0, 1, 3]]),
        ("uses a vertex twice", corners(0.0), vec![[0, 1, 1]]),
    ];
    for (word, vertices, triangles) in broken {
        tally.tried += 1;
        let error = Mesh::new(vertices, triangles).err();
        if !error.is_some_and(|error| error.to_string().contains(word)) {
            tally.wrong.push(format!("mesh: {word}"));
        }
    }
}
