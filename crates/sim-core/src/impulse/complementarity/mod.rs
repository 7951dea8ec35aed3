//! The impulses of contacts as a linear complementarity problem: each contact pushes or opens.

mod cholesky;
mod guess;
mod proximal;

pub(super) use proximal::Network;

use alloc::vec::Vec;

use super::{Joined, Known};

/// The greatest number of contacts that are solved with sums that do not depend on the order of contacts.
pub(super) const FEW: usize = 8;

/// The error of the solution, as a fraction of the largest speed.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The least impulses after which each contact opens at least as fast as wanted, and held contacts exactly so. Only
/// held contacts may have negative impulses.
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

/// A number for each of a few contacts.
type Few = [f64; FEW];

/// The Delassus operator `N M⁻¹ Nᵀ` of a few contacts. Rows and columns are scaled, so that heavy bodies count like
/// light ones.
struct Matrix {
    count: usize,
    rows: [Few; FEW],
    /// The scale of each row and column, a power of two.
    scale: Few,
}

impl Matrix {
    fn of(contacts: &[Joined], inverse_mass: &[f64]) -> Matrix {
        let mut matrix = Matrix {
            count: contacts.len(),
            rows: [[0.0; FEW]; FEW],
            scale: [1.0; FEW],
        };
        for (contact, scale) in contacts.iter().zip(&mut matrix.scale) {
            let own = contact.shared(contact, inverse_mass);
            if own > 0.0 {
                *scale = libm::ldexp(1.0, -libm::ilogb(own) / 2);
            }
        }
        for (k, contact) in contacts.iter().enumerate() {
            for (l, other) in contacts.iter().enumerate() {
                let shared = contact.shared(other, inverse_mass);
                matrix.rows[k][l] = matrix.scale[k] * matrix.scale[l] * shared;
            }
        }
        matrix
    }

    /// The multipliers, if they are found.
    fn multipliers(&self, wanted: &[f64], held: &[bool]) -> Option<Vec<f64>> {
        let mut scaled = [0.0; FEW];
        for ((scaled, wanted), scale) in scaled.iter_mut().zip(wanted).zip(&self.scale) {
            *scaled = wanted * scale;
        }
        let given = self.guess(&scaled, held)?;
        let pairs = given.iter().zip(&self.scale).take(self.count);
        Some(pairs.map(|(given, scale)| given * scale).collect())
    }

    /// The residual of the wanted change after some impulses.
    fn missing(&self, wanted: &Few, given: &Few) -> Few {
        let mut missing = [0.0; FEW];
        for (k, row) in self.rows[..self.count].iter().enumerate() {
            let parts = row[..self.count].iter().zip(given);
            missing[k] = wanted[k] - sum(parts.map(|(x, given)| x * given));
        }
        missing
    }
}

/// A sum that does not depend on the order of its terms, and that only changes its sign if the terms change theirs.
/// Positive and negative terms are added separately, each from the least on.
pub(super) fn sum(terms: impl Iterator<Item = f64>) -> f64 {
    let (mut few, mut count, mut many) = ([0.0_f64; 16], 0, Vec::new());
    for term in terms.filter(|&term| term != 0.0) {
        if count == few.len() {
            many.push(term);
            continue;
        }
        let mut place = count;
        while place > 0 && few[place - 1].abs() > term.abs() {
            few[place] = few[place - 1];
            place -= 1;
        }
        few[place] = term;
        count += 1;
    }
    let terms = if many.is_empty() {
        &few[..count]
    } else {
        many.extend(few);
        many.sort_unstable_by(|a: &f64, b| a.abs().total_cmp(&b.abs()));
        &many[..]
    };
    let (mut up, mut down) = (0.0, 0.0);
    for &term in terms {
        if term > 0.0 {
            up += term;
        } else if term < 0.0 {
            down -= term;
        }
    }
    up - down
}
