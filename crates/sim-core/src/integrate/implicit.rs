//! The equation that every implicit method here solves.
//!
//! ```text
//! w = v + h a(t, x + d w, w)
//! ```
//!
//! for the velocities `w`. Backward Euler has `d = h = dt`; the implicit midpoint rule has half of
//! that; a kick by a force that depends on the velocity has `d = 0`.
//!
//! Newton's method solves it: `(1 - h ∂a/∂v - h d ∂a/∂x) δ = w - v - h a`, then `w - δ`, until `δ` is below
//! [`TOLERANCE`]. An uncoupled body has a 3×3 matrix of its own. Coupled bodies use a Krylov method, which needs only
//! products with the matrix.

use glam::{DMat3, DVec3};

use super::{Failure, Jacobians, System, krylov, scratch::Newton};

/// The size of the last correction, relative to the greatest of the velocities and of `x/h`. Newton's method squares
/// its error, so the remaining error is rounding.
const TOLERANCE: f64 = 1e-12;

/// Below this size, corrections that no longer shrink end the iteration.
const LOOSE_TOLERANCE: f64 = 1e-8;

/// The most corrections. From a good start two or three are enough.
const ITERATIONS: u32 = 40;

/// The parameters of the equation.
pub(super) struct Equation<'a> {
    /// The time at which accelerations are evaluated, s.
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

/// The most times that a correction is halved because it increases the residual.
const HALVINGS: u32 = 10;

/// The size of a correction. It is at least 1 if the linear system was not solved, because the size then means nothing.
pub(super) fn trusted(size: f64, solved: bool) -> f64 {
    if solved { size } else { size.max(1.0) }
}

/// The convergence of one body, or of coupled bodies together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Progress {
    last: f64,
    pub(super) is_done: bool,
}

impl Progress {
    pub(super) const NONE: Progress = Progress {
        last: f64::INFINITY,
        is_done: false,
    };

    /// Records the size of a correction.
    pub(super) fn note(&mut self, size: f64) {
        // The next correction would be smaller than this one by at least the same factor.
        let next = size * (size / self.last);
        let solved = size <= TOLERANCE || self.last.is_finite() && next <= 0.01 * TOLERANCE;
        // Corrections that no longer shrink are rounding, which happens if large forces cancel.
        let stalled = size <= LOOSE_TOLERANCE && size > 0.5 * self.last;
        self.is_done = solved || stalled;
        self.last = size;
    }
}

/// Corrects until the solution is reached. `correct` returns the body with the largest correction and its relative
/// size. It records sizes in `progress`, which has an entry for each body, or one for all together.
pub(super) fn iterate(
    progress: &mut [Progress],
    mut correct: impl FnMut(&mut [Progress]) -> (usize, f64),
) -> Result<(), Failure> {
    progress.fill(Progress::NONE);
    for iteration in 1.. {
        let (body, size) = correct(progress);
        if progress.iter().all(|progress| progress.is_done) {
            break;
        }
        if iteration == ITERATIONS || !size.is_finite() {
            return Err(Failure::NotConverged {
                body,
                iterations: iteration,
            });
        }
    }
    Ok(())
}

impl Equation<'_> {
    /// Solves for the velocities, starting from those in `w`.
    pub(super) fn solve(
        &self,
        system: &dyn System,
        w: &mut [DVec3],
        room: &mut Newton,
    ) -> Result<(), Failure> {
        let mut last_residual = f64::INFINITY;
        if system.is_coupled() {
            return iterate(&mut [Progress::NONE], |progress| {
                let (body, size) = self.correct_together(system, w, room, &mut last_residual);
                progress[0].note(size);
                (body, size)
            });
        }
        let mut progress = room.take_progress(w.len());
        let solved = iterate(&mut progress, |progress| {
            self.correct_each(system, w, room, progress)
        });
        room.progress = progress;
        solved
    }

    /// One correction of uncoupled bodies; each is corrected until its own solution is reached. Returns the body with
    /// the largest correction relative to its own speed, and that relative size.
    fn correct_each(
        &self,
        system: &dyn System,
        w: &mut [DVec3],
        room: &mut Newton,
        progress: &mut [Progress],
    ) -> (usize, f64) {
        let n = w.len();
        let ([x, residual], jacobians) = room.columns(n);
        jacobians.resize(n, Jacobians::ZERO);
        self.residual(system, w, x, residual);
        system.jacobians(self.time, x, w, jacobians);
        let mut worst = (0, 0.0);
        for (i, progress) in progress.iter_mut().enumerate() {
            if progress.is_done {
                continue;
            }
            let matrix = self.matrix(&jacobians[i]).transpose();
            let correction = solve(matrix.to_cols_array_2d(), residual[i].to_array());
            let correction = DVec3::from(correction);
            w[i] -= correction;
            let size = largest(correction) / self.scale(i, w[i]);
            progress.note(size);
            // NaN counts as the largest.
            if size > worst.1 || size.is_nan() {
                worst = (i, size);
            }
        }
        worst
    }

    /// One correction of coupled bodies, relative to the greatest speed among them. As long as the last correction has
    /// increased the residual, half of it is taken back first.
    fn correct_together(
        &self,
        system: &dyn System,
        w: &mut [DVec3],
        room: &mut Newton,
        last_residual: &mut f64,
    ) -> (usize, f64) {
        let n = w.len();
        let ([x, residual, correction, moved, krylov @ ..], jacobians) =
            room.columns::<{ 4 + krylov::COLUMNS }>(n);
        jacobians.resize(n, Jacobians::ZERO);
        self.residual(system, w, x, residual);
        let mut size = krylov::dot(residual, residual);
        for _ in 0..HALVINGS {
            if size <= *last_residual {
                break;
            }
            for (w, correction) in w.iter_mut().zip(correction.iter_mut()) {
                *correction *= 0.5;
                *w += *correction;
            }
            self.residual(system, w, x, residual);
            size = krylov::dot(residual, residual);
        }
        *last_residual = size;
        system.jacobians(self.time, x, w, jacobians);
        for jacobians in jacobians.iter_mut() {
            // The inverse of the diagonal block, as preconditioner of the Krylov method.
            jacobians.position = self.matrix(jacobians).inverse();
        }
        let condition = |from: &[DVec3], to: &mut [DVec3]| {
            for ((to, from), block) in to.iter_mut().zip(from).zip(jacobians.iter()) {
                *to = block.position * *from;
            }
        };
        let apply = |u: &[DVec3], out: &mut [DVec3]| {
            for (moved, u) in moved.iter_mut().zip(u) {
                *moved = self.drift * *u;
            }
            system.apply_jacobian(self.time, (x, w), (moved, u), out);
            for (out, u) in out.iter_mut().zip(u) {
                *out = *u - self.h * *out;
            }
        };
        let solved = krylov::solve(apply, condition, residual, correction, krylov);
        let mut scale: f64 = f64::MIN_POSITIVE;
        let mut worst = (0, 0.0);
        for i in 0..n {
            w[i] -= correction[i];
            scale = scale.max(self.scale(i, w[i]));
            let size = largest(correction[i]);
            // NaN counts as the largest.
            if size > worst.1 || size.is_nan() {
                worst = (i, size);
            }
        }
        (worst.0, trusted(worst.1 / scale, solved))
    }

    /// Writes `w - v - h a(x + d w, w)`, and the positions `x + d w`.
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

    fn scale(&self, i: usize, w: DVec3) -> f64 {
        scale(self.position[i], self.velocity[i], w, self.h)
    }
}

/// The speed relative to which a correction of `w` is measured. A large position leaves few correct digits to the
/// velocity that changes it.
pub(super) fn scale(x: DVec3, v: DVec3, w: DVec3, h: f64) -> f64 {
    let moving = largest(v).max(largest(w));
    moving.max(largest(x) / h.abs()).max(f64::MIN_POSITIVE)
}

pub(super) fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// The solution of a small linear system, given by rows: Gaussian elimination with row exchanges.
pub(super) fn solve<const N: usize>(mut rows: [[f64; N]; N], mut right: [f64; N]) -> [f64; N] {
    for column in 0..N {
        let mut pivot = column;
        for row in column + 1..N {
            if rows[row][column].abs() > rows[pivot][column].abs() {
                pivot = row;
            }
        }
        rows.swap(column, pivot);
        right.swap(column, pivot);
        let (top, top_right) = (rows[column], right[column]);
        for row in column + 1..N {
            let factor = rows[row][column] / top[column];
            for (entry, above) in rows[row].iter_mut().zip(top).skip(column) {
                *entry -= factor * above;
            }
            right[row] -= factor * top_right;
        }
    }
    for row in (0..N).rev() {
        let mut rest = right[row];
        for column in row + 1..N {
            rest -= rows[row][column] * right[column];
        }
        right[row] = rest / rows[row][row];
    }
    right
}
