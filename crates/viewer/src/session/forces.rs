//! Edits of forces. In the layout state they change the set-up too, later only the world.

use sim_core::{Force, WorldError};

use super::{Session, State};

impl Session {
    /// Puts a force in the place of another.
    pub fn replace_force(&mut self, index: usize, force: Force) {
        self.edit_forces(|session| session.world.replace_force(index, force));
    }

    /// Adds a force.
    pub fn add_force(&mut self, force: Force) {
        self.edit_forces(|session| session.world.add_force(force).map(drop));
    }

    /// Removes a force.
    pub fn remove_force(&mut self, index: usize) {
        self.edit_forces(|session| session.world.remove_force(index).map(drop));
    }

    fn edit_forces(&mut self, change: impl FnOnce(&mut Self) -> Result<(), WorldError>) {
        match change(self) {
            Ok(()) => {
                self.notices.dismiss("forces");
                self.disown_jobs();
                if self.state == State::Layout {
                    self.scene.forces = self.world.forces().to_vec();
                    self.edited();
                }
                self.begin_record();
            }
            Err(error) => self.notices.error("forces", error.to_string()),
        }
    }
}
