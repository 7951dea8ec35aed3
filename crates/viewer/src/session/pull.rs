//! Pulls a body by a spring while physics runs. When released, the body keeps its velocity: it is thrown.

use std::f64::consts::TAU;

use sim_core::{DVec3, Force};

use super::{Session, State};

/// The natural frequency of the body on the spring alone, Hz, and the fraction of critical damping: firm, and stable
/// with every method at the usual rates.
const FREQUENCY: f64 = 1.5;
const DAMPING: f64 = 0.7;

/// A body that is being pulled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    body: usize,
    /// The index of the spring among the forces.
    force: usize,
    /// The point where the body is held, relative to the point of attachment, m. A turning body is attached where it is
    /// held.
    grip: DVec3,
    /// The depth of the held point in front of the eye, along the view, m.
    depth: f64,
}

impl Session {
    /// Takes hold of the body that a ray meets, if physics runs and the body is movable. Returns whether it did.
    pub fn take_hold(&mut self, origin: DVec3, direction: DVec3) -> bool {
        self.let_go();
        if self.state != State::Running {
            return false;
        }
        let Some((along, body)) = self.hit(origin, direction) else {
            return false;
        };
        let mass = self.world.mass(body);
        if !self.world.kind(body).is_movable() {
            let name = &self.scene.bodies[body].name;
            let text = format!("{name} is immovable, so nothing pulls it.");
            self.notices.info("pull", text);
            return false;
        }
        let point = origin + along * direction;
        let rate = TAU * FREQUENCY;
        let turned = self.shown_rotation(body);
        let held = turned.inverse() * (point - self.shown_position(body));
        let (tied, anchor, grip) = match self.world.turns(body) {
            true => (Some(held), self.world.point_of(body, held), DVec3::ZERO),
            false => {
                let grip = point - self.shown_centre(body);
                (None, self.world.position(body), grip)
            }
        };
        let spring = Force::Anchor {
            body,
            point: tied,
            anchor,
            rest_length: 0.0,
            stiffness: mass * rate * rate,
            damping: 2.0 * DAMPING * mass * rate,
        };
        match self.world.add_force(spring) {
            Ok(force) => {
                self.pull = Some(Pull {
                    body,
                    force,
                    grip,
                    depth: (point - self.camera.eye()).dot(self.camera.forward()),
                });
                self.select(Some(body));
                self.disown_jobs();
                self.begin_record();
                true
            }
            Err(error) => {
                self.notices.error("pull", error.to_string());
                false
            }
        }
    }

    /// Pulls the held body to the point of a ray at the depth at which it was taken.
    pub fn pull(&mut self, origin: DVec3, direction: DVec3) {
        let Some(pull) = self.pull else { return };
        let forward = self.camera.forward();
        let ahead = direction.dot(forward);
        let along = (pull.depth - (origin - self.camera.eye()).dot(forward)) / ahead;
        let place = origin + along * direction - pull.grip;
        let mut spring = self.world.forces().get(pull.force).cloned();
        let Some(Force::Anchor { body, anchor, .. }) = &mut spring else {
            self.pull = None;
            return;
        };
        if *body != pull.body || *anchor == place || !place.is_finite() {
            return;
        }
        *anchor = place;
        if spring.is_some_and(|spring| self.world.replace_force(pull.force, spring).is_ok()) {
            self.disown_jobs();
            self.begin_record();
        }
    }

    /// Whether a body is held.
    pub fn is_pulling(&self) -> bool {
        self.pull.is_some()
    }

    /// Releases the held body.
    pub fn let_go(&mut self) {
        let Some(pull) = self.pull.take() else {
            return;
        };
        let held = self.world.forces().get(pull.force);
        if matches!(held, Some(Force::Anchor { body, .. }) if *body == pull.body)
            && self.world.remove_force(pull.force).is_ok()
        {
            self.disown_jobs();
            self.begin_record();
        }
    }
}
