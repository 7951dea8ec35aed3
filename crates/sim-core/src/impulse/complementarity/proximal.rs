//! The lambdas of many contacts: which contacts push, and how much.
//!
//! The multipliers `λ` of contacts that are to open by `w` minimise `½ λᵀ A λ - λᵀ w`, none of them
//! negative except those of contacts that are held. The Delassus operator `A = N M⁻¹ Nᵀ` may be singular, because
//! contacts may share a load in many ways. The proximal point method (Rockafellar 1976, "Augmented Lagrangians and
//! applications of the proximal point algorithm in convex programming") goes to the minimum by steps that
//! each add `½ (λ' - λ)ᵀ R⁻¹ (λ' - λ)`. With large `R` few steps are needed, and each is a minimum of
//!
//! ```text
//! ½ dᵀ M d + Σ ½ p² / ρ,    p = λ + ρ (w - N d),  or nothing where that pulls
//! ```
//!
//! over changes of velocity `d`. This function has one minimum, no constraints, and quadratic pieces: Newton's
//! method finds the minimum (Li, Sun, Toh 2018, "A highly efficient semismooth Newton augmented Lagrangian method"),
//! with the matrix `M + Σ ρ n nᵀ` over contacts that push, 3 × 3 a body. The height of a heap does not make it
//! slower, nor do masses up to about 1 : 10^6.

use alloc::{vec, vec::Vec};
use glam::{DMat3, DVec3};

use super::{ROUNDING, cholesky::Cholesky};
use crate::impulse::{Joined, Known};

/// `R` by the heavier of the bodies of a contact: large, but not so large that rounding in the factor undoes
/// what a step gains; and by what it grows where a step gains little, and how often. None changes the answer.
const STIFFNESS: f64 = (1_u32 << 24) as f64;
const STIFFER: f64 = 64.0;
const MOST_STIFFER: u32 = 3;

/// Steps of the proximal point method at most. A few are enough where bodies have room; where they have not,
/// what is left closes the least.
const STEPS: usize = 32;

/// Sweeps before the first step, contact by contact, there and back. They find most of who pushes.
const SWEEPS: usize = 4;

/// Steps of Newton's method in each, at most; and how many are taken whole at first, which mostly finds the
/// least at once, before the least along each is looked for, which always finds it.
const NEWTON_STEPS: usize = 48;
const FULL_STEPS: usize = 10;

/// Looks for the least along a line, at most.
const LOOKS: usize = 16;

/// Lengths of a step beyond which nothing is looked for.
const FARTHEST: f64 = 1024.0;

/// Contacts and their bodies as one problem.
struct Problem<'a> {
    contacts: &'a [Joined],
    inverse_mass: &'a [f64],
    held: &'a [bool],
    /// How much contacts are to open, m/s.
    wanted: &'a [f64],
    /// By contact, kg.
    stiffness: Vec<f64>,
    /// Row of each body in the factor; none for what nothing moves.
    row: Vec<Option<usize>>,
}

/// The multipliers: the least ones after which no contact closes as far as it is wanted to open, and those
/// that are held open just as far.
pub(super) fn multipliers(
    contacts: &[Joined],
    inverse_mass: &[f64],
    wanted: &[f64],
    known: Known,
) -> Vec<f64> {
    let mut problem = Problem::of(contacts, inverse_mass, wanted, known.held);
    let count = contacts.len();
    let mut given = match known.warm.len() == count {
        true => known.warm.to_vec(),
        false => vec![0.0; count],
    };
    for (k, given) in given.iter_mut().enumerate() {
        *given = problem.allowed(k, *given);
    }
    problem.sweep(&mut given);
    let mut newton = Newton::of(&problem);
    let most = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
    let enough = known.enough.max(ROUNDING * most);
    let mut best = (f64::INFINITY, given.clone());
    let (mut is_found, mut stiffer) = (true, 0);
    for _ in 0..STEPS {
        let missing = problem.missing(&given);
        let worst = problem.worst(&given, &missing);
        if worst <= enough {
            return given;
        }
        let is_slow = is_found && worst > 0.25 * best.0;
        if worst < best.0 {
            best = (worst, given.clone());
        }
        if is_slow {
            // Rounding is all that is left, or there is no room.
            if stiffer == MOST_STIFFER {
                break;
            }
            stiffer += 1;
            newton.pushes.clear();
            problem
                .stiffness
                .iter_mut()
                .for_each(|stiffness| *stiffness *= STIFFER);
        }
        is_found = newton.step(&problem, &mut given, &missing);
    }
    best.1
}

impl<'a> Problem<'a> {
    fn of(
        contacts: &'a [Joined],
        inverse_mass: &'a [f64],
        wanted: &'a [f64],
        held: &'a [bool],
    ) -> Problem<'a> {
        let mut rows = 0..;
        let row = inverse_mass.iter().map(|&w| match w > 0.0 {
            true => rows.next(),
            false => None,
        });
        let row = row.collect();
        // By the heavier of two bodies: light ones pass on what heavy ones weigh.
        let stiffness = contacts.iter().map(|contact| {
            let (i, j) = contact.bodies;
            let moved = [inverse_mass[i], inverse_mass[j]].into_iter();
            let least = moved.filter(|&w| w > 0.0).fold(f64::INFINITY, f64::min);
            STIFFNESS / least
        });
        Problem {
            stiffness: stiffness.collect(),
            contacts,
            inverse_mass,
            held,
            wanted,
            row,
        }
    }

    fn is_held(&self, k: usize) -> bool {
        self.held.get(k) == Some(&true)
    }

    /// A multiplier, or none where a contact does not pull.
    fn allowed(&self, k: usize, given: f64) -> f64 {
        match self.is_held(k) {
            true => given,
            false => given.max(0.0),
        }
    }

    /// Brings impulses nearer to the answer, contact by contact, there and back (Gauss, Seidel).
    fn sweep(&self, given: &mut [f64]) {
        let mut change = self.change(given);
        for _ in 0..SWEEPS {
            for k in (0..given.len()).chain((0..given.len()).rev()) {
                let contact = &self.contacts[k];
                let (i, j) = contact.bodies;
                let yielding = self.inverse_mass[i] + self.inverse_mass[j];
                if yielding > 0.0 {
                    let missing = self.wanted[k] - contact.opening(&change);
                    let next = self.allowed(k, given[k] + missing / yielding);
                    let by = (next - given[k]) * contact.normal;
                    change[i] -= self.inverse_mass[i] * by;
                    change[j] += self.inverse_mass[j] * by;
                    given[k] = next;
                }
            }
        }
    }

    /// What impulses change velocities by, m/s.
    fn change(&self, given: &[f64]) -> Vec<DVec3> {
        let mut change = vec![DVec3::ZERO; self.inverse_mass.len()];
        for (contact, &given) in self.contacts.iter().zip(given) {
            let (i, j) = contact.bodies;
            change[i] -= given * self.inverse_mass[i] * contact.normal;
            change[j] += given * self.inverse_mass[j] * contact.normal;
        }
        change
    }

    /// What contacts are to open further after some impulses, m/s.
    fn missing(&self, given: &[f64]) -> Vec<f64> {
        let change = self.change(given);
        let pairs = self.contacts.iter().zip(self.wanted);
        pairs
            .map(|(contact, wanted)| wanted - contact.opening(&change))
            .collect()
    }

    /// How far from the answer some impulses are, m/s.
    fn worst(&self, given: &[f64], missing: &[f64]) -> f64 {
        let of = |k: usize| match given[k] > 0.0 || self.is_held(k) {
            true => missing[k].abs(),
            false => missing[k].max(0.0),
        };
        (0..given.len()).map(of).fold(0.0, f64::max)
    }
}

/// Newton's method, and its memory.
struct Newton {
    factor: Cholesky,
    /// Which contacts push in the factor; none where nothing has been factored.
    pushes: Vec<bool>,
    /// The change of velocity so far in a step, the next part of it, and the gradient there, by bodies.
    change: Vec<DVec3>,
    way: Vec<DVec3>,
    rows: Vec<DVec3>,
    memory: Vec<DVec3>,
}

impl Newton {
    fn of(problem: &Problem) -> Newton {
        let bodies = problem.inverse_mass.len();
        let ties = problem.contacts.iter().filter_map(|contact| {
            let (i, j) = contact.bodies;
            problem.row[i].zip(problem.row[j])
        });
        let rows = problem.row.iter().flatten().count();
        Newton {
            factor: Cholesky::of_graph(rows, ties),
            pushes: Vec::new(),
            change: vec![DVec3::ZERO; bodies],
            way: vec![DVec3::ZERO; bodies],
            rows: vec![DVec3::ZERO; rows],
            memory: vec![DVec3::ZERO; rows],
        }
    }

    /// Takes a step of the proximal point method from impulses after which something is missing, and tells
    /// whether it has come to its end.
    fn step(&mut self, problem: &Problem, given: &mut [f64], missing: &[f64]) -> bool {
        let count = given.len();
        self.change.fill(DVec3::ZERO);
        // What each contact has opened by the change, and opens along the way.
        let (mut opened, mut opens) = (vec![0.0; count], vec![0.0; count]);
        let more = |k: usize, opened: f64| problem.stiffness[k] * (missing[k] - opened);
        // At first those that push now, and those that close.
        let pushes_after = |step: usize, k: usize, opened: f64| match step {
            0 => given[k] > 0.0 || missing[k] > 0.0,
            _ => given[k] + more(k, opened) > 0.0,
        };
        let mut is_found = false;
        for step in 0..NEWTON_STEPS {
            let pushes: Vec<bool> = (0..count)
                .map(|k| problem.is_held(k) || pushes_after(step, k, opened[k]))
                .collect();
            if self.pushes != pushes {
                self.factor(problem, &pushes);
                self.pushes = pushes;
            }
            // The gradient with its sign changed.
            for (&row, (&change, &inverse)) in problem
                .row
                .iter()
                .zip(self.change.iter().zip(problem.inverse_mass))
            {
                if let Some(row) = row {
                    self.rows[row] = -change / inverse;
                }
            }
            for (k, contact) in problem.contacts.iter().enumerate() {
                let by = match self.pushes[k] {
                    true => more(k, opened[k]),
                    false => -given[k],
                };
                let (i, j) = contact.bodies;
                if let Some(row) = problem.row[i] {
                    self.rows[row] -= by * contact.normal;
                }
                if let Some(row) = problem.row[j] {
                    self.rows[row] += by * contact.normal;
                }
            }
            self.factor.solve(&mut self.rows, &mut self.memory);
            for (way, row) in self.way.iter_mut().zip(&problem.row) {
                *way = row.map_or(DVec3::ZERO, |row| self.rows[row]);
            }
            for (opens, contact) in opens.iter_mut().zip(problem.contacts) {
                *opens = contact.opening(&self.way);
            }
            let is_same = (0..count).all(|k| {
                problem.is_held(k)
                    || self.pushes[k] == (given[k] + more(k, opened[k] + opens[k]) > 0.0)
            });
            let length = match is_same || step < FULL_STEPS {
                true => 1.0,
                false => self.least_along(problem, given, missing, (&opened, &opens)),
            };
            for (change, way) in self.change.iter_mut().zip(&self.way) {
                *change += length * *way;
            }
            for (opened, opens) in opened.iter_mut().zip(&opens) {
                *opened += length * opens;
            }
            is_found = is_same;
            if is_same || length == 0.0 {
                break;
            }
        }
        for k in 0..count {
            given[k] = problem.allowed(k, given[k] + more(k, opened[k]));
        }
        is_found
    }

    /// How far along the way the least is: where the slope, which rises from piece to piece, is
    /// nothing.
    fn least_along(
        &self,
        problem: &Problem,
        given: &[f64],
        missing: &[f64],
        (opened, opens): (&[f64], &[f64]),
    ) -> f64 {
        let (mut inertia, mut linear) = (0.0, 0.0);
        let bodies = self.change.iter().zip(&self.way);
        for ((change, way), &inverse) in bodies.zip(problem.inverse_mass) {
            if inverse > 0.0 {
                inertia += way.length_squared() / inverse;
                linear += change.dot(*way) / inverse;
            }
        }
        let slope = |length: f64| {
            let of = |k: usize| {
                let more = problem.stiffness[k] * (missing[k] - opened[k] - length * opens[k]);
                (problem.allowed(k, given[k] + more) - given[k]) * opens[k]
            };
            linear + length * inertia - (0..given.len()).map(of).sum::<f64>()
        };
        let (mut low, mut high) = (0.0, 1.0);
        let (mut at_low, mut at_high) = (slope(low), slope(high));
        if at_low >= 0.0 || at_low.is_nan() {
            return 0.0;
        }
        let steep = at_low.abs();
        let enough = 0.1 * steep;
        while at_high < 0.0 {
            // Where nothing bounds it, rounding is all that is left.
            if -at_high <= enough || high >= FARTHEST {
                return high;
            }
            (low, at_low) = (high, at_high);
            high *= 2.0;
            at_high = slope(high);
        }
        for _ in 0..LOOKS {
            if at_high <= enough {
                return high;
            }
            let chord = low + (high - low) * at_low / (at_low - at_high);
            let edge = 0.1 * (high - low);
            let middle = chord.max(low + edge).min(high - edge);
            let there = slope(middle);
            if there.abs() <= enough {
                return middle;
            }
            match there < 0.0 {
                true => (low, at_low) = (middle, there),
                false => (high, at_high) = (middle, there),
            }
        }
        low
    }

    /// Factors the matrix of contacts that push.
    fn factor(&mut self, problem: &Problem, pushes: &[bool]) {
        let moved = problem.inverse_mass.iter().filter(|&&w| w > 0.0);
        self.factor.begin(moved.map(|w| 1.0 / w));
        for (k, contact) in problem.contacts.iter().enumerate() {
            if pushes[k] {
                let block = problem.stiffness[k] * outer(contact.normal);
                let (i, j) = contact.bodies;
                let rows = (problem.row[i], problem.row[j]);
                for row in [rows.0, rows.1].into_iter().flatten() {
                    self.factor.add(row, block);
                }
                if let Some((i, j)) = rows.0.zip(rows.1) {
                    self.factor.add_between(i, j, -block);
                }
            }
        }
        self.factor.factor();
    }
}

/// `v vᵀ`.
fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v.x * v, v.y * v, v.z * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn upwards(bodies: (usize, usize)) -> Joined {
        Joined {
            bodies,
            normal: DVec3::Y,
        }
    }

    fn solved(contacts: &[Joined], inverse_mass: &[f64], wanted: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let given = multipliers(contacts, inverse_mass, wanted, Known::default());
        let missing = Problem::of(contacts, inverse_mass, wanted, &[]).missing(&given);
        (given, missing)
    }

    #[test]
    fn a_column_of_unequal_masses_carries_its_weight() {
        for ratio in [1.0, 1e3, 1e-3, 1e6] {
            let mass = |k: usize| if k.is_multiple_of(2) { 1.0 } else { ratio };
            let inverse_mass: Vec<f64> = (0..41)
                .map(|k| if k == 0 { 0.0 } else { 1.0 / mass(k) })
                .collect();
            let contacts: Vec<Joined> = (0..40).map(|k| upwards((k, k + 1))).collect();
            let mut wanted = vec![0.0; 40];
            wanted[0] = 1.0;
            let (given, missing) = solved(&contacts, &inverse_mass, &wanted);
            for k in 0..40 {
                let weight: f64 = (k + 1..41).map(mass).sum();
                let error = (given[k] / weight - 1.0).abs();
                assert!(error < 1e-11, "{ratio} {k}: {} for {weight}", given[k]);
                // What goes into the lightest body cancels but for rounding.
                let rounding = f64::EPSILON * given[0] / ratio.min(1.0);
                let missing = missing[k].abs();
                assert!(missing <= 4.0 * rounding, "{ratio} {k}: {missing:e}");
            }
        }
    }

    #[test]
    fn contacts_that_are_one_share_what_they_carry() {
        let contacts: Vec<Joined> = (0..60).map(|k| upwards((k / 6, k / 6 + 1))).collect();
        let inverse_mass: Vec<f64> = (0..11).map(|k| if k == 0 { 0.0 } else { 0.5 }).collect();
        let mut wanted = vec![0.0; 60];
        wanted[..6].fill(1.0);
        let (given, missing) = solved(&contacts, &inverse_mass, &wanted);
        for layer in 0..10 {
            let weight = 2.0 * (10 - layer) as f64;
            let carried: f64 = given[6 * layer..6 * layer + 6].iter().sum();
            assert!((carried / weight - 1.0).abs() < 1e-12, "{layer}: {carried}");
        }
        assert!(missing.iter().all(|missing| missing.abs() < 1e-13));
    }

    #[test]
    fn what_has_no_room_closes_little_and_comes_to_an_end() {
        // Ten bodies in a row between walls of which one comes nearer.
        let contacts: Vec<Joined> = (0..11).map(|k| upwards((k, k + 1))).collect();
        let inverse_mass: Vec<f64> = (0..12).map(|k| f64::from(k % 11 != 0)).collect();
        let mut wanted = vec![0.0; 11];
        wanted[10] = 1.0;
        let (given, missing) = solved(&contacts, &inverse_mass, &wanted);
        assert!(given.iter().all(|given| *given >= 0.0 && given.is_finite()));
        assert!(missing.iter().all(|missing| *missing < 0.2), "{missing:?}");
    }
}
