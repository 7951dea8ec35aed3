//! Edits of forces. In the layout state they change the set-up too, later only the world.

use sim_core::Force;

use super::{Input, Session, State};

impl Session {
    /// Replaces a force.
    pub fn replace_force(&mut self, index: usize, force: Force) {
        self.edit_forces(|forces| {
            *forces.get_mut(index)? = force;
            Some(())
        });
    }

    /// Adds a force.
    pub fn add_force(&mut self, force: Force) {
        self.edit_forces(|forces| {
            forces.push(force);
            Some(())
        });
    }

    /// Removes a force.
    pub fn remove_force(&mut self, index: usize) {
        self.edit_forces(|forces| (index < forces.len()).then(|| drop(forces.remove(index))));
    }

    /// Changes the list of forces, unless the force to change does not exist.
    fn edit_forces(&mut self, change: impl FnOnce(&mut Vec<Force>) -> Option<()>) {
        let mut forces = self.world.forces().to_vec();
        if change(&mut forces).is_none() {
            let text = "There is no such force.";
            return self.notices.error("forces", text.to_owned());
        }
        match self.change(Input::Forces(forces)) {
            Ok(_) => {
                self.notices.dismiss("forces");
                self.disown_jobs();
                if self.state == State::Layout {
                    self.scene.forces = self.world.forces().to_vec();
                    self.edited();
                }
                self.begin_record();
            }
            Err(error) => self.notices.error("forces", error.text(&self.scene)),
        }
    }
}
