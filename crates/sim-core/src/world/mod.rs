//! The running state of a scene.

mod collision;
mod contact_features;
mod contacts;
mod continuous;
mod discrete;
mod error;
mod forces;
mod hash;
mod marks;
mod order;
mod overlap;
mod penetration;
mod plan;
mod profile;
mod separate;
mod state;
mod stepping;
mod system;
#[cfg(test)]
mod tests;

use alloc::{boxed::Box, collections::BTreeMap, sync::Arc, vec::Vec};
use core::ops::RangeInclusive;
use glam::DVec3;
use once_cell::race::OnceBox;

use crate::{
    Body, Bvh, Extent, Force, Mesh, Shape,
    collide::Form,
    integrate::{Method, Scratch},
};
pub use collision::Impact;
pub use contact_features::{ContactFeature, Touching};
pub use contacts::{Bundled, RestingContact};
use continuous::{ContactSet, Continuous};
use discrete::Discrete;
pub use error::{StepError, WorldError};
use marks::Marks;
use overlap::Placed;
pub use penetration::Overlap;
use plan::Plan;
use profile::Timer;
pub use profile::{Phase, Profile};
pub use separate::SeparateError;
use state::State;

/// Bodies, their motion, and how it goes on.
///
/// Bodies are named by the index that [`World::add`] returned. Methods that read one panic on an
/// index that does not exist, as slices do; methods that change one return an error.
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
pub struct World {
    settings: Settings,
    current: State,
    previous: State,
    /// The state before that, in a step, for who fails.
    earlier: State,
    mass: Vec<f64>,
    force: Vec<DVec3>,
    /// What constant forces and weight do to each body, m/s².
    acceleration: Vec<DVec3>,
    /// Acceleration by all weights.
    weight: DVec3,
    forces: Vec<Force>,
    /// Who is stepped with whom; `None` when bodies or forces have changed.
    plan: Option<Plan>,
    scratch: Scratch,
    /// Greatest component of a velocity, m/s, from which growth is counted; `None` before the
    /// first step under a force that depends on the motion.
    speed_scale: Option<f64>,
    /// The motion from which growth is counted, and on the way since.
    marks: Marks,
    /// What bodies keep of an approaching speed; empty while all are elastic.
    restitution: Vec<f64>,
    /// Coefficients of friction; empty while all bodies are smooth.
    friction: Vec<f64>,
    /// The shape of each body, as an index of `solids`; `None` is a point.
    shape: Vec<Option<u32>>,
    solids: Vec<Solid>,
    /// Where a shape is among the solids.
    known_shapes: BTreeMap<ShapeKey, u32>,
    /// The bodies that have a shape.
    solid: Vec<usize>,
    /// Pairs that began in overlap, in order; without those of bodies that have just been placed.
    overlapping: Vec<(usize, usize)>,
    placed: Placed,
    steps: u64,
    impacts: u64,
    contact_steps: u64,
    bundled: Bundled,
    last_impact: Option<Impact>,
    /// Where impacts are listed, while someone asks.
    report: Option<Vec<Impact>>,
    /// Reads a clock between phases, while someone asks.
    timer: Option<Timer>,
    /// Who is in touch, and along which normals.
    contacts: ContactSet,
    continuous: Continuous,
    discrete: Discrete,
    /// Time and step at which `dt` was last set: time since is steps times `dt`, without drift.
    since: (f64, u64),
}

/// A shape, shared by all bodies that have it, and its tree once one is needed.
#[derive(Clone, Debug)]
struct Solid {
    shape: Shape,
    extent: Extent,
    bvh: OnceBox<Arc<Bvh>>,
}

impl Solid {
    fn bvh(&self) -> Option<&Bvh> {
        self.bvh.get().map(|bvh| &**bvh)
    }
}

/// What makes two shapes the same: of meshes their place in memory, as comparing triangles takes too
/// long; of others the bits of their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ShapeKey {
    Mesh(usize),
    Sphere(u64),
    HalfSpace([u64; 3]),
}

impl ShapeKey {
    fn of(shape: &Shape) -> ShapeKey {
        match shape {
            Shape::Mesh(mesh) => ShapeKey::Mesh(Arc::as_ptr(mesh) as usize),
            Shape::Sphere { radius } => ShapeKey::Sphere(radius.to_bits()),
            Shape::HalfSpace { normal } => ShapeKey::HalfSpace(normal.to_array().map(f64::to_bits)),
        }
    }
}

/// How a world steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Length of a step, s; positive.
    pub dt: f64,
    /// Time integration.
    pub method: &'static Method,
    /// How collisions are found.
    pub collision: Collision,
    /// Error that adaptive methods may make in a step, from 1e-15 to 1: relative and, in m and
    /// m/s, absolute.
    pub tolerance: f64,
}

/// How collisions are found, and what follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Collision {
    /// At the end of each step, by every edge of one mesh against every triangle of the other.
    /// Bodies that meet exchange an impulse and go back to where the step began.
    Naive,
    /// The same through bounding volume hierarchies, with the same answers.
    Bvh,
    /// At the time of impact, wherever it is within the step: bodies go on with the rest of it.
    Continuous,
}

impl Settings {
    /// Least and greatest tolerance.
    pub const TOLERANCES: RangeInclusive<f64> = 1e-15..=1.0;
}

impl Default for Settings {
    /// 60 Hz, velocity Verlet, continuous collisions; a tolerance of 1e-9.
    ///
    /// Verlet costs what symplectic Euler does in free fall, and is exact there.
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
    pub fn new(settings: Settings) -> Result<World, WorldError> {
        error::check_dt(settings.dt)?;
        error::check_tolerance(settings.tolerance)?;
        Ok(World {
            settings,
            current: State::default(),
            previous: State::default(),
            earlier: State::default(),
            mass: Vec::new(),
            force: Vec::new(),
            acceleration: Vec::new(),
            weight: DVec3::ZERO,
            forces: Vec::new(),
            plan: None,
            scratch: Scratch::default(),
            speed_scale: None,
            marks: Marks::default(),
            restitution: Vec::new(),
            friction: Vec::new(),
            shape: Vec::new(),
            solids: Vec::new(),
            known_shapes: BTreeMap::new(),
            solid: Vec::new(),
            overlapping: Vec::new(),
            placed: Placed::default(),
            steps: 0,
            impacts: 0,
            contact_steps: 0,
            bundled: Bundled::default(),
            last_impact: None,
            report: None,
            timer: None,
            contacts: ContactSet::default(),
            continuous: Continuous::default(),
            discrete: Discrete::default(),
            since: (0.0, 0),
        })
    }

    /// Adds a body and returns its index: 0 for the first, and so on.
    pub fn add(&mut self, body: Body) -> Result<usize, WorldError> {
        let index = self.len();
        error::check_vector(index, "position", body.position)?;
        error::check_vector(index, "velocity", body.velocity)?;
        error::check_vector(index, "force", body.force)?;
        error::check_mass(index, body.mass)?;
        error::check_restitution(index, body.restitution)?;
        error::check_friction(index, body.friction)?;
        let shape = body.shape.map(|shape| error::check_shape(index, shape));
        let shape = shape.transpose()?.map(|shape| self.share(shape));
        self.current.push(body.position, body.velocity);
        self.previous.push(body.position, body.velocity);
        self.mass.push(body.mass);
        self.force.push(body.force);
        self.acceleration.push(self.constant_acceleration(index));
        self.plan = None;
        self.speed_scale = None;
        self.set_restitution_column(index, body.restitution);
        self.set_friction_column(index, body.friction);
        self.solid.extend(shape.map(|_| index));
        self.shape.push(shape);
        self.note_placed(index);
        Ok(index)
    }

    /// Steps by `dt`: moves every body, and lets those that meet bounce, as [`Settings::collision`]
    /// has it.
    ///
    /// On an error the world stays as it was before the step, to the bit.
    pub fn step(&mut self) -> Result<(), StepError> {
        self.seek_overlaps();
        // What was before is kept until nothing can fail any more.
        core::mem::swap(&mut self.earlier, &mut self.previous);
        core::mem::swap(&mut self.previous, &mut self.current);
        self.current.match_len(&self.previous);
        self.integrate()?;
        if self.solid.len() > 1 {
            match self.settings.collision {
                Collision::Naive | Collision::Bvh => self.collide(),
                Collision::Continuous => self.collide_continuously()?,
            }
        }
        self.steps += 1;
        Ok(())
    }

    /// [`World::step`], adding each impact to a list, in the order in which they happen.
    pub fn step_reporting(&mut self, impacts: &mut Vec<Impact>) -> Result<(), StepError> {
        self.report = Some(core::mem::take(impacts));
        let known = self.report.as_ref().map_or(0, Vec::len);
        let outcome = self.step();
        *impacts = self.report.take().unwrap_or_default();
        if outcome.is_err() {
            impacts.truncate(known);
        }
        outcome
    }

    /// How many bodies there are.
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        let (time, step) = self.since;
        time + (self.steps - step) as f64 * self.settings.dt
    }

    /// Steps done.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Impulses exchanged.
    pub fn impacts(&self) -> u64 {
        self.impacts
    }

    /// The latest exchange of an impulse.
    pub fn last_impact(&self) -> Option<&Impact> {
        self.last_impact.as_ref()
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

    /// Mass of a body, kg.
    pub fn mass(&self, body: usize) -> f64 {
        self.mass[body]
    }

    /// Constant resultant force on a body, N.
    pub fn force(&self, body: usize) -> DVec3 {
        self.force[body]
    }

    /// Part of the approaching speed with which a body leaves an impact; of two the lesser counts.
    pub fn restitution(&self, body: usize) -> f64 {
        self.restitution.get(body).copied().unwrap_or(1.0)
    }

    /// Coefficient of friction of a body ([`Body::friction`]); of two the geometric mean counts.
    pub fn friction(&self, body: usize) -> f64 {
        self.friction.get(body).copied().unwrap_or(0.0)
    }

    /// Shape of a body, unless it is a point that meets nothing.
    pub fn shape(&self, body: usize) -> Option<&Shape> {
        self.solid_of(body).map(|solid| &solid.shape)
    }

    /// Mesh of a body, if it has one.
    pub fn mesh(&self, body: usize) -> Option<&Arc<Mesh>> {
        self.shape(body).and_then(Shape::mesh)
    }

    /// Tree over a body's mesh, if one has been needed so far.
    pub fn bvh(&self, body: usize) -> Option<&Bvh> {
        self.solid_of(body).and_then(Solid::bvh)
    }

    /// Builds the trees that no step has needed yet, to look at them or to aim rays.
    pub fn build_bvhs(&mut self) {
        for body in 0..self.len() {
            self.need_bvh(body);
        }
    }

    /// Places a body, m. It starts afresh from there: its previous position is the same.
    pub fn set_position(&mut self, body: usize, position: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "position", position)?;
        self.current.position[body] = position;
        self.previous.position[body] = position;
        self.speed_scale = None;
        self.forget_contacts_of(body);
        self.note_placed(body);
        Ok(())
    }

    /// Sets a velocity, m/s.
    pub fn set_velocity(&mut self, body: usize, velocity: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "velocity", velocity)?;
        self.current.velocity[body] = velocity;
        self.speed_scale = None;
        self.continuous.wake_all();
        Ok(())
    }

    /// Sets a constant resultant force, N.
    pub fn set_force(&mut self, body: usize, force: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "force", force)?;
        self.force[body] = force;
        self.acceleration[body] = self.constant_acceleration(body);
        self.continuous.wake_all();
        Ok(())
    }

    /// Sets a mass, kg.
    pub fn set_mass(&mut self, body: usize, mass: f64) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_mass(body, mass)?;
        self.forget_contacts_of(body);
        self.mass[body] = mass;
        // Immovable bodies may be in each other.
        self.note_placed(body);
        self.acceleration[body] = self.constant_acceleration(body);
        self.speed_scale = None;
        Ok(())
    }

    /// Sets the restitution of a body, 0 to 1.
    pub fn set_restitution(&mut self, body: usize, restitution: f64) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_restitution(body, restitution)?;
        self.set_restitution_column(body, restitution);
        self.continuous.wake_all();
        Ok(())
    }

    /// Sets the coefficient of friction of a body, 0 to infinity.
    pub fn set_friction(&mut self, body: usize, friction: f64) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_friction(body, friction)?;
        self.set_friction_column(body, friction);
        Ok(())
    }

    /// How the world steps.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes how the world steps, from the next step on.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), WorldError> {
        error::check_dt(settings.dt)?;
        error::check_tolerance(settings.tolerance)?;
        self.speed_scale = None;
        if settings.dt != self.settings.dt {
            self.since = (self.time(), self.steps);
        }
        self.settings = settings;
        self.continuous.wake_all();
        Ok(())
    }

    fn check_body(&self, body: usize) -> Result<(), WorldError> {
        let bodies = self.len();
        (body < bodies)
            .then_some(())
            .ok_or(WorldError::NoBody { body, bodies })
    }

    fn set_restitution_column(&mut self, body: usize, restitution: f64) {
        if !self.restitution.is_empty() || restitution != 1.0 {
            self.restitution.resize(self.len(), 1.0);
            self.restitution[body] = restitution;
        }
    }

    fn set_friction_column(&mut self, body: usize, friction: f64) {
        if !self.friction.is_empty() || friction != 0.0 {
            self.friction.resize(self.len(), 0.0);
            self.friction[body] = friction;
        }
    }

    fn solid_of(&self, body: usize) -> Option<&Solid> {
        self.shape[body].map(|s| &self.solids[s as usize])
    }

    /// The index of a shape among the solids, which bodies with the same one share.
    fn share(&mut self, shape: Shape) -> u32 {
        let next = self.solids.len() as u32;
        let place = *self
            .known_shapes
            .entry(ShapeKey::of(&shape))
            .or_insert(next);
        if place == next {
            self.solids.push(Solid {
                extent: shape.extent(),
                shape,
                bvh: OnceBox::new(),
            });
        }
        place
    }

    fn need_bvh(&self, body: usize) {
        if let Some(Solid {
            shape: Shape::Mesh(mesh),
            bvh,
            ..
        }) = self.solid_of(body)
        {
            bvh.get_or_init(|| Box::new(Arc::new(Bvh::build(mesh))));
        }
    }

    /// How far a body's shape reaches about its position.
    fn extent(&self, body: usize) -> Extent {
        self.solid_of(body)
            .map_or_else(Extent::default, |solid| solid.extent)
    }

    /// A body's shape for questions about pairs; a mesh has one once its tree is built.
    fn form(&self, body: usize) -> Option<Form<'_>> {
        let solid = self.solid_of(body)?;
        match solid.shape {
            Shape::Mesh(_) => solid.bvh().map(Form::Mesh),
            Shape::Sphere { radius } => Some(Form::Sphere(radius)),
            Shape::HalfSpace { normal } => Some(Form::HalfSpace(normal)),
        }
    }
}
