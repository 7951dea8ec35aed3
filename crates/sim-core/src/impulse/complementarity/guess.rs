//! Which contacts push, found from a guess.

use super::{FEW, Few, Matrix, ROUNDING, sum};

/// Guesses at which contacts push; a few are enough, by far.
const GUESSES: usize = 40;

/// Part of the largest speed that is missing where equations have no solution: parallel contacts of the
/// same bodies that want different speeds cannot all push.
const UNSOLVED: f64 = 1e-9;

impl Matrix {
    /// Contacts are taken to push or not to push by guess, the equations of those that push solved,
    /// and the guess mended where one would pull or one that does not push closes (Júdice, Pires
    /// 1994, "A block principal pivoting algorithm for large-scale strictly monotone linear
    /// complementarity problems").
    pub(super) fn guess(&self, wanted: &Few, held: &[bool]) -> Option<Few> {
        let count = self.count;
        let is_held = |k: usize| held.get(k) == Some(&true);
        let scale = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let mut pushes = [false; FEW];
        for k in 0..count {
            pushes[k] = wanted[k] > 0.0 || is_held(k);
        }
        for guess in 0..GUESSES {
            let given = self.solve(wanted, &pushes);
            let missing = self.missing(wanted, &given);
            let is_wrong = |k: &usize| match pushes[*k] {
                true => given[*k] < -ROUNDING * scale && !is_held(*k),
                false => missing[*k] > ROUNDING * scale,
            };
            let wrong = (0..count)
                .filter(is_wrong)
                .fold(0, |wrong, k| wrong | 1 << k);
            if wrong == 0 {
                let is_unsolved = |k: usize| pushes[k] && missing[k].abs() > UNSOLVED * scale;
                if (0..count).any(is_unsolved) {
                    return None;
                }
                let mut pushed = given;
                for k in (0..count).filter(|&k| !is_held(k)) {
                    pushed[k] = given[k].max(0.0);
                }
                return Some(pushed);
            }
            // All at once is fast; one at a time, from the last on, does not go in circles.
            let mended = match guess < GUESSES / 2 {
                true => wrong,
                false => 1 << u32::ilog2(wrong),
            };
            for k in (0..count).filter(|k| mended >> k & 1 == 1) {
                pushes[k] = !pushes[k];
            }
        }
        None
    }

    /// The impulses of those that push by conjugate gradients (Hestenes, Stiefel 1952), which know no
    /// order among contacts, and where there are many solutions find the one that shares best.
    fn solve(&self, wanted: &Few, pushes: &[bool; FEW]) -> Few {
        let only = |mut values: Few| {
            for (value, &pushes) in values.iter_mut().zip(pushes) {
                if !pushes {
                    *value = 0.0;
                }
            }
            values
        };
        let dot = |a: &Few, b: &Few| sum(a.iter().zip(b).map(|(a, b)| a * b));
        let mut given = [0.0; FEW];
        let mut best = (f64::INFINITY, given);
        let scale = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let enough = (f64::EPSILON * scale) * (f64::EPSILON * scale);
        // Rounding leaves a part of the last bits in each run, so that one more is worth it.
        for _ in 0..3 {
            let mut residual = only(self.missing(wanted, &given));
            let mut size = dot(&residual, &residual);
            if size < best.0 {
                best = (size, given);
            }
            let mut direction = residual;
            for _ in 0..self.count {
                if size <= enough {
                    return best.1;
                }
                let image = only(self.missing(&[0.0; FEW], &direction));
                let curvature = -dot(&direction, &image);
                if size == 0.0 || curvature <= 0.0 {
                    break;
                }
                let length = size / curvature;
                for k in 0..self.count {
                    given[k] += length * direction[k];
                    residual[k] += length * image[k];
                }
                let next = dot(&residual, &residual);
                for k in 0..self.count {
                    direction[k] = residual[k] + next / size * direction[k];
                }
                size = next;
                if size < best.0 {
                    best = (size, given);
                }
            }
        }
        best.1
    }
}
