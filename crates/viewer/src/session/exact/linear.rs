//! A body under forces that are linear in position and velocity: springs without rest length to fixed points, linear
//! drag, and a constant force.

use sim_core::DVec3;

/// The equation `x'' = push - stiffness x - damping x'`, each per kg, with x relative to `centre`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear {
    /// The point towards which the springs pull, m.
    pub(super) centre: DVec3,
    /// Acceleration by constant forces, m/s².
    pub(super) push: DVec3,
    /// Stiffness over mass, 1/s².
    pub(super) stiffness: f64,
    /// Drag and damping over mass, 1/s.
    pub(super) damping: f64,
}

impl Linear {
    /// Position, m, and velocity, m/s, after `time`, s, from an initial position and velocity.
    pub(super) fn at(&self, place: DVec3, velocity: DVec3, time: f64) -> (DVec3, DVec3) {
        if self.stiffness == 0.0 {
            return self.dragged(place, velocity, time);
        }
        let rest = self.centre + self.push / self.stiffness;
        let away = place - rest;
        let half = 0.5 * self.damping;
        let under = half * half - self.stiffness;
        // The motion is `a(t) away + b(t) velocity`, and its derivative has the same form.
        let [a, b, a_slope, b_slope] = if under * time * time > 1e-4 {
            // Two decaying exponentials, written so that neither is a difference of large numbers.
            let fast = -(half + under.sqrt());
            let slow = self.stiffness / fast;
            let (e_slow, e_fast) = ((slow * time).exp(), (fast * time).exp());
            let width = slow - fast;
            [
                (slow * e_fast - fast * e_slow) / width,
                (e_slow - e_fast) / width,
                self.stiffness * (e_fast - e_slow) / width,
                (slow * e_slow - fast * e_fast) / width,
            ]
        } else {
            let (cos, sin) = if under * time * time < -1e-4 {
                let turn = (-under).sqrt();
                ((turn * time).cos(), (turn * time).sin() / turn)
            } else {
                // Near critical damping both are computed from their series.
                let z = under * time * time;
                (
                    1.0 + z / 2.0 * (1.0 + z / 12.0 * (1.0 + z / 30.0)),
                    time * (1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0))),
                )
            };
            let fall = (-half * time).exp();
            [
                fall * (cos + half * sin),
                fall * sin,
                -fall * self.stiffness * sin,
                fall * (cos - half * sin),
            ]
        };
        (
            rest + a * away + b * velocity,
            a_slope * away + b_slope * velocity,
        )
    }

    /// Drag without a spring.
    fn dragged(&self, place: DVec3, velocity: DVec3, time: f64) -> (DVec3, DVec3) {
        let end = self.push / self.damping;
        let excess = velocity - end;
        let gone = -(-self.damping * time).exp_m1();
        (
            place + end * time + excess * (gone / self.damping),
            velocity - excess * gone,
        )
    }
}
