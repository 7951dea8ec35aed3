//! The world: the state of a scene, and its step.

mod bodies;
mod body_view;
mod column;
mod contact_features;
mod contacts;
mod continuous;
mod discrete;
mod elapsed;
mod error;
mod events;
mod exchange;
mod filter;
mod forces;
mod handle;
mod hash;
mod kind;
mod layout;
mod lever_system;
mod marks;
mod near;
mod order;
mod overlap;
mod penetration;
mod plan;
mod profile;
mod query;
mod record;
mod remove;
mod scene;
mod separate;
#[cfg(feature = "serde")]
mod snapshot;
mod state;
mod stepping;
mod system;
#[cfg(test)]
mod tests;
mod turning;
mod turning_start;

use alloc::{sync::Arc, vec::Vec};
use core::ops::RangeInclusive;
use glam::DVec3;

use crate::{Body, Bvh, Mesh, Shape, integrate::Method};
use bodies::Bodies;
pub use body_view::BodyView;
pub use contact_features::{ContactFeature, Touching};
pub use contacts::{Bundled, RestingContact};
use continuous::{ContactSet, Continuous};
use discrete::Discrete;
use elapsed::Elapsed;
pub use error::{StepError, WorldError};
pub use events::{ContactEvent, ContactEventKind};
pub use exchange::Impact;
pub use filter::Groups;
use forces::Forces;
pub use handle::BodyHandle;
use handle::Handles;
use layout::Layout;
use overlap::Overlaps;
pub use penetration::Overlap;
pub use profile::{Phase, Profile};
use record::Record;
use scene::scene;
pub use separate::SeparateError;
use state::State;
use stepping::{Cause, Integrator, Way};

/// Bodies, their motion, and their steps.
///
/// Bodies are named by the index that [`World::add`] returned. Methods that read a body panic on an index that does not
/// exist, as slices do; methods that change one return an error. Indices change when bodies are removed
/// ([`World::remove`]); a [`BodyHandle`] names the same body before and after.
///
/// ```
/// use sim_core::{Body, DVec3, Settings, World};
///
/// let mut world = World::new(Settings::default())?;
/// let stone = world.add(Body {
///     velocity: DVec3::new(2.0, 3.0, 0.0),
///     force: DVec3::new(0.0, -1.0, 0.0),
///     ..Body::default()
/// })?;
/// for _ in 0..60 {
///     world.step()?;
/// }
/// assert!((world.position(stone).x - 2.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize),
    serde(try_from = "snapshot::Snapshot")
)]
pub struct World {
    settings: Settings,
    elapsed: Elapsed,
    bodies: Bodies,
    handles: Handles,
    forces: Forces,
    /// Motion after the last step, at its start, and at the start of the step before.
    current: State,
    previous: State,
    earlier: State,
    /// Pairs that were placed in overlap.
    overlaps: Overlaps,
    /// The pairs in contact, and their normals.
    contacts: ContactSet,
    record: Record,
    // Caches of the phases of a step.
    integrator: Integrator,
    continuous: Continuous,
    discrete: Discrete,
    /// The tree for queries about bodies at their positions.
    index: query::Index,
}

/// The parameters of a world's steps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Settings {
    /// Length of a step, s; positive.
    pub dt: f64,
    /// Time integration. `serde` writes its name.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrate::by_name"))]
    pub method: &'static Method,
    /// How collisions are found.
    pub collision: Collision,
    /// Error that adaptive methods may make in a step, from 1e-15 to 1: relative, and absolute in m and m/s.
    pub tolerance: f64,
}

/// How collisions are found and resolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Collision {
    /// At the end of each step, by every edge of one mesh against every triangle of the other. Bodies that meet
    /// exchange an impulse and go back to the start of the step.
    Naive,
    /// The same through bounding volume hierarchies, with the same answers.
    Bvh,
    /// At the time of impact within the step: bodies continue with the rest of the step.
    Continuous,
}

impl Settings {
    /// Least and greatest tolerance.
    pub const TOLERANCES: RangeInclusive<f64> = 1e-15..=1.0;
}

impl Default for Settings {
    /// 60 Hz, velocity Verlet, continuous collisions; a tolerance of 1e-9.
    ///
    /// In free fall Verlet costs as much as symplectic Euler, and is exact.
    fn default() -> Settings {
        Settings {
            dt: 1.0 / 60.0,
            method: Method::named("velocity-verlet").expect("it is in the table"),
            collision: Collision::Continuous,
            tolerance: 1e-9,
        }
    }
}

impl World {
    /// An empty world at time 0.
    ///
    /// # Errors
    ///
    /// [`WorldError::Dt`] or [`WorldError::Tolerance`] out of range.
    pub fn new(settings: Settings) -> Result<World, WorldError> {
        error::check_dt(settings.dt)?;
        error::check_tolerance(settings.tolerance)?;
        Ok(World {
            settings,
            elapsed: Elapsed::default(),
            bodies: Bodies::default(),
            handles: Handles::default(),
            forces: Forces::default(),
            current: State::default(),
            previous: State::default(),
            earlier: State::default(),
            overlaps: Overlaps::default(),
            contacts: ContactSet::default(),
            record: Record::default(),
            integrator: Integrator::default(),
            continuous: Continuous::default(),
            discrete: Discrete::default(),
            index: query::Index::default(),
        })
    }

    /// Adds a body and returns its index: the number of bodies before. [`World::handle`] gives a name
    /// that remains valid when other bodies are removed.
    ///
    /// # Errors
    ///
    /// An error that names a field out of the range given at [`Body`]; the world stays as it was.
    pub fn add(&mut self, mut body: Body) -> Result<usize, WorldError> {
        let index = self.len();
        error::check_body(index, &body)?;
        let shape = body.shape.map(|shape| error::check_shape(index, shape));
        body.shape = shape.transpose()?;
        let turn = body.turn.map(|turn| turning::prepared(index, turn, &body));
        let turn = turn.transpose()?;
        self.push(body);
        if let Some(turn) = turn {
            self.push_turn(index, turn);
        }
        Ok(index)
    }

    /// Adds a body that has been checked.
    fn push(&mut self, body: Body) {
        let index = self.len();
        self.current.push(body.position, body.velocity);
        self.previous.push(body.position, body.velocity);
        self.bodies.push(body);
        self.bodies.acceleration[index] = self.constant_acceleration(index);
        self.handles.push();
        self.forces.forget_plan();
        self.integrator.forget_growth();
        self.note_placed(index);
    }

    /// Steps by `dt`: moves every body, and resolves the collisions as [`Settings::collision`]
    /// selects.
    ///
    /// On an error the world stays as it was before the step, to the bit.
    pub fn step(&mut self) -> Result<(), StepError> {
        if let Some(events) = &mut self.record.events {
            events.begin();
        }
        if self.continuous.is_dormant {
            self.record.contact_steps += u64::from(!self.contacts.is_empty());
        } else {
            self.move_on()?;
        }
        self.elapsed.steps += 1;
        if self.record.events.is_some() {
            self.list_events();
        }
        Ok(())
    }

    /// Moves every body by a step.
    fn move_on(&mut self) -> Result<(), StepError> {
        self.index.forget();
        self.seek_overlaps();
        self.make_plan();
        // The earlier state is kept until the step can no longer fail.
        core::mem::swap(&mut self.earlier, &mut self.previous);
        core::mem::swap(&mut self.previous, &mut self.current);
        self.current.match_len(&self.previous);
        let done = self.integrate().and_then(|()| self.collide());
        done.map_err(|(body, cause)| self.failed(body, cause))
    }

    /// Moves every body as if there were no contacts.
    fn integrate(&mut self) -> Result<(), (usize, Cause)> {
        let way = Way {
            contacts: &self.contacts,
            end: &mut self.current,
            horizons: &mut self.continuous.paths.horizons,
        };
        self.integrator.integrate(scene!(self), way)
    }

    /// Resolves impacts and lasting contacts.
    fn collide(&mut self) -> Result<(), (usize, Cause)> {
        if self.bodies.solid.len() < 2 {
            return self.turn_freely();
        }
        match self.settings.collision {
            Collision::Naive | Collision::Bvh => {
                self.turn_freely()?;
                self.collide_discretely();
                Ok(())
            }
            Collision::Continuous => self.collide_continuously(),
        }
    }

    /// [`World::step`], adding each impact to a list, in the order in which they happen.
    pub fn step_reporting(&mut self, impacts: &mut Vec<Impact>) -> Result<(), StepError> {
        self.record.list = Some(core::mem::take(impacts));
        let known = self.record.list.as_ref().map_or(0, Vec::len);
        let outcome = self.step();
        *impacts = self.record.list.take().unwrap_or_default();
        if outcome.is_err() {
            impacts.truncate(known);
        }
        outcome
    }

    /// The number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.mass.len()
    }

    /// Whether there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.mass.is_empty()
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.elapsed.time(&self.settings)
    }

    /// The number of completed steps.
    pub fn steps(&self) -> u64 {
        self.elapsed.steps
    }

    /// The number of impulses exchanged.
    pub fn impacts(&self) -> u64 {
        self.record.impacts
    }

    /// The latest impact.
    pub fn last_impact(&self) -> Option<&Impact> {
        self.record.last_impact.as_ref()
    }

    /// Position of a body, m.
    pub fn position(&self, body: usize) -> DVec3 {
        self.current.position[body]
    }

    /// Position one step before, m.
    pub fn previous_position(&self, body: usize) -> DVec3 {
        self.previous.position[body]
    }

    /// Position between the last two states, m: 0 gives the previous one, 1 the current one.
    pub fn interpolated(&self, body: usize, fraction: f64) -> DVec3 {
        self.previous_position(body)
            .lerp(self.position(body), fraction)
    }

    /// Velocity of a body, m/s.
    pub fn velocity(&self, body: usize) -> DVec3 {
        self.current.velocity[body]
    }

    /// Constant resultant force on a body, N.
    pub fn force(&self, body: usize) -> DVec3 {
        self.bodies.force[body]
    }

    /// Coefficient of restitution of a body; for two bodies the lesser value counts.
    pub fn restitution(&self, body: usize) -> f64 {
        self.bodies.restitution(body)
    }

    /// Coefficient of friction of a body ([`Body::friction`]); for two bodies the geometric mean counts.
    pub fn friction(&self, body: usize) -> f64 {
        self.bodies.friction(body)
    }

    /// The shape of a body; `None` for a point, which meets no other body.
    pub fn shape(&self, body: usize) -> Option<&Shape> {
        self.bodies.shape(body)
    }

    /// The mesh of a body, if it has one.
    pub fn mesh(&self, body: usize) -> Option<&Arc<Mesh>> {
        self.shape(body).and_then(Shape::mesh)
    }

    /// The tree over a body's mesh, if a step or query has built it.
    pub fn bvh(&self, body: usize) -> Option<&Bvh> {
        self.bodies.bvh(body)
    }

    /// Pairs of bodies that meet now by the exact test and were not placed in overlap, in order. There are none after
    /// a step. Intended for checks; it takes a box test for each near pair.
    pub fn meeting(&self) -> Vec<(usize, usize)> {
        let at = &self.current.position;
        let mut near = self.bodies.near_pairs(at, |_| 0.0);
        let known = self.overlapping();
        near.retain(|&(i, j)| {
            known.binary_search(&(i, j)).is_err() && self.bodies.meet_in(&self.current, i, j)
        });
        near
    }

    /// Builds the trees that no step has needed yet, to display them or to cast rays.
    pub fn build_bvhs(&mut self) {
        for body in 0..self.len() {
            self.bodies.need_bvh(body);
        }
    }

    /// Sets the position of a body, m, and its previous position to the same.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], or a component beyond ±1e100.
    pub fn set_position(&mut self, body: usize, position: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "position", position)?;
        self.current.position[body] = position;
        self.previous.position[body] = position;
        self.integrator.forget_growth();
        self.forget_contacts_of(body);
        self.note_placed(body);
        Ok(())
    }

    /// Sets a velocity, m/s.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], a component beyond ±1e100, or any but zero of a static body.
    pub fn set_velocity(&mut self, body: usize, velocity: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "velocity", velocity)?;
        error::check_kind(body, self.bodies.kind.get(body), velocity)?;
        self.current.velocity[body] = velocity;
        self.integrator.forget_growth();
        self.continuous.wake_all();
        Ok(())
    }

    /// Sets a constant resultant force, N.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], or a component beyond ±1e100.
    pub fn set_force(&mut self, body: usize, force: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "force", force)?;
        self.bodies.force[body] = force;
        self.bodies.acceleration[body] = self.constant_acceleration(body);
        self.continuous.wake_all();
        Ok(())
    }

    /// Sets the restitution of a body, 0 to 1.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], or [`WorldError::Restitution`] out of range.
    pub fn set_restitution(&mut self, body: usize, restitution: f64) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_restitution(body, restitution)?;
        self.bodies.restitution.set(body, restitution);
        self.continuous.wake_all();
        Ok(())
    }

    /// Sets the coefficient of friction of a body, 0 to infinity.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], or [`WorldError::Friction`] out of range.
    pub fn set_friction(&mut self, body: usize, friction: f64) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_friction(body, friction)?;
        self.bodies.friction.set(body, friction);
        self.continuous.wake_all();
        Ok(())
    }

    /// The settings of the steps.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings, from the next step on.
    ///
    /// # Errors
    ///
    /// [`WorldError::Dt`] or [`WorldError::Tolerance`] out of range.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), WorldError> {
        error::check_dt(settings.dt)?;
        error::check_tolerance(settings.tolerance)?;
        self.integrator.forget_growth();
        if settings.dt != self.settings.dt {
            self.elapsed.change_dt(&self.settings);
        }
        self.settings = settings;
        self.continuous.wake_all();
        Ok(())
    }

    /// The bodies at their current positions.
    fn layout(&self) -> Layout<'_> {
        Layout {
            bodies: &self.bodies,
            at: &self.current.position,
            turned: &self.current.turned,
            before: &self.previous,
            contacts: &self.contacts,
            overlaps: &self.overlaps,
        }
    }

    fn check_body(&self, body: usize) -> Result<(), WorldError> {
        let bodies = self.len();
        (body < bodies)
            .then_some(())
            .ok_or(WorldError::NoBody { body, bodies })
    }
}
