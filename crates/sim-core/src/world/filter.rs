//! Collision filters: groups of bodies, and single pairs that never collide.

use alloc::{boxed::Box, collections::BTreeSet};

use super::{World, WorldError, bodies::Bodies, column::Column};

/// The groups that a body is in, and the groups with which it collides, a bit for each group.
///
/// Two bodies collide if each is in a group with which the other one collides. By default a
/// body is in all groups and collides with all.
///
/// ```
/// use sim_core::Groups;
///
/// const DEBRIS: u32 = 1;
/// const WALLS: u32 = 2;
/// let debris = Groups { member_of: DEBRIS, collides_with: !DEBRIS };
/// let wall = Groups { member_of: WALLS, ..Groups::ALL };
/// assert!(debris.collide(wall) && !debris.collide(debris));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Groups {
    /// The groups that the body is in.
    pub member_of: u32,
    /// The groups that it collides with.
    pub collides_with: u32,
}

impl Groups {
    /// In all groups, and collides with all.
    pub const ALL: Groups = Groups {
        member_of: u32::MAX,
        collides_with: u32::MAX,
    };
    /// In no group: the body meets no other body.
    pub const NONE: Groups = Groups {
        member_of: 0,
        collides_with: 0,
    };

    /// Whether bodies of these groups collide; the same for both.
    #[must_use]
    pub const fn collide(self, other: Groups) -> bool {
        self.member_of & other.collides_with != 0 && other.member_of & self.collides_with != 0
    }
}

impl Default for Groups {
    fn default() -> Groups {
        Groups::ALL
    }
}

/// The groups and pairs that keep bodies from colliding.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    groups: Column<Groups>,
    /// The lower body first.
    pairs: BTreeSet<(usize, usize)>,
}

impl Filter {
    fn allows(&self, i: usize, j: usize) -> bool {
        self.groups.get(i).collide(self.groups.get(j))
            && !self.pairs.contains(&(i.min(j), i.max(j)))
    }

    /// Removes a body; the indices of the bodies after it decrease by one.
    fn remove(&mut self, body: usize) {
        self.groups.remove(body);
        let pairs = core::mem::take(&mut self.pairs).into_iter();
        let others = pairs.filter(|&(i, j)| i != body && j != body);
        let moved = |other: usize| other - usize::from(other > body);
        self.pairs = others.map(|(i, j)| (moved(i), moved(j))).collect();
    }
}

impl Bodies {
    /// Whether two bodies with shapes can interact: one is movable, and no filter keeps them from colliding.
    #[inline]
    pub(super) fn may_meet(&self, i: usize, j: usize) -> bool {
        (self.is_movable(i) || self.is_movable(j))
            && self
                .filter
                .as_ref()
                .is_none_or(|filter| filter.allows(i, j))
    }

    fn groups(&self, body: usize) -> Groups {
        let filter = self.filter.as_ref();
        filter.map_or(Groups::ALL, |filter| filter.groups.get(body))
    }

    pub(super) fn set_groups(&mut self, body: usize, groups: Groups) {
        if self.groups(body) != groups {
            self.need_filter().groups.set(body, groups);
            self.drop_idle_filter();
        }
    }

    fn need_filter(&mut self) -> &mut Filter {
        self.filter.get_or_insert_with(|| {
            Box::new(Filter {
                groups: Column::new(Groups::ALL),
                pairs: BTreeSet::new(),
            })
        })
    }

    /// Removes a filter that has no effect, so that pairs are not tested against it.
    fn drop_idle_filter(&mut self) {
        let is_idle = |filter: &Filter| filter.groups.is_usual() && filter.pairs.is_empty();
        self.filter.take_if(|filter| is_idle(filter));
    }

    /// Removes a body; the indices of the bodies after it decrease by one.
    pub(super) fn remove_from_filter(&mut self, body: usize) {
        if let Some(filter) = &mut self.filter {
            filter.remove(body);
            self.drop_idle_filter();
        }
    }

    /// Pairs of bodies that never collide, in order.
    pub(super) fn ignored_pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let pairs = self.filter.iter().flat_map(|filter| &filter.pairs);
        pairs.copied()
    }
}

impl World {
    /// The groups of a body, which select the bodies that it collides with.
    ///
    /// # Panics
    ///
    /// If there is no body of that index.
    #[must_use]
    pub fn groups(&self, body: usize) -> Groups {
        assert!(body < self.len(), "there is no body {body}");
        self.bodies.groups(body)
    }

    /// Puts a body into groups. Contacts with bodies that it no longer collides with end. If it overlaps bodies
    /// with which it collides from now on, they count as placed in overlap.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`].
    pub fn set_groups(&mut self, body: usize, groups: Groups) -> Result<(), WorldError> {
        self.check_body(body)?;
        if self.bodies.groups(body) != groups {
            self.forget_contacts_of(body);
            self.bodies.set_groups(body, groups);
            self.note_placed(body);
        }
        Ok(())
    }

    /// Two bodies never collide from now on, for example two that a spring joins: they do not block each other in any
    /// mode, and are never in overlap or in contact. The order of the two does not matter, and a second call changes
    /// nothing.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], and [`WorldError::SameBody`] of a body and itself.
    pub fn ignore_pair(&mut self, i: usize, j: usize) -> Result<(), WorldError> {
        let pair = self.check_pair(i, j)?;
        if self.bodies.need_filter().pairs.insert(pair) {
            self.forget_contacts_between(pair);
        }
        Ok(())
    }

    /// Two bodies that [`World::ignore_pair`] has named collide again. If they overlap now, they count as placed in
    /// overlap.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], and [`WorldError::SameBody`] of a body and itself.
    pub fn heed_pair(&mut self, i: usize, j: usize) -> Result<(), WorldError> {
        let pair = self.check_pair(i, j)?;
        let filter = self.bodies.filter.as_mut();
        if filter.is_some_and(|filter| filter.pairs.remove(&pair)) {
            self.bodies.drop_idle_filter();
            self.forget_contacts_of(i);
            self.note_placed(i);
        }
        Ok(())
    }

    /// The pairs of bodies that [`World::ignore_pair`] has named, the lower index first, in order.
    pub fn ignored_pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.bodies.ignored_pairs()
    }

    fn check_pair(&self, i: usize, j: usize) -> Result<(usize, usize), WorldError> {
        self.check_body(i)?;
        self.check_body(j)?;
        match i == j {
            true => Err(WorldError::SameBody { body: i }),
            false => Ok((i.min(j), i.max(j))),
        }
    }

    /// Removes the contact and the overlap of two bodies.
    fn forget_contacts_between(&mut self, pair: (usize, usize)) {
        self.seek_overlaps();
        self.overlaps.retain(|&known| known != pair);
        self.contacts.retain(|contact| contact.bodies != pair);
        self.continuous.wake_all();
    }
}
