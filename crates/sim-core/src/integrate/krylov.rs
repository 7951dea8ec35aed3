//! Linear systems of coupled bodies, solved with products of the matrix only.
//!
//! BiCGSTAB (van der Vorst 1992, "Bi-CGSTAB: a fast and smoothly converging variant of Bi-CG",
//! SIAM J. Sci. Stat. Comput. 13(2), p. 635), preconditioned from the right by the inverted
//! blocks of single bodies on the diagonal. Dampers make the matrices unsymmetric, which excludes conjugate
//! gradients. BiCGSTAB needs a few columns of memory; GMRES needs more.

use glam::DVec3;

/// Columns of scratch that [`solve`] needs.
pub(super) const COLUMNS: usize = 7;

/// The residual at which to stop, relative to the right-hand side. Newton's method corrects the rest.
const TOLERANCE: f64 = 1e-8;

/// Writes into `solution` an approximation of the solution of `apply(solution) = right`, where
/// `condition` applies the preconditioner.
///
/// Returns `true` if it reaches [`TOLERANCE`]. Returns `false`, with the best solution so far, after somewhat more
/// products than the matrix has rows, or if the recurrence breaks down.
pub(super) fn solve(
    mut apply: impl FnMut(&[DVec3], &mut [DVec3]),
    condition: impl Fn(&[DVec3], &mut [DVec3]),
    right: &[DVec3],
    solution: &mut [DVec3],
    room: [&mut [DVec3]; COLUMNS],
) -> bool {
    let [
        residual,
        shadow,
        direction,
        image,
        ready,
        second,
        ready_second,
    ] = room;
    solution.fill(DVec3::ZERO);
    residual.copy_from_slice(right);
    shadow.copy_from_slice(right);
    direction.copy_from_slice(right);
    let goal = TOLERANCE * TOLERANCE * dot(right, right);
    let mut rho = dot(shadow, residual);
    for _ in 0..50 + 3 * right.len() {
        let squared = dot(residual, residual);
        if squared <= goal {
            return true;
        }
        if rho == 0.0 || squared.is_nan() {
            return false;
        }
        condition(direction, ready);
        apply(ready, image);
        let alpha = rho / dot(shadow, image);
        add(residual, -alpha, image);
        condition(residual, ready_second);
        apply(ready_second, second);
        let squared = dot(second, second);
        let omega = if squared > 0.0 {
            dot(second, residual) / squared
        } else {
            0.0
        };
        add(solution, alpha, ready);
        add(solution, omega, ready_second);
        add(residual, -omega, second);
        let next = dot(shadow, residual);
        let beta = next / rho * (alpha / omega);
        rho = next;
        if !beta.is_finite() {
            return dot(residual, residual) <= goal;
        }
        for ((d, r), i) in direction.iter_mut().zip(&*residual).zip(&*image) {
            *d = *r + beta * (*d - omega * *i);
        }
    }
    false
}

fn add(to: &mut [DVec3], factor: f64, what: &[DVec3]) {
    for (to, what) in to.iter_mut().zip(what) {
        *to += factor * *what;
    }
}

pub(super) fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| a.x * b.x + a.y * b.y + a.z * b.z)
        .sum()
}
