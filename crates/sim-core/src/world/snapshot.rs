//! A world as data, from which it continues with the same bits.
//!
//! The data contains no caches. It contains each mesh once, however many bodies share it.

mod read;

use alloc::{format, vec::Vec};
use glam::DVec3;
use serde::{Deserialize, Serialize, Serializer, ser};

use super::{
    Bundled, Groups, Impact, Settings, World, continuous::ContactConstraint, handle::Slot,
    marks::KeptMotion, turning::TurningState,
};
use crate::{BodyKind, Force, Shape};

/// The version of the format; worlds of other versions are refused.
const VERSION: u32 = 4;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Snapshot {
    version: u32,
    settings: Settings,
    steps: u64,
    /// Time and step at which `dt` was last set.
    since: (f64, u64),
    shapes: Vec<Shape>,
    bodies: Vec<BodyState>,
    /// Pairs that never collide.
    ignored: Vec<(usize, usize)>,
    forces: Vec<Force>,
    /// The order in which coupled bodies are stepped.
    order: Option<Vec<usize>>,
    slots: Vec<Slot>,
    free_slots: Vec<u32>,
    overlaps: Vec<KnownOverlap>,
    contacts: Vec<ContactConstraint>,
    /// For each body, indices of its contacts.
    contacts_of: Vec<Vec<u32>>,
    /// Bodies whose contacts are solved once a step.
    bundled: Vec<usize>,
    bundled_in_step: Bundled,
    /// Bodies at rest, whose contacts are not solved anew.
    asleep: Vec<usize>,
    placed: bool,
    knows_near: bool,
    impacts: u64,
    last_impact: Option<Impact>,
    contact_steps: u64,
    growth: Option<Growth>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyState {
    /// Its index in the shapes.
    shape: Option<usize>,
    kind: BodyKind,
    mass: f64,
    position: DVec3,
    velocity: DVec3,
    previous_position: DVec3,
    force: DVec3,
    restitution: f64,
    #[serde(with = "crate::serde_number")]
    friction: f64,
    groups: Groups,
    user_data: u64,
    /// The data of a turning body. Worlds of the first version had none.
    #[serde(default)]
    turn: Option<TurningState>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct KnownOverlap {
    bodies: (usize, usize),
    /// The depth where the two bodies were placed, m, once it has been computed.
    depth_at_start: Option<f64>,
}

/// The data from which growth of the motion is measured.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Growth {
    speed: f64,
    kept: Vec<KeptMotion>,
}

/// A world is written with all data that its later motion depends on. After it is read, it continues with the same
/// bits, and the handles of its bodies name the same bodies. The format must not round numbers: with `serde_json`,
/// use the feature `float_roundtrip`.
///
/// # Errors
///
/// If a force is an external law ([`Force::Body`], [`Force::Pair`]), or the method is not in
/// [`METHODS`](crate::METHODS): these are code.
impl Serialize for World {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut forces = self.forces().iter();
        let law = |force: &&Force| matches!(force, Force::Body { .. } | Force::Pair { .. });
        if let Some(index) = forces.position(|force| law(&force)) {
            return Err(ser::Error::custom(format!(
                "force {index} is a law from outside: it is code, which has no text"
            )));
        }
        Snapshot::of(self).serialize(to)
    }
}

impl Snapshot {
    fn of(world: &World) -> Snapshot {
        let (contacts_of, bundled) = world.contacts.places();
        let (slots, free_slots) = world.handles.slots();
        let overlap = |&bodies: &(usize, usize)| KnownOverlap {
            bodies,
            depth_at_start: world.overlaps.depth_at_start(bodies),
        };
        let body = |(i, shape): (usize, Option<usize>)| BodyState {
            shape,
            kind: world.kind(i),
            mass: world.mass(i),
            position: world.position(i),
            velocity: world.velocity(i),
            previous_position: world.previous_position(i),
            force: world.force(i),
            restitution: world.restitution(i),
            friction: world.friction(i),
            groups: world.groups(i),
            user_data: world.user_data(i),
            turn: world.turning_state(i),
        };
        Snapshot {
            version: VERSION,
            settings: world.settings,
            steps: world.elapsed.steps,
            since: world.elapsed.since,
            shapes: world.bodies.all_shapes().cloned().collect(),
            bodies: (0..).zip(world.bodies.shape_places()).map(body).collect(),
            ignored: world.ignored_pairs().collect(),
            forces: world.forces().to_vec(),
            order: world.planned_order(),
            slots: slots.to_vec(),
            free_slots: free_slots.to_vec(),
            overlaps: world.overlapping().iter().map(overlap).collect(),
            contacts: world.contacts.all().to_vec(),
            contacts_of: contacts_of.to_vec(),
            bundled,
            bundled_in_step: world.continuous.bundled,
            asleep: world.continuous.sleepers(),
            placed: world.continuous.placed,
            knows_near: world.continuous.knows_near(),
            impacts: world.record.impacts,
            last_impact: world.record.last_impact.clone(),
            contact_steps: world.record.contact_steps,
            growth: world.integrator.growth().map(|(speed, marks)| Growth {
                speed,
                kept: marks.kept(),
            }),
        }
    }
}
