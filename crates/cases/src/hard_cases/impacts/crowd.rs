//! Cases 24, 26: what a hit puts back; a hundred cubes in a box.

use sim_core::{Body, Collision, DVec3, Settings, Vec3};

use super::{DT, Finding, Tried, builtin, cuboid, mesh, settings, wall, world, worst};

pub(crate) fn rollback() -> Tried {
    let (cow, cube) = (builtin("cow.obj")?, builtin("cube.obj")?);
    let (mut hits, mut wrong) = (0, 0);
    for phase in 0..super::PHASES {
        let settings = Settings {
            collision: Collision::Bvh,
            ..settings(DT)
        };
        let x = -3.0 - 2.0 * DT * f64::from(phase) / f64::from(super::PHASES);
        let bodies = [
            mesh(&cow, DVec3::ZERO, DVec3::ZERO),
            mesh(&cube, DVec3::new(x, 0.25, 0.0), 2.0 * DVec3::X),
        ];
        let mut world = world(settings, &bodies)?;
        for _ in 0..180 {
            let (before, impacts) = ([0, 1].map(|i| world.position(i)), world.impacts());
            world.step()?;
            if world.impacts() > impacts {
                hits += 1;
                wrong += u32::from([0, 1].map(|i| world.position(i)) != before);
            }
        }
    }
    let why = format!("discrete mode: {hits} steps with a hit, {wrong} of which move a body");
    let figure = if hits > 0 {
        f64::from(wrong)
    } else {
        f64::INFINITY
    };
    Ok(Finding::within(figure, 0.0, why))
}

const HALF_BOX: f64 = 2.5;
const HALF_CUBE: f64 = 0.25;
/// s
const LONG: u64 = 1000;

/// The golden ratio's powers spread numbers from -1 to 1 evenly (Roberts 2018, "The unreasonable
/// effectiveness of quasirandom sequences").
fn spread(n: usize, k: usize) -> f64 {
    let ratio = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9][k];
    2.0 * (n as f64 * ratio).fract() - 1.0
}

pub(crate) fn cubes() -> Tried {
    let cube = cuboid(Vec3::splat(HALF_CUBE as f32), Vec3::ZERO)?.into();
    let mut bodies: Vec<Body> = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|axis| [axis, -axis])
        .map(|normal| wall(normal, -HALF_BOX * normal, DVec3::ZERO))
        .collect();
    let walls = bodies.len();
    bodies.extend((0..100).map(|i| {
        let vector = |n| DVec3::new(spread(n, 0), spread(n, 1), spread(n, 2));
        let cell = DVec3::from_array([i % 5, i / 5 % 5, i / 25].map(|c| c as f64));
        let place = cell - DVec3::new(2.0, 2.0, 1.5) + 0.2 * vector(i + 1);
        mesh(&cube, place, 2.0 * vector(i + 301))
    }));
    let mut world = world(settings(DT), &bodies)?;
    let start = world.kinetic_energy();
    let (mut words, mut figure, mut wrong) = (Vec::new(), 0.0, 0);
    for seconds in [10, LONG] {
        while world.steps() < 60 * seconds {
            world.step()?;
        }
        let positions: Vec<DVec3> = (walls..world.len()).map(|i| world.position(i)).collect();
        for (i, p) in positions.iter().enumerate() {
            wrong += u32::from(p.abs().max_element() > HALF_BOX - HALF_CUBE + 1e-12);
            let overlaps = |q: &DVec3| (*q - *p).abs().max_element() < 2.0 * HALF_CUBE - 1e-12;
            wrong += positions[..i].iter().filter(|q| overlaps(q)).count() as u32;
        }
        let error = (world.kinetic_energy() / start - 1.0).abs();
        figure = worst([figure, error / (world.impacts() as f64).sqrt()]);
        words.push(format!(
            "{error:.1e} after {} impacts in {seconds} s",
            world.impacts()
        ));
    }
    let why = format!(
        "energy is off by {}; {wrong} are outside or in another; figure: error by the root of \
         impacts",
        words.join(" and by ")
    );
    let figure = if wrong > 0 { f64::INFINITY } else { figure };
    Ok(Finding::within(figure, 1e-15, why))
}
