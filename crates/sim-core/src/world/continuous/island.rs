//! Islands: sets of movable bodies connected by contacts.

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

use super::super::{
    bodies::Bodies,
    order::{self, InOrder},
    state::State,
};
use super::view::View;
use crate::impulse::{Joined, Prepared};

/// The bodies of an island and their constraints.
#[derive(Clone, Debug, Default)]
pub(super) struct Island {
    /// The movable bodies.
    pub(super) bodies: Vec<usize>,
    /// Indices of the constraints.
    pub(super) constraints: Vec<usize>,
    /// The order of all bodies of the constraints.
    order: InOrder,
}

/// The bodies visited in a search for islands.
#[derive(Clone, Debug, Default)]
pub(super) struct Visited {
    round: u32,
    body: Vec<u32>,
}

impl Visited {
    /// Begins a search with no body visited.
    pub(super) fn begin(&mut self, bodies: usize) {
        self.body.resize(bodies, 0);
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.body.fill(0);
            self.round = 1;
        }
    }

    /// Whether a body has been visited.
    pub(super) fn has(&self, body: usize) -> bool {
        self.body[body] == self.round
    }

    /// Visits a body, and returns whether it was not visited before.
    pub(super) fn visit(&mut self, body: usize) -> bool {
        mem::replace(&mut self.body[body], self.round) != self.round
    }
}

impl View<'_> {
    /// The island of a body, unless it has been visited.
    pub(super) fn island_of(&self, seed: usize, visited: &mut Visited) -> Option<Island> {
        let mut island = self.island_around(seed, visited)?;
        self.sort(&mut island);
        Some(island)
    }

    /// The same, not sorted.
    pub(super) fn island_around(&self, seed: usize, visited: &mut Visited) -> Option<Island> {
        if !self.scene.bodies.is_movable(seed) || !visited.visit(seed) {
            return None;
        }
        let mut island = Island {
            bodies: alloc::vec![seed],
            constraints: Vec::new(),
            order: InOrder::default(),
        };
        let mut next = 0;
        while let Some(&body) = island.bodies.get(next) {
            next += 1;
            for &index in self.contacts.of_body(body) {
                let (i, j) = self.contacts.all()[index as usize].bodies;
                let other = i + j - body;
                // Of two movable bodies, the lower one adds the constraint.
                if !self.scene.bodies.is_movable(other) || body < other {
                    island.constraints.push(index as usize);
                }
                if self.scene.bodies.is_movable(other) && visited.visit(other) {
                    island.bodies.push(other);
                }
            }
        }
        Some(island)
    }

    /// Sorts an island in an order that does not depend on the indices of bodies, because sums over it round.
    fn sort(&self, island: &mut Island) {
        let all = self.contacts.all();
        let Island {
            bodies,
            constraints,
            order,
        } = island;
        let pairs = constraints.iter().map(|&index| all[index].bodies);
        let both = pairs.flat_map(|(i, j)| [i, j]);
        let walls = both.filter(|&body| !self.scene.bodies.is_movable(body));
        *order = self.scene.in_order(walls.chain(bodies.iter().copied()));
        bodies.clear();
        let ordered = order.bodies.iter().copied();
        bodies.extend(ordered.filter(|&body| self.scene.bodies.is_movable(body)));
        if constraints.len() > 1 {
            constraints.sort_by_cached_key(|&index| {
                let contact = &all[index];
                (order.between(contact.bodies, contact.normal), index)
            });
        }
    }
}

/// The bodies of some constraints, each once and in order, and the constraints between their places in this list.
pub(in crate::world) struct Places {
    pub(super) bodies: Vec<usize>,
    pub(super) joined: Vec<Joined>,
    pub(super) inverse_mass: Vec<f64>,
    pub(super) prepared: Prepared,
}

impl Places {
    pub(super) fn of(view: View<'_>, island: &Island) -> Places {
        let all = view.contacts.all();
        let contacts = island.constraints.iter().map(|&index| &all[index]);
        let contacts = contacts.map(|c| (c.bodies, c.normal));
        Places::in_order(view.scene.bodies, &island.order, contacts)
    }

    pub(in crate::world) fn between(
        of: &Bodies,
        motion: &State,
        contacts: impl Iterator<Item = ((usize, usize), DVec3)> + Clone,
    ) -> Places {
        let both = contacts.clone().flat_map(|((i, j), _)| [i, j]);
        Places::in_order(of, &order::in_order(of, motion, both), contacts)
    }

    fn in_order(
        of: &Bodies,
        order: &InOrder,
        contacts: impl Iterator<Item = ((usize, usize), DVec3)>,
    ) -> Places {
        let joined = contacts
            .map(|((i, j), normal)| Joined {
                bodies: (order.place(i), order.place(j)),
                normal,
            })
            .collect();
        let bodies = order.bodies.clone();
        let inverse_mass = bodies.iter().map(|&body| 1.0 / of.mass[body]).collect();
        Places {
            bodies,
            joined,
            inverse_mass,
            prepared: Prepared::default(),
        }
    }

    /// The opening speed for an impulse of 1 N s on a contact, 1/kg.
    pub(super) fn yielding(&self, k: usize) -> f64 {
        let (i, j) = self.joined[k].bodies;
        self.inverse_mass[i] + self.inverse_mass[j]
    }

    pub(super) fn each(&self, of: impl Fn(usize) -> DVec3) -> Vec<DVec3> {
        self.bodies.iter().map(|&body| of(body)).collect()
    }

    /// Writes the values of movable bodies.
    pub(super) fn put(&self, values: &[DVec3], to: &mut [DVec3], inverse_mass: &[f64]) {
        for ((&body, &value), &inverse) in self.bodies.iter().zip(values).zip(inverse_mass) {
            if inverse > 0.0 {
                to[body] = value;
            }
        }
    }
}
