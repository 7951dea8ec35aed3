//! The lambdas of many contacts: which contacts push, and how much.
//!
//! The multipliers `λ` of contacts that are to open by `w` minimise `½ λᵀ A λ - λᵀ w`, with none of them negative
//! except those of held contacts. The Delassus operator `A = N M⁻¹ Nᵀ` may be singular, because contacts may share a
//! load in many ways. The proximal point method (Rockafellar 1976, "Augmented Lagrangians and applications of the
//! proximal point algorithm in convex programming") reaches the minimum in steps that each add
//! `½ (λ' - λ)ᵀ R⁻¹ (λ' - λ)`. With large `R` few steps are needed, and each is a minimum of
//!
//! ```text
//! ½ dᵀ M d + Σ ½ p² / ρ,    p = λ + ρ (w - N d),  or 0 if that would pull
//! ```
//!
//! over changes of velocity `d`. This function has one minimum, no constraints, and quadratic pieces: Newton's method
//! finds the minimum (Li, Sun, Toh 2018, "A highly efficient semismooth Newton augmented Lagrangian method"), with
//! the matrix `M + Σ ρ n nᵀ` over contacts that push, 3 × 3 for each body. The height of a heap does not make it
//! slower, nor do masses up to about 1 : 10^6.

use alloc::{vec, vec::Vec};
use core::mem;
use glam::{DMat3, DVec3};

use super::{
    ROUNDING,
    cholesky::{Cholesky, Pattern},
};
use crate::impulse::{Joined, Known, Prepared};

/// The first is `R` for the mass of the heavier body of a contact: large, but not so large that rounding in the
/// factor undoes the gain of a step. `R` grows by the second if a step gains little, at most as often as the third
/// says. None of them changes the solution.
const STIFFNESS: f64 = (1_u32 << 24) as f64;
const STIFFER: f64 = 64.0;
const MOST_STIFFER: u32 = 3;

/// The greatest number of steps of the proximal point method. A few are enough if bodies have room. If they have
/// none, the iteration approaches the impulses with the least closing.
const STEPS: usize = 32;

/// The number of sweeps before the first step, contact by contact, forward and back. They find most of the contacts
/// that push.
const SWEEPS: usize = 2;

/// The greatest number of Newton steps in each proximal step, and how many of them are taken with their full length.
/// Full steps mostly find the minimum at once. The later steps use a line search, which always finds it.
const NEWTON_STEPS: usize = 48;
const FULL_STEPS: usize = 10;

/// The greatest number of evaluations in a line search.
const LOOKS: usize = 16;

/// The greatest length in a line search, in lengths of the step.
const FARTHEST: f64 = 1024.0;

/// A contact between two places in the order of elimination. All immovable bodies are in the last place.
#[derive(Clone, Debug)]
struct Link {
    bodies: (usize, usize),
    normal: DVec3,
    /// The index of the block between the two in the factor; `None` if one of them is immovable.
    block: Option<usize>,
    /// `1 / (1/m1 + 1/m2)`, kg, or zero if neither is movable.
    mass: f64,
}

impl Link {
    /// The opening speed of the contact, m/s.
    fn opening(&self, velocity: &[DVec3]) -> f64 {
        (velocity[self.bodies.1] - velocity[self.bodies.0]).dot(self.normal)
    }
}

/// Contacts and their bodies in the order of elimination.
#[derive(Clone, Debug)]
pub(in crate::impulse) struct Network {
    links: Vec<Link>,
    /// By place, kg and 1/kg; both are zero in the last place.
    mass: Vec<f64>,
    inverse_mass: Vec<f64>,
    pattern: Pattern,
}

/// A network and the wanted opening speeds, as one problem.
struct Problem<'a> {
    network: &'a Network,
    held: &'a [bool],
    /// The wanted opening speeds of contacts, m/s.
    wanted: &'a [f64],
    /// By contact, kg.
    stiffness: Vec<f64>,
}

/// The least multipliers after which each contact opens at least as fast as wanted, and held contacts exactly so.
pub(super) fn multipliers(
    contacts: &[Joined],
    inverse_mass: &[f64],
    wanted: &[f64],
    known: Known,
) -> Vec<f64> {
    let own = Prepared::default();
    let prepared = known.prepared.unwrap_or(&own);
    let network = prepared.network(contacts, inverse_mass);
    let mut problem = Problem::of(network, wanted, known.held);
    let count = contacts.len();
    let mut given = match known.warm.len() == count {
        true => known.warm.to_vec(),
        false => vec![0.0; count],
    };
    for (k, given) in given.iter_mut().enumerate() {
        *given = problem.allowed(k, *given);
    }
    problem.sweep(&mut given);
    let mut newton = Newton::of(network);
    let most = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
    let enough = known.enough.max(ROUNDING * most);
    let mut best = (f64::INFINITY, given.clone());
    let (mut is_found, mut stiffer) = (true, 0);
    for _ in 0..STEPS {
        newton.look(&problem, &given);
        let worst = problem.worst(&given, &newton.missing);
        if worst <= enough {
            return given;
        }
        let is_slow = is_found && worst > 0.25 * best.0;
        if worst < best.0 {
            best.0 = worst;
            best.1.copy_from_slice(&given);
        }
        if is_slow {
            // Only rounding is left, or bodies have no room.
            if stiffer == MOST_STIFFER {
                break;
            }
            stiffer += 1;
            newton.forget();
            problem
                .stiffness
                .iter_mut()
                .for_each(|stiffness| *stiffness *= STIFFER);
        }
        is_found = newton.step(&problem, &mut given);
    }
    best.1
}

impl Network {
    pub(in crate::impulse) fn of(contacts: &[Joined], inverse_mass: &[f64]) -> Network {
        let mut rows = 0..;
        let row = inverse_mass.iter().map(|&w| match w > 0.0 {
            true => rows.next(),
            false => None,
        });
        let row: Vec<Option<usize>> = row.collect();
        let ties = contacts.iter().map(|contact| contact.bodies);
        let ties = ties.filter_map(|(i, j)| row[i].zip(row[j]));
        let count = row.iter().flatten().count();
        let pattern = Pattern::of_graph(count, ties);
        let place = |body: usize| row[body].map_or(count, |row| pattern.place[row] as usize);
        let (mut mass, mut inverse) = (vec![0.0; count + 1], vec![0.0; count + 1]);
        for (body, &w) in inverse_mass.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            (mass[place(body)], inverse[place(body)]) = (1.0 / w, w);
        }
        let link = |contact: &Joined| {
            let bodies = (place(contact.bodies.0), place(contact.bodies.1));
            let yielding = inverse[bodies.0] + inverse[bodies.1];
            let is_tie = bodies.0 < count && bodies.1 < count;
            Link {
                bodies,
                normal: contact.normal,
                block: is_tie.then(|| pattern.between(bodies.0, bodies.1)),
                mass: if yielding > 0.0 { 1.0 / yielding } else { 0.0 },
            }
        };
        Network {
            links: contacts.iter().map(link).collect(),
            mass,
            inverse_mass: inverse,
            pattern,
        }
    }

    /// Computes the changes of velocities by impulses, m/s.
    fn change(&self, given: &[f64], change: &mut [DVec3]) {
        change.fill(DVec3::ZERO);
        for (link, &given) in self.links.iter().zip(given) {
            let (i, j) = link.bodies;
            change[i] -= given * self.inverse_mass[i] * link.normal;
            change[j] += given * self.inverse_mass[j] * link.normal;
        }
    }
}

impl<'a> Problem<'a> {
    fn of(network: &'a Network, wanted: &'a [f64], held: &'a [bool]) -> Problem<'a> {
        // The heavier body counts, because light bodies pass on the load of heavy ones.
        let mass = &network.mass;
        let stiffness = |link: &Link| STIFFNESS * mass[link.bodies.0].max(mass[link.bodies.1]);
        Problem {
            stiffness: network.links.iter().map(stiffness).collect(),
            network,
            held,
            wanted,
        }
    }

    fn is_held(&self, k: usize) -> bool {
        self.held.get(k) == Some(&true)
    }

    /// A multiplier, or zero if it is negative and the contact is not held.
    fn allowed(&self, k: usize, given: f64) -> f64 {
        match self.is_held(k) {
            true => given,
            false => given.max(0.0),
        }
    }

    /// Improves impulses contact by contact, forward and back (Gauss-Seidel).
    fn sweep(&self, given: &mut [f64]) {
        let Network {
            links,
            inverse_mass,
            ..
        } = self.network;
        let mut change = vec![DVec3::ZERO; inverse_mass.len()];
        self.network.change(given, &mut change);
        for _ in 0..SWEEPS {
            for k in (0..given.len()).chain((0..given.len()).rev()) {
                let link = &links[k];
                let missing = self.wanted[k] - link.opening(&change);
                let next = self.allowed(k, given[k] + missing * link.mass);
                let by = (next - given[k]) * link.normal;
                let (i, j) = link.bodies;
                change[i] -= inverse_mass[i] * by;
                change[j] += inverse_mass[j] * by;
                given[k] = next;
            }
        }
    }

    /// The greatest residual of the impulses `given`, m/s. `missing` are the opening speeds that contacts lack after
    /// these impulses.
    fn worst(&self, given: &[f64], missing: &[f64]) -> f64 {
        let of = |k: usize| match given[k] > 0.0 || self.is_held(k) {
            true => missing[k].abs(),
            false => missing[k].max(0.0),
        };
        (0..given.len()).map(of).fold(0.0, f64::max)
    }
}

/// Newton's method, with its memory.
struct Newton<'a> {
    factor: Cholesky<'a>,
    /// Which contacts push in the last factorization, if there is one, and which push now.
    factored: Option<Vec<bool>>,
    pushes: Vec<bool>,
    /// The change of velocity so far in a step, and the next Newton step, by place.
    change: Vec<DVec3>,
    way: Vec<DVec3>,
    /// The opening speeds that contacts lack at the start of the step, those gained since then, and those gained
    /// along the next Newton step, m/s.
    missing: Vec<f64>,
    opened: Vec<f64>,
    opens: Vec<f64>,
}

impl Newton<'_> {
    fn of(network: &Network) -> Newton<'_> {
        let (places, count) = (network.mass.len(), network.links.len());
        Newton {
            factor: Cholesky::of(&network.pattern),
            factored: None,
            pushes: vec![false; count],
            change: vec![DVec3::ZERO; places],
            way: vec![DVec3::ZERO; places],
            missing: vec![0.0; count],
            opened: vec![0.0; count],
            opens: vec![0.0; count],
        }
    }

    /// Discards the factorization.
    fn forget(&mut self) {
        self.factored = None;
    }

    /// Computes the residuals after some impulses.
    fn look(&mut self, problem: &Problem, given: &[f64]) {
        problem.network.change(given, &mut self.change);
        let links = problem.network.links.iter().zip(problem.wanted);
        for (missing, (link, wanted)) in self.missing.iter_mut().zip(links) {
            *missing = wanted - link.opening(&self.change);
        }
    }

    /// The further impulse of a contact, N s, after it has opened by `opened`, m/s.
    fn more(&self, problem: &Problem, k: usize, opened: f64) -> f64 {
        problem.stiffness[k] * (self.missing[k] - opened)
    }

    /// Takes a step of the proximal point method from impulses whose residuals are computed. Returns whether Newton's
    /// method has converged.
    fn step(&mut self, problem: &Problem, given: &mut [f64]) -> bool {
        self.change.fill(DVec3::ZERO);
        self.opened.fill(0.0);
        // At first the contacts that push now, and those that close.
        for (k, pushes) in self.pushes.iter_mut().enumerate() {
            *pushes = problem.is_held(k) || given[k] > 0.0 || self.missing[k] > 0.0;
        }
        let mut is_found = false;
        for step in 0..NEWTON_STEPS {
            if self.factored.as_ref() != Some(&self.pushes) {
                self.factor(problem);
            }
            self.find_way(problem, given);
            let is_same = self.mark(problem, given, 1.0);
            let length = match is_same || step < FULL_STEPS {
                true => 1.0,
                false => self.least_along(problem, given),
            };
            for (change, way) in self.change.iter_mut().zip(&self.way) {
                *change += length * *way;
            }
            for (opened, opens) in self.opened.iter_mut().zip(&self.opens) {
                *opened += length * opens;
            }
            is_found = is_same;
            if is_same || length == 0.0 {
                break;
            }
            if length != 1.0 {
                self.mark(problem, given, 0.0);
            }
        }
        for (k, given) in given.iter_mut().enumerate() {
            *given = problem.allowed(k, *given + self.more(problem, k, self.opened[k]));
        }
        is_found
    }

    /// Marks the contacts that push after a part of the Newton step. Returns whether they are the same as before.
    fn mark(&mut self, problem: &Problem, given: &[f64], part: f64) -> bool {
        let mut is_same = true;
        for (k, &given) in given.iter().enumerate() {
            let more = self.more(problem, k, self.opened[k] + part * self.opens[k]);
            let pushes = problem.is_held(k) || given + more > 0.0;
            is_same &= mem::replace(&mut self.pushes[k], pushes) == pushes;
        }
        is_same
    }

    /// Computes the Newton step for the pushing contacts, and the opening speeds that contacts gain along it.
    fn find_way(&mut self, problem: &Problem, given: &[f64]) {
        // The negative gradient.
        let bodies = self.change.iter().zip(&problem.network.mass);
        for (way, (&change, &mass)) in self.way.iter_mut().zip(bodies) {
            *way = -mass * change;
        }
        for (k, link) in problem.network.links.iter().enumerate() {
            let by = match self.pushes[k] {
                true => self.more(problem, k, self.opened[k]),
                false => -given[k],
            };
            let (i, j) = link.bodies;
            self.way[i] -= by * link.normal;
            self.way[j] += by * link.normal;
        }
        self.factor.solve(&mut self.way);
        if let Some(unmoved) = self.way.last_mut() {
            *unmoved = DVec3::ZERO;
        }
        for (opens, link) in self.opens.iter_mut().zip(&problem.network.links) {
            *opens = link.opening(&self.way);
        }
    }

    /// The length along the Newton step at which the function is least: there its slope, which increases from piece
    /// to piece, is zero.
    fn least_along(&self, problem: &Problem, given: &[f64]) -> f64 {
        let (mut inertia, mut linear) = (0.0, 0.0);
        let bodies = self.change.iter().zip(&self.way);
        for ((change, way), &mass) in bodies.zip(&problem.network.mass) {
            inertia += mass * way.length_squared();
            linear += mass * change.dot(*way);
        }
        let slope = |length: f64| {
            let of = |k: usize| {
                let more = self.more(problem, k, self.opened[k] + length * self.opens[k]);
                (problem.allowed(k, given[k] + more) - given[k]) * self.opens[k]
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
            // If there is no bound, only rounding is left.
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
    fn factor(&mut self, problem: &Problem) {
        let Newton { factor, pushes, .. } = self;
        let (_, moved) = problem.network.mass.split_last().unwrap_or((&0.0, &[]));
        factor.begin(moved);
        let links = problem.network.links.iter().zip(&problem.stiffness);
        for ((link, &stiffness), _) in links.zip(pushes).filter(|(_, pushes)| **pushes) {
            let block = stiffness * outer(link.normal);
            let (i, j) = link.bodies;
            for place in [i, j].into_iter().filter(|&place| place < moved.len()) {
                factor.add(place, &block);
            }
            if let Some(between) = link.block {
                factor.take_between(between, &block);
            }
        }
        factor.factor();
        self.factored = Some(self.pushes.clone());
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
        let network = Network::of(contacts, inverse_mass);
        let problem = Problem::of(&network, wanted, &[]);
        let mut newton = Newton::of(&network);
        newton.look(&problem, &given);
        (given, newton.missing)
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
                // The impulses on the lightest body cancel up to rounding.
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
        // Ten bodies in a row between two walls, one of which approaches.
        let contacts: Vec<Joined> = (0..11).map(|k| upwards((k, k + 1))).collect();
        let inverse_mass: Vec<f64> = (0..12).map(|k| f64::from(k % 11 != 0)).collect();
        let mut wanted = vec![0.0; 11];
        wanted[10] = 1.0;
        let (given, missing) = solved(&contacts, &inverse_mass, &wanted);
        assert!(given.iter().all(|given| *given >= 0.0 && given.is_finite()));
        assert!(missing.iter().all(|missing| *missing < 0.2), "{missing:?}");
    }
}
