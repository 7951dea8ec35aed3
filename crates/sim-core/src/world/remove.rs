//! Removal of bodies.

use super::{World, WorldError, continuous::Continuous, discrete::Discrete};
use crate::Body;

impl World {
    /// Removes a body from the world and returns it with its current properties. The indices of the bodies after it
    /// decrease by one, as in a vector; handles stay valid ([`World::handle`]). The cost is proportional to the
    /// number of bodies, as that of a step.
    ///
    /// The forces that name the body are removed too: springs, and drag, anchors or attraction of that body alone.
    /// [`World::forces`] keeps the others, in their order, with the new indices of bodies. Bodies that rested on it
    /// fall from the next step on. The number of impacts stays the same; the latest impact is dropped if the body was
    /// part of it. Bodies that were connected with it neither by contacts nor by forces continue to the bit as if it
    /// had never existed.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`]; for a handle, call [`World::index_of`] first.
    pub fn remove(&mut self, body: usize) -> Result<Body, WorldError> {
        self.check_body(body)?;
        let removed = self.body(body).to_body();
        let order = self.planned_order();
        self.forget_contacts_of(body);
        self.overlaps.remove_body(body);
        self.contacts.remove_body(body);
        self.record.remove_body(body);
        for state in [&mut self.current, &mut self.previous] {
            state.remove(body);
        }
        if let Some(slot) = self.bodies.turners.remove(body) {
            for state in [&mut self.current, &mut self.previous] {
                state.turned.remove(slot);
            }
        }
        self.handles.remove(body, self.bodies.len());
        self.bodies.remove(body);
        self.remove_forces_of(body);
        if let Some(mut order) = order {
            order.retain(|&other| other != body);
            order
                .iter_mut()
                .for_each(|other| *other -= usize::from(*other > body));
            self.plan_in_order(&order);
        }
        // Caches and events use the old indices.
        self.index.forget();
        if self.record.events.is_some() {
            self.record.events = Some(Default::default());
        }
        self.discrete = Discrete::default();
        self.continuous = Continuous::resumed(
            self.continuous.placed,
            self.continuous.knows_near(),
            self.continuous.bundled,
        );
        Ok(removed)
    }
}
