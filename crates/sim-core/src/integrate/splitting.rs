//! Symplectic methods made of drifts, `x += h v`, and kicks, `v += h a(t, x)`.
//!
//! Each of the two is the exact flow of one part of the energy, so any sequence of them is symplectic, and a
//! palindrome is reversible (Hairer, Lubich, Wanner 2006, sec. II.5 and III.3).
//!
//! Forces that depend on the velocity have no such part. A sequence of drifts `a_i` and kicks `b_i` is also a
//! sequence of symplectic Euler steps and their adjoints, of lengths
//! `α_1 = a_1, α_2 = b_1 - α_1, α_3 = a_2 - α_2, ...`. It keeps its order with any other pair of a first-order method
//! and its adjoint (McLachlan 1995, "On the numerical integration of ordinary differential equations by symmetric
//! composition methods", SIAM J. Sci. Comput. 16, p. 151). So a kick has two parts: `v += α_2i-1 h a(t, x, v)` with
//! the velocity before it, and `v += α_2i h a(t, x, v)` with the velocity after it. Order and reversibility remain;
//! symplecticity is not defined for such forces.

use glam::DVec3;

use super::{Failure, Scratch, Step, System, implicit::Equation};

/// A kick at a time (s), in two parts (s): one uses the velocity before it, the other the velocity after it.
pub(super) struct Kick {
    pub(super) time: f64,
    pub(super) explicit: f64,
    pub(super) implicit: f64,
}

impl Kick {
    pub(super) fn act(
        &self,
        system: &dyn System,
        x: &[DVec3],
        v: &mut [DVec3],
        scratch: &mut Scratch,
    ) -> Result<(), Failure> {
        let system = system.kicks().unwrap_or(system);
        let ([a], newton) = scratch.with_newton(x.len());
        let by_velocity = system.depends_on_velocity();
        let explicit = match by_velocity {
            true => self.explicit,
            false => self.explicit + self.implicit,
        };
        if explicit != 0.0 {
            system.accelerations(self.time, x, v, a);
            for (v, a) in v.iter_mut().zip(a.iter()) {
                *v += explicit * *a;
            }
        }
        if !by_velocity || self.implicit == 0.0 {
            return Ok(());
        }
        a.copy_from_slice(v);
        let equation = Equation {
            time: self.time,
            position: x,
            velocity: a,
            h: self.implicit,
            drift: 0.0,
        };
        equation.solve(system, v, newton)
    }
}

/// A step of alternating drifts and kicks, a drift first and last; lengths are fractions of `dt`.
pub(super) fn step<const KICKS: usize>(
    system: &dyn System,
    s: Step<'_>,
    drifts: &[f64],
    kicks: &[f64; KICKS],
) -> Result<(), Failure> {
    s.new_position.copy_from_slice(s.position);
    s.new_velocity.copy_from_slice(s.velocity);
    // The part of the kick that uses the velocity before it: the rest of the drift before the kick.
    let mut explicit = drifts[0];
    let mut now = 0.0;
    for (i, &length) in kicks.iter().enumerate() {
        now += drifts[i];
        system.drift(drifts[i] * s.dt, s.new_position, s.new_velocity);
        let implicit = length - explicit;
        let kick = Kick {
            time: s.time + now * s.dt,
            explicit: explicit * s.dt,
            implicit: implicit * s.dt,
        };
        kick.act(system, s.new_position, s.new_velocity, s.scratch)?;
        explicit = drifts[i + 1] - implicit;
    }
    system.drift(drifts[KICKS] * s.dt, s.new_position, s.new_velocity);
    Ok(())
}
