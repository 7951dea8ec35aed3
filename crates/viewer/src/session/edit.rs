//! Edits of bodies. In the layout state they change the set-up, later only the world. A refused value changes nothing,
//! and a message gives the reason.

use scene::{SceneBody, SceneShape, SceneTurn};
use sim_core::DVec3;

use super::{Input, Session, State};

impl Session {
    /// Moves the origin of the selected body to `position`, m.
    pub fn set_position(&mut self, position: DVec3) {
        let edited = self.edit(
            "position",
            |i| Input::Position(i, position),
            |body| {
                body.position = position;
            },
        );
        if edited && self.display.trails {
            self.trails.begin(&self.world);
        }
    }

    /// Gives the selected body a velocity, m/s.
    pub fn set_velocity(&mut self, velocity: DVec3) {
        self.edit(
            "velocity",
            |i| Input::Velocity(i, velocity),
            |body| body.velocity = velocity,
        );
    }

    /// Gives the selected turning body an angular velocity, rad/s.
    pub fn set_spin(&mut self, spin: DVec3) {
        self.edit(
            "spin",
            |i| Input::Spin(i, spin),
            |body| {
                if let Some(turn) = &mut body.turn {
                    turn.spin = spin;
                }
            },
        );
    }

    /// Makes the selected body a turning body, or one that only translates. Layout only.
    pub fn set_turns(&mut self, turns: bool) {
        self.edit_shape("turns", |body| {
            body.turn = turns.then(SceneTurn::default);
        });
    }

    /// Applies a constant force to the selected body, N.
    pub fn set_force(&mut self, force: DVec3) {
        self.edit(
            "force",
            |i| Input::Force(i, force),
            |body| body.force = force,
        );
    }

    /// Gives the selected body a mass, kg, positive; the body becomes movable.
    pub fn set_mass(&mut self, mass: f64) {
        let turns = self.selection.is_some_and(|i| self.world.turns(i));
        if turns && self.state == State::Layout {
            // The inertia changes with the mass.
            return self.edit_shape("mass", |body| (body.mass, body.immovable) = (mass, false));
        }
        self.edit(
            "mass",
            |i| Input::Mass(i, mass),
            |body| (body.mass, body.immovable) = (mass, false),
        );
    }

    /// Makes the selected body immovable, or movable again with its former mass.
    pub fn set_immovable(&mut self, immovable: bool) {
        let Some(i) = self.selection else { return };
        let turns = self.world.turns(i) && self.state == State::Layout;
        if immovable && turns {
            self.edit_shape("mass", |body| body.immovable = true);
        } else if immovable {
            self.edit("mass", Input::Immovable, |body| body.immovable = true);
        } else {
            self.set_mass(self.world.mass(i));
        }
    }

    /// Sets the coefficient of restitution of the selected body, 0 to 1.
    pub fn set_restitution(&mut self, restitution: f64) {
        self.edit(
            "restitution",
            |i| Input::Restitution(i, restitution),
            |body| body.restitution = restitution,
        );
    }

    /// Gives the selected body a coefficient of friction, from 0 to infinity.
    pub fn set_friction(&mut self, friction: f64) {
        self.edit(
            "friction",
            |i| Input::Friction(i, friction),
            |body| body.friction = friction,
        );
    }

    /// Gives the selected body another shape. Layout only.
    pub fn set_shape(&mut self, shape: SceneShape) {
        self.edit_shape("shape", |body| body.shape = shape);
    }

    /// Rotates the selected body: degrees about the fixed axes x, then y, then z. Layout only.
    pub fn set_rotation(&mut self, rotation: DVec3) {
        self.edit_shape("rotation", |body| body.rotation = rotation);
    }

    /// Scales the selected body along its own axes; not 0. Layout only.
    pub fn set_scale(&mut self, scale: DVec3) {
        self.edit_shape("scale", |body| body.scale = scale);
    }

    /// Gives the selected body a new name, which must be unique.
    pub fn rename_selected(&mut self, name: &str) {
        let (Some(i), name) = (self.selection, name.trim()) else {
            return;
        };
        let bodies = &self.scene.bodies;
        let before = bodies[i].name.clone();
        if name == before {
            return;
        }
        if name.is_empty() || bodies.iter().any(|body| body.name == name) {
            let text = match name.is_empty() {
                true => "A body needs a name.".to_owned(),
                false => format!("Another body is called {name}."),
            };
            return self.notices.error("rename", text);
        }
        if self.hidden.remove(&before) {
            self.hidden.insert(name.to_owned());
        }
        name.clone_into(&mut self.scene.bodies[i].name);
        self.notices.dismiss("rename");
        self.edited();
    }

    /// Whether a body is hidden in the picture.
    pub fn is_hidden(&self, body: usize) -> bool {
        let body = self.scene.bodies.get(body);
        body.is_some_and(|body| self.hidden.contains(&body.name))
    }

    /// Hides a body in the picture, or shows it again; it moves and collides in either case.
    pub fn hide(&mut self, body: usize, hidden: bool) {
        let Some(body) = self.scene.bodies.get(body) else {
            return;
        };
        match hidden {
            true => self.hidden.insert(body.name.clone()),
            false => self.hidden.remove(&body.name),
        };
    }

    /// Sets the selected body's colour, sRGB, each part from 0 to 1.
    pub fn set_colour(&mut self, colour: [f32; 3]) {
        if let Some(body) = self.selection.and_then(|i| self.scene.bodies.get_mut(i)) {
            body.colour = Some(colour);
            self.edited();
        }
    }

    /// Removes the selected body. Layout only.
    pub fn delete_selected(&mut self) {
        let Some(i) = self.selected_in_layout("delete") else {
            return;
        };
        let before = self.scene.clone();
        let name = before.bodies[i].name.clone();
        let forces = self.scene.remove_body(i);
        if !self.rebuild("delete", |scene| *scene = before) {
            return;
        }
        self.select(None);
        let text = match forces {
            0 => format!("Deleted {name}."),
            1 => format!("Deleted {name} and a force that named it."),
            _ => format!("Deleted {name} and {forces} forces that named it."),
        };
        self.notices.info("delete", text);
    }

    /// Adds a copy of the selected body beside all others and selects it. Layout only.
    pub fn duplicate_selected(&mut self) {
        let Some(i) = self.selected_in_layout("duplicate") else {
            return;
        };
        self.add_body(self.scene.bodies[i].clone());
    }

    /// Adds a body beside all others, with a unique name, and selects it.
    pub(super) fn add_body(&mut self, mut body: SceneBody) {
        body.name = self.unused_name(&body.name);
        body.position = self.free_place(&body);
        self.scene.bodies.push(body);
        let added = self.rebuild("add", |scene| {
            scene.bodies.pop();
        });
        if added {
            self.select(self.world.len().checked_sub(1));
        }
    }

    /// Applies a change to the selected body of the world and, in the layout state, of the scene. Returns whether it
    /// succeeded.
    fn edit(
        &mut self,
        field: &'static str,
        input: impl FnOnce(usize) -> Input,
        keep: impl FnOnce(&mut SceneBody),
    ) -> bool {
        let Some(i) = self.selection else {
            return false;
        };
        match self.change(input(i)) {
            Ok(_) => {
                self.notices.dismiss(field);
                self.disown_jobs();
                if self.state == State::Layout {
                    keep(&mut self.scene.bodies[i]);
                    self.edited();
                }
                self.begin_record();
                true
            }
            Err(error) => {
                self.notices.error(field, error.text(&self.scene));
                false
            }
        }
    }

    /// Applies a change of the set-up that requires new geometry.
    fn edit_shape(&mut self, field: &'static str, change: impl FnOnce(&mut SceneBody)) {
        let Some(i) = self.selected_in_layout(field) else {
            return;
        };
        let before = self.scene.bodies[i].clone();
        change(&mut self.scene.bodies[i]);
        self.rebuild(field, |scene| scene.bodies[i] = before);
    }

    /// The selected body, if the set-up can be changed now; otherwise a message says why not.
    fn selected_in_layout(&mut self, field: &'static str) -> Option<usize> {
        let i = self.selection?;
        if self.state == State::Layout {
            return Some(i);
        }
        self.notices.error(
            field,
            format!("Reset first: {field} changes the layout, and physics has begun."),
        );
        None
    }

    /// Makes the world again from a changed scene, or reverts the change. Returns whether it succeeded.
    fn rebuild(&mut self, about: &'static str, take_back: impl FnOnce(&mut scene::Scene)) -> bool {
        match self.scene.world() {
            Ok(world) => {
                self.notices.dismiss(about);
                self.edited();
                self.adopt(world);
                true
            }
            Err(error) => {
                take_back(&mut self.scene);
                self.notices.error(about, error.to_string());
                false
            }
        }
    }

    /// `wish`, or `wish 2`, `wish 3`, ... if that name is in use.
    fn unused_name(&self, wish: &str) -> String {
        let taken = |name: &str| self.scene.bodies.iter().any(|body| body.name == name);
        std::iter::once(wish.to_owned())
            .chain((2..).map(|n| format!("{wish} {n}")))
            .find(|name| !taken(name))
            .unwrap_or_default()
    }
}
