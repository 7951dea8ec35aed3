//! Times of first contact of meshes that translate and rotate uniformly, from closed forms and from exact tests.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};
use std::sync::Arc;

use kit::meshes::{boxes, builtin, cuboid};
use sim_core::collide::turning::{Figure, Moving, Turning, first_contact};
use sim_core::collide::{Placement, tree};
use sim_core::rotation::Flight;
use sim_core::{Bvh, DQuat, DVec3, Mesh, Vec3};

use crate::hard_cases::Verdict;

/// Two meshes that may come into contact, for each of some spins.
pub struct Contact {
    /// Name in tables and file names.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// The bodies, and the source of the exact time.
    pub about: &'static str,
    /// The spins, rad/s.
    pub spins: &'static [f64],
    /// Makes the pair for a spin.
    pub make: fn(f64) -> Meeting,
    /// The largest error that passes, s.
    pub tolerance: f64,
    /// The seekers that must pass at every spin.
    pub passed_by: &'static [Seeker],
    /// The seekers that must fail at some spin.
    pub failed_by: &'static [Seeker],
}

/// Two moving meshes.
#[derive(Clone, Debug)]
pub struct Meeting {
    /// The two meshes with their motion.
    pub things: [Thing; 2],
    /// The duration of the search, s.
    pub duration: f64,
    /// The source of the exact time of first contact.
    pub truth: Truth,
}

/// A mesh that translates uniformly and rotates uniformly about the origin of its frame.
#[derive(Clone, Debug)]
pub struct Thing {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Its half extents if it is a box centred at its origin, m.
    pub half: Option<Vec3>,
    /// Initial position, m.
    pub position: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Angular velocity, rad/s.
    pub spin: DVec3,
}

/// The source of the exact time of first contact.
#[derive(Clone, Copy, Debug)]
pub enum Truth {
    /// A closed form, s.
    At(f64),
    /// They do not meet.
    Never,
    /// The exact intersection test of the meshes, at 4,096 times and then by bisection.
    ByTests,
    /// The closed form of the lowest vertex above the plane `y = 0`, the surface of the second mesh.
    LowestCorner,
}

/// The implementations that search for contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seeker {
    /// Ours, for meshes.
    Ours,
    /// The nonlinear shape cast of `parry3d-f64`, for meshes.
    #[cfg(feature = "rapier3d-f64")]
    ParryMeshes,
    /// The same shape cast for the boxes of `parry3d-f64`.
    #[cfg(feature = "rapier3d-f64")]
    ParryBoxes,
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The time of contact, s; `None` if the search finds none.
    pub time: Option<f64>,
    /// Whether the search itself reports that it was incomplete: ours, that the meshes are apart until then and it has
    /// not searched further; parry, by its status, which can occur together with a correct time.
    pub has_failed: bool,
}

/// A prepared search.
pub type Search = Box<dyn Fn() -> Found>;

impl Thing {
    fn mesh(mesh: Arc<Mesh>, position: DVec3) -> Thing {
        Thing {
            mesh,
            half: None,
            position,
            velocity: DVec3::ZERO,
            spin: DVec3::ZERO,
        }
    }

    fn cuboid(half: Vec3, position: DVec3) -> Thing {
        Thing {
            half: Some(half),
            ..Thing::mesh(cuboid(half), position)
        }
    }

    fn moving(self, velocity: DVec3) -> Thing {
        Thing { velocity, ..self }
    }

    fn spinning(self, spin: DVec3) -> Thing {
        Thing { spin, ..self }
    }

    fn position_at(&self, t: f64) -> DVec3 {
        self.position + t * self.velocity
    }

    fn rotation_at(&self, t: f64) -> DQuat {
        DQuat::from_scaled_axis(t * self.spin)
    }
}

fn cube(position: DVec3) -> Thing {
    Thing::cuboid(Vec3::splat(0.5), position)
}

/// A floor whose upper face lies in the plane `y = 0`.
fn floor() -> Thing {
    Thing::cuboid(Vec3::new(8.0, 1.0, 8.0), DVec3::NEG_Y)
}

/// Both searches of parry.
const PARRY: &[Seeker] = &[
    #[cfg(feature = "rapier3d-f64")]
    Seeker::ParryMeshes,
    #[cfg(feature = "rapier3d-f64")]
    Seeker::ParryBoxes,
];

/// All contacts.
pub static CONTACTS: [Contact; 8] = [
    Contact {
        name: "cube-floor",
        title: "A cube falls on a floor, spinning",
        about: "A cube of 1 m comes down at 1 m/s upon the upper face of a box and spins about an oblique axis; 1 s. \
                The time is that at which its lowest corner is level with the face.",
        spins: &[1.0, 10.0, 100.0, 1000.0],
        make: |spin| {
            let axis = DVec3::new(0.3, 0.2, 0.9).normalize();
            let cube = cube(1.3 * DVec3::Y).moving(-DVec3::Y);
            Meeting {
                things: [cube.spinning(spin * axis), floor()],
                duration: 1.0,
                truth: Truth::LowestCorner,
            }
        },
        tolerance: 1e-9,
        passed_by: &[Seeker::Ours],
        failed_by: PARRY,
    },
    Contact {
        name: "cow-cow",
        title: "A cow hits a cow, both spinning",
        about: "A cow of 6,000 triangles comes at 10 m/s upon another one, and they spin about axes across each other; \
                0.25 s. The time is that from which on the meshes meet by the exact test of two placed meshes.",
        spins: &[1.0, 3.0, 10.0, 30.0, 100.0],
        make: |spin| {
            let cow = builtin("cow.obj");
            let way = DVec3::new(1.0, 0.05, 0.1).normalize();
            Meeting {
                things: [
                    Thing::mesh(cow.clone(), DVec3::ZERO).spinning(spin * DVec3::Y),
                    Thing::mesh(cow, -3.0 * way)
                        .moving(10.0 * way)
                        .spinning(spin * DVec3::new(0.6, 0.8, 0.0)),
                ],
                duration: 0.25,
                truth: Truth::ByTests,
            }
        },
        tolerance: 1e-9,
        passed_by: &[Seeker::Ours],
        failed_by: &[],
    },
    Contact {
        name: "edge-face",
        title: "An edge turns onto a face",
        about: "A cube of 1 m turns about its centre, 1.1 m beside another one; 0.5 s. Closed form.",
        spins: &[1.0],
        make: |spin| Meeting {
            things: [
                cube(DVec3::ZERO).spinning(spin * DVec3::Z),
                cube(1.1 * DVec3::X),
            ],
            duration: 0.5,
            truth: Truth::At((FRAC_PI_4 - (0.6 * 2_f64.sqrt()).acos()) / spin),
        },
        tolerance: 1e-9,
        passed_by: Seeker::ALL,
        failed_by: &[],
    },
    Contact {
        name: "flat-faces",
        title: "Faces close flat",
        about: "A cube of 1 m comes at 1 m/s upon another one and turns about the way on which it comes, so that faces meet \
                as a whole; 0.4 s. Closed form.",
        spins: &[1.0],
        make: |spin| Meeting {
            things: [
                cube(DVec3::ZERO),
                cube(1.1 * DVec3::X)
                    .moving(-DVec3::X)
                    .spinning(spin * DVec3::X),
            ],
            duration: 0.4,
            // 1.1 - 1 in floating point, as in the positions.
            truth: Truth::At(1.1 - 1.0),
        },
        tolerance: 1e-9,
        passed_by: Seeker::ALL,
        failed_by: &[],
    },
    Contact {
        name: "peg-hole",
        title: "A peg turns in its hole",
        about: "A square peg of 1 m turns in a square hole of 1.25 m, which no convex shape is; 1 s. Closed form.",
        spins: &[1.0],
        make: |spin| {
            let (inner, outer, high) = (0.625, 1.0, 0.5);
            let wall = |low: [f32; 2], top: [f32; 2]| {
                let [low, top] = [(low, -high), (top, high)].map(|([x, y], z)| Vec3::new(x, y, z));
                [low, top]
            };
            let hole = boxes(&[
                wall([-outer, inner], [outer, outer]),
                wall([-outer, -outer], [outer, -inner]),
                wall([inner, -inner], [outer, inner]),
                wall([-outer, -inner], [-inner, inner]),
            ]);
            let peg = Thing::cuboid(Vec3::new(0.5, 0.5, 1.0), DVec3::ZERO);
            Meeting {
                things: [
                    peg.spinning(spin * DVec3::Z),
                    Thing::mesh(hole, DVec3::ZERO),
                ],
                duration: 1.0,
                truth: Truth::At((FRAC_PI_4 - (0.625 * 2_f64.sqrt()).acos()) / spin),
            }
        },
        tolerance: 1e-9,
        passed_by: Seeker::ALL,
        failed_by: &[],
    },
    Contact {
        name: "graze",
        title: "An edge grazes a floor",
        about: "A cube of 1 m turns above a floor, which its edge cuts by 1e-6 m as it passes and then leaves; half a turn. \
                Closed form.",
        spins: &[1.0],
        make: |spin| {
            let height = 0.5_f64.sqrt() - 1e-6;
            Meeting {
                things: [cube(height * DVec3::Y).spinning(spin * DVec3::Z), floor()],
                duration: FRAC_PI_2 / spin,
                truth: Truth::At((FRAC_PI_4 - (height * 2_f64.sqrt()).acos()) / spin),
            }
        },
        // Rounding errors of 1e-16 m in the initial state cause larger errors of the time of a grazing contact.
        tolerance: 1e-9,
        passed_by: Seeker::ALL,
        failed_by: &[],
    },
    Contact {
        name: "blade-post",
        title: "A blade passes through a post",
        about: "A blade of 2 m, 0.02 m thick, goes round once about its middle and stands at the end as at the start; a post \
                of 0.02 m stands in its way. The time is that from which on the meshes meet by the exact test.",
        spins: &[TAU],
        make: |spin| Meeting {
            things: [
                Thing::cuboid(Vec3::new(1.0, 0.5, 0.01), DVec3::ZERO).spinning(spin * DVec3::Y),
                Thing::cuboid(Vec3::new(0.01, 1.0, 0.01), DVec3::new(0.6, 0.0, -0.6)),
            ],
            duration: 1.0,
            truth: Truth::ByTests,
        },
        tolerance: 1e-9,
        passed_by: &[Seeker::Ours],
        failed_by: PARRY,
    },
    Contact {
        name: "past",
        title: "A cube passes another by a billionth",
        about: "A cube of 1 m flies at 10 m/s past another one, 1e-9 m beside it, and turns about the axis across the gap; \
                0.4 s. They do not meet.",
        spins: &[1.0],
        make: |spin| Meeting {
            things: [
                cube(DVec3::ZERO),
                cube(DVec3::new(2.0, 1.0 + 1e-9, 0.0))
                    .moving(-10.0 * DVec3::X)
                    .spinning(spin * DVec3::Y),
            ],
            duration: 0.4,
            truth: Truth::Never,
        },
        tolerance: 1e-9,
        passed_by: &[Seeker::Ours],
        failed_by: PARRY,
    },
];

impl Contact {
    /// The verdict on a result, for the exact time of first contact. Only the time matters.
    pub fn verdict(&self, exact: Option<f64>, found: &Found) -> Verdict {
        Verdict::of(match (exact, found.time) {
            (Some(exact), Some(time)) => (time - exact).abs() <= self.tolerance,
            (None, None) => true,
            _ => false,
        })
    }
}

impl Meeting {
    /// The exact time of the first contact, s, found without the code under test.
    pub fn exact(&self) -> Option<f64> {
        match self.truth {
            Truth::At(time) => Some(time),
            Truth::Never => None,
            Truth::ByTests => self.by_tests(),
            Truth::LowestCorner => self.by_lowest_corner(),
        }
    }

    fn by_tests(&self) -> Option<f64> {
        let [a, b] = &self.things;
        let trees = [a, b].map(|thing| Bvh::build(&thing.mesh));
        let meet = |t: f64| {
            let inverse = a.rotation_at(t).inverse();
            let offset = inverse * (b.position_at(t) - a.position_at(t));
            let turn = (inverse * b.rotation_at(t)).normalize();
            let placed = Placement::turned(turn, offset);
            placed.is_some_and(|placed| tree::intersect(&trees[0], &trees[1], placed))
        };
        let count = 4096;
        let at = |i: u32| self.duration * f64::from(i) / f64::from(count);
        let first = (0..=count).find(|&i| meet(at(i)))?;
        Some(bisect(at(first.max(1) - 1), at(first), meet))
    }

    fn by_lowest_corner(&self) -> Option<f64> {
        let body = &self.things[0];
        let corners: Vec<DVec3> = body.mesh.vertices().iter().map(|v| v.as_dvec3()).collect();
        let height = |t: f64| {
            let (turn, from) = (body.rotation_at(t), body.position_at(t).y);
            let heights = corners.iter().map(|&corner| (turn * corner).y + from);
            heights.fold(f64::INFINITY, f64::min)
        };
        // Two samples are a hundredth of a radian apart.
        let count = 1000 + (100.0 * body.spin.length() * self.duration) as u32;
        let at = |i: u32| self.duration * f64::from(i) / f64::from(count);
        let reach = corners.iter().map(|corner| corner.length());
        let speed = body.velocity.length() + body.spin.length() * reach.fold(0.0, f64::max);
        let way = speed * self.duration / f64::from(count);
        for i in 1..=count {
            let (before, after) = (at(i - 1), at(i));
            if height(before) > way {
                continue;
            }
            // A height that falls below zero and rises again in between has its minimum there.
            let dip = lowest(before, after, &height);
            let below = [dip, after].into_iter().find(|&t| height(t) <= 0.0);
            if let Some(below) = below {
                return Some(bisect(before, below, |t| height(t) <= 0.0));
            }
        }
        None
    }
}

/// The boundary between false and true, to the last bit.
fn bisect(mut not: f64, mut is: f64, at: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (not + is);
        if middle <= not || middle >= is {
            return is;
        }
        match at(middle) {
            true => is = middle,
            false => not = middle,
        }
    }
}

/// The position of the minimum of a unimodal function in an interval, by ternary search.
fn lowest(mut low: f64, mut high: f64, of: &impl Fn(f64) -> f64) -> f64 {
    for _ in 0..40 {
        let third = (high - low) / 3.0;
        match of(low + third) < of(high - third) {
            true => high -= third,
            false => low += third,
        }
    }
    0.5 * (low + high)
}

impl Seeker {
    /// All seekers that are compiled in.
    pub const ALL: &[Seeker] = &[
        Seeker::Ours,
        #[cfg(feature = "rapier3d-f64")]
        Seeker::ParryMeshes,
        #[cfg(feature = "rapier3d-f64")]
        Seeker::ParryBoxes,
    ];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Seeker::Ours => "ours, meshes",
            #[cfg(feature = "rapier3d-f64")]
            Seeker::ParryMeshes => "parry f64, meshes",
            #[cfg(feature = "rapier3d-f64")]
            Seeker::ParryBoxes => "parry f64, boxes",
        }
    }

    /// Builds trees and shapes; `None` if the seeker has no shape for a mesh.
    pub fn prepare(self, meeting: &Meeting) -> Option<Search> {
        match self {
            Seeker::Ours => Some(ours(meeting)),
            #[cfg(feature = "rapier3d-f64")]
            Seeker::ParryMeshes => peer::search(meeting, false),
            #[cfg(feature = "rapier3d-f64")]
            Seeker::ParryBoxes => peer::search(meeting, true),
        }
    }
}

fn ours(meeting: &Meeting) -> Search {
    let duration = meeting.duration;
    let movers = meeting.things.clone().map(|thing| {
        // With equal moments the body rotates uniformly.
        let flight = Flight::new(
            DVec3::ONE,
            DQuat::IDENTITY,
            thing.spin,
            DVec3::ZERO,
            duration,
        );
        let flight = flight.unwrap_or_else(|error| unreachable!("{error}"));
        (Bvh::build(&thing.mesh), flight, thing)
    });
    Box::new(move || {
        let [a, b] = movers.each_ref().map(|(tree, flight, thing)| Moving {
            figure: Figure::Mesh(tree),
            centre: DVec3::ZERO,
            position: thing.position,
            velocity: thing.velocity,
            acceleration: DVec3::ZERO,
            turning: match thing.spin == DVec3::ZERO {
                true => Turning::Still(DQuat::IDENTITY),
                false => Turning::Flight(flight, DQuat::IDENTITY),
            },
        });
        let touch = first_contact(&a, &b, duration);
        Found {
            time: touch.map(|touch| touch.time),
            // A search that ended early is recognised by a distance that is not a contact.
            has_failed: touch.is_some_and(|touch| touch.distance > touch.near),
        }
    })
}

#[cfg(feature = "rapier3d-f64")]
mod peer {
    use rapier3d_f64::parry::math::{Pose, Vector};
    use rapier3d_f64::parry::query::{
        NonlinearRigidMotion, ShapeCastStatus, cast_shapes_nonlinear,
    };
    use rapier3d_f64::parry::shape::{Cuboid, Shape, TriMesh};

    use super::{Found, Meeting, Search, Thing};
    use crate::scenes::vector;

    fn shape(thing: &Thing, as_box: bool) -> Option<Box<dyn Shape>> {
        if as_box {
            return Some(Box::new(Cuboid::new(vector(thing.half?.as_dvec3()))));
        }
        let vertices = thing.mesh.vertices().iter();
        let vertices = vertices.map(|v| vector(v.as_dvec3())).collect();
        let mesh = TriMesh::new(vertices, thing.mesh.triangles().to_vec()).ok()?;
        Some(Box::new(mesh))
    }

    pub(super) fn search(meeting: &Meeting, as_box: bool) -> Option<Search> {
        let [a, b] = &meeting.things;
        let (first, second) = (shape(a, as_box)?, shape(b, as_box)?);
        let motions = [a, b].map(|thing| {
            let start = Pose::from_translation(vector(thing.position));
            let (velocity, spin) = (vector(thing.velocity), vector(thing.spin));
            NonlinearRigidMotion::new(start, Vector::ZERO, velocity, spin)
        });
        let duration = meeting.duration;
        Some(Box::new(move || {
            let [a, b] = &motions;
            let hit =
                cast_shapes_nonlinear(a, first.as_ref(), b, second.as_ref(), 0.0, duration, true);
            match hit {
                Ok(hit) => Found {
                    time: hit.map(|hit| hit.time_of_impact),
                    has_failed: hit.is_some_and(|hit| hit.status != ShapeCastStatus::Converged),
                },
                Err(_) => Found {
                    time: None,
                    has_failed: true,
                },
            }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_tests_come_to_the_closed_forms() {
        for contact in &CONTACTS {
            for &spin in contact.spins {
                let meeting = (contact.make)(spin);
                let exact = meeting.exact();
                let tested = meeting.by_tests();
                println!("{} {spin}: {exact:?} {tested:?}", contact.name);
                assert_eq!(exact.is_some(), tested.is_some(), "{}", contact.name);
                assert_ne!(exact, Some(0.0), "{} meet at the start", contact.name);
                let off = exact.zip(tested).map_or(0.0, |(a, b)| (a - b).abs());
                assert!(off < 1e-10, "{} {spin}: {off:e}", contact.name);
            }
        }
    }

    #[test]
    fn a_miss_a_ghost_and_a_late_time_fail() {
        let contact = &CONTACTS[0];
        let found = |time| Found {
            time,
            has_failed: false,
        };
        for (exact, time, verdict) in [
            (Some(0.5), Some(0.5), Verdict::Pass),
            (Some(0.5), Some(0.6), Verdict::Fail),
            (Some(0.5), Some(f64::NAN), Verdict::Fail),
            (Some(0.5), None, Verdict::Fail),
            (None, Some(0.5), Verdict::Fail),
            (None, None, Verdict::Pass),
        ] {
            assert_eq!(contact.verdict(exact, &found(time)), verdict);
        }
    }
}
