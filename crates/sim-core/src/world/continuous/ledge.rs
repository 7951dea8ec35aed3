//! Ledges that are only rounding: tiles that are level except for the last bit of their vertices.
//!
//! Vertices are f32, so that the tops of two bodies that are meant to be level differ by some parts in 10^7. A body
//! that slides from the lower one to the higher one would stop there. If a sliding body is stopped by a ledge no
//! higher than that rounding, and would lie on it, it is lifted onto it with all bodies that lie on it. This acts as
//! a ramp of no length. The lift costs the energy that the weight gains, and a body without so much kinetic energy is
//! stopped after all.

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

use super::super::stepping::Cause;
use super::{
    contact_set::ContactConstraint,
    event::{Event, EventKind},
    event_loop::EventLoop,
    island::Visited,
    view::View,
};
use crate::collide::{first_contact, meet, snap};

/// The greatest difference of the normals of surfaces that are level except for the rounding of their vertices.
const LEVEL: f64 = 1e-6;

/// The number of lifts that are tried, each twice as high as the one before.
const LIFTS: i32 = 8;

/// The greatest number of times that a body is lifted in a step; the next ledge stops it.
const MOST_CLIMBS: u32 = 16;

/// A body that slides onto a ledge.
struct Slide {
    body: usize,
    ledge: usize,
    /// The contact that it slides on.
    constraint: ContactConstraint,
    /// The direction away from the surface below.
    up: DVec3,
    /// Its velocity along the ledge, m/s.
    along: DVec3,
    /// The highest ledge that rounding explains, m.
    most: f64,
}

impl EventLoop<'_> {
    /// Lifts a sliding body onto a ledge of rounding, if the event is an impact with such a ledge. Returns whether it
    /// has.
    pub(super) fn climb(
        &mut self,
        event: &Event,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<bool, (usize, Cause)> {
        let (i, j) = event.bodies;
        if event.kind != EventKind::Impact {
            return Ok(false);
        }
        for (body, ledge) in [(i, j), (j, i)] {
            for place in 0..self.solver.contacts.of_body(body).len() {
                let index = self.solver.contacts.of_body(body)[place] as usize;
                if let Some(slide) = self.view().slide_onto(event, body, ledge, index)
                    && self.lift(&slide, time, restarted)?
                {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Lifts a body onto a ledge, if the ledge is no higher than rounding. Returns whether it has.
    fn lift(
        &mut self,
        slide: &Slide,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<bool, (usize, Cause)> {
        let Some(forward) = slide.along.try_normalize() else {
            return Ok(false);
        };
        let (up, most) = (slide.up, slide.most);
        let pair = (slide.body.min(slide.ledge), slide.body.max(slide.ledge));
        let hover = self.view().layout().hover_gap(pair.0, pair.1);
        let Some(forms) = self
            .solver
            .scene
            .bodies
            .form(pair.0)
            .zip(self.solver.scene.bodies.form(pair.1))
        else {
            return Ok(false);
        };
        let sign = if slide.body == pair.1 { 1.0 } else { -1.0 };
        let start = &self.solver.paths.start;
        let offset = start.position[pair.1] - start.position[pair.0];
        // Far enough that a round body is over the ledge.
        let size = self.solver.scene.bodies.extent(slide.body).half;
        let far = 4.0 * libm::sqrt(most * size) + 4.0 * most + 64.0 * hover;
        let is_free = |lift: f64| {
            let from = offset + sign * lift * up;
            let way = sign * far * forward;
            first_contact(forms.0, forms.1, snap(from), snap(way)).is_none()
        };
        let lifts = (0..LIFTS).map(|k| most * libm::ldexp(1.0, k + 1 - LIFTS));
        let Some(lift) = lifts
            .into_iter()
            .map(|lift| lift + hover)
            .find(|&lift| is_free(lift))
        else {
            return Ok(false);
        };
        // A little onto the ledge, and down to it.
        let onto = 4.0 * hover * forward;
        let level = ContactConstraint {
            bodies: pair,
            normal: sign * up,
            ahead: None,
            ..slide.constraint
        };
        let reach = lift + 8.0 * hover;
        let level_at = |ahead: DVec3| {
            let surface =
                self.view()
                    .surface_below(&level, offset + sign * (lift * up + ahead), reach);
            surface.filter(|surface| (surface.normal - level.normal).length() <= LEVEL)
        };
        if let Some(surface) = level_at(onto) {
            let lift = lift - surface.distance + hover;
            return self.raise(slide, lift, lift * up + onto, time, restarted);
        }
        // A round or pointed body is not over the ledge yet.
        match level_at(far * forward) {
            Some(_) => self.raise(slide, lift, lift * up, time, restarted),
            None => Ok(false),
        }
    }

    /// Displaces a body and its whole island, unless they would meet other bodies, and slows the body down by the
    /// energy that this takes.
    fn raise(
        &mut self,
        slide: &Slide,
        lift: f64,
        by: DVec3,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<bool, (usize, Cause)> {
        let (slider, up) = (slide.body, slide.up);
        let mut visited = Visited::default();
        visited.begin(self.solver.scene.bodies.len());
        let Some(island) = self.view().island_of(slider, &mut visited) else {
            return Ok(false);
        };
        let applied = &self.solver.paths.applied_acceleration;
        let weight = |&body: &usize| -self.solver.scene.bodies.mass[body] * applied[body].dot(up);
        let work = lift * island.bodies.iter().map(weight).sum::<f64>();
        let squared = slide.along.length_squared();
        let left = squared - 2.0 * work.max(0.0) / self.solver.scene.bodies.mass[slider];
        let climbs = self.solver.tallies.climbs.get(slider).copied().unwrap_or(0);
        if visited.has(slide.ledge) || left <= 0.0 || climbs == MOST_CLIMBS {
            return Ok(false);
        }
        for &body in &island.bodies {
            self.solver.restart(body, time, restarted)?;
        }
        let mut partners = Vec::new();
        for &body in &island.bodies {
            let broad = &self.solver.near.broad;
            broad.each_partner(body, |other| partners.push((body, other)));
        }
        partners.retain(|&(_, other)| !visited.has(other));
        let mut probe = mem::take(&mut self.solver.paths.probe);
        let mut is_blocked = Ok(false);
        for (body, other) in partners {
            if !self
                .solver
                .scene
                .may_collide(body.min(other), body.max(other))
            {
                continue;
            }
            self.solver.scene.bodies.need_bvh(other);
            is_blocked = self
                .view()
                .motion()
                .motion_at(other, time, &mut probe)
                .map(|(at, _)| {
                    let from = self.solver.paths.start.position[body] - at;
                    self.view()
                        .is_stopped(body, other, from, [lift * up, by - lift * up])
                });
            if !matches!(is_blocked, Ok(false)) {
                break;
            }
        }
        self.solver.paths.probe = probe;
        if is_blocked? {
            return Ok(false);
        }
        for &body in &island.bodies {
            self.solver.paths.start.position[body] += by;
        }
        let bodies = self.solver.scene.bodies.len();
        self.solver.tallies.climbs.resize(bodies, 0);
        self.solver.tallies.climbs[slider] += 1;
        let slower = libm::sqrt(left / squared);
        self.solver.paths.start.velocity[slider] += (slower - 1.0) * slide.along;
        self.solver.hand_over(&slide.constraint)?;
        Ok(true)
    }
}

impl View<'_> {
    /// How a body slides on one of its contacts onto the body with which it has an impact, if that rises from the
    /// surface by no more than rounding at their contact point.
    fn slide_onto(&self, event: &Event, body: usize, ledge: usize, index: usize) -> Option<Slide> {
        let constraint = self.contacts.all()[index];
        let (i, j) = constraint.bodies;
        let (up, floor) = match body == j {
            true => (constraint.normal, i),
            false => (-constraint.normal, j),
        };
        let normal = match body == event.bodies.1 {
            true => event.contact.normal,
            false => -event.contact.normal,
        };
        if !self.scene.bodies.is_movable(body)
            || constraint.is_overlap
            || (normal - up).length() <= LEVEL
        {
            return None;
        }
        let start = &self.paths.start;
        let touched = start.position[i] + constraint.point;
        let of = |body: usize, point: DVec3| (point - start.position[body]).dot(up).abs();
        let point = event.contact.point;
        let most = f64::from(f32::EPSILON) * (of(floor, touched) + of(ledge, point));
        // An impact below the surface is not one with a ledge.
        if (point - touched).dot(up).abs() > most {
            return None;
        }
        let relative = start.velocity[body] - start.velocity[ledge];
        Some(Slide {
            body,
            ledge,
            constraint,
            up,
            along: relative - relative.dot(up) * up,
            most,
        })
    }

    /// Whether a body meets another one on a path of two parts from an offset. The path is searched, and not only its
    /// end, because points and sheets would be missed there.
    fn is_stopped(&self, body: usize, other: usize, from: DVec3, parts: [DVec3; 2]) -> bool {
        let Some((other, body)) = self.scene.bodies.forms(other, body) else {
            return false;
        };
        let mut at = from;
        for part in parts {
            if first_contact(other, body, snap(at), snap(part)).is_some() {
                return true;
            }
            at += part;
        }
        meet(other, body, snap(at))
    }
}
