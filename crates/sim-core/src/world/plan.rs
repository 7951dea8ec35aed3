//! Which bodies must be stepped together.
//!
//! Bodies on which nothing but a constant force acts appear in no section. Forces of single
//! bodies make sections that can be cut anywhere; forces between bodies make sections that hold
//! every body they reach, and all between them in the columns.

use alloc::vec::Vec;
use core::ops::Range;

use crate::force::{Force, Reach};

/// The forces of a world by whom they act on, and the bodies by who moves whom. Forces are
/// indices into the world's list.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    /// Runs of bodies, in order and apart.
    pub(super) sections: Vec<Section>,
    /// Forces on every body.
    pub(super) each: Vec<usize>,
    /// Forces on one body, in the order of bodies.
    pub(super) single: Vec<(usize, usize)>,
    /// Forces between two bodies, in the order of the lower one.
    pub(super) pairs: Vec<([usize; 2], usize)>,
    /// Forces between every two bodies.
    pub(super) each_pair: Vec<usize>,
    /// Whether some force depends on velocities.
    pub(super) depends_on_velocity: bool,
}

/// A run of bodies that forces act on.
#[derive(Clone, Debug)]
pub(super) struct Section {
    pub(super) bodies: Range<usize>,
    /// Whether forces act between them.
    pub(super) is_coupled: bool,
}

impl Plan {
    pub(super) fn new(forces: &[Force], bodies: usize) -> Plan {
        let mut plan = Plan::default();
        for (force, what) in forces.iter().enumerate() {
            plan.depends_on_velocity |= what.depends_on_velocity();
            match what.reach() {
                Reach::Weight => {}
                Reach::Body(body) => plan.single.push((body, force)),
                Reach::EachBody => plan.each.push(force),
                Reach::Pair(pair) => plan.pairs.push((pair, force)),
                Reach::EachPair => plan.each_pair.push(force),
            }
        }
        plan.single.sort_unstable();
        plan.pairs
            .sort_unstable_by_key(|&([i, j], force)| (i.min(j), force));
        plan.sections = plan.coupled_sections(bodies);
        plan.add_uncoupled_sections(bodies);
        plan
    }

    /// The runs from the lower to the higher body of each pair, united where they share a body.
    fn coupled_sections(&self, bodies: usize) -> Vec<Section> {
        let everyone = (!self.each_pair.is_empty() && bodies > 1).then_some(0..bodies);
        let pairs = self.pairs.iter();
        let runs = pairs.map(|&([i, j], _)| i.min(j)..i.max(j) + 1);
        let mut sections: Vec<Section> = Vec::new();
        for run in everyone.into_iter().chain(runs) {
            match sections.last_mut() {
                Some(last) if run.start < last.bodies.end => {
                    last.bodies.end = last.bodies.end.max(run.end);
                }
                _ => sections.push(Section {
                    bodies: run,
                    is_coupled: true,
                }),
            }
        }
        sections
    }

    /// The other bodies that a force acts on: all of them, or those that forces name.
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
        // Cut out what is in a coupled section already.
        let coupled = self.sections.len();
        for mut run in runs {
            for i in 0..coupled {
                let hole = self.sections[i].bodies.clone();
                if hole.end <= run.start || run.end <= hole.start {
                    continue;
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
            });
        }
    }

    /// The forces on single bodies of a run.
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
        let plan = Plan::new(forces, bodies);
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
