//! Impulses of contacts that push or do not: a linear complementarity problem.

mod cholesky;
mod guess;
mod proximal;

use alloc::{vec, vec::Vec};

use super::{Joined, Known};

/// Up to so many contacts are solved in sums that know no order.
const FEW: usize = 8;

/// Part of the largest speed that is lost in solving.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The least impulses after which no contact closes as far as it is wanted to open, and those that are held
/// open just as far: none negative but of contacts that are held.
pub(super) fn multipliers(
    contacts: &[Joined],
    inverse_mass: &[f64],
    wanted: &[f64],
    known: Known,
) -> Vec<f64> {
    let is_few = contacts.len() <= FEW;
    let guess = || Matrix::of(contacts, inverse_mass).multipliers(wanted, known.held);
    let guess = is_few.then(guess).flatten();
    guess.unwrap_or_else(|| proximal::multipliers(contacts, inverse_mass, wanted, known))
}

/// The matrix `N M⁻¹ Nᵀ` by rows, of which most is zero; rows and columns scaled, so that heavy bodies
/// count like light ones.
struct Matrix {
    /// Where each begins, and where the last one ends.
    begin: Vec<usize>,
    entries: Vec<(u32, f64)>,
    /// Of each row and column, powers of two.
    scale: Vec<f64>,
}

impl Matrix {
    fn of(contacts: &[Joined], inverse_mass: &[f64]) -> Matrix {
        let mut at: Vec<Vec<usize>> = vec![Vec::new(); inverse_mass.len()];
        for (k, contact) in contacts.iter().enumerate() {
            for body in [contact.bodies.0, contact.bodies.1] {
                // Nothing arrives through a body that nothing moves.
                if inverse_mass[body] > 0.0 {
                    at[body].push(k);
                }
            }
        }
        let scale = |contact: &Joined| {
            let own = contact.shared(contact, inverse_mass);
            match own > 0.0 {
                true => libm::ldexp(1.0, -libm::ilogb(own) / 2),
                false => 1.0,
            }
        };
        let scale: Vec<f64> = contacts.iter().map(scale).collect();
        let (mut begin, mut entries) = (vec![0], Vec::new());
        let mut others: Vec<usize> = Vec::new();
        for (contact, own) in contacts.iter().zip(&scale) {
            let (i, j) = contact.bodies;
            others.clear();
            others.extend(at[i].iter().chain(&at[j]));
            others.sort_unstable();
            others.dedup();
            let shared = |&l: &usize| {
                let shared = contact.shared(&contacts[l], inverse_mass);
                (l as u32, own * scale[l] * shared)
            };
            entries.extend(others.iter().map(shared).filter(|entry| entry.1 != 0.0));
            begin.push(entries.len());
        }
        Matrix {
            begin,
            entries,
            scale,
        }
    }

    fn rows(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        let bounds = self.begin.windows(2);
        bounds.map(|bounds| &self.entries[bounds[0]..bounds[1]])
    }

    /// The multipliers, if they are found.
    fn multipliers(&self, wanted: &[f64], held: &[bool]) -> Option<Vec<f64>> {
        let scaled = |values: &[f64]| -> Vec<f64> {
            let pairs = values.iter().zip(&self.scale);
            pairs.map(|(value, scale)| value * scale).collect()
        };
        self.guess(&scaled(wanted), held)
            .map(|given| scaled(&given))
    }

    /// What is left of the wanted change after some impulses.
    fn missing(&self, wanted: &[f64], given: &[f64]) -> Vec<f64> {
        let done = |row: &[(u32, f64)]| sum(row.iter().map(|&(l, x)| x * given[l as usize]));
        let pairs = wanted.iter().zip(self.rows());
        pairs.map(|(w, row)| w - done(row)).collect()
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
