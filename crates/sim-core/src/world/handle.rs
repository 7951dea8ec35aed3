//! Handles: names of bodies that remain valid when other bodies are removed.

use alloc::vec::Vec;

use super::{World, WorldError};

/// A permanent name of a body in its world. The index of a body changes when a body before it is removed; its handle
/// does not.
///
/// The handle of a removed body is *stale* for ever, even if another body uses its slot, because each slot counts its
/// bodies. A handle is valid in one world and its copies; another world does not know it, or has another body of this
/// handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyHandle {
    slot: u32,
    generation: u32,
}

/// The map between handles and bodies. It is empty until the first body is removed; until then the handle of a body
/// is its index.
#[derive(Clone, Debug, Default)]
pub(super) struct Handles {
    slots: Vec<Slot>,
    /// For each body its slot.
    slot_of: Vec<u32>,
    free: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Slot {
    /// The number of bodies that had this slot before.
    pub(super) generation: u32,
    /// The body that has this slot.
    pub(super) body: Option<u32>,
}

impl Handles {
    fn of(&self, body: usize) -> BodyHandle {
        let slot = self.slot_of.get(body).map_or(body as u32, |&slot| slot);
        let known = self.slots.get(slot as usize);
        BodyHandle {
            slot,
            generation: known.map_or(0, |slot| slot.generation),
        }
    }

    /// The body of a handle, among `bodies` bodies.
    fn body(&self, handle: BodyHandle, bodies: usize) -> Option<usize> {
        let place = handle.slot as usize;
        if self.slots.is_empty() {
            return (handle.generation == 0 && place < bodies).then_some(place);
        }
        let slot = self.slots.get(place)?;
        let body = slot.body.filter(|_| slot.generation == handle.generation);
        body.map(|body| body as usize)
    }

    /// Adds a body after all others.
    pub(super) fn push(&mut self) {
        if self.slots.is_empty() {
            return;
        }
        let body = Some(self.slot_of.len() as u32);
        let slot = self.free.pop().unwrap_or_else(|| {
            self.slots.push(Slot {
                generation: 0,
                body,
            });
            self.slots.len() as u32 - 1
        });
        self.slots[slot as usize].body = body;
        self.slot_of.push(slot);
    }

    /// Removes one of `bodies` bodies; the indices of the bodies after it decrease by one.
    pub(super) fn remove(&mut self, body: usize, bodies: usize) {
        if self.slots.is_empty() {
            self.slot_of = (0..bodies as u32).collect();
            let all = self.slot_of.iter().map(|&body| Slot {
                generation: 0,
                body: Some(body),
            });
            self.slots = all.collect();
        }
        let slot = self.slot_of.remove(body);
        let gone = &mut self.slots[slot as usize];
        gone.body = None;
        // A slot whose counter is at its maximum is not used again.
        if let Some(next) = gone.generation.checked_add(1) {
            gone.generation = next;
            self.free.push(slot);
        }
        for (body, &slot) in (0..).zip(&self.slot_of).skip(body) {
            self.slots[slot as usize].body = Some(body);
        }
    }
}

#[cfg(feature = "serde")]
impl Handles {
    pub(super) fn slots(&self) -> (&[Slot], &[u32]) {
        (&self.slots, &self.free)
    }

    /// Handles from given slots and free slots; `None` unless each of the bodies has exactly one slot.
    pub(super) fn in_slots(slots: Vec<Slot>, free: Vec<u32>, bodies: usize) -> Option<Handles> {
        if slots.is_empty() {
            return free.is_empty().then(Handles::default);
        }
        let mut slot_of = alloc::vec![None; bodies];
        for (slot, body) in (0..).zip(slots.iter().map(|slot| slot.body)) {
            if let Some(body) = body {
                let place = slot_of.get_mut(body as usize)?;
                if place.replace(slot).is_some() {
                    return None;
                }
            }
        }
        let mut seen = alloc::collections::BTreeSet::new();
        let is_free = |&slot: &u32| slots.get(slot as usize).is_some_and(|s| s.body.is_none());
        let are_free = free.iter().all(|slot| is_free(slot) && seen.insert(*slot));
        let slot_of: Option<Vec<u32>> = slot_of.into_iter().collect();
        slot_of.filter(|_| are_free).map(|slot_of| Handles {
            slots,
            slot_of,
            free,
        })
    }
}

impl World {
    /// The handle of a body. It stays valid when other bodies are removed.
    ///
    /// # Panics
    ///
    /// If there is no body of that index.
    #[must_use]
    pub fn handle(&self, body: usize) -> BodyHandle {
        assert!(body < self.len(), "there is no body {body}");
        self.handles.of(body)
    }

    /// The current index of a body; it may change when a body is removed.
    ///
    /// ```
    /// # use sim_core::{Body, Settings, World};
    /// let mut world = World::new(Settings::default())?;
    /// let (first, second) = (world.add(Body::default())?, world.add(Body::default())?);
    /// let (gone, kept) = (world.handle(first), world.handle(second));
    /// world.remove(first)?;
    /// assert_eq!(world.index_of(kept), Ok(0));
    /// assert!(world.index_of(gone).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`WorldError::Stale`] if the body has been removed, or the handle is not of this world.
    pub fn index_of(&self, handle: BodyHandle) -> Result<usize, WorldError> {
        let body = self.handles.body(handle, self.len());
        body.ok_or(WorldError::Stale { handle })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Settings, test_random::Random};

    #[test]
    fn handles_name_their_bodies_whatever_is_added_and_removed() {
        let mut world = World::new(Settings::default()).unwrap();
        let mut random = Random(3);
        let mut below = |n: usize| random.up_to(1 << 20).unsigned_abs() as usize % n;
        let (mut there, mut gone) = (Vec::new(), Vec::new());
        for id in 1..2000 {
            if below(2) == 0 || there.is_empty() {
                let body = world
                    .add(Body {
                        user_data: id,
                        ..Body::default()
                    })
                    .unwrap();
                there.push((world.handle(body), id));
            } else {
                let (handle, id) = there.swap_remove(below(there.len()));
                let body = world.index_of(handle).unwrap();
                assert_eq!(world.remove(body).unwrap().user_data, id);
                gone.push(handle);
            }
            for &(handle, id) in &there {
                let body = world.index_of(handle).unwrap();
                assert_eq!((world.user_data(body), world.handle(body)), (id, handle));
            }
        }
        assert!(gone.len() > 500 && world.len() == there.len());
        for handle in gone {
            assert_eq!(world.index_of(handle), Err(WorldError::Stale { handle }));
        }
    }

    #[test]
    fn a_world_that_removes_nothing_keeps_nothing() {
        let mut world = World::new(Settings::default()).unwrap();
        for _ in 0..10 {
            world.add(Body::default()).unwrap();
        }
        assert!(world.handles.slots.is_empty() && world.handles.slot_of.is_empty());
        assert_eq!(world.index_of(world.handle(9)), Ok(9));
    }

    #[test]
    fn a_slot_that_has_had_too_many_bodies_has_no_more() {
        let mut world = World::new(Settings::default()).unwrap();
        world.add(Body::default()).unwrap();
        world.remove(0).unwrap();
        world.handles.slots[0].generation = u32::MAX;
        world.add(Body::default()).unwrap();
        let last = world.handle(0);
        world.remove(0).unwrap();
        world.add(Body::default()).unwrap();
        assert_eq!(world.handle(0).slot, 1);
        assert!(world.index_of(last).is_err());
    }
}
