//! What turning bodies do where they touch: they bounce, or go on in contact for the rest of the step.
//!
//! **Impacts.** All features that touch at the instant are answered at once, with their arms
//! ([`crate::impulse::arms`]): restitution along each normal, no friction.
//!
//! **Contact.** Bodies that would be back at once, or that have had very many impacts in the step, *drift*
//! for what is left of it, `τ`: with the velocities `u = v + τ a + M⁻¹ Jᵀ p`, `0 <= p ⟂ J u + (g - room)/τ >= 0`,
//! where `a` is what forces do, and `g` the gaps of what is known to touch (Anitescu, Potra 1997, "Formulating
//! dynamic multi-rigid-body contact problems with friction as solvable linear complementarity problems").
//! Their ways are searched like all others: what they meet early ends the drift there, with the velocity
//! `v + s (u - v)` after the part `s` of it, and it begins anew with that contact as well. No crossing is
//! possible whatever the velocities are.
//!
//! A drift gives no energy but what lifts bodies to the room that they are kept at. On a part `s` of it, with
//! `d = u - v`, forces do the work `s τ a·u = s (d·u - pᵀJu)`, and kinetic energy changes by `s v·d + s² d²/2`. So the
//! sum of kinetic and potential energy grows by `s pᵀJu - s (1 - s/2) d²`, in the norm of mass, where `pᵀJu` is
//! `pᵀ(room - g)/τ`: the force of the contacts times the room that they still lack. How the inertia turns within a
//! step is left out. The error is that of one step: places are off by `τ² a / 2` at most.

use alloc::{vec, vec::Vec};
use core::{f64::consts::PI, mem};

use glam::{DMat3, DQuat, DVec3};

use super::super::stepping::Cause;
use super::{
    bounce::ties,
    event::{Event, EventKind},
    event_loop::EventLoop,
    solver::ContactSolver,
};
use crate::{
    collide::{
        Contact,
        turning::{ContactPoint, Moving, Turning, features_within},
    },
    impulse::arms::{self, Arms, Twist, Yielding},
};

/// Features touch that are no farther apart than this times what is a contact.
const REACH: f64 = 64.0;
/// Least gap from which bodies bounce, in the same: where those stop that come from afar.
const LEAST_ROOM: f64 = 0.75;
/// Gap at which bodies that drift are kept, in the same.
const ROOM: f64 = 32.0;
/// Impacts of a turning body in a step after which it drifts, if its impacts lose something.
const MANY_IMPACTS: u32 = 32;
/// The same if they lose nothing.
const MANY_ELASTIC_IMPACTS: u32 = 4096;
/// Contacts that may be met in a drift, one after the other, before bodies stop for the rest of the step.
const MANY_ROUNDS: u32 = 24;

/// Turning bodies in contact in a step.
#[derive(Clone, Debug, Default)]
pub(super) struct TurningRest {
    /// By slot: impacts and rounds of drifting in the step.
    impacts: Vec<u32>,
    rounds: Vec<u32>,
    /// By slot, the motion before the drift, while there is one.
    before: Vec<Option<Before>>,
    /// By slot, velocity and angular momentum with which a body goes on after the step that has stopped in it.
    stopped: Vec<Option<(DVec3, DVec3)>>,
    /// What is known to touch.
    contacts: Vec<Anchored>,
}

/// Motion before a drift, and when that was.
#[derive(Clone, Copy, Debug)]
struct Before {
    since: f64,
    velocity: DVec3,
    momentum: DVec3,
}

/// A contact by points of both bodies.
#[derive(Clone, Copy, Debug)]
struct Anchored {
    bodies: (usize, usize),
    /// As seen from the centres of mass, in the frames of the shapes, m.
    points: [DVec3; 2],
    /// In the frame of the one whose surface it is.
    normal: DVec3,
    owner: usize,
    room: f64,
}

/// A contact where bodies are now.
#[derive(Clone, Copy, Debug)]
struct Touching {
    bodies: (usize, usize),
    arms: (DVec3, DVec3),
    normal: DVec3,
    owner: usize,
    gap: f64,
    room: f64,
}

/// What becomes of an impact.
enum TurningOutcome {
    Bounce,
    /// Bodies lose the speed at which they close, and stay in contact.
    Stop,
    /// They stay in contact, as they were.
    Rest,
}

impl TurningRest {
    /// Begins a step.
    pub(super) fn begin(&mut self, slots: usize) {
        self.impacts.clear();
        self.impacts.resize(slots, 0);
        self.rounds.clear();
        self.rounds.resize(slots, 0);
        self.before.clear();
        self.before.resize(slots, None);
        self.stopped.clear();
        self.stopped.resize(slots, None);
        self.contacts.clear();
    }
}

impl EventLoop<'_> {
    /// Gives bodies that have stopped in the step the motion with which they go on, unless they are pushed.
    pub(super) fn go_on_turning(&mut self) {
        let ContactSolver {
            scene,
            paths,
            turning,
            ..
        } = &mut self.solver;
        for (slot, stopped) in turning.stopped.iter().enumerate() {
            let body = scene.bodies.turners.body[slot];
            if let Some((velocity, momentum)) = *stopped
                && paths.end.velocity[body] == DVec3::ZERO
            {
                paths.end.velocity[body] = velocity;
                paths.end.turned[slot].momentum = momentum;
            }
        }
    }

    /// Answers the impacts of turning bodies at a time, at which their trajectories start, and takes them
    /// from a group.
    pub(super) fn resolve_turning(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
        (seeds, restarted): (&mut Vec<usize>, &mut Vec<usize>),
    ) -> Result<(), (usize, Cause)> {
        let bodies = self.solver.scene.bodies;
        if bodies.turners.is_empty() {
            return Ok(());
        }
        let is_turning = |event: &Event| {
            event.kind != EventKind::ContactEnd
                && event.bodies.0 != event.bodies.1
                && bodies.pair_tumbles(event.bodies.0, event.bodies.1)
        };
        let mut turning: Vec<Event> = group
            .iter()
            .filter(|event| is_turning(event))
            .cloned()
            .collect();
        if turning.is_empty() {
            return Ok(());
        }
        group.retain(|event| !is_turning(event));
        turning.retain(|event| !self.solver.goes_on(event));
        for event in &turning {
            self.solver.end_drift(event.bodies.0, time);
            self.solver.end_drift(event.bodies.1, time);
            seeds.extend([event.bodies.0, event.bodies.1]);
        }
        let mut found: Vec<Vec<Touching>> = Vec::new();
        for event in &turning {
            let mut touching = self.solver.touching(event, time)?;
            self.solver.make_room(event, &mut touching, time)?;
            found.push(touching);
        }
        let (mut bouncing, mut stopped, mut resting) = (Vec::new(), Vec::new(), Vec::new());
        for (event, touching) in turning.iter().zip(found) {
            match self.solver.outcome(event, &touching, time)? {
                TurningOutcome::Bounce => bouncing.push((event, touching)),
                TurningOutcome::Stop => {
                    stopped.push((event, touching.clone()));
                    resting.push(touching);
                }
                TurningOutcome::Rest => resting.push(touching),
            }
        }
        self.bounce_turning(&bouncing, None, time)?;
        self.bounce_turning(&stopped, Some(0.0), time)?;
        let seen: Vec<usize> = turning
            .iter()
            .flat_map(|event| [event.bodies.0, event.bodies.1])
            .collect();
        for touching in resting.iter().flatten() {
            self.solver.anchor(touching, time);
        }
        if !resting.is_empty() {
            self.solver.drift_all(&seen, time, (seeds, restarted))?;
        }
        Ok(())
    }

    /// Lets bodies bounce, those that impacts tie together at once: with a restitution, or the least of all.
    fn bounce_turning(
        &mut self,
        bouncing: &[(&Event, Vec<Touching>)],
        restitution: Option<f64>,
        time: f64,
    ) -> Result<(), (usize, Cause)> {
        if bouncing.is_empty() {
            return Ok(());
        }
        let all = self.solver.scene.bodies;
        let pairs = bouncing.iter().map(|(event, _)| event.bodies);
        let ties = ties(pairs, all.len(), |body| all.is_movable(body));
        let mut ties: Vec<(usize, usize)> = ties.into_iter().zip(0..).collect();
        ties.sort_unstable();
        for tied in ties.chunk_by(|a, b| a.0 == b.0) {
            let tied: Vec<&(&Event, Vec<Touching>)> =
                tied.iter().map(|&(_, k)| &bouncing[k]).collect();
            self.bounce_tied(&tied, restitution, time)?;
        }
        Ok(())
    }

    fn bounce_tied(
        &mut self,
        tied: &[&(&Event, Vec<Touching>)],
        restitution: Option<f64>,
        time: f64,
    ) -> Result<(), (usize, Cause)> {
        let scene = self.solver.scene;
        let least = || {
            let pairs = tied.iter().map(|(event, _)| event.bodies);
            pairs
                .map(|(i, j)| scene.bodies.pair_restitution(i, j))
                .fold(1.0, f64::min)
        };
        let restitution = restitution.unwrap_or_else(least);
        let touching: Vec<Touching> = tied.iter().flat_map(|(_, all)| all).copied().collect();
        let mut island = self.solver.gather(&touching, time)?;
        let before = island.twists.clone();
        let is_flat = tied.len() == 1 && island.is_flat(&touching);
        let given = match is_flat {
            true => island.bounce_flat(restitution),
            false => arms::reflect(
                &island.contacts,
                &island.yielding,
                &mut island.twists,
                restitution,
            ),
        };
        // Through the centres of mass nothing is turned.
        let turning = if is_flat { &[][..] } else { &given };
        self.solver.put(&island, turning);
        let mut first = 0;
        for (event, touching) in tied {
            let of_event = first..first + touching.len();
            first = of_event.end;
            let parts = || of_event.clone().map(|k| (&island.contacts[k], given[k]));
            let impulse: f64 = parts().map(|(_, given)| given).sum();
            if impulse <= 0.0 {
                continue;
            }
            let mean = |of: &dyn Fn(&Arms) -> f64| {
                parts().map(|(arms, given)| given * of(arms)).sum::<f64>() / impulse
            };
            let speeds = (
                mean(&|arms| -arms.opening(&before)),
                mean(&|arms| arms.opening(&island.twists)),
            );
            let at = self.view().instant(event.bodies, time);
            // Of several features that touch at once the event has one, and its normal may be any between
            // those of its faces: what is told is what is given.
            let sum = |of: &dyn Fn(&Arms) -> DVec3| {
                parts().map(|(arms, given)| given * of(arms)).sum::<DVec3>()
            };
            let total = sum(&|arms| arms.normal);
            let contact = Contact {
                point: at.positions.0 + sum(&|arms| arms.arms.0) / impulse,
                normal: total.try_normalize().unwrap_or(event.contact.normal),
                ..event.contact
            };
            let told = (total.length(), speeds);
            let impact = scene.impact(event.bodies, &contact, told, at);
            self.note_impact(impact);
        }
        Ok(())
    }
}

/// The bodies of some contacts, once each, with their motion.
struct ArmIsland {
    bodies: Vec<usize>,
    contacts: Vec<Arms>,
    yielding: Vec<Yielding>,
    twists: Vec<Twist>,
}

impl ArmIsland {
    /// Whether an impulse through the centres of mass answers all contacts alike: they are along one normal,
    /// close at one speed, and the centre of each body that moves is over what it touches with.
    fn is_flat(&self, touching: &[Touching]) -> bool {
        let Some(first) = self.contacts.first() else {
            return false;
        };
        let closing = -first.opening(&self.twists);
        let normal = first.normal;
        let (i, j) = first.bodies;
        let is_still = self.twists[i].spin == DVec3::ZERO && self.twists[j].spin == DVec3::ZERO;
        let is_alike = self.contacts.iter().all(|contact| {
            contact.bodies == first.bodies && (contact.normal - normal).length() <= SAME_PLACE
        });
        let over = |body: usize, arm: fn(&Touching) -> DVec3| {
            self.yielding[body].mass == 0.0 || {
                let arms: Vec<DVec3> = touching.iter().map(arm).collect();
                is_over(&arms, normal)
            }
        };
        // Of two that turn what pushes the one through its centre has to push the other one so.
        let turns = |body: usize| self.yielding[body].inertia != DMat3::ZERO;
        let between = touching[0].arms.0 - touching[0].arms.1;
        let is_in_line = between.cross(normal).length() <= SAME_PLACE * between.length();
        is_still
            && (is_in_line || !turns(i) || !turns(j))
            && closing > 0.0
            && is_alike
            && over(i, |touching| touching.arms.0)
            && over(j, |touching| touching.arms.1)
    }

    /// Exchanges an impulse along the normal that all contacts share, through the centres of mass, and says
    /// what share of it each has.
    fn bounce_flat(&mut self, restitution: f64) -> Vec<f64> {
        let contact = self.contacts[0];
        let (i, j) = contact.bodies;
        let mass = |body: usize| 1.0 / self.yielding[body].mass;
        let first = (mass(i), self.twists[i].velocity);
        let second = (mass(j), self.twists[j].velocity);
        let mut given = vec![0.0; self.contacts.len()];
        if let Some(exchange) = crate::impulse::between(first, second, contact.normal, restitution)
        {
            for (body, after) in [(i, exchange.after.0), (j, exchange.after.1)] {
                if self.yielding[body].mass > 0.0 {
                    self.twists[body].velocity = after;
                }
            }
            given.fill(exchange.impulse / self.contacts.len() as f64);
        }
        given
    }
}

/// Whether the origin, seen along a normal, is within the hull of points, or but for rounding on its border:
/// between none of two neighbours in direction is more than half a turn.
fn is_over(points: &[DVec3], normal: DVec3) -> bool {
    let (u, v) = normal.any_orthonormal_pair();
    let flat = points.iter().map(|p| (p.dot(u), p.dot(v)));
    let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
    let mut angles = Vec::new();
    for (x, y) in flat {
        if x.abs().max(y.abs()) <= SAME_PLACE * size {
            return true;
        }
        angles.push(libm::atan2(y, x));
    }
    angles.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (angles.first(), angles.last()) else {
        return false;
    };
    let half = PI + SAME_PLACE;
    let wrap = first + 2.0 * PI - last;
    angles.windows(2).all(|pair| pair[1] - pair[0] <= half) && wrap <= half
}

/// Rounding of arms and of their directions.
const SAME_PLACE: f64 = 1e-12;

impl ContactSolver<'_> {
    /// Whether an event is no contact yet, and the search goes on from there; not for ever in a step.
    fn goes_on(&mut self, event: &Event) -> bool {
        let (i, j) = event.bodies;
        if event.kind != EventKind::Horizon {
            return false;
        }
        for body in [i, j] {
            if let Some(slot) = self.scene.bodies.turners.slot(body) {
                self.turning.rounds[slot] += 1;
            }
        }
        !self.is_stopped(i) && !self.is_stopped(j)
    }

    /// Ends the drift of a body at a time, at which its trajectory starts: it has of the change of its
    /// velocity what belongs to the part that is over.
    fn end_drift(&mut self, body: usize, time: f64) {
        let Some(slot) = self.scene.bodies.turners.slot(body) else {
            return;
        };
        let Some(before) = self.turning.before[slot].take() else {
            return;
        };
        self.paths.drifting[slot] = false;
        self.paths.acceleration[body] = self.paths.applied_acceleration[body];
        let whole = self.scene.settings.dt - before.since;
        let part = (time - before.since) / whole;
        let velocity = &mut self.paths.start.velocity[body];
        *velocity = before.velocity + part * (*velocity - before.velocity);
        let momentum = &mut self.paths.start.turned[slot].momentum;
        *momentum = before.momentum + part * (*momentum - before.momentum);
    }

    /// How a body is turned at a time: shape into the world.
    fn rotation_at(&self, body: usize, time: f64) -> DQuat {
        let bodies = self.scene.bodies;
        match bodies.turners.slot(body) {
            Some(slot) if bodies.tumbles(body) => {
                let turned = self.view().motion().turned_at(slot, body, time);
                let axes = bodies.turners.inertia[slot].axes();
                (turned.rotation * axes.inverse()).normalize()
            }
            _ => DQuat::IDENTITY,
        }
    }

    fn place_at(&mut self, body: usize, time: f64) -> Result<DVec3, (usize, Cause)> {
        let mut probe = mem::take(&mut self.paths.probe);
        let place = self.view().motion().motion_at(body, time, &mut probe);
        self.paths.probe = probe;
        Ok(place?.0)
    }

    /// All that touches at an impact.
    fn touching(&mut self, event: &Event, time: f64) -> Result<Vec<Touching>, (usize, Cause)> {
        let (i, j) = event.bodies;
        let (first, second) = (self.place_at(i, time)?, self.place_at(j, time)?);
        let still = |place: DVec3| (place, DVec3::ZERO, DVec3::ZERO);
        let turning = |body: usize| Turning::Still(self.rotation_at(body, time));
        let bodies = self.scene.bodies;
        let a: Option<Moving<'_>> = bodies.moving(i, still(first), turning(i));
        let b: Option<Moving<'_>> = bodies.moving(j, still(second), turning(j));
        let near = event.gap;
        let mut found = match a.zip(b) {
            Some((a, b)) => features_within(&a, &b, (0.5 * near, REACH * near)),
            None => Vec::new(),
        };
        let place = event.contact.point - first;
        let is_along = |point: &ContactPoint| point.normal.dot(event.contact.normal) > 0.5;
        if !found.iter().any(is_along) {
            found.push(ContactPoint {
                points: [place, place + near * event.contact.normal],
                normal: event.contact.normal,
                owner: 0,
            });
        }
        let between = second - first;
        Ok(found
            .into_iter()
            .map(|point| Touching {
                bodies: event.bodies,
                arms: (point.points[0], point.points[1] - between),
                normal: point.normal,
                owner: point.owner,
                gap: (point.points[1] - point.points[0]).dot(point.normal),
                room: ROOM * near,
            })
            .collect())
    }

    /// Moves bodies apart that are nearer than a search from there can tell from a contact: by a rounding,
    /// where others leave room for it.
    fn make_room(
        &mut self,
        event: &Event,
        touching: &mut [Touching],
        time: f64,
    ) -> Result<(), (usize, Cause)> {
        let nearest = touching.iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
        let Some(&Touching { gap, normal, .. }) = nearest else {
            return Ok(());
        };
        let missing = LEAST_ROOM * event.gap - gap;
        if missing <= 0.0 {
            return Ok(());
        }
        let (i, j) = event.bodies;
        let before = [i, j].map(|body| self.paths.start.position[body]);
        self.move_apart(event.bodies, missing * normal);
        for body in [i, j] {
            if self.scene.bodies.is_movable(body) && self.meets_others(body, time)? {
                self.paths.start.position[i] = before[0];
                self.paths.start.position[j] = before[1];
                return Ok(());
            }
        }
        for other in touching {
            other.gap += missing * other.normal.dot(normal);
        }
        Ok(())
    }

    /// Whether a body meets another one at a time, by the exact test.
    fn meets_others(&mut self, body: usize, time: f64) -> Result<bool, (usize, Cause)> {
        let mut partners = mem::take(&mut self.near.partners);
        partners.clear();
        let broad = &self.near.broad;
        broad.each_partner(body, |other| partners.push(other));
        let own = (
            body,
            (self.place_at(body, time)?, self.rotation_at(body, time)),
        );
        let mut meets = false;
        for &other in &partners {
            if self.scene.may_collide(body.min(other), body.max(other)) {
                let place = (self.place_at(other, time)?, self.rotation_at(other, time));
                meets |= self.scene.bodies.meet_placed(own, (other, place));
            }
        }
        self.near.partners = partners;
        Ok(meets)
    }

    /// What becomes of an impact.
    fn outcome(
        &mut self,
        event: &Event,
        touching: &[Touching],
        time: f64,
    ) -> Result<TurningOutcome, (usize, Cause)> {
        let island = self.gather(touching, time)?;
        let fastest = island
            .contacts
            .iter()
            .map(|contact| (-contact.opening(&island.twists), contact.normal))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((closing, normal)) = fastest else {
            return Ok(TurningOutcome::Rest);
        };
        let (i, j) = event.bodies;
        let mut most = 0;
        for body in [i, j] {
            if let Some(slot) = self.scene.bodies.turners.slot(body)
                && self.scene.bodies.is_movable(body)
            {
                self.turning.impacts[slot] += 1;
                most = most.max(self.turning.impacts[slot]);
            }
        }
        let restitution = self.scene.bodies.pair_restitution(i, j);
        let many = match restitution < 1.0 {
            true => MANY_IMPACTS,
            false => MANY_ELASTIC_IMPACTS,
        };
        let applied = &self.paths.applied_acceleration;
        let load_speed = self.scene.settings.dt * (applied[i] - applied[j]).dot(normal);
        let pull = applied[i]
            .dot(normal)
            .abs()
            .max(applied[j].dot(normal).abs());
        // What has fallen through the room that bodies are kept at is no impact.
        let fallen = libm::sqrt(8.0 * ROOM * event.gap * pull);
        let unfelt = self.view().unfelt(load_speed) + fallen;
        Ok(
            match most <= many && self.view().bounces(((i, j), normal), closing, load_speed) {
                true => TurningOutcome::Bounce,
                false if closing > unfelt => TurningOutcome::Stop,
                false => TurningOutcome::Rest,
            },
        )
    }

    /// Bodies of contacts as they move at a time.
    fn gather(&mut self, touching: &[Touching], time: f64) -> Result<ArmIsland, (usize, Cause)> {
        let all = self.scene.bodies;
        let mut bodies: Vec<usize> = touching
            .iter()
            .flat_map(|touching| [touching.bodies.0, touching.bodies.1])
            .collect();
        bodies.sort_unstable();
        bodies.dedup();
        let place = |body: usize| bodies.partition_point(|&other| other < body);
        let contacts = touching
            .iter()
            .map(|touching| Arms {
                bodies: (place(touching.bodies.0), place(touching.bodies.1)),
                normal: touching.normal,
                arms: touching.arms,
            })
            .collect();
        let mut twists = Vec::with_capacity(bodies.len());
        let mut yielding = Vec::with_capacity(bodies.len());
        for &body in &bodies {
            let mut twist = all.twist_in(&self.paths.start, body);
            if !all.is_movable(body) {
                let mut probe = mem::take(&mut self.paths.probe);
                let motion = self.view().motion().motion_at(body, time, &mut probe);
                self.paths.probe = probe;
                twist.velocity = motion?.1;
            }
            if !all.tumbles(body) {
                twist.spin = DVec3::ZERO;
            }
            twists.push(twist);
            yielding.push(all.yielding_in(&self.paths.start, body));
        }
        Ok(ArmIsland {
            bodies,
            contacts,
            yielding,
            twists,
        })
    }

    /// Gives the bodies of an island their new motion: velocities as they are, and angular momenta by the
    /// impulses, so that what one gains the other one loses.
    fn put(&mut self, island: &ArmIsland, given: &[f64]) {
        let all = self.scene.bodies;
        for (place, &body) in island.bodies.iter().enumerate() {
            if all.is_movable(body) {
                self.paths.start.velocity[body] = island.twists[place].velocity;
            }
        }
        if given.is_empty() {
            return;
        }
        for (contact, &given) in island.contacts.iter().zip(given) {
            let push = given * contact.normal;
            for (place, arm, push) in [
                (contact.bodies.0, contact.arms.0, -push),
                (contact.bodies.1, contact.arms.1, push),
            ] {
                let body = island.bodies[place];
                if let Some(slot) = all.turners.slot(body)
                    && all.tumbles(body)
                    && all.is_movable(body)
                {
                    self.paths.start.turned[slot].momentum += arm.cross(push);
                }
            }
        }
    }

    /// Notes that two bodies touch, where they are at a time.
    fn anchor(&mut self, touching: &Touching, time: f64) {
        let (i, j) = touching.bodies;
        let inverse = [i, j].map(|body| self.rotation_at(body, time).inverse());
        let contact = Anchored {
            bodies: touching.bodies,
            points: [inverse[0] * touching.arms.0, inverse[1] * touching.arms.1],
            normal: inverse[touching.owner] * touching.normal,
            owner: touching.owner,
            room: touching.room,
        };
        // One of the same features is taken for the same.
        let is_same = |known: &Anchored| {
            known.bodies == contact.bodies
                && known.owner == contact.owner
                && known.normal.dot(contact.normal) > SAME_NORMAL
                && (0..2)
                    .any(|k| (known.points[k] - contact.points[k]).length() <= 4.0 * contact.room)
        };
        self.turning.contacts.retain(|known| !is_same(known));
        self.turning.contacts.push(contact);
    }

    /// What is known to touch among some bodies and what they touch, where they are at a time.
    fn known_contacts(
        &mut self,
        bodies: &[usize],
        time: f64,
    ) -> Result<Vec<Touching>, (usize, Cause)> {
        let mut touching = Vec::new();
        for place in 0..self.turning.contacts.len() {
            let contact = self.turning.contacts[place];
            let (i, j) = contact.bodies;
            // What has bounced off since goes its own way.
            let is_off = |body: usize| {
                let all = self.scene.bodies;
                all.is_movable(body) && all.tumbles(body) && !bodies.contains(&body)
            };
            if !bodies.contains(&i) && !bodies.contains(&j) || is_off(i) || is_off(j) {
                continue;
            }
            let rotations = [i, j].map(|body| self.rotation_at(body, time));
            let arms = (
                rotations[0] * contact.points[0],
                rotations[1] * contact.points[1],
            );
            let normal = rotations[contact.owner] * contact.normal;
            let between = self.place_at(j, time)? - self.place_at(i, time)?;
            touching.push(Touching {
                bodies: contact.bodies,
                arms,
                normal,
                owner: contact.owner,
                gap: (between + arms.1 - arms.0).dot(normal),
                room: contact.room,
            });
        }
        Ok(touching)
    }

    /// Whether a body has met so much in a drift that it stays where it is.
    fn is_stopped(&self, body: usize) -> bool {
        let slot = self.scene.bodies.turners.slot(body);
        slot.is_some_and(|slot| self.turning.rounds[slot] > MANY_ROUNDS)
    }

    /// Adds the contacts that bodies keep which do not turn, and whom turning ones push: they give on what
    /// they get.
    fn add_kept_contacts(
        &mut self,
        touching: &mut Vec<Touching>,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let all = self.scene.bodies;
        let mut bodies: Vec<usize> = Vec::new();
        let reach = |bodies: &mut Vec<usize>, (i, j): (usize, usize)| {
            for body in [i, j] {
                if all.is_movable(body) && !all.tumbles(body) && !bodies.contains(&body) {
                    bodies.push(body);
                }
            }
        };
        for touching in touching.iter() {
            reach(&mut bodies, touching.bodies);
        }
        let mut known: Vec<u32> = Vec::new();
        let mut next = 0;
        while let Some(&body) = bodies.get(next) {
            next += 1;
            for &index in self.contacts.of_body(body) {
                if known.contains(&index) {
                    continue;
                }
                known.push(index);
                let constraint = &self.contacts.all()[index as usize];
                reach(&mut bodies, constraint.bodies);
                touching.push(Touching {
                    bodies: constraint.bodies,
                    arms: (DVec3::ZERO, DVec3::ZERO),
                    normal: constraint.normal,
                    owner: 0,
                    gap: 0.0,
                    room: 0.0,
                });
            }
        }
        for body in bodies {
            self.restart(body, time, restarted)?;
        }
        Ok(())
    }

    /// Lets bodies that touch, and those that drift and touch them, drift for the rest of the step.
    fn drift_all(
        &mut self,
        seen: &[usize],
        time: f64,
        (seeds, restarted): (&mut Vec<usize>, &mut Vec<usize>),
    ) -> Result<(), (usize, Cause)> {
        let all = self.scene.bodies;
        let mut bodies: Vec<usize> = seen
            .iter()
            .copied()
            .filter(|&body| all.is_movable(body))
            .collect();
        bodies.sort_unstable();
        bodies.dedup();
        let mut next = 0;
        while let Some(&body) = bodies.get(next) {
            next += 1;
            for contact in &self.turning.contacts {
                let (i, j) = contact.bodies;
                if body != i && body != j {
                    continue;
                }
                let other = i + j - body;
                let is_tied = all.is_movable(other)
                    && all
                        .turners
                        .slot(other)
                        .is_some_and(|slot| self.paths.drifting[slot]);
                if is_tied && !bodies.contains(&other) {
                    bodies.push(other);
                }
            }
        }
        for &body in &bodies {
            self.restart(body, time, restarted)?;
            self.end_drift(body, time);
        }
        let left = self.scene.settings.dt - time;
        let mut touching = self.known_contacts(&bodies, time)?;
        self.add_kept_contacts(&mut touching, time, restarted)?;
        let tied = touching
            .iter()
            .flat_map(|touching| [touching.bodies.0, touching.bodies.1]);
        seeds.extend(tied.chain(bodies.iter().copied()));
        let mut island = self.gather(&touching, time)?;
        let mut before: Vec<(usize, usize, Before)> = Vec::new();
        for (place, &body) in island.bodies.iter().enumerate() {
            let Some(slot) = all.turners.slot(body) else {
                continue;
            };
            if !all.tumbles(body) || !all.is_movable(body) || !bodies.contains(&body) {
                continue;
            }
            self.turning.rounds[slot] += 1;
            let stagger = self.paths.velocity_stagger;
            let pull = self.view().motion().acceleration_there(body);
            let twist = &mut island.twists[place];
            if self.is_stopped(body) {
                // It stays where it is for what is left, and is only pushed. What it has, forces apart, it
                // keeps for the next step.
                let momentum = self.paths.start.turned[slot].momentum;
                self.turning.stopped[slot].get_or_insert((twist.velocity, momentum));
                *twist = Twist::default();
                self.paths.start.turned[slot].momentum = DVec3::ZERO;
            } else {
                twist.velocity -= stagger * self.paths.acceleration[body];
            }
            let momentum = self.paths.start.turned[slot].momentum;
            before.push((
                body,
                slot,
                Before {
                    since: time,
                    velocity: twist.velocity,
                    momentum,
                },
            ));
            if !self.is_stopped(body) {
                twist.velocity += left * pull;
                let torque = all.turners.torque[slot];
                self.paths.start.turned[slot].momentum += left * torque;
                twist.spin = all.twist_in(&self.paths.start, body).spin;
            }
        }
        let wanted: Vec<f64> = island
            .contacts
            .iter()
            .zip(&touching)
            .map(|(arms, touching)| {
                let (i, j) = touching.bodies;
                let widened = match self.is_stopped(i) || self.is_stopped(j) {
                    true => 0.0,
                    false => (touching.room - touching.gap) / left,
                };
                widened - arms.opening(&island.twists)
            })
            .collect();
        let given = arms::multipliers(&island.contacts, &island.yielding, &wanted);
        arms::push(
            &island.contacts,
            &island.yielding,
            &mut island.twists,
            &given,
        );
        self.put(&island, &given);
        for (body, slot, before) in before {
            self.turning.before[slot] = Some(before);
            self.paths.drifting[slot] = true;
            self.paths.acceleration[body] = DVec3::ZERO;
        }
        Ok(())
    }
}

/// Cosine above which two normals are one.
const SAME_NORMAL: f64 = 1.0 - 1e-6;
