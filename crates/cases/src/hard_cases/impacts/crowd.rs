//! Cases 24, 26: the state restored after a hit; a hundred cubes in a box.

use kit::bodies::mesh_body;
use kit::meshes::{builtin, cube, star};
use kit::worlds::{precise, world_of};
use sim_core::{Collision, DVec3, Settings};

use super::{DT, Finding, PHASES, Tried, worst};
use crate::scenes::{Form, HALF, continuous, crowd};

/// A step with a hit is undone as a whole, and no other step is.
pub(crate) fn rollback() -> Tried {
    let cube = cube(0.5);
    let (mut hits, mut wrong) = (0, 0);
    let mut lost: f64 = 0.0;
    for (still, collision) in [
        (star(1.0, 0.2), Collision::Naive),
        (star(1.0, 0.2), Collision::Bvh),
        (builtin("cow.obj"), Collision::Bvh),
    ] {
        for phase in 0..PHASES {
            let x = -3.0 - 2.0 * DT * f64::from(phase) / f64::from(PHASES);
            let bodies = [
                mesh_body(&still, DVec3::ZERO, DVec3::ZERO),
                mesh_body(&cube, DVec3::new(x, 0.25, 0.0), 2.0 * DVec3::X),
            ];
            let settings = Settings {
                collision,
                ..precise(DT)
            };
            let mut world = world_of(settings, bodies);
            let mut moves = 0;
            for _ in 0..180 {
                let (before, impacts) = ([0, 1].map(|i| world.position(i)), world.impacts());
                world.step()?;
                if world.impacts() > impacts {
                    hits += 1;
                    wrong += u32::from([0, 1].map(|i| world.position(i)) != before);
                } else {
                    moves += 1;
                }
            }
            wrong += u32::from(moves == 180);
            let centre = 0.5 * (world.position(0) + world.position(1));
            lost = worst([lost, (centre.x - 0.5 * x - f64::from(moves) * DT).abs()]);
        }
    }
    let why = format!(
        "discrete modes: {hits} steps with a hit; {wrong} of them move a body, or runs are without; \
         figure: way of the centre in other steps"
    );
    let figure = if wrong > 0 { f64::INFINITY } else { lost };
    Ok(Finding::within(figure, 1e-12, why))
}

/// The duration, s.
const LONG: u64 = 1000;

pub(crate) fn cubes() -> Tried {
    let (scene, half_box) = crowd(100, &Form::Cube(HALF));
    let mut world = continuous(&scene);
    let start = world.kinetic_energy();
    let (mut words, mut figure, mut wrong) = (Vec::new(), 0.0, 0);
    for seconds in [10, LONG] {
        while world.steps() < 60 * seconds {
            world.step()?;
        }
        let positions: Vec<DVec3> = scene.movable().map(|i| world.position(i)).collect();
        for (i, p) in positions.iter().enumerate() {
            wrong += u32::from(p.abs().max_element() > half_box - HALF + 1e-12);
            let overlaps = |q: &DVec3| (*q - *p).abs().max_element() < 2.0 * HALF - 1e-12;
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
