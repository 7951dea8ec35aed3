//! The inertia and rotation of turning bodies. Columns are indexed by slot, and are empty in a world without turning
//! bodies.

use alloc::vec::Vec;
use glam::{DMat3, DQuat, DVec3};

use super::{
    World, WorldError,
    bodies::Bodies,
    error,
    state::{State, Turned},
    stepping::Cause,
};
use crate::{
    Body, Extent, Inertia, Shape, Turn,
    collide::{
        self, Placement,
        turning::{Figure, Moving, Turning},
    },
    impulse::arms::{Twist, Yielding},
    rotation::{self, Flight},
};

/// The inertias, torques and sizes of turning bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Turners {
    /// For each body its slot, or [`NONE`]; only as long as the last turning body needs.
    slot: Vec<u32>,
    /// For each slot the body.
    pub(super) body: Vec<usize>,
    pub(super) inertia: Vec<Inertia>,
    /// The constant torque about the centre of mass, N m.
    pub(super) torque: Vec<DVec3>,
    /// The distance of the farthest point of the shape from the centre of mass, m.
    pub(super) radius: Vec<f64>,
}

const NONE: u32 = u32::MAX;

impl Turners {
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.body.is_empty()
    }

    /// The slot of a body, if it turns.
    #[inline]
    pub(super) fn slot(&self, body: usize) -> Option<usize> {
        let slot = *self.slot.get(body)?;
        (slot != NONE).then_some(slot as usize)
    }

    /// The inverse inertia of a body in the world, 1/(kg m²). `axes` is the rotation of its principal axes.
    pub(super) fn inverse_inertia(&self, slot: usize, axes: DQuat) -> DMat3 {
        let axes = DMat3::from_quat(axes);
        let inverse = DMat3::from_diagonal(self.inertia[slot].moments().recip());
        axes * inverse * axes.transpose()
    }

    fn push(&mut self, body: usize, turn: Prepared) {
        self.slot.resize(body, NONE);
        self.slot.push(self.body.len() as u32);
        self.body.push(body);
        self.inertia.push(turn.inertia);
        self.torque.push(turn.torque);
        self.radius.push(turn.radius);
    }

    /// Removes a body; the index of each body after it decreases by one. Returns its slot, if it had one.
    pub(super) fn remove(&mut self, body: usize) -> Option<usize> {
        let slot = self.slot(body);
        if body < self.slot.len() {
            self.slot.remove(body);
        }
        if let Some(slot) = slot {
            self.body.remove(slot);
            self.inertia.remove(slot);
            self.torque.remove(slot);
            self.radius.remove(slot);
            for other in self.slot.iter_mut().filter(|other| **other != NONE) {
                *other -= u32::from(*other as usize > slot);
            }
        }
        for other in &mut self.body {
            *other -= usize::from(*other > body);
        }
        slot
    }
}

impl Bodies {
    /// Whether the rotation of a body changes its shape in space. It does not for a ball about its centre of mass.
    #[inline]
    pub(super) fn tumbles(&self, body: usize) -> bool {
        !self.turners.is_empty() && self.slot_that_shows(body).is_some()
    }

    fn slot_that_shows(&self, body: usize) -> Option<usize> {
        let slot = self.turners.slot(body)?;
        let is_round = matches!(self.shape(body), Some(Shape::Sphere { .. }))
            && self.turners.inertia[slot].centre() == DVec3::ZERO;
        (!is_round).then_some(slot)
    }

    /// Whether one of two bodies tumbles.
    #[inline]
    pub(super) fn pair_tumbles(&self, i: usize, j: usize) -> bool {
        !self.turners.is_empty() && (self.tumbles(i) || self.tumbles(j))
    }

    /// The extent of a body's shape about its position for all rotations.
    #[inline(always)]
    pub(super) fn extent_however_turned(&self, body: usize) -> Extent {
        match self.turners.is_empty() {
            true => self.extent(body),
            false => self.extent_among_turning(body),
        }
    }

    // A separate function, so that worlds without turning bodies do not pay for its stack frame.
    #[inline(never)]
    fn extent_among_turning(&self, body: usize) -> Extent {
        match self.slot_that_shows(body) {
            Some(slot) => Extent::of_ball(self.turners.radius[slot]),
            None => self.extent(body),
        }
    }

    /// The rotation from a body's shape into the world.
    pub(super) fn rotation_in(&self, state: &State, body: usize) -> DQuat {
        self.rotation_among(&state.turned, body)
    }

    /// The same, given the rotations by slot.
    pub(super) fn rotation_among(&self, turned: &[Turned], body: usize) -> DQuat {
        match self.turners.slot(body) {
            Some(slot) => self.rotation_of(slot, &turned[slot]),
            None => DQuat::IDENTITY,
        }
    }

    /// The same for a turning body, given its slot.
    pub(super) fn rotation_of(&self, slot: usize, turned: &Turned) -> DQuat {
        (turned.rotation * self.turners.inertia[slot].axes().inverse()).normalize()
    }

    /// The centre of mass of a turning body in the shape's frame, m. The position of other bodies is the origin of the
    /// frame.
    pub(super) fn centre_of(&self, body: usize) -> DVec3 {
        let slot = self.turners.slot(body);
        slot.map_or(DVec3::ZERO, |slot| self.turners.inertia[slot].centre())
    }

    /// The position of the origin of a body's shape, m.
    pub(super) fn origin_in(&self, state: &State, body: usize) -> DVec3 {
        state.position[body] - self.rotation_in(state, body) * self.centre_of(body)
    }

    /// Whether two bodies meet in a state, by the exact test.
    pub(super) fn meet_in(&self, state: &State, i: usize, j: usize) -> bool {
        if !self.pair_tumbles(i, j) {
            return self.meet_at(i, j, state.position[j] - state.position[i]);
        }
        let placed = |body: usize| (state.position[body], self.rotation_in(state, body));
        self.meet_placed((i, placed(i)), (j, placed(j)))
    }

    /// The same for two meshes by every edge of one against every triangle of the other.
    pub(super) fn meet_naively_in(&self, state: &State, i: usize, j: usize) -> bool {
        let (Some(first), Some(second)) = (self.mesh(i), self.mesh(j)) else {
            return self.meet_in(state, i, j);
        };
        let swept = |body: usize| self.swept_box(body, state.position[body], state.position[body]);
        if !swept(i).meets(&swept(j)) {
            return false;
        }
        let placed = |body: usize| (state.position[body], self.rotation_in(state, body));
        let (a, b) = (placed(i), placed(j));
        let between = self.between((i, a), (j, b));
        turned_place(a.1, b.1, between)
            .is_some_and(|place| collide::naive::intersect(first, second, place))
    }

    /// The vector from the origin of one body's shape to that of another one, for given positions and rotations, m.
    fn between(
        &self,
        (i, (x, first)): (usize, (DVec3, DQuat)),
        (j, (y, second)): (usize, (DVec3, DQuat)),
    ) -> DVec3 {
        (y - second * self.centre_of(j)) - (x - first * self.centre_of(i))
    }

    /// Whether two bodies meet at given positions and rotations, by the exact test.
    pub(super) fn meet_placed(
        &self,
        (i, (x, first)): (usize, (DVec3, DQuat)),
        (j, (y, second)): (usize, (DVec3, DQuat)),
    ) -> bool {
        self.need_bvh(i);
        self.need_bvh(j);
        let between = self.between((i, (x, first)), (j, (y, second)));
        match (self.shape(i), self.shape(j)) {
            (Some(Shape::Mesh(_)), Some(Shape::Mesh(_))) => {
                let (Some(a), Some(b)) = (self.bvh(i), self.bvh(j)) else {
                    return false;
                };
                turned_place(first, second, between)
                    .is_some_and(|place| collide::tree::intersect(a, b, place))
            }
            // The rotation of a ball or half-space does not matter: test it in the frame of the mesh.
            (Some(Shape::Mesh(_)), Some(other)) => {
                self.meets_unturned(i, other, first.inverse() * between, first)
            }
            (Some(other), Some(Shape::Mesh(_))) => {
                self.meets_unturned(j, other, second.inverse() * -between, second)
            }
            _ => self
                .form(i)
                .zip(self.form(j))
                .is_some_and(|(a, b)| collide::meet(a, b, collide::snap(between))),
        }
    }

    /// Whether two meshes in a state certainly meet after every translation of one of them by at most `by`, m.
    pub(super) fn stay_in_each_other(
        &self,
        state: &State,
        (i, j): (usize, usize),
        by: f64,
    ) -> bool {
        let (Some(a), Some(b)) = (self.bvh(i), self.bvh(j)) else {
            return false;
        };
        let placed = |body: usize| (state.position[body], self.rotation_in(state, body));
        let (first, second) = (placed(i), placed(j));
        let between = self.between((i, first), (j, second));
        turned_place(first.1, second.1, between)
            .is_some_and(|place| collide::stay_in_each_other(a, b, place, by))
    }

    /// Whether a mesh with a given rotation meets a ball or a half-space at an offset in the mesh's frame.
    fn meets_unturned(&self, mesh: usize, other: &Shape, offset: DVec3, turned: DQuat) -> bool {
        let Some(form) = self.form(mesh) else {
            return false;
        };
        let other = match *other {
            Shape::Sphere { radius } => collide::Form::Sphere(radius),
            Shape::HalfSpace { normal } => collide::Form::HalfSpace(turned.inverse() * normal),
            Shape::Mesh(_) => return false,
        };
        collide::meet(form, other, collide::snap(offset))
    }

    /// A body as input of the search for turning contacts, with given position, velocity and acceleration.
    pub(super) fn moving<'a>(
        &'a self,
        body: usize,
        (position, velocity, acceleration): (DVec3, DVec3, DVec3),
        turning: Turning<'a>,
    ) -> Option<Moving<'a>> {
        let figure = match self.shape(body)? {
            Shape::Mesh(_) => Figure::Mesh(self.bvh(body)?),
            &Shape::Sphere { radius } => Figure::Ball(radius),
            &Shape::HalfSpace { normal } => Figure::HalfSpace(normal),
        };
        Some(Moving {
            figure,
            centre: self.centre_of(body),
            position,
            velocity,
            acceleration,
            turning,
        })
    }

    /// The velocity and angular velocity of a body in a state.
    pub(super) fn twist_in(&self, state: &State, body: usize) -> Twist {
        let spin = self.turners.slot(body).map_or(DVec3::ZERO, |slot| {
            let Turned { rotation, momentum } = state.turned[slot];
            rotation::spin(self.turners.inertia[slot].moments(), rotation, momentum)
        });
        Twist {
            velocity: state.velocity[body],
            spin,
        }
    }

    /// The response of a body to impulses in a state: its inverse mass and inverse inertia.
    pub(super) fn yielding_in(&self, state: &State, body: usize) -> Yielding {
        if !self.is_movable(body) {
            return Yielding {
                mass: 0.0,
                inertia: DMat3::ZERO,
            };
        }
        let inertia = match self.turners.slot(body) {
            Some(slot) if self.tumbles(body) => self
                .turners
                .inverse_inertia(slot, state.turned[slot].rotation),
            _ => DMat3::ZERO,
        };
        Yielding {
            mass: 1.0 / self.mass[body],
            inertia,
        }
    }
}

/// The placement of a mesh in the frame of another one. Both are rotated; `between` is the vector between their origins
/// in the world, m.
fn turned_place(first: DQuat, second: DQuat, between: DVec3) -> Option<Placement> {
    let to_first = first.inverse();
    Placement::turned((to_first * second).normalize(), to_first * between)
}

impl Turned {
    /// A rotation with the angular momentum of an angular velocity in the world, rad/s.
    fn spinning(inertia: &Inertia, rotation: DQuat, spin: DVec3) -> Turned {
        Turned {
            rotation,
            momentum: rotation * (inertia.moments() * (rotation.inverse() * spin)),
        }
    }
}

/// The inertia and the rotations of a turning body, as stored in a snapshot.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TurningState {
    pub(super) inertia: Inertia,
    pub(super) torque: DVec3,
    pub(super) now: Turned,
    /// The rotation at the start of the last step.
    pub(super) before: Turned,
}

/// The checked data of a turning body.
pub(super) struct Prepared {
    inertia: Inertia,
    torque: DVec3,
    radius: f64,
    turned: Turned,
}

/// Checks the rotation data of a body whose other data has been checked.
pub(super) fn prepared(index: usize, turn: Turn, body: &Body) -> Result<Prepared, WorldError> {
    error::check_vector(index, "spin", turn.spin)?;
    error::check_vector(index, "torque", turn.torque)?;
    if !turn.rotation.is_finite() || !turn.rotation.is_normalized() {
        return Err(WorldError::Rotation { body: index });
    }
    if let Some(Shape::HalfSpace { .. }) = body.shape {
        return Err(WorldError::TurningHalfSpace { body: index });
    }
    let is_movable = body.kind.is_movable();
    let of_shape = || match &body.shape {
        _ if !is_movable => Inertia::new(DVec3::ONE, DQuat::IDENTITY, DVec3::ZERO),
        Some(Shape::Mesh(mesh)) => Inertia::solid(mesh, body.mass),
        &Some(Shape::Sphere { radius }) => Inertia::ball(radius, body.mass),
        Some(Shape::HalfSpace { .. }) | None => Err(crate::InertiaError::Shapeless),
    };
    let refused = |error| WorldError::Inertia { body: index, error };
    let mut inertia = turn.inertia.map_or_else(of_shape, Ok).map_err(refused)?;
    let mut torque = turn.torque;
    if !is_movable {
        // The body is immovable: its spin is constant for any moments.
        let steady = Inertia::new(DVec3::ONE, DQuat::IDENTITY, inertia.centre());
        inertia = steady.map_err(refused)?;
        torque = DVec3::ZERO;
    }
    let rotation = (turn.rotation.normalize() * inertia.axes()).normalize();
    let turned = Turned::spinning(&inertia, rotation, turn.spin);
    error::check_vector(index, "angular momentum", turned.momentum)?;
    Ok(Prepared {
        turned,
        radius: radius_about(body.shape.as_ref(), inertia.centre()),
        inertia,
        torque,
    })
}

/// The distance of the farthest point of a shape from a centre in its frame, m.
fn radius_about(shape: Option<&Shape>, centre: DVec3) -> f64 {
    match shape {
        Some(Shape::Mesh(mesh)) => mesh
            .vertices()
            .iter()
            .map(|v| (v.as_dvec3() - centre).length())
            .fold(0.0, f64::max),
        Some(&Shape::Sphere { radius }) => radius + centre.length(),
        Some(Shape::HalfSpace { .. }) | None => 0.0,
    }
}

impl World {
    /// Makes a body that was just added a turning body, and restores its previous and current rotation to the bit.
    #[cfg(feature = "serde")]
    pub(super) fn resume_turn(&mut self, body: usize, turn: TurningState) {
        let prepared = Prepared {
            radius: radius_about(self.shape(body), turn.inertia.centre()),
            inertia: turn.inertia,
            torque: turn.torque,
            turned: turn.now,
        };
        self.push_turn(body, prepared);
        if let Some(previous) = self.previous.turned.last_mut() {
            *previous = turn.before;
        }
    }

    /// The inertia of a turning body, and its previous and current rotation.
    #[cfg(feature = "serde")]
    pub(super) fn turning_state(&self, body: usize) -> Option<TurningState> {
        let slot = self.bodies.turners.slot(body)?;
        Some(TurningState {
            inertia: self.bodies.turners.inertia[slot],
            torque: self.bodies.turners.torque[slot],
            now: self.current.turned[slot],
            before: self.previous.turned[slot],
        })
    }

    /// Makes a body that was just added a turning body.
    pub(super) fn push_turn(&mut self, body: usize, turn: Prepared) {
        self.current.turned.push(turn.turned);
        self.previous.turned.push(turn.turned);
        self.bodies.turners.push(body, turn);
    }

    /// The turning bodies.
    pub(crate) fn turning_bodies(&self) -> impl Iterator<Item = usize> + '_ {
        self.bodies.turners.body.iter().copied()
    }

    /// Rotates all turning bodies as in free flight, except those that the method has rotated.
    pub(super) fn turn_freely(&mut self) -> Result<(), (usize, Cause)> {
        let Turners {
            body,
            inertia,
            torque,
            ..
        } = &self.bodies.turners;
        let dt = self.settings.dt;
        for (slot, &body) in body.iter().enumerate() {
            if self.forces.plan.is_levered(body) && self.bodies.is_movable(body) {
                continue;
            }
            let Turned { rotation, momentum } = self.previous.turned[slot];
            let moments = inertia[slot].moments();
            let flight = Flight::new(moments, rotation, momentum, torque[slot], dt)
                .map_err(|error| (body, Cause::Turning(error)))?;
            self.current.turned[slot] = Turned {
                rotation: flight.rotation_at(dt),
                momentum: flight.momentum_at(dt),
            };
        }
        Ok(())
    }

    /// Sets the rotation of a body's shape, a unit quaternion. The body keeps its spin.
    pub fn set_rotation(&mut self, body: usize, rotation: DQuat) -> Result<(), WorldError> {
        self.check_body(body)?;
        if !rotation.is_finite() || !rotation.is_normalized() {
            return Err(WorldError::Rotation { body });
        }
        let slot = self.slot_of(body)?;
        let inertia = self.bodies.turners.inertia[slot];
        let spin = self.spin(body);
        let rotation = (rotation.normalize() * inertia.axes()).normalize();
        let turned = Turned::spinning(&inertia, rotation, spin);
        self.current.turned[slot] = turned;
        self.previous.turned[slot] = turned;
        self.forget_contacts_of(body);
        self.note_placed(body);
        Ok(())
    }

    /// Sets the angular velocity of a turning body, in the world, rad/s.
    pub fn set_spin(&mut self, body: usize, spin: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "spin", spin)?;
        let slot = self.slot_of(body)?;
        let inertia = self.bodies.turners.inertia[slot];
        let rotation = self.current.turned[slot].rotation;
        let turned = Turned::spinning(&inertia, rotation, spin);
        error::check_vector(body, "angular momentum", turned.momentum)?;
        self.current.turned[slot] = turned;
        Ok(())
    }

    fn slot_of(&self, body: usize) -> Result<usize, WorldError> {
        let slot = self.bodies.turners.slot(body);
        slot.ok_or(WorldError::DoesNotTurn { body })
    }

    /// Scales the inertia of a turning body to another mass. The body keeps its spin.
    pub(super) fn scale_inertia(&mut self, body: usize, mass: f64) -> Result<(), WorldError> {
        let Some(slot) = self.bodies.turners.slot(body) else {
            return Ok(());
        };
        if !self.bodies.is_movable(body) {
            return Ok(());
        }
        let ratio = mass / self.mass(body);
        let old = self.bodies.turners.inertia[slot];
        let new = Inertia::new(ratio * old.moments(), old.axes(), old.centre());
        let momentum = ratio * self.current.turned[slot].momentum;
        error::check_vector(body, "angular momentum", momentum)?;
        self.bodies.turners.inertia[slot] =
            new.map_err(|error| WorldError::Inertia { body, error })?;
        for state in [&mut self.current, &mut self.previous] {
            state.turned[slot].momentum *= ratio;
        }
        Ok(())
    }

    /// The rotation of a body and how it changes; `None` if the body cannot rotate.
    pub fn turn(&self, body: usize) -> Option<Turn> {
        let slot = self.bodies.turners.slot(body)?;
        Some(Turn {
            rotation: self.rotation(body),
            spin: self.spin(body),
            torque: self.bodies.turners.torque[slot],
            inertia: Some(self.bodies.turners.inertia[slot]),
        })
    }

    /// Whether a body can rotate.
    pub fn turns(&self, body: usize) -> bool {
        self.bodies.turners.slot(body).is_some()
    }

    /// The rotation from a body's shape into the world.
    pub fn rotation(&self, body: usize) -> DQuat {
        self.bodies.rotation_in(&self.current, body)
    }

    /// The position of the origin of a body's shape, m. It differs from the body's position if the body turns about a
    /// centre of mass elsewhere.
    pub fn origin(&self, body: usize) -> DVec3 {
        match self.turns(body) {
            true => self.bodies.origin_in(&self.current, body),
            false => self.position(body),
        }
    }

    /// Angular velocity of a body in the world, rad/s.
    pub fn spin(&self, body: usize) -> DVec3 {
        self.bodies.twist_in(&self.current, body).spin
    }

    /// Angular momentum of a body about its centre of mass, kg m²/s; zero for a body that cannot rotate or is
    /// immovable.
    pub fn angular_momentum(&self, body: usize) -> DVec3 {
        let slot = self.bodies.turners.slot(body);
        let slot = slot.filter(|_| self.bodies.is_movable(body));
        slot.map_or(DVec3::ZERO, |slot| self.current.turned[slot].momentum)
    }

    /// Inertia of a turning body.
    pub fn inertia(&self, body: usize) -> Option<&Inertia> {
        let slot = self.bodies.turners.slot(body)?;
        Some(&self.bodies.turners.inertia[slot])
    }

    /// Position of a shape's origin (m) and rotation between the last two states: 0 gives the previous state, 1 the
    /// current one. Rotations are interpolated on the sphere, along the shorter arc.
    pub fn interpolated_pose(&self, body: usize, fraction: f64) -> (DVec3, DQuat) {
        let place = self.interpolated(body, fraction);
        if !self.turns(body) {
            return (place, DQuat::IDENTITY);
        }
        let before = self.bodies.rotation_in(&self.previous, body);
        let rotation = before.slerp(self.rotation(body), fraction);
        (place - rotation * self.bodies.centre_of(body), rotation)
    }
}
