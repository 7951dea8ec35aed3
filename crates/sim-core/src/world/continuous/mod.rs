//! Impacts at the time at which they happen.

use super::{StepError, World};

impl World {
    pub(super) fn collide_continuously(&mut self) -> Result<(), StepError> {
        self.collide();
        Ok(())
    }
}
