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
    /// are most of what is missing. It may start from impulses of a problem like this one.
    pub(super) fn descend(
        &self,
        wanted: &[f64],
        held: &[bool],
        warm: Vec<f64>,
        enough: f64,
    ) -> Vec<f64> {
        // No step of this length along a gradient goes up (Gershgorin).
        let size = |row: &[(u32, f64)]| row.iter().map(|entry| entry.1.abs()).sum();
        let length = 1.0 / self.rows().map(size).fold(f64::MIN_POSITIVE, f64::max);
        let most = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let free = |x: f64, least: f64, g: f64| if x > least { g } else { 0.0 };
        let count = wanted.len();
        let zeros = || vec![0.0; count];
        let least: Vec<f64> = (0..count)
            .map(|k| {
                if held.get(k) == Some(&true) {
                    f64::NEG_INFINITY
                } else {
                    0.0
                }
            })
            .collect();
        let (mut pulled, mut way, mut gradient) = (zeros(), zeros(), zeros());
        let mut given = if warm.len() == count { warm } else { zeros() };
        self.gradient(&given, wanted, &mut gradient);
        for k in 0..count {
            way[k] = free(given[k], least[k], gradient[k]);
        }
        let (mut best_worst, mut idle) = (f64::INFINITY, 0);
        for _ in 0..STEPS_A_CONTACT * count {
            // The gradients of those that may give less, as far as they may, and of those that may not.
            let (mut worst, mut of_chopped, mut of_free) = (0.0_f64, 0.0, 0.0);
            for ((&x, &least), &g) in given.iter().zip(&least).zip(&gradient) {
                if x > least {
                    worst = worst.max(g.abs());
                    of_free += g * g.min((x - least) / length);
                } else if g < 0.0 {
                    worst = worst.max(-g);
                    of_chopped += g * g;
                }
            }
            idle = if worst < best_worst { 0 } else { idle + 1 };
            best_worst = best_worst.min(worst);
            let is_idle = best_worst <= NEARLY * most && idle > count;
            if worst <= enough.max(ROUNDING * most) || is_idle {
                break;
            }
            let is_balanced = of_chopped <= of_free;
            if !is_balanced {
                for ((way, (&x, &least)), &g) in
                    way.iter_mut().zip(given.iter().zip(&least)).zip(&gradient)
                {
                    *way = if x > least { 0.0 } else { g.min(0.0) };
                }
            }
            let (mut curvature, mut slope, mut size) = (0.0, 0.0, 0.0);
            let mut room = f64::INFINITY;
            for (k, row) in self.rows().enumerate() {
                let image: f64 = row.iter().map(|&(l, x)| x * way[l as usize]).sum();
                let along = way[k];
                pulled[k] = image;
                curvature += along * image;
                slope += along * gradient[k];
                size += along * along;
                if along > 0.0 {
                    room = room.min((given[k] - least[k]) / along);
                }
            }
            // Contacts that hold each other up against nothing: rounding leads there, or parallel ones of
            // which some want less, which give up what they give.
            let is_flat = curvature <= 256.0 * f64::EPSILON * size / length;
            if is_flat && (worst <= NEARLY * most || room.is_infinite()) {
                break;
            }
            let best = if is_flat {
                f64::INFINITY
            } else {
                slope / curvature
            };
            let step = best.min(room);
            let mut turn = 0.0;
            for k in 0..count {
                given[k] = (given[k] - step * way[k]).max(least[k]);
                gradient[k] -= step * pulled[k];
                turn += free(given[k], least[k], gradient[k]) * pulled[k];
            }
            let is_blocked = best > room;
            if is_balanced && is_blocked {
                for k in 0..count {
                    let down = length * free(given[k], least[k], gradient[k]);
                    given[k] = (given[k] - down).max(least[k]);
                }
                self.gradient(&given, wanted, &mut gradient);
            }
            let turn = if is_balanced && !is_blocked {
                turn / curvature
            } else {
                0.0
            };
            for k in 0..count {
                way[k] = free(given[k], least[k], gradient[k]) - turn * way[k];
            }
        }
        given
    }

    /// What contacts open more than they are wanted to.
    fn gradient(&self, given: &[f64], wanted: &[f64], gradient: &mut [f64]) {
        for ((row, wanted), gradient) in self.rows().zip(wanted).zip(gradient) {
            let image: f64 = row.iter().map(|&(l, x)| x * given[l as usize]).sum();
            *gradient = image - wanted;
        }
    }
}
