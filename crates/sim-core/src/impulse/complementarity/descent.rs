//! Which contacts push, by descent.

use alloc::{vec, vec::Vec};

use super::{Matrix, ROUNDING};

/// Steps of descent for each contact, at most; one or two are enough unless masses differ by orders
/// of magnitude.
const STEPS_A_CONTACT: usize = 512;
/// Part of the largest speed below which a contact's worth of steps without a gain shows that rounding
/// is all that is left.
const NEARLY: f64 = 1e-10;

impl Matrix {
    /// The impulses, by descent along free and chopped gradients in turns (Dostál, Schöberl 2005,
    /// "Minimizing quadratic functions subject to bound constraints with the rate of convergence
    /// and finite termination", MPRGP): conjugate gradients among those that push, as long as these
    /// are most of what is missing. It needs no guess.
    pub(super) fn descend(&self, wanted: &[f64]) -> Vec<f64> {
        // No step of this length along a gradient goes up (Gershgorin).
        let size = |row: &[(usize, f64)]| row.iter().map(|entry| entry.1.abs()).sum();
        let length = 1.0 / self.rows().map(size).fold(f64::MIN_POSITIVE, f64::max);
        let most = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let free = |x: f64, g: f64| if x > 0.0 { g } else { 0.0 };
        let chopped = |x: f64, g: f64| if x > 0.0 { 0.0 } else { g.min(0.0) };
        let count = wanted.len();
        let zeros = || vec![0.0; count];
        let (mut given, mut pulled, mut way) = (zeros(), zeros(), zeros());
        let mut gradient: Vec<f64> = wanted.iter().map(|w| -w).collect();
        let (mut least, mut idle) = (f64::INFINITY, 0);
        for _ in 0..STEPS_A_CONTACT * count {
            let (mut worst, mut of_chopped, mut of_free) = (0.0_f64, 0.0, 0.0);
            for (&x, &g) in given.iter().zip(&gradient) {
                let (f, c) = (free(x, g), chopped(x, g));
                worst = worst.max(f.abs()).max(c.abs());
                of_chopped += c * c;
                of_free += f * f.min(x / length);
            }
            idle = if worst < least { 0 } else { idle + 1 };
            least = least.min(worst);
            let is_idle = least <= NEARLY * most && idle > count;
            if worst <= ROUNDING * most || is_idle {
                break;
            }
            let is_balanced = of_chopped <= of_free;
            if !is_balanced {
                for (way, (&x, &g)) in way.iter_mut().zip(given.iter().zip(&gradient)) {
                    *way = chopped(x, g);
                }
            }
            let (mut curvature, mut slope, mut size) = (0.0, 0.0, 0.0);
            let mut room = f64::INFINITY;
            for (k, row) in self.rows().enumerate() {
                pulled[k] = row.iter().map(|&(l, x)| x * way[l]).sum();
                curvature += way[k] * pulled[k];
                slope += way[k] * gradient[k];
                size += way[k] * way[k];
                if way[k] > 0.0 {
                    room = room.min(given[k] / way[k]);
                }
            }
            // Contacts that hold each other up against nothing: only rounding leads there.
            if curvature <= 16.0 * f64::EPSILON * size / length {
                break;
            }
            let best = slope / curvature;
            let step = best.min(room);
            let mut turn = 0.0;
            for k in 0..count {
                given[k] = (given[k] - step * way[k]).max(0.0);
                gradient[k] -= step * pulled[k];
                turn += free(given[k], gradient[k]) * pulled[k] / curvature;
            }
            if is_balanced && best > room {
                for (x, g) in given.iter_mut().zip(&gradient) {
                    *x = (*x - length * free(*x, *g)).max(0.0);
                }
                for (k, row) in self.rows().enumerate() {
                    let image: f64 = row.iter().map(|&(l, x)| x * given[l]).sum();
                    gradient[k] = image - wanted[k];
                }
            }
            let turn = if is_balanced && best <= room {
                turn
            } else {
                0.0
            };
            for k in 0..count {
                way[k] = free(given[k], gradient[k]) - turn * way[k];
            }
        }
        given
    }
}
