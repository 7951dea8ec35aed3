//! Which contacts push, by guess.

use alloc::{vec, vec::Vec};

use super::{Matrix, ROUNDING, sum};

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
    pub(super) fn guess(&self, wanted: &[f64], held: &[bool]) -> Option<Vec<f64>> {
        let is_held = |k: usize| held.get(k) == Some(&true);
        let scale = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let wants = wanted.iter().enumerate();
        let mut pushes: Vec<bool> = wants.map(|(k, &w)| w > 0.0 || is_held(k)).collect();
        for guess in 0..GUESSES {
            let given = self.solve(wanted, &pushes);
            let missing = self.missing(wanted, &given);
            let is_wrong = |k: usize| match pushes[k] {
                true => given[k] < -ROUNDING * scale && !is_held(k),
                false => missing[k] > ROUNDING * scale,
            };
            let wrong: Vec<usize> = (0..wanted.len()).filter(|&k| is_wrong(k)).collect();
            if wrong.is_empty() {
                let is_unsolved = |k: usize| pushes[k] && missing[k].abs() > UNSOLVED * scale;
                if (0..wanted.len()).any(is_unsolved) {
                    return None;
                }
                let given = given.into_iter().enumerate();
                let pushed =
                    |(k, given): (usize, f64)| if is_held(k) { given } else { given.max(0.0) };
                return Some(given.map(pushed).collect());
            }
            // All at once is fast; one at a time does not go in circles.
            let mended = if guess < GUESSES / 2 { wrong.len() } else { 1 };
            for &k in wrong.iter().rev().take(mended) {
                pushes[k] = !pushes[k];
            }
        }
        None
    }

    /// The impulses of those that push by conjugate gradients (Hestenes, Stiefel 1952), which know no
    /// order among contacts, and where there are many solutions find the one that shares best.
    fn solve(&self, wanted: &[f64], pushes: &[bool]) -> Vec<f64> {
        let only = |values: Vec<f64>| -> Vec<f64> {
            let values = values.into_iter().zip(pushes);
            values
                .map(|(value, &pushes)| if pushes { value } else { 0.0 })
                .collect()
        };
        let dot = |a: &[f64], b: &[f64]| sum(a.iter().zip(b).map(|(a, b)| a * b));
        let mut given = vec![0.0; wanted.len()];
        let mut best = (f64::INFINITY, given.clone());
        let scale = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let enough = (f64::EPSILON * scale) * (f64::EPSILON * scale);
        // Rounding leaves a part of the last bits in each run, so that one more is worth it.
        for _ in 0..3 {
            let mut residual = only(self.missing(wanted, &given));
            let mut size = dot(&residual, &residual);
            if size < best.0 {
                best = (size, given.clone());
            }
            let mut direction = residual.clone();
            for _ in 0..wanted.len() {
                if size <= enough {
                    return best.1;
                }
                let none = vec![0.0; wanted.len()];
                let image: Vec<f64> = only(self.missing(&none, &direction));
                let curvature = -dot(&direction, &image);
                if size == 0.0 || curvature <= 0.0 {
                    break;
                }
                let length = size / curvature;
                for k in 0..given.len() {
                    given[k] += length * direction[k];
                    residual[k] += length * image[k];
                }
                let next = dot(&residual, &residual);
                for k in 0..given.len() {
                    direction[k] = residual[k] + next / size * direction[k];
                }
                size = next;
                if size < best.0 {
                    best = (size, given.clone());
                }
            }
        }
        best.1
    }
}
