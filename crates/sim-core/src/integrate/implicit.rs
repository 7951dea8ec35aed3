//! The equation that every implicit method here comes down to.
//!
//! ```text
//! w = v + h a(t, x + d w, w)
//! ```
//!
//! for the velocities `w`. Backward Euler has `d = h = dt`; the implicit midpoint rule has half of
//! that; each stage of a diagonally implicit Runge-Kutta method has `d = h = γ dt`; a kick by a
//! force that depends on the velocity has `d = 0`.
//!
//! Newton's method solves it: `(1 - h ∂a/∂v - h d ∂a/∂x) δ = w - v - h a`, then `w - δ`, until `δ`
//! is below [`TOLERANCE`]. Bodies that no force couples have a 3×3 matrix each; coupled ones are
//! left to a Krylov method, which needs products with the matrix only.

use glam::{DMat3, DVec3};

use super::{Failure, Jacobians, System, krylov, scratch::Newton};

/// Size of the last correction, relative to the greatest of the velocities and of `x/h`. Newton's
/// method squares its error, so what is left is rounding.
const TOLERANCE: f64 = 1e-12;

/// Size from which on corrections may stop to shrink.
const LOOSE_TOLERANCE: f64 = 1e-8;

/// Corrections after which a solution is given up. From a good start it takes two or three.
const ITERATIONS: u32 = 40;

/// What is known of the equation.
pub(super) struct Equation<'a> {
    /// Time at which accelerations are taken.
    pub(super) time: f64,
    /// `x`
    pub(super) position: &'a [DVec3],
    /// `v`
    pub(super) velocity: &'a [DVec3],
    /// `h`
    pub(super) h: f64,
    /// `d`
    pub(super) drift: f64,
}

impl Equation<'_> {
    /// Solves for the velocities, starting from those in `w`.
    pub(super) fn solve(
        &self,
        system: &dyn System,
        w: &mut [DVec3],
        room: &mut Newton,
    ) -> Result<(), Failure> {
        let mut worst = (0, f64::INFINITY);
        for _ in 0..ITERATIONS {
            let last = worst.1;
            worst = if system.is_coupled() {
                self.correct_together(system, w, room)
            } else {
                self.correct_each(system, w, room)
            };
            // The next correction would be smaller than this one by at least as much again.
            let next = worst.1 * (worst.1 / last);
            let solved = worst.1 <= TOLERANCE || last.is_finite() && next <= 0.01 * TOLERANCE;
            // Corrections that no longer shrink are rounding, where large forces cancel.
            let stalled = worst.1 <= LOOSE_TOLERANCE && worst.1 > 0.5 * last;
            if solved || stalled {
                return Ok(());
            }
            if !worst.1.is_finite() {
                break;
            }
        }
        Err(Failure::NotConverged {
            body: worst.0,
            iterations: ITERATIONS,
        })
    }

    /// One correction of bodies that do not depend on each other. Returns the body with the
    /// largest, relative to its own speed, and that size.
    fn correct_each(
        &self,
        system: &dyn System,
        w: &mut [DVec3],
        room: &mut Newton,
    ) -> (usize, f64) {
        let n = w.len();
        let ([x, residual], jacobians) = room.columns(n);
        jacobians.resize(n, Jacobians::ZERO);
        self.residual(system, w, x, residual);
        system.jacobians(self.time, x, w, jacobians);
        let mut worst = (0, 0.0);
        for i in 0..n {
            let correction = solve3(self.matrix(&jacobians[i]), residual[i]);
            w[i] -= correction;
            let size = largest(correction) / self.scale(i, w[i]);
            // A NaN is the worst of all.
            if size > worst.1 || size.is_nan() {
                worst = (i, size);
            }
        }
        worst
    }

    /// One correction of bodies that do, relative to the greatest speed among them.
    fn correct_together(
        &self,
        system: &dyn System,
        w: &mut [DVec3],
        room: &mut Newton,
    ) -> (usize, f64) {
        let n = w.len();
        let ([x, residual, correction, moved, krylov @ ..], jacobians) =
            room.columns::<{ 4 + krylov::COLUMNS }>(n);
        jacobians.resize(n, Jacobians::ZERO);
        self.residual(system, w, x, residual);
        system.jacobians(self.time, x, w, jacobians);
        for jacobians in jacobians.iter_mut() {
            // The block on the diagonal, inverted, is what makes the Krylov method quick.
            jacobians.position = self.matrix(jacobians).inverse();
        }
        let mut apply = |u: &[DVec3], out: &mut [DVec3]| {
            for (moved, u) in moved.iter_mut().zip(u) {
                *moved = self.drift * *u;
            }
            system.apply_jacobian(self.time, (x, w), (moved, u), out);
            for (out, u) in out.iter_mut().zip(u) {
                *out = *u - self.h * *out;
            }
        };
        krylov::solve(&mut apply, jacobians, residual, correction, krylov);
        let mut scale: f64 = f64::MIN_POSITIVE;
        let mut worst = (0, 0.0);
        for i in 0..n {
            w[i] -= correction[i];
            scale = scale.max(self.scale(i, w[i]));
            let size = largest(correction[i]);
            // A NaN is the worst of all.
            if size > worst.1 || size.is_nan() {
                worst = (i, size);
            }
        }
        (worst.0, worst.1 / scale)
    }

    /// `w - v - h a(x + d w, w)`, and the positions at which it is.
    fn residual(&self, system: &dyn System, w: &[DVec3], x: &mut [DVec3], residual: &mut [DVec3]) {
        for ((x, start), w) in x.iter_mut().zip(self.position).zip(w) {
            *x = *start + self.drift * *w;
        }
        system.accelerations(self.time, x, w, residual);
        for ((r, w), v) in residual.iter_mut().zip(w).zip(self.velocity) {
            *r = *w - *v - self.h * *r;
        }
    }

    /// `1 - h ∂a/∂v - h d ∂a/∂x` of one body.
    fn matrix(&self, slopes: &Jacobians) -> DMat3 {
        DMat3::IDENTITY - self.h * slopes.velocity - self.h * self.drift * slopes.position
    }

    /// The velocity against which a correction of a body is small. A position of many digits
    /// leaves few of them to the velocity that moves it.
    fn scale(&self, i: usize, w: DVec3) -> f64 {
        let moving = largest(self.velocity[i]).max(largest(w));
        let placed = largest(self.position[i]) / self.h.abs();
        moving.max(placed).max(f64::MIN_POSITIVE)
    }
}

fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// The solution of a 3×3 system, by elimination with row exchanges.
fn solve3(matrix: DMat3, right: DVec3) -> DVec3 {
    let [x, y, z] = matrix.transpose().to_cols_array_2d();
    let mut rows = [
        [x[0], x[1], x[2], right.x],
        [y[0], y[1], y[2], right.y],
        [z[0], z[1], z[2], right.z],
    ];
    for column in 0..3 {
        let below = column..3;
        let pivot = below.max_by(|&i, &j| rows[i][column].abs().total_cmp(&rows[j][column].abs()));
        rows.swap(column, pivot.unwrap_or(column));
        let top = rows[column];
        for row in &mut rows[column + 1..] {
            let factor = row[column] / top[column];
            for (entry, above) in row.iter_mut().zip(top).skip(column) {
                *entry -= factor * above;
            }
        }
    }
    let z = rows[2][3] / rows[2][2];
    let y = (rows[1][3] - rows[1][2] * z) / rows[1][1];
    let x = (rows[0][3] - rows[0][1] * y - rows[0][2] * z) / rows[0][0];
    DVec3::new(x, y, z)
}
