//! The classical Runge-Kutta method of order four.

use super::Method;

pub(super) static METHOD: Method = Method {
    name: "rk4",
    title: "Classical RK4",
    order: 4,
    stability: "stable while ω dt < 2.83: an oscillator loses energy slowly",
    source: "Kutta 1901; Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I, sec. II.1",
    symplectic: false,
    reversible: false,
    adaptive: false,
    fall: Some(0.5),
    // Four slopes: at the start, twice in the middle, at the end. The columns for the end accumulate their weighted
    // sum.
    step: |system, s| {
        let (x, v, dt) = (s.position, s.velocity, s.dt);
        let [xs, vs, a] = s.scratch.columns(x.len());
        xs.copy_from_slice(x);
        vs.copy_from_slice(v);
        s.new_position.copy_from_slice(x);
        s.new_velocity.copy_from_slice(v);
        let stages = [
            (0.0, 1.0, 0.5),
            (0.5, 2.0, 0.5),
            (0.5, 2.0, 1.0),
            (1.0, 1.0, 0.0),
        ];
        for (node, weight, next) in stages {
            system.accelerations(s.time + node * dt, xs, vs, a);
            let share = weight / 6.0 * dt;
            for i in 0..x.len() {
                s.new_position[i] += share * vs[i];
                s.new_velocity[i] += share * a[i];
                xs[i] = x[i] + next * dt * vs[i];
                vs[i] = v[i] + next * dt * a[i];
            }
        }
        Ok(())
    },
};
