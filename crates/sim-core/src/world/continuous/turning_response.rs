//! The response of turning bodies that touch: they bounce, or stay in contact ([`super::turning_rest`]).
//!
//! All features that touch at the same time are resolved at once, with their lever arms ([`crate::impulse::arms`]):
//! with restitution along each normal and without friction.

use alloc::{vec, vec::Vec};
use core::{f64::consts::PI, mem};

use glam::{DMat3, DQuat, DVec3};

use super::super::stepping::Cause;
use super::{
    event::{Event, EventKind},
    event_loop::EventLoop,
    position_correction::shares,
    solver::ContactSolver,
};
use crate::{
    collide::{
        Contact,
        turning::{ContactPoint, Moving, Turning, features_within},
    },
    impulse::arms::{self, Arms, Twist, Yielding},
    pieces::ties,
};

/// Features touch if they are no farther apart than this times the distance that counts as a contact.
pub(super) const REACH: f64 = 64.0;
/// The least gap from which bodies bounce, in the same unit: bodies that come from afar stop at this gap.
const LEAST_ROOM: f64 = 0.75;
/// The gap of bodies in contact, in the same unit.
const ROOM: f64 = 32.0;
/// The number of impacts of a turning body in a step after which it stays in contact, if its impacts lose energy.
const MANY_IMPACTS: u32 = 32;
/// The same if its impacts are elastic.
const MANY_ELASTIC_IMPACTS: u32 = 4096;
/// A contact at the present poses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    pub(super) bodies: (usize, usize),
    pub(super) arms: (DVec3, DVec3),
    pub(super) normal: DVec3,
    pub(super) owner: usize,
    /// The directions of crossing edges.
    pub(super) edges: Option<[DVec3; 2]>,
    pub(super) gap: f64,
    pub(super) room: f64,
}

/// The outcome of an impact.
enum TurningOutcome {
    Bounce,
    /// The bodies lose their closing speed and stay in contact.
    Stop,
    /// The bodies stay in contact with their present motion.
    Rest,
}

impl EventLoop<'_> {
    /// Resolves the impacts of turning bodies at a time, at which their trajectories start, and removes them from a
    /// group.
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
        let is_press_end = |event: &Event| {
            let (i, j) = event.bodies;
            event.kind == EventKind::Horizon && i == j && self.view().motion().press(i).is_some()
        };
        let ended: Vec<usize> = group
            .iter()
            .filter(|event| is_press_end(event))
            .map(|event| event.bodies.0)
            .collect();
        let mut turning: Vec<Event> = group
            .iter()
            .filter(|event| is_turning(event))
            .cloned()
            .collect();
        if turning.is_empty() && ended.is_empty() {
            return Ok(());
        }
        group.retain(|event| !is_turning(event));
        turning.retain(|event| !self.solver.goes_on(event));
        // Bodies that contacts have pushed stay in contact, whatever hits them.
        let mut pressed: Vec<usize> = Vec::new();
        // The acceleration that presses bodies together is the rest of their acceleration that contacts do not
        // support.
        let load = |body: usize| self.solver.view().motion().acceleration_there(body);
        let loads: Vec<[DVec3; 2]> = turning
            .iter()
            .map(|event| [load(event.bodies.0), load(event.bodies.1)])
            .collect();
        for event in &turning {
            for body in [event.bodies.0, event.bodies.1] {
                if self.solver.release(body) {
                    pressed.push(body);
                }
                seeds.push(body);
            }
        }
        let is_met = !turning.is_empty();
        for body in ended {
            if self.solver.release(body) {
                pressed.push(body);
            }
        }
        let mut found: Vec<Vec<Touching>> = Vec::new();
        for event in &turning {
            let mut touching = self.solver.touching(event, time)?;
            self.solver.make_room(event, &mut touching, time)?;
            found.push(touching);
        }
        let (mut bouncing, mut stopped, mut resting) = (Vec::new(), Vec::new(), Vec::new());
        for ((event, load), touching) in turning.iter().zip(loads).zip(found) {
            match self.solver.outcome(event, load, &touching, time)? {
                TurningOutcome::Bounce => bouncing.push((event, touching)),
                TurningOutcome::Stop => {
                    stopped.push((event, touching.clone()));
                    resting.push(touching);
                }
                TurningOutcome::Rest => resting.push(touching),
            }
        }
        let lasting = resting.iter().flatten();
        pressed.extend(lasting.flat_map(|touching| [touching.bodies.0, touching.bodies.1]));
        self.bounce_turning(&bouncing, None, time)?;
        self.bounce_turning(&stopped, Some(0.0), time)?;
        for touching in resting.iter().flatten() {
            self.solver.anchor(touching, time);
        }
        if !pressed.is_empty() {
            self.solver
                .press_all((&pressed, is_met), time, (seeds, restarted))?;
        }
        Ok(())
    }

    /// Lets bodies bounce. Bodies that impacts connect bounce together, with the given restitution or else the least
    /// of all.
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
        // An impulse through the centres of mass turns no body.
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
            // If several features touch at once, the event has only one of them, and its normal may be any between
            // those of its faces. So the total impulse is reported.
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

/// The bodies of some contacts, each once, with their motion.
pub(super) struct ArmIsland {
    pub(super) bodies: Vec<usize>,
    pub(super) contacts: Vec<Arms>,
    pub(super) yielding: Vec<Yielding>,
    pub(super) twists: Vec<Twist>,
}

impl ArmIsland {
    /// Whether one impulse through the centres of mass resolves all contacts alike: they have the same normal and
    /// close at the same speed, and along the normal the centre of each movable body is within its contact points.
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
        // If both bodies turn, the impulse must pass through both centres.
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

    /// Exchanges an impulse along the common normal of all contacts, through the centres of mass. Returns the share
    /// of each contact.
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

/// Whether the origin, seen along a normal, is within the convex hull of the points, or on its border up to rounding.
/// This holds if no two points that are neighbours in direction are more than half a turn apart.
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

/// The relative rounding of lever arms and of their directions.
const SAME_PLACE: f64 = 1e-12;

impl ContactSolver<'_> {
    /// The rotation of a body at a time, from its shape to the world.
    pub(super) fn rotation_at(&self, body: usize, time: f64) -> DQuat {
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

    pub(super) fn place_at(&mut self, body: usize, time: f64) -> Result<DVec3, (usize, Cause)> {
        let mut probe = mem::take(&mut self.paths.probe);
        let place = self.view().motion().motion_at(body, time, &mut probe);
        self.paths.probe = probe;
        Ok(place?.0)
    }

    /// All features that touch at an impact.
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
                edges: None,
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
                edges: point.edges,
                gap: (point.points[1] - point.points[0]).dot(point.normal),
                room: ROOM * near,
            })
            .collect())
    }

    /// Moves bodies apart if they are so near that a search from there cannot distinguish them from bodies in
    /// contact. The distance is a rounding, and other bodies must leave room for it.
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
        // Both bodies move, or the one that has room.
        let (i, j) = event.bodies;
        let before = [i, j].map(|body| self.paths.start.position[body]);
        let (first, second) = shares(
            self.scene.bodies.is_movable(i),
            self.scene.bodies.is_movable(j),
        );
        for part in [first, 0.0, 1.0] {
            let ways = [-part, 1.0 - part].map(|part| part * missing * normal);
            if part > 0.0 && first == 0.0 || part < 1.0 && second == 0.0 {
                continue;
            }
            let mut has_room = true;
            for ((body, before), way) in [i, j].into_iter().zip(before).zip(ways) {
                self.paths.start.position[body] = before + way;
                has_room &= way == DVec3::ZERO || self.met_by(body, time)?.is_none();
            }
            if has_room {
                for other in touching {
                    other.gap += missing * other.normal.dot(normal);
                }
                return Ok(());
            }
        }
        self.paths.start.position[i] = before[0];
        self.paths.start.position[j] = before[1];
        Ok(())
    }

    /// Another body that overlaps with `body` at a time, by the exact test.
    pub(super) fn met_by(
        &mut self,
        body: usize,
        time: f64,
    ) -> Result<Option<usize>, (usize, Cause)> {
        let mut partners = mem::take(&mut self.near.partners);
        partners.clear();
        let broad = &self.near.broad;
        broad.each_partner(body, |other| partners.push(other));
        let own = (
            body,
            (self.place_at(body, time)?, self.rotation_at(body, time)),
        );
        let mut met = None;
        for &other in &partners {
            if met.is_none() && self.scene.may_collide(body.min(other), body.max(other)) {
                let place = (self.place_at(other, time)?, self.rotation_at(other, time));
                let meets = self.scene.bodies.meet_placed(own, (other, place));
                met = meets.then_some(other);
            }
        }
        self.near.partners = partners;
        Ok(met)
    }

    /// The outcome of an impact.
    fn outcome(
        &mut self,
        event: &Event,
        load: [DVec3; 2],
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
        let [first, second] = load.map(|acceleration| acceleration.dot(normal));
        let load_speed = self.scene.settings.dt * (first - second);
        let pull = first.abs().max(second.abs());
        // Bodies that have fallen only through the gap of bodies in contact have no impact.
        let fallen = libm::sqrt(8.0 * ROOM * event.gap * pull);
        let unfelt = self.view().unfelt(load_speed) + fallen;
        if closing <= unfelt && restitution < 1.0 {
            return Ok(TurningOutcome::Rest);
        }
        Ok(
            match most <= many && self.view().bounces(((i, j), normal), closing, load_speed) {
                true => TurningOutcome::Bounce,
                false if closing > unfelt => TurningOutcome::Stop,
                false => TurningOutcome::Rest,
            },
        )
    }

    /// The bodies of some contacts with their motion at a time.
    pub(super) fn gather(
        &mut self,
        touching: &[Touching],
        time: f64,
    ) -> Result<ArmIsland, (usize, Cause)> {
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
            let mut twist = self.twist_of(body);
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

    /// Gives the bodies of an island their new motion. Velocities are set. Angular momenta are changed by the
    /// impulses, so that one body gains what the other one loses.
    pub(super) fn put(&mut self, island: &ArmIsland, given: &[f64]) {
        let all = self.scene.bodies;
        for (place, &body) in island.bodies.iter().enumerate() {
            if all.is_movable(body) {
                *self.changed(body).0 = island.twists[place].velocity;
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
                if all.tumbles(body)
                    && all.is_movable(body)
                    && let Some(momentum) = self.changed(body).1
                {
                    *momentum += arm.cross(push);
                }
            }
        }
    }
}
