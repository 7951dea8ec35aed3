//! A stiff method of order four.

use super::{Method, implicit::Equation};

pub(super) static METHOD: Method = Method {
    name: "sdirk4",
    title: "SDIRK 4",
    order: 4,
    stability: "stable at every step (A- and L-stable): stiff motion dies out at once",
    source: "Hairer, Wanner 1996, Solving Ordinary Differential Equations II, eq. IV.6.16",
    symplectic: false,
    reversible: false,
    adaptive: false,
    fall: Some(0.5),
    // Five stages, each an equation like backward Euler's with the same dt/4. The last one is the
    // end of the step.
    step: |system, s| {
        let (n, h) = (s.position.len(), GAMMA * s.dt);
        let ([x, v, mut rest @ ..], room) = s.scratch.with_newton::<{ 2 + 2 * STAGES }>(n);
        let (speeds, slopes) = rest.split_at_mut(STAGES);
        s.new_velocity.copy_from_slice(s.velocity);
        for stage in 0..STAGES {
            x.copy_from_slice(s.position);
            v.copy_from_slice(s.velocity);
            for (earlier, weight) in A[stage].iter().enumerate().take(stage) {
                for i in 0..n {
                    x[i] += weight * s.dt * speeds[earlier][i];
                    v[i] += weight * s.dt * slopes[earlier][i];
                }
            }
            let equation = Equation {
                time: s.time + NODES[stage] * s.dt,
                position: x,
                velocity: v,
                h,
                drift: h,
            };
            equation.solve(system, s.new_velocity, room)?;
            for i in 0..n {
                let w = s.new_velocity[i];
                speeds[stage][i] = w;
                slopes[stage][i] = (w - v[i]) / h;
                s.new_position[i] = x[i] + h * w;
            }
        }
        Ok(())
    },
};

const STAGES: usize = 5;
const GAMMA: f64 = 0.25;
const NODES: [f64; STAGES] = [1.0 / 4.0, 3.0 / 4.0, 11.0 / 20.0, 1.0 / 2.0, 1.0];

/// Below the diagonal, on which every entry is [`GAMMA`].
const A: [[f64; 4]; STAGES] = [
    [0.0; 4],
    [1.0 / 2.0, 0.0, 0.0, 0.0],
    [17.0 / 50.0, -1.0 / 25.0, 0.0, 0.0],
    [371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0, 0.0],
    [25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0],
];
