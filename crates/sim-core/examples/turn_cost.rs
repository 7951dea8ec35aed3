//! What a step of a free rotation costs, and how much of its energy it keeps.
//!
//! `cargo run --release -p sim-core --example turn_cost`

use std::hint::black_box;
use std::time::Instant;

use sim_core::rotation::{Flight, spin};
use sim_core::{DQuat, DVec3};

const STEPS: u32 = 200_000;

fn main() {
    println!(
        "moments, angle of a step: ns to make it and to have its end, drift of energy in {STEPS} steps"
    );
    let dt = 1.0 / 60.0;
    for moments in [
        DVec3::splat(1.0),
        DVec3::new(1.0, 1.0, 0.5),
        DVec3::new(1.0, 2.0, 3.0),
    ] {
        for angle in [0.01, 0.1, 0.3, 1.0, 10.0] {
            let momentum = moments * DVec3::new(3.0, 4.0, 5.0).normalize() * angle / dt;
            let energy = |rotation: DQuat| momentum.dot(spin(moments, rotation, momentum));
            let mut rotation = DQuat::IDENTITY;
            let first = energy(rotation);
            let start = Instant::now();
            for _ in 0..STEPS {
                let flight = Flight::new(moments, rotation, momentum, DVec3::ZERO, black_box(dt))
                    .expect("a flight");
                rotation = flight.rotation_at(dt);
            }
            let nanoseconds = start.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS);
            let drift = energy(rotation) / first - 1.0;
            println!("{moments} {angle:5}: {nanoseconds:7.0} {drift:9.1e}");
        }
    }
}
