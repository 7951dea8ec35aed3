//! Impulses of contacts that push or do not: a linear complementarity problem.

use alloc::{vec, vec::Vec};

use super::Joined;

/// Up to so many contacts are solved in sums that know no order.
const FEW: usize = 32;

/// Part of the largest speed that is lost in solving.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Guesses at which contacts push; a few are enough, by far.
const GUESSES: usize = 40;

/// Steps of descent for each contact, at most.
const STEPS_A_CONTACT: usize = 32;

/// The matrix `N M⁻¹ Nᵀ` by rows, of which most is zero.
pub(super) struct Rows {
    /// Where each begins, and where the last one ends.
    begin: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

impl Rows {
    pub(super) fn of(contacts: &[Joined], inverse_mass: &[f64]) -> Rows {
        let mut at: Vec<Vec<usize>> = vec![Vec::new(); inverse_mass.len()];
        for (k, contact) in contacts.iter().enumerate() {
            for body in [contact.bodies.0, contact.bodies.1] {
                // Nothing arrives through a body that nothing moves.
                if inverse_mass[body] > 0.0 {
                    at[body].push(k);
                }
            }
        }
        let (mut begin, mut entries) = (vec![0], Vec::new());
        let mut others: Vec<usize> = Vec::new();
        for contact in contacts {
            let (i, j) = contact.bodies;
            others.clear();
            others.extend(at[i].iter().chain(&at[j]));
            others.sort_unstable();
            others.dedup();
            let shared = |&l: &usize| (l, contact.shared(&contacts[l], inverse_mass));
            entries.extend(others.iter().map(shared).filter(|entry| entry.1 != 0.0));
            begin.push(entries.len());
        }
        Rows { begin, entries }
    }

    fn row(&self, k: usize) -> &[(usize, f64)] {
        &self.entries[self.begin[k]..self.begin[k + 1]]
    }

    fn rows(&self) -> impl Iterator<Item = &[(usize, f64)]> {
        (1..self.begin.len()).map(|k| self.row(k - 1))
    }

    /// The least impulses, none negative, after which no contact closes as far as it is wanted to
    /// open.
    pub(super) fn multipliers(&self, wanted: &[f64]) -> Vec<f64> {
        match wanted.len() <= FEW {
            true => self.guess(wanted).unwrap_or_else(|| self.descend(wanted)),
            false => self.descend(wanted),
        }
    }

    /// Contacts are taken to push or not to push by guess, the equations of those that push solved,
    /// and the guess mended where one would pull or one that does not push closes (Júdice, Pires
    /// 1994, "A block principal pivoting algorithm for large-scale strictly monotone linear
    /// complementarity problems").
    fn guess(&self, wanted: &[f64]) -> Option<Vec<f64>> {
        let scale = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let mut pushes: Vec<bool> = wanted.iter().map(|&w| w > 0.0).collect();
        for guess in 0..GUESSES {
            let given = self.solve(wanted, &pushes);
            let missing = self.missing(wanted, &given);
            let is_wrong = |k: usize| match pushes[k] {
                true => given[k] * self.own(k) < -ROUNDING * scale,
                false => missing[k] > ROUNDING * scale,
            };
            let wrong: Vec<usize> = (0..wanted.len()).filter(|&k| is_wrong(k)).collect();
            if wrong.is_empty() {
                return Some(given.into_iter().map(|given| given.max(0.0)).collect());
            }
            // All at once is fast; one at a time does not go in circles.
            let mended = if guess < GUESSES / 2 { wrong.len() } else { 1 };
            for &k in wrong.iter().rev().take(mended) {
                pushes[k] = !pushes[k];
            }
        }
        None
    }

    /// What a contact's own impulse does to its speed.
    fn own(&self, k: usize) -> f64 {
        let entry = self.row(k).iter().find(|&&(l, _)| l == k);
        entry.map_or(1.0, |&(_, own)| own)
    }

    /// What is left of the wanted change after some impulses.
    fn missing(&self, wanted: &[f64], given: &[f64]) -> Vec<f64> {
        let done = |row: &[(usize, f64)]| sum(row.iter().map(|&(l, x)| x * given[l]));
        let pairs = wanted.iter().zip(self.rows());
        pairs.map(|(w, row)| w - done(row)).collect()
    }

    /// The impulses, by descent along free and chopped gradients in turns (Dostál, Schöberl 2005,
    /// "Minimizing quadratic functions subject to bound constraints with the rate of convergence
    /// and finite termination", MPRGP): conjugate gradients among those that push, as long as these
    /// are most of what is missing. It needs time in proportion to the contacts, and no guess.
    fn descend(&self, wanted: &[f64]) -> Vec<f64> {
        // No step of this length along a gradient goes up (Gershgorin).
        let size = |row: &[(usize, f64)]| row.iter().map(|entry| entry.1.abs()).sum();
        let length = 1.0 / self.rows().map(size).fold(f64::MIN_POSITIVE, f64::max);
        let scale = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        let free = |x: f64, g: f64| if x > 0.0 { g } else { 0.0 };
        let chopped = |x: f64, g: f64| if x > 0.0 { 0.0 } else { g.min(0.0) };
        let count = wanted.len();
        let (mut given, mut pulled, mut way) =
            (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        let mut gradient: Vec<f64> = wanted.iter().map(|w| -w).collect();
        for _ in 0..STEPS_A_CONTACT * count {
            let (mut worst, mut of_chopped, mut of_free) = (0.0_f64, 0.0, 0.0);
            for (&x, &g) in given.iter().zip(&gradient) {
                let (f, c) = (free(x, g), chopped(x, g));
                worst = worst.max(f.abs()).max(c.abs());
                of_chopped += c * c;
                of_free += f * f.min(x / length);
            }
            if worst <= ROUNDING * scale {
                break;
            }
            let is_balanced = of_chopped <= of_free;
            if !is_balanced {
                for (way, (&x, &g)) in way.iter_mut().zip(given.iter().zip(&gradient)) {
                    *way = chopped(x, g);
                }
            }
            let (mut curvature, mut slope, mut room) = (0.0, 0.0, f64::INFINITY);
            let mut size = 0.0;
            for (k, row) in self.rows().enumerate() {
                pulled[k] = row.iter().map(|&(l, x)| x * way[l]).sum();
                curvature += way[k] * pulled[k];
                size += way[k] * way[k];
                slope += way[k] * gradient[k];
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
                turn += free(given[k], gradient[k]) * pulled[k];
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
                turn / curvature
            } else {
                0.0
            };
            for k in 0..count {
                way[k] = free(given[k], gradient[k]) - turn * way[k];
            }
        }
        given
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

/// A sum that does not depend on the order of its terms, and that only changes its sign with theirs:
/// positive and negative terms apart, each from the least on.
pub(super) fn sum(terms: impl Iterator<Item = f64>) -> f64 {
    let (mut few, mut count, mut many) = ([0.0; 16], 0, Vec::new());
    for term in terms.filter(|&term| term != 0.0) {
        if count < few.len() {
            few[count] = term;
            count += 1;
        } else {
            many.push(term);
        }
    }
    let terms = if many.is_empty() {
        &mut few[..count]
    } else {
        many.extend(few);
        &mut many[..]
    };
    if terms.len() > 2 {
        terms.sort_unstable_by(|a, b| a.abs().total_cmp(&b.abs()));
    }
    let total = |sign: f64| {
        let part = terms
            .iter()
            .map(|term| sign * term)
            .filter(|&term| term > 0.0);
        part.sum::<f64>()
    };
    total(1.0) - total(-1.0)
}
