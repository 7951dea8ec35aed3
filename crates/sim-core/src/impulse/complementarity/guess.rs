//! The contacts that push, found from a guess.

use super::{FEW, Few, Matrix, ROUNDING, sum};

/// The greatest number of guesses which contacts push; a few are by far enough.
const GUESSES: usize = 40;

/// The residual, as a fraction of the largest speed, above which the equations have no solution: parallel contacts of
/// the same bodies that want different speeds cannot all push.
const UNSOLVED: f64 = 1e-9;

impl Matrix {
    /// Guesses which contacts push, and solves the equations of these. It then corrects the guess: a contact that
    /// would pull stops pushing, and one that does not push but closes starts to push (Júdice, Pires 1994, "A block
    /// principal pivoting algorithm for large-scale strictly monotone linear complementarity problems").
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
            // To correct all contacts at once is fast. To correct one at a time, from the last on, does not cycle.
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

    /// The impulses of the pushing contacts, by conjugate gradients (Hestenes, Stiefel 1952). The method does not
    /// depend on the order of contacts, and if there are many solutions, it finds the one that shares the load best.
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
        // Each run leaves a part of the last bits to rounding, so that further runs help.
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
