//! How scenes of a kind are made and judged.

use std::env;

use sim_core::{Body, Collision, DVec3, Impact, Settings, Shape, World};

/// SplitMix64: numbers that look random and are the same on every run.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn from(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }

    /// A whole number.
    pub(crate) fn whole(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as u64) as i64
    }

    pub(crate) fn one_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u64) as usize]
    }

    /// Each component from -1 to 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(
            self.from(-1.0, 1.0),
            self.from(-1.0, 1.0),
            self.from(-1.0, 1.0),
        )
    }
}

/// What has been judged of a kind.
#[derive(Default)]
struct Tally {
    judged: usize,
    wrong: usize,
    shown: Vec<String>,
}

/// Judges scenes of a kind: as many as are asked for, or the usual number. A case says nothing of a
/// scene that is none of its kind, as where bodies overlap from the start.
pub(crate) fn judge(usual: usize, case: impl Fn(&mut Random) -> Option<Result<(), String>>) {
    judge_from(0, usual, case);
}

/// The same from another scene on.
pub(crate) fn judge_from(
    begin: usize,
    usual: usize,
    case: impl Fn(&mut Random) -> Option<Result<(), String>>,
) {
    let number = |name| {
        env::var(name)
            .ok()
            .map(|text: String| text.parse().expect("a number"))
    };
    let count: usize = number("CASES").unwrap_or(usual);
    let first = number("FIRST").unwrap_or(begin);
    let mut tally = Tally::default();
    for index in first.. {
        if tally.judged == count || index == first + 8 * count {
            break;
        }
        // Each from its own number, so that it can be made again alone.
        let mut random = Random((index as u64).wrapping_mul(0xd134_2543_de82_ef95));
        let Some(verdict) = case(&mut random) else {
            continue;
        };
        tally.judged += 1;
        if let Err(what) = verdict {
            tally.wrong += 1;
            if tally.shown.len() < 6 {
                tally.shown.push(format!("FIRST={index}: {what}"));
            }
        }
    }
    let Tally {
        judged,
        wrong,
        shown,
    } = tally;
    println!("{judged} judged, {wrong} wrong");
    assert_eq!(judged, count, "too few scenes of this kind");
    assert_eq!(wrong, 0, "of {judged}:\n{}", shown.join("\n"));
}

pub(crate) fn world(dt: f64, bodies: Vec<Body>) -> World {
    let settings = Settings {
        dt,
        collision: Collision::Continuous,
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("settings");
    for body in bodies {
        world.add(body).expect("a body");
    }
    world
}

pub(crate) fn body(shape: &Shape, position: DVec3, velocity: DVec3) -> Body {
    Body {
        shape: Some(shape.clone()),
        position,
        velocity,
        ..Body::default()
    }
}

pub(crate) fn immovable(body: Body) -> Body {
    Body {
        mass: f64::INFINITY,
        ..body
    }
}

pub(crate) fn half_space(normal: DVec3, position: DVec3) -> Body {
    immovable(body(&Shape::HalfSpace { normal }, position, DVec3::ZERO))
}

/// Impacts that a step of a few bodies may have.
const MOST: usize = 2_000;

/// Steps, and says what is wrong after it: an error, impacts without end, or bodies that meet.
pub(crate) fn step(world: &mut World) -> Result<Vec<Impact>, String> {
    let mut impacts = Vec::new();
    let at = world.steps() + 1;
    world
        .step_reporting(&mut impacts)
        .map_err(|error| error.to_string())?;
    if impacts.len() > MOST {
        return Err(format!("step {at}: {} impacts", impacts.len()));
    }
    let pairs = overlaps(world);
    match pairs.is_empty() {
        true => Ok(impacts),
        false => Err(format!("step {at}: {pairs:?} meet")),
    }
}

/// Who meets whom where bodies are now, by the exact test of a world in which they are placed afresh.
pub(crate) fn overlaps(world: &World) -> Vec<(usize, usize)> {
    let mut again = World::new(*world.settings()).expect("settings");
    for i in 0..world.len() {
        let body = Body {
            shape: world.shape(i).cloned(),
            position: world.position(i),
            mass: world.mass(i),
            ..Body::default()
        };
        again.add(body).expect("a body");
    }
    again.overlapping().to_vec()
}

/// Kinetic energy, and potential energy under a weight along -y, J.
pub(crate) fn energy(world: &World, gravity: f64) -> f64 {
    let movable = (0..world.len()).filter(|&i| world.mass(i).is_finite());
    let potential = movable.map(|i| world.mass(i) * gravity * world.position(i).y);
    world.kinetic_energy() + potential.sum::<f64>()
}
