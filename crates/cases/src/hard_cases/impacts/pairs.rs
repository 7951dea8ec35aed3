//! Cases 9, 10, 13, 14, 21: two bodies head on.

use kit::bodies::{body, immovable, wall};
use kit::meshes::{cube, cuboid, sheet};
use kit::shapes::ball;
use kit::worlds::{precise, run, world_of};
use sim_core::{Body, DVec3, Shape, Vec3};

use super::{DT, Finding, PHASES, Tried, ULP, apart, motions, worst};

const STEPS: u64 = 8;

/// A cube of edge 1 m and a ball of the same width, with their half extents along x, m.
fn shapes() -> [(Shape, f64); 2] {
    [(Shape::Mesh(cube(0.5)), 0.5), (ball(0.5), 0.5)]
}

/// Two bodies on the x axis; the first one approaches from the left.
struct HeadOn {
    bodies: [Body; 2],
    /// Start position of the second body, m.
    origin: f64,
    /// Distance of the positions at contact, m.
    reach: f64,
    speeds: [f64; 2],
    after: [f64; 2],
}

impl HeadOn {
    fn equal((shape, half): (Shape, f64), speeds: [f64; 2]) -> HeadOn {
        let body = Body {
            shape: Some(shape),
            ..Body::default()
        };
        HeadOn {
            bodies: [body.clone(), body],
            origin: 1.0,
            reach: 2.0 * half,
            speeds,
            after: [speeds[1], speeds[0]],
        }
    }

    /// Over all phases: the number of missing or additional impacts, and the greatest error of velocities, positions
    /// and times, relative to the tolerances: 4u of a body's own speed, 1e-12 v dt, and a rounding of the largest
    /// coordinate for each step and for the impact.
    fn errors(&self) -> anyhow::Result<Errors> {
        let mut errors = Errors::default();
        for phase in 0..PHASES {
            let approach = self.speeds[0] - self.speeds[1];
            let hit = (3.0 + f64::from(phase) / f64::from(PHASES)) * DT;
            let gap = approach * hit;
            let places = [self.origin - self.reach - gap, self.origin];
            let mut bodies = self.bodies.clone();
            for i in 0..2 {
                bodies[i].position = DVec3::X * places[i];
                bodies[i].velocity = DVec3::X * self.speeds[i];
            }
            let mut world = world_of(precise(DT), bodies);
            let impacts = run(&mut world, STEPS)?;
            errors.tried += 1;
            errors.wrong += u32::from(impacts.len() != 1);
            let size = self.origin + LARGEST + gap + approach * STEPS as f64 * DT;
            let rounding = (STEPS as f64 + 32.0) * ULP * size;
            let hit = gap / approach;
            if let Some(impact) = impacts.first() {
                let allowed = 1e-12 * DT + rounding / approach;
                errors.time = worst([errors.time, (impact.time - hit).abs() / allowed]);
            }
            let rest = STEPS as f64 * DT - hit;
            for (i, place) in places.into_iter().enumerate() {
                let end = place + self.speeds[i] * hit + self.after[i] * rest;
                let exact = DVec3::X * self.after[i];
                let own = 2.0 * ULP * self.after[i].abs().max(self.speeds[i].abs());
                let off = (world.velocity(i) - exact).length();
                errors.velocity = worst([errors.velocity, off / own.max(f64::MIN_POSITIVE)]);
                let allowed = 1e-12 * approach * DT + rounding;
                let off = (world.position(i) - DVec3::X * end).length();
                errors.position = worst([errors.position, off / allowed]);
            }
        }
        Ok(errors)
    }
}

/// Largest half extent of the shapes here, m.
const LARGEST: f64 = 4.0;

#[derive(Default)]
struct Errors {
    tried: u32,
    wrong: u32,
    velocity: f64,
    position: f64,
    time: f64,
}

impl Errors {
    fn of(pairs: impl IntoIterator<Item = HeadOn>) -> anyhow::Result<Errors> {
        let mut all = Errors::default();
        for pair in pairs {
            let errors = pair.errors()?;
            all.tried += errors.tried;
            all.wrong += errors.wrong;
            all.velocity = worst([all.velocity, errors.velocity]);
            all.position = worst([all.position, errors.position]);
            all.time = worst([all.time, errors.time]);
        }
        Ok(all)
    }

    fn finding(self) -> Finding {
        let wrong = 2.0 * f64::from(self.wrong);
        let why = format!(
            "{} of {} impacts; velocities are off by {:.2} of 4u of the body's own, positions by \
             {:.2} of 1e-12 v dt and the rounding of coordinates, times by {:.2} of what that takes",
            self.tried - self.wrong,
            self.tried,
            self.velocity,
            self.position,
            self.time
        );
        Finding::within(
            worst([self.velocity, self.position, self.time, wrong]),
            1.0,
            why,
        )
    }
}

const SPEEDS: [f64; 10] = [1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6];

/// Points too, also with the second one at the origin: there neither sizes nor coordinates give the length of a rounding,
/// by which bodies that meet are kept apart.
pub(crate) fn head_on() -> Tried {
    let point = (ball(0.0), 0.0);
    let alike = shapes().into_iter().chain([point.clone()]);
    let mut pairs = Vec::new();
    for speed in SPEEDS {
        pairs.extend(
            alike
                .clone()
                .map(|shape| HeadOn::equal(shape, [speed, 0.0])),
        );
        pairs.push(HeadOn {
            origin: 0.0,
            ..HeadOn::equal(point.clone(), [speed, 0.0])
        });
    }
    Ok(Errors::of(pairs)?.finding())
}

pub(crate) fn both_fast() -> Tried {
    let small = (Shape::Mesh(cube(0.1)), f64::from(0.1f32));
    let pairs = shapes().into_iter().chain([small]);
    let pairs = pairs.map(|shape| HeadOn::equal(shape, [200.0, -200.0]));
    Ok(Errors::of(pairs)?.finding())
}

/// Points, balls and cubes hit a half-space, a plate, and a sheet without thickness.
pub(crate) fn thin_wall() -> Tried {
    let fixed = |mesh| immovable(body(&Shape::Mesh(mesh), DVec3::ZERO, DVec3::ZERO));
    let walls = [
        (wall(-DVec3::X, DVec3::ZERO, DVec3::ZERO), 0.0),
        (
            fixed(cuboid(Vec3::new(0.0005, 4.0, 4.0))),
            f64::from(0.0005f32),
        ),
        (fixed(sheet(0.0)), 0.0),
    ];
    let shapes = [
        (ball(0.0), 0.0),
        (ball(0.25), 0.25),
        (Shape::Mesh(cube(0.25)), 0.25),
    ];
    let mut pairs = Vec::new();
    for (wall, thick) in walls {
        for shape in &shapes {
            pairs.extend(SPEEDS.map(|speed| {
                let mut pair = HeadOn::equal(shape.clone(), [speed, 0.0]);
                pair.bodies[1] = wall.clone();
                pair.reach = shape.1 + thick;
                pair.after = [-speed, 0.0];
                pair
            }));
        }
    }
    Ok(Errors::of(pairs)?.finding())
}

pub(crate) fn mass_ratio() -> Tried {
    let mut pairs = Vec::new();
    for shape in shapes() {
        for ratio in [1e3, 1e6, 1e9, 1e12] {
            for [m1, m2] in [[1.0, ratio], [ratio, 1.0]] {
                let mut pair = HeadOn::equal(shape.clone(), [10.0, 0.0]);
                pair.bodies[0].mass = m1;
                pair.bodies[1].mass = m2;
                pair.after = [(m1 - m2) / (m1 + m2) * 10.0, 2.0 * m1 / (m1 + m2) * 10.0];
                pairs.push(pair);
            }
        }
    }
    Ok(Errors::of(pairs)?.finding())
}

/// The figure is relative to 12 u of the distance, for rounding and twice the gap kept between bodies. Any different
/// velocity is a failure.
pub(crate) fn far_away() -> Tried {
    let (mut figure, mut velocities): (f64, u32) = (0.0, 0);
    for (shape, half) in shapes() {
        for phase in 0..PHASES {
            let gap = 60.0 * DT * (1.0 + f64::from(phase) / f64::from(PHASES));
            // On the grid of numbers at the farthest position, so that the start is the same at every distance.
            let start = -((2.0 * half + gap) * 2f64.powi(24)).round() * 2f64.powi(-24);
            let at = |far: DVec3| -> anyhow::Result<_> {
                let moving = |x: DVec3, v: f64| body(&shape, x, DVec3::X * v);
                let bodies = [moving(far + DVec3::X * start, 60.0), moving(far, 0.0)];
                let mut world = world_of(precise(DT), bodies);
                let impacts = run(&mut world, 4)?.len();
                let back = |(x, v): (DVec3, DVec3)| (x - far, v);
                let ends: Vec<_> = motions(&world).into_iter().map(back).collect();
                Ok((impacts, ends))
            };
            let (_, near) = at(DVec3::ZERO)?;
            for far in [1e4, 1e6, 1e8] {
                for axis in [DVec3::X, DVec3::new(1.0, 1.0, -1.0)] {
                    let (impacts, found) = at(far * axis)?;
                    let differ = (0..2).filter(|&i| found[i].1 != near[i].1).count();
                    velocities += differ as u32 + u32::from(impacts != 1);
                    figure = worst([figure, apart(&found, &near) / (12.0 * ULP * far)]);
                }
            }
        }
    }
    let why = format!(
        "{velocities} velocities differ at 1e4, 1e6 and 1e8 m; figure: positions, in parts of 12 u \
         of the distance, as bodies are kept apart by some"
    );
    let figure = if velocities > 0 {
        f64::INFINITY
    } else {
        figure
    };
    Ok(Finding::within(figure, 1.0, why))
}
