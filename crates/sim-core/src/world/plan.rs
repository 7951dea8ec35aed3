//! Which bodies must be stepped together.
//!
//! Bodies with only constant forces belong to no section. Forces on single bodies make sections that can be cut
//! anywhere. A force between bodies makes a section that contains every body on which it acts, and all bodies between
//! these in the columns. In such a section, the bodies that forces connect are a group. Each group is stepped by itself
//! and in an order of its own: sums over bodies round, and this rounding must not depend on places in the columns.

use alloc::{vec, vec::Vec};
use core::ops::Range;

use super::order::Key;
use crate::{
    force::{Force, Reach},
    pieces::Pieces,
};

/// The forces of a world, sorted by the bodies on which they act, and the bodies that must be stepped together. A force
/// is given by its index in the world's list.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    /// Ranges of bodies, in order and disjoint.
    pub(super) sections: Vec<Section>,
    /// Forces on every body.
    pub(super) each: Vec<usize>,
    /// Forces on one body: the body and the force, in the order of bodies.
    pub(super) single: Vec<(usize, usize)>,
    /// Forces between two bodies, in the order of the lower body.
    pub(super) pairs: Vec<([usize; 2], usize)>,
    /// Forces between every two bodies.
    pub(super) each_pair: Vec<usize>,
    /// Whether some force depends on velocities.
    pub(super) depends_on_velocity: bool,
    /// Bodies on which forces act at points, in order.
    pub(super) levered: Vec<usize>,
}

/// A range of bodies on which forces act.
#[derive(Clone, Debug)]
pub(super) struct Section {
    pub(super) bodies: Range<usize>,
    /// Whether forces act between them.
    pub(super) is_coupled: bool,
    /// If so, these bodies by connected component.
    pub(super) groups: Vec<Group>,
}

/// Bodies of a coupled section that are stepped together.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// In the order in which they are stepped: first the bodies named by forces between two bodies, in the order of
    /// these forces; then the others, by their motion when forces were last set.
    pub(super) bodies: Vec<usize>,
    /// The range of the bodies in the columns, if they are in this order there, without a gap.
    pub(super) run: Option<Range<usize>>,
    /// Forces on one body and between two bodies, by places in the group, in the order of forces.
    pub(super) single: Vec<(usize, usize)>,
    pub(super) pairs: Vec<([usize; 2], usize)>,
    /// The bodies on which forces act at points, by places in the group.
    pub(super) levered: Vec<usize>,
}

impl Plan {
    /// `key` orders the bodies that forces do not order.
    pub(super) fn new(forces: &[Force], bodies: usize, key: impl Fn(usize) -> Key) -> Plan {
        let mut plan = Plan::default();
        for (force, what) in forces.iter().enumerate() {
            plan.depends_on_velocity |= what.nature().depends_on_velocity;
            if what.has_points() {
                plan.levered.extend(what.bodies());
            }
            match what.reach() {
                Reach::Weight => {}
                Reach::Body(body) => plan.single.push((body, force)),
                Reach::EachBody => plan.each.push(force),
                Reach::Pair(pair) => plan.pairs.push((pair, force)),
                Reach::EachPair => plan.each_pair.push(force),
            }
        }
        plan.levered.sort_unstable();
        plan.levered.dedup();
        plan.single.sort_unstable();
        plan.pairs
            .sort_unstable_by_key(|&([i, j], force)| (i.min(j), force));
        plan.sections = plan.coupled_sections(bodies);
        plan.add_groups(bodies, key);
        plan.add_uncoupled_sections(bodies);
        plan
    }

    /// The ranges from the lower to the higher body of each pair, joined if they share a body. A body on which forces
    /// act at points has a section too, because such forces couple its rotation to its position.
    fn coupled_sections(&self, bodies: usize) -> Vec<Section> {
        let everyone = (!self.each_pair.is_empty() && bodies > 1).then_some(0..bodies);
        let pairs = self.pairs.iter();
        let pairs = pairs.map(|&([i, j], _)| i.min(j)..i.max(j) + 1);
        let levered = self.levered.iter().map(|&body| body..body + 1);
        let mut runs: Vec<Range<usize>> =
            everyone.into_iter().chain(pairs).chain(levered).collect();
        runs.sort_by_key(|run| run.start);
        let mut sections: Vec<Section> = Vec::new();
        for run in runs {
            match sections.last_mut() {
                Some(last) if run.start < last.bodies.end => {
                    last.bodies.end = last.bodies.end.max(run.end);
                }
                _ => sections.push(Section {
                    bodies: run,
                    is_coupled: true,
                    groups: Vec::new(),
                }),
            }
        }
        sections
    }

    /// Divides coupled sections into groups.
    fn add_groups(&mut self, bodies: usize, key: impl Fn(usize) -> Key) {
        if self.sections.is_empty() {
            return;
        }
        let mut pairs = self.pairs.clone();
        pairs.sort_unstable_by_key(|&(_, force)| force);
        let mut pieces = Pieces::new(bodies);
        for &([i, j], _) in &pairs {
            pieces.join(i, j);
        }
        if !self.each_pair.is_empty() {
            (1..bodies).for_each(|body| {
                pieces.join(0, body);
            });
        }
        // The place at which a body is first named; bodies that no force names come last.
        let mut named = vec![usize::MAX; bodies];
        for (place, body) in pairs.iter().flat_map(|&(pair, _)| pair).enumerate() {
            named[body] = named[body].min(place);
        }
        let mut in_order: Vec<usize> = self
            .sections
            .iter()
            .flat_map(|s| s.bodies.clone())
            .collect();
        in_order.sort_by(|&one, &other| {
            let by_force = named[one].cmp(&named[other]);
            by_force.then_with(|| key(one).cmp(&key(other)))
        });
        // Indexed by the lowest body of each group, which is in the same section as the whole group.
        let mut groups: Vec<Vec<usize>> = vec![Vec::new(); bodies];
        let mut place = vec![0; bodies];
        for body in in_order {
            let group = &mut groups[pieces.first(body)];
            place[body] = group.len();
            group.push(body);
        }
        let mut own_pairs: Vec<Vec<([usize; 2], usize)>> = vec![Vec::new(); bodies];
        for &(pair, force) in &pairs {
            own_pairs[pieces.first(pair[0])].push((pair.map(|body| place[body]), force));
        }
        for section in 0..self.sections.len() {
            for first in self.sections[section].bodies.clone() {
                let bodies = core::mem::take(&mut groups[first]);
                if bodies.is_empty() {
                    continue;
                }
                let is_run = (first..).zip(&bodies).all(|(next, &body)| body == next);
                let single = bodies.iter().flat_map(|&body| {
                    let forces = self.single_in(&(body..body + 1)).iter();
                    forces.map(|&(body, force)| (place[body], force))
                });
                let places = 0..bodies.len();
                let levered =
                    places.filter(|&place| self.levered.binary_search(&bodies[place]).is_ok());
                let group = Group {
                    levered: levered.collect(),
                    single: single.collect(),
                    pairs: core::mem::take(&mut own_pairs[first]),
                    run: is_run.then(|| first..first + bodies.len()),
                    bodies,
                };
                self.sections[section].groups.push(group);
            }
        }
    }

    /// Adds sections for the other bodies on which forces act: all bodies, or those that forces name.
    fn add_uncoupled_sections(&mut self, bodies: usize) {
        let mut runs: Vec<Range<usize>> = Vec::new();
        if self.each.is_empty() {
            for &(body, _) in &self.single {
                match runs.last_mut() {
                    Some(last) if body <= last.end => last.end = body + 1,
                    _ => runs.push(body..body + 1),
                }
            }
        } else {
            runs.push(0..bodies);
        }
        // Without the parts that are in a coupled section already.
        let coupled = self.sections.len();
        for mut run in runs {
            let before = |section: &Section| section.bodies.end <= run.start;
            let first = self.sections[..coupled].partition_point(before);
            for i in first..coupled {
                let hole = self.sections[i].bodies.clone();
                if run.end <= hole.start {
                    break;
                }
                self.add_uncoupled(run.start..hole.start);
                run.start = hole.end;
            }
            self.add_uncoupled(run);
        }
        self.sections
            .sort_unstable_by_key(|section| section.bodies.start);
    }

    fn add_uncoupled(&mut self, bodies: Range<usize>) {
        if bodies.start < bodies.end {
            self.sections.push(Section {
                bodies,
                is_coupled: false,
                groups: Vec::new(),
            });
        }
    }

    /// Whether forces act at points of a body.
    #[inline]
    pub(super) fn is_levered(&self, body: usize) -> bool {
        !self.levered.is_empty() && self.levered.binary_search(&body).is_ok()
    }

    /// Whether only constant forces act on a group.
    pub(super) fn is_free(&self, group: &Group) -> bool {
        group.bodies.len() == 1 && self.each.is_empty() && group.single.is_empty()
    }

    /// The section that contains a body.
    pub(super) fn section_at(&self, body: usize) -> Option<&Section> {
        let after = self
            .sections
            .partition_point(|section| section.bodies.end <= body);
        let section = self.sections.get(after);
        section.filter(|section| section.bodies.start <= body)
    }

    /// The forces on single bodies of a range.
    pub(super) fn single_in(&self, bodies: &Range<usize>) -> &[(usize, usize)] {
        let list = &self.single[..];
        let start = list.partition_point(|&(body, _)| body < bodies.start);
        let end = list.partition_point(|&(body, _)| body < bodies.end);
        &list[start..end]
    }

    /// The forces between two bodies of a coupled section.
    pub(super) fn pairs_in(&self, bodies: &Range<usize>) -> &[([usize; 2], usize)] {
        let list = &self.pairs[..];
        let start = list.partition_point(|&([i, j], _)| i.min(j) < bodies.start);
        let end = list.partition_point(|&([i, j], _)| i.min(j) < bodies.end);
        &list[start..end]
    }
}

#[cfg(test)]
mod tests {
    use core::slice;

    use super::*;

    fn spring(i: usize, j: usize) -> Force {
        Force::Spring {
            bodies: [i, j],
            points: None,
            rest_length: 0.0,
            stiffness: 1.0,
            damping: 0.0,
        }
    }

    fn drag(body: Option<usize>) -> Force {
        Force::LinearDrag {
            body,
            coefficient: 1.0,
        }
    }

    fn sections(forces: &[Force], bodies: usize) -> Vec<(Range<usize>, bool)> {
        let plan = Plan::new(forces, bodies, |_| Key::default());
        let sections = plan.sections.into_iter();
        sections.map(|s| (s.bodies, s.is_coupled)).collect()
    }

    #[test]
    fn free_bodies_are_in_no_section() {
        let weight = Force::Gravity {
            acceleration: glam::DVec3::Y,
        };
        assert_eq!(sections(slice::from_ref(&weight), 9), []);
        assert_eq!(sections(&[weight, drag(Some(4))], 9), [(4..5, false)]);
        let two = [drag(Some(4)), drag(Some(3)), drag(Some(4))];
        assert_eq!(sections(&two, 9), [(3..5, false)]);
    }

    #[test]
    fn pairs_that_share_a_body_are_one_section() {
        let chain = [spring(2, 3), spring(4, 3), spring(7, 6)];
        assert_eq!(sections(&chain, 9), [(2..5, true), (6..8, true)]);
        let nested = [spring(0, 8), spring(2, 3)];
        assert_eq!(sections(&nested, 9), [(0..9, true)]);
    }

    #[test]
    fn coupled_sections_are_cut_out_of_the_others() {
        let forces = [drag(None), spring(5, 3)];
        let expected = [(0..3, false), (3..6, true), (6..9, false)];
        assert_eq!(sections(&forces, 9), expected);
        let gravitation = Force::Gravitation { constant: 1.0 };
        assert_eq!(sections(slice::from_ref(&gravitation), 9), [(0..9, true)]);
        assert_eq!(sections(&[gravitation], 1), []);
    }
}
