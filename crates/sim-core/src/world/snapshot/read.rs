//! A world from a snapshot: any input gives a valid world or an error.

use alloc::{collections::BTreeMap, format, string::String, string::ToString, vec::Vec};
use glam::{DQuat, DVec3};

use super::{BodyState, Growth, KnownOverlap, Snapshot, TurningState, VERSION};
use crate::{
    Body, Feature, Impact, Shape, World, WorldError,
    rotation::spin,
    world::{
        continuous::{ContactConstraint, ContactSet, Continuous},
        error::{LARGEST, check_body, check_shape, check_vector},
        handle::Handles,
        marks::Marks,
        overlap::Overlaps,
    },
};

/// More than any run counts; sums of such counts do not overflow.
const MOST_COUNTED: u64 = 1 << 53;

/// The most that the square of a unit vector's length may differ from 1.
const UNIT: f64 = 1e-9;

impl TryFrom<Snapshot> for World {
    type Error = String;

    fn try_from(data: Snapshot) -> Result<World, String> {
        if data.version != VERSION {
            let Snapshot { version, .. } = data;
            return Err(format!(
                "the world is of version {version} of the format: this is {VERSION}"
            ));
        }
        let mut world = World::new(data.settings).map_err(|error| error.to_string())?;
        world.read_bodies(data.bodies, &data.shapes)?;
        for (i, j) in data.ignored {
            let done = world.ignore_pair(i, j);
            done.map_err(|error| error.to_string())?;
        }
        for force in data.forces {
            let added = world.add_force(force).map(drop);
            added.map_err(|error| error.to_string())?;
        }
        if let Some(order) = data.order {
            order.iter().try_for_each(|&body| world.is_there(body))?;
            world.plan_in_order(&order);
        }
        let handles = Handles::in_slots(data.slots, data.free_slots, world.len());
        world.handles = handles.ok_or("each body must have one slot, and a free slot no body")?;
        world.read_elapsed(data.steps, data.since)?;
        world.overlaps = world.read_overlaps(&data.overlaps)?;
        world.check_contacts(&data.contacts)?;
        data.bundled
            .iter()
            .try_for_each(|&body| world.is_there(body))?;
        world.contacts = ContactSet::in_places(
            data.contacts,
            data.contacts_of,
            &data.bundled,
            &world.bodies,
        )
        .ok_or("each contact must be listed with its movable bodies, once, and no other")?;
        world.build_trees_in_touch();
        world.continuous = Continuous::resumed(data.placed, data.knows_near, data.bundled_in_step);
        data.asleep
            .iter()
            .try_for_each(|&body| world.is_there(body))?;
        world
            .continuous
            .put_to_sleep(&data.asleep, world.bodies.len());
        if let Some(impact) = &data.last_impact {
            world.check_impact(impact)?;
        }
        if data.impacts.max(data.contact_steps) > MOST_COUNTED {
            return Err(format!("no run counts beyond {MOST_COUNTED}"));
        }
        world.record.impacts = data.impacts;
        world.record.last_impact = data.last_impact;
        world.record.contact_steps = data.contact_steps;
        if let Some(growth) = data.growth {
            world.read_growth(growth)?;
        }
        // The step relies on this invariant; without it, it may take very long.
        if let Some((i, j)) = world.meeting().first() {
            return Err(format!(
                "bodies {i} and {j} meet, and are not listed among the overlaps"
            ));
        }
        Ok(world)
    }
}

impl World {
    fn read_bodies(&mut self, bodies: Vec<BodyState>, shapes: &[Shape]) -> Result<(), String> {
        for (index, data) in bodies.into_iter().enumerate() {
            let shape = data.shape.map(|place| {
                let shape = shapes.get(place);
                shape.ok_or_else(|| format!("body {index}: there is no shape {place}"))
            });
            let shape = shape.transpose()?;
            shape.map_or(Ok(()), |shape| check_shape_of(index, shape))?;
            check_vector(index, "previous position", data.previous_position)
                .map_err(|error| error.to_string())?;
            let body = Body {
                shape: shape.cloned(),
                kind: data.kind,
                position: data.position,
                velocity: data.velocity,
                mass: data.mass,
                force: data.force,
                restitution: data.restitution,
                friction: data.friction,
                groups: data.groups,
                user_data: data.user_data,
                turn: None,
            };
            check_body(index, &body).map_err(|error| error.to_string())?;
            let turn = data.turn.map(|turn| turn.checked(index, &body));
            let turn = turn.transpose()?;
            self.push(body);
            self.previous.position[index] = data.previous_position;
            if let Some(turn) = turn {
                self.resume_turn(index, turn);
            }
        }
        Ok(())
    }

    fn read_elapsed(&mut self, steps: u64, since: (f64, u64)) -> Result<(), String> {
        let is_sound =
            (0.0..=LARGEST).contains(&since.0) && since.1 <= steps && steps <= MOST_COUNTED;
        if !is_sound {
            return Err(format!("{steps} steps, counted since {since:?}, are none"));
        }
        self.elapsed.steps = steps;
        self.elapsed.since = since;
        Ok(())
    }

    fn read_overlaps(&self, overlaps: &[KnownOverlap]) -> Result<Overlaps, String> {
        let pairs: Vec<(usize, usize)> = overlaps.iter().map(|known| known.bodies).collect();
        if !pairs.is_sorted_by(|one, next| one < next) {
            return Err("overlaps must be in order, each once".into());
        }
        let mut depths = BTreeMap::new();
        for known in overlaps {
            self.check_pair_of("overlap", known.bodies)?;
            if let Some(depth) = known.depth_at_start {
                check_numbers("overlap", &[depth])?;
                depths.insert(known.bodies, depth);
            }
        }
        Ok(Overlaps::known(pairs, depths))
    }

    fn check_contacts(&self, contacts: &[ContactConstraint]) -> Result<(), String> {
        for contact in contacts {
            self.check_pair_of("contact", contact.bodies)?;
            if !contact.is_sound() {
                return Err("a contact has a number that is none, or out of range".into());
            }
            check_unit("contact", contact.normal)?;
        }
        Ok(())
    }

    fn check_impact(&self, impact: &Impact) -> Result<(), String> {
        let (i, j) = impact.bodies;
        self.is_there(i)?;
        self.is_there(j)?;
        let vectors = [impact.point, impact.positions.0, impact.positions.1];
        vectors
            .iter()
            .try_for_each(|vector| check_numbers("impact", &vector.to_array()))?;
        let (closing, parting) = impact.speeds;
        check_numbers("impact", &[impact.time, impact.impulse, closing, parting])?;
        check_unit("impact", impact.normal)?;
        let (first, second) = impact.rotations;
        if ![first, second]
            .iter()
            .all(|turned| turned.is_finite() && turned.is_normalized())
        {
            return Err(
                "the latest impact is of bodies that are not turned by unit quaternions".into(),
            );
        }
        let Some(feature) = impact.feature else {
            return Ok(());
        };
        let is_in = |index: u32, count: usize| (index as usize) < count;
        let found = self
            .mesh(i)
            .zip(self.mesh(j))
            .is_some_and(|(first, second)| match feature {
                Feature::VertexFace { vertex, face } => {
                    is_in(vertex, first.vertices().len()) && is_in(face, second.triangles().len())
                }
                Feature::FaceVertex { face, vertex } => {
                    is_in(face, first.triangles().len()) && is_in(vertex, second.vertices().len())
                }
                Feature::EdgeEdge {
                    first: one,
                    second: other,
                } => is_in(one, first.edges().len()) && is_in(other, second.edges().len()),
            });
        match found {
            true => Ok(()),
            false => Err("the latest impact is at a feature that its bodies do not have".into()),
        }
    }

    /// Builds the trees that existed: a step requires the trees of bodies in contact or in overlap.
    fn build_trees_in_touch(&self) {
        let contacts = self.contacts.all().iter().map(|contact| contact.bodies);
        for (i, j) in contacts.chain(self.overlaps.pairs.iter().copied()) {
            self.bodies.need_bvh(i);
            self.bodies.need_bvh(j);
        }
    }

    fn read_growth(&mut self, growth: Growth) -> Result<(), String> {
        let marks = Marks::of_kept(growth.kept, self.len());
        let marks = marks.ok_or("growth is counted from a motion that is none")?;
        if !(f64::MIN_POSITIVE..=LARGEST).contains(&growth.speed) {
            return Err("growth is counted from no speed".into());
        }
        self.integrator.resume_growth(growth.speed, marks);
        Ok(())
    }

    /// Checks that two bodies can touch: the lower index first, with shapes that may meet.
    fn check_pair_of(&self, what: &str, (i, j): (usize, usize)) -> Result<(), String> {
        self.is_there(i)?;
        self.is_there(j)?;
        let can_touch = i < j
            && self.bodies.has_shape(i)
            && self.bodies.has_shape(j)
            && self.bodies.may_meet(i, j);
        match can_touch {
            true => Ok(()),
            false => Err(format!("bodies {i} and {j} have no {what}")),
        }
    }

    fn is_there(&self, body: usize) -> Result<(), String> {
        self.check_body(body).map_err(|error| error.to_string())
    }
}

impl TurningState {
    /// The same data, if the body can have such a rotation.
    fn checked(self, index: usize, body: &Body) -> Result<TurningState, String> {
        if let Some(Shape::HalfSpace { .. }) = body.shape {
            let error = WorldError::TurningHalfSpace { body: index };
            return Err(error.to_string());
        }
        let moments = self.inertia.moments();
        if !body.kind.is_movable() && (self.torque != DVec3::ZERO || moments != DVec3::ONE) {
            return Err(format!(
                "body {index}: nothing turns it, so its torque is 0 and its moments are 1"
            ));
        }
        check_vector(index, "torque", self.torque).map_err(|error| error.to_string())?;
        for turned in [&self.before, &self.now] {
            if !is_unit(turned.rotation) {
                return Err(WorldError::Rotation { body: index }.to_string());
            }
            let spin = spin(moments, turned.rotation, turned.momentum);
            for (field, vector) in [("angular momentum", turned.momentum), ("spin", spin)] {
                check_vector(index, field, vector).map_err(|error| error.to_string())?;
            }
        }
        Ok(self)
    }
}

/// Whether a quaternion has length 1, up to the rounding of a step.
fn is_unit(rotation: DQuat) -> bool {
    (rotation.length_squared() - 1.0).abs() <= UNIT
}

/// Checks a shape as a world stores it: a normal already has length 1 and must not be rounded again.
fn check_shape_of(body: usize, shape: &Shape) -> Result<(), String> {
    match shape {
        Shape::HalfSpace { normal } => check_unit("half-space", *normal),
        other => check_shape(body, other.clone())
            .map(drop)
            .map_err(|error| error.to_string()),
    }
}

fn check_numbers(what: &str, numbers: &[f64]) -> Result<(), String> {
    // Written so that NaN is refused.
    match numbers.iter().all(|number| number.abs() <= LARGEST) {
        true => Ok(()),
        false => Err(format!("{what}: {numbers:?} must be within ±1e100")),
    }
}

fn check_unit(what: &str, normal: DVec3) -> Result<(), String> {
    match (normal.length_squared() - 1.0).abs() <= UNIT {
        true => Ok(()),
        false => Err(format!("{what}: the normal {normal} is not of length 1")),
    }
}
