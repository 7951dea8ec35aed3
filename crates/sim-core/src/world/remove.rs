//! Removal of bodies.

use super::{World, WorldError, continuous::Continuous, discrete::Discrete};
use crate::Body;

impl World {
    /// Takes a body out of the world and returns it as it was. The indices of those after it are one less
    /// from then on, as in a vector; handles stay ([`World::handle`]). Time grows with the number of
    /// bodies, as that of a step does.
    ///
    /// The forces that name it go with it: springs, and drag, anchors or attraction of that body alone.
    /// [`World::forces`] holds the others, in their order, with the indices that bodies have now. What lay on
    /// it falls from the next step on. The count of impacts stays, and the latest impact is forgotten if
    /// the body was in it. Bodies with which it was in touch neither directly nor by forces go on to the bit as
    /// if it had never been there.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`]; for a handle ask [`World::index_of`] first.
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
        // What is kept to save time is about other indices, and so are events.
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
