//! Whether bodies separate after an impact, or stay in contact.
//!
//! They separate with their restitution. If forces press them together and they would be back within a small part of
//! a step, they stay in contact instead. From then on a constraint keeps them apart ([`super::contact_set`]), for the
//! rest of the step and in the next ones, until they separate. So a ball comes to rest after finitely many bounces.
//!
//! If forces may grow without bound, the length of a step does not show how soon bodies are back: bodies that touch
//! in passing are out of each other's way long before its end. Such bodies stay in contact only if they would
//! separate by no more than the gap of contacts.
//!
//! There are two more cases for bodies with a restitution less than one. They come to rest if their remaining speed
//! moves them by no more than a rounding in a step. They also come to rest if they are caught among others, so that
//! impacts follow each other faster and faster though nothing presses these two together (inelastic collapse;
//! McNamara, Young 1994, "Inelastic collapse in two dimensions"). This requires that their remaining speed is a small
//! part of the speed at which the impacts began, or of the speed that forces give to each of them if they lie on
//! something.

use glam::DVec3;

use super::{
    event::{Event, Outcome},
    tallies::Bounces,
    view::View,
};

/// A flight shorter than this fraction of a step does not count.
const SHORTEST_FLIGHT: f64 = 1.0 / 16.0;

/// The number of impacts of a body in a step after which it may be caught among others.
pub(super) const MANY_BOUNCES: u32 = 8;

/// The number of estimates of the top of a hop, each from the force at the one before.
const HOPS: u32 = 16;

/// Fraction of the greatest closing speed of a body in a step that is negligible beside that speed.
const SPENT: f64 = 1e-6;

/// How often a body may come to rest in a step, each time at its own time, before its island is bundled: all impacts
/// that would come to rest in the step begin their contacts at once, with their gaps.
const MANY_RESTS: u32 = 4;

impl View<'_> {
    /// The closing speed of two bodies at their impact, m/s.
    pub(super) fn closing(&self, event: &Event) -> f64 {
        let (i, j) = event.bodies;
        let velocity = &self.paths.start.velocity;
        (velocity[i] - velocity[j]).dot(event.contact.normal)
    }

    /// Decides whether two bodies bounce or come to rest, from their motion at the starts of their trajectories.
    pub(super) fn classify(&self, event: &mut Event) {
        let closing = self.closing(event);
        self.classify_by(event, closing, self.pressed_on_hop(event, closing));
    }

    /// The acceleration with which forces press two bodies together at their impact, m/s²: the greater of the values
    /// with and without their contacts with others, because one of those may end here.
    pub(super) fn pressed(&self, event: &Event) -> f64 {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let there = self.motion().acceleration_there(i) - self.motion().acceleration_there(j);
        let applied = &self.paths.applied_acceleration;
        let alone = applied[i] - applied[j];
        there.dot(normal).max(alone.dot(normal))
    }

    /// The acceleration with which forces press two bodies together that close at a speed, m/s². It is that at their
    /// impact, or that at the top of the following hop if it is so much less there that they are not back soon. If
    /// forces decrease with distance, a hop goes farther than the force at its start suggests.
    pub(super) fn pressed_on_hop(&self, event: &Event, closing: f64) -> f64 {
        let pressed = self.pressed(event);
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let is_forced =
            self.motion().coupled_group(i).is_some() || self.motion().coupled_group(j).is_some();
        let leaving = self.scene.bodies.pair_restitution(i, j) * closing;
        if !is_forced || leaving <= 0.0 {
            return pressed;
        }
        let is_bundled = self.is_bundled(i) || self.is_bundled(j);
        let flight = self.scene.settings.dt * self.shortest_flight(is_bundled);
        let weight = |body: usize| match self.scene.bodies.is_movable(body) {
            true => 1.0 / self.scene.bodies.mass[body],
            false => 0.0,
        };
        let (first, second) = (weight(i), weight(j));
        let applied = &self.paths.applied_acceleration;
        let alone = (applied[i] - applied[j]).dot(normal);
        let mut least = pressed;
        for _ in 0..HOPS {
            if 2.0 * leaving > flight * least {
                return least;
            }
            let height = 0.5 * leaving * leaving / least;
            let by = height / (first + second) * normal;
            let moved = [(i, -first * by), (j, second * by)];
            let there = self.motion().acceleration_beside(i, &moved)
                - self.motion().acceleration_beside(j, &moved);
            let there = there.dot(normal).max(alone);
            if there >= least {
                break;
            }
            least = there;
        }
        // For bodies at rest, the force at the impact counts.
        pressed
    }

    pub(super) fn classify_by(&self, event: &mut Event, closing: f64, pressed: f64) {
        event.load_speed = self.scene.settings.dt * pressed;
        event.outcome = match self.bounces(event.plane(), closing, event.load_speed) {
            true => Outcome::Bounce,
            false => Outcome::Rest,
        };
    }

    /// Whether two bodies separate again that close at the speed `closing`, while forces close them by `load_speed`
    /// in a step.
    pub(super) fn bounces(
        &self,
        ((i, j), normal): ((usize, usize), DVec3),
        closing: f64,
        load_speed: f64,
    ) -> bool {
        if closing <= 0.0 || self.is_held(i, j) {
            return false;
        }
        let restitution = self.scene.bodies.pair_restitution(i, j);
        let lasting = restitution * (closing - self.unfelt(load_speed)).max(0.0);
        // The bodies are back after the time 2 v / a.
        let is_bundled = self.is_bundled(i) || self.is_bundled(j);
        let flight = self.shortest_flight(is_bundled);
        let is_steep = self.are_steep(i, j);
        let is_short = |speed: f64, push: f64| {
            // The height of the hop is 0.5 v² / a.
            let is_high = || {
                let hover = self.layout().hover_gap(i, j);
                0.5 * speed * speed * self.scene.settings.dt > hover * push
            };
            2.0 * speed <= flight * push && !(is_steep && is_high())
        };
        if load_speed > 0.0 && is_short(lasting, load_speed) {
            return false;
        }
        let leaving = restitution * closing;
        // Contacts move bodies by their gap in a step, so that an impact need not distinguish that speed from zero.
        let is_touching = [i, j]
            .iter()
            .any(|&body| !self.contacts.of_body(body).is_empty());
        let is_spent = || {
            let unseen = match is_touching {
                true => self.layout().hover_gap(i, j),
                false => self.layout().resolution_along(i, j, normal),
            };
            leaving * self.scene.settings.dt <= unseen
        };
        let is_caught = || {
            let felt = self.scene.settings.dt * self.greatest_push(i, j);
            let bounces = self.bounces_of(i, j);
            let rests = self.rests_of(i) > 0 || self.rests_of(j) > 0;
            let is_many = bounces.count >= MANY_BOUNCES;
            is_many && leaving <= SPENT * bounces.fastest
                || (is_bundled || is_many && rests) && is_short(leaving, felt)
        };
        !(restitution < 1.0 && (is_spent() || is_caught()))
    }

    /// The impacts of the one of two bodies that has had more.
    pub(super) fn bounces_of(&self, i: usize, j: usize) -> Bounces {
        let of = |body: usize| self.tallies.bounces.get(body).copied();
        let (first, second) = (of(i).unwrap_or_default(), of(j).unwrap_or_default());
        match first.count >= second.count {
            true => first,
            false => second,
        }
    }

    /// Whether the contacts of a body are bundled: it has come to rest too often in this step, or it is bundled since
    /// the last step or by its island.
    pub(super) fn is_bundled(&self, body: usize) -> bool {
        self.rests_of(body) > MANY_RESTS || self.contacts.is_bundled(body)
    }

    /// A flight shorter than this fraction of a step does not count; in a bundled island, the fraction is one.
    pub(super) fn shortest_flight(&self, is_bundled: bool) -> f64 {
        match is_bundled {
            true => 1.0,
            false => SHORTEST_FLIGHT,
        }
    }

    pub(super) fn rests_of(&self, body: usize) -> u32 {
        self.tallies.rests.get(body).copied().unwrap_or(0)
    }

    /// The speed at which bodies at rest on each other close, if forces close them by `load_speed` in a step: zero,
    /// except for the velocity stagger of a method.
    pub(super) fn unfelt(&self, load_speed: f64) -> f64 {
        load_speed * (self.paths.velocity_stagger / self.scene.settings.dt).abs()
    }
}
