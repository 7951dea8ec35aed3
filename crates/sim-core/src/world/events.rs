//! Contacts that begin, persist or end in a step, by pairs of bodies.

use alloc::{boxed::Box, vec::Vec};
use glam::DVec3;

use super::{Impact, World};

/// A change of the contact of two bodies in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactEvent {
    /// Whether the contact begins, persists or ends.
    pub kind: ContactEventKind,
    /// The bodies, the lower index first.
    pub bodies: (usize, usize),
    /// Unit normal, from the first body to the second; for several contacts that of the one with the greatest
    /// impulse.
    pub normal: DVec3,
    /// The point where they touch, or touched last, m.
    pub point: DVec3,
    /// Impulse on the second body from the first in the step, N s. It is the sum of the impulses of impacts along their
    /// normals, of those that have stopped bodies in contact, and of the force of lasting contacts
    /// ([`RestingContact::force`](super::RestingContact::force)), with friction, times their duration in
    /// the step. It does not include friction in an impact, and if forces change within a step it uses the force of the
    /// last solution. If two events in a step have the same bodies, the first has the whole impulse.
    pub impulse: DVec3,
}

/// How a contact can change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEventKind {
    /// The bodies were not in contact when the step began, and came into contact in it: they had an impact, or came to
    /// rest on each other.
    Begun,
    /// They were in contact when the step began, and still are.
    Persisting,
    /// They were in contact, and no longer are. A bounce both begins and ends a contact.
    Ended,
}

/// The events of the last step, and the data for those of the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    /// Impacts since the step began.
    pub(super) impacts: Vec<Push>,
    /// Contacts after the step.
    now: Vec<Push>,
    /// For each pair in contact before the step, the contact that counts; and memory for those after it.
    before: Vec<Push>,
    next: Vec<Push>,
    events: Vec<ContactEvent>,
}

/// An impact, a contact, or all contacts of two bodies together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push {
    bodies: (usize, usize),
    /// Its place in the order of events.
    order: usize,
    /// The time, s.
    time: f64,
    normal: DVec3,
    point: DVec3,
    /// The impulse on the second body, N s.
    impulse: DVec3,
    /// The force of a lasting contact, N.
    force: DVec3,
}

impl Events {
    /// Removes the impacts of a failed step.
    pub(super) fn begin(&mut self) {
        self.impacts.clear();
    }

    pub(super) fn note(&mut self, impact: &Impact) {
        let (i, j) = impact.bodies;
        let normal = if i < j { impact.normal } else { -impact.normal };
        self.impacts.push(Push {
            bodies: (i.min(j), i.max(j)),
            order: self.impacts.len(),
            time: impact.time,
            normal,
            point: impact.point,
            impulse: impact.impulse * normal,
            force: DVec3::ZERO,
        });
    }

    /// Lists the events of a step that begins at a time (s) and lasts `dt`, pair by pair in order.
    fn list(&mut self, start: f64, dt: f64) {
        self.events.clear();
        let key = |push: &Push| (push.bodies, push.order);
        self.impacts.sort_unstable_by_key(key);
        self.now.sort_unstable_by_key(key);
        let (mut impacts, mut now, mut before) =
            (&self.impacts[..], &self.now[..], &self.before[..]);
        self.next.clear();
        loop {
            let next = [impacts.first(), now.first(), before.first()];
            let Some(bodies) = next.into_iter().flatten().map(|push| push.bodies).min() else {
                break;
            };
            let [impacts, contacts, was] =
                [&mut impacts, &mut now, &mut before].map(|list| take(list, bodies));
            let was = was.first();
            let mut impulse: DVec3 = impacts.iter().map(|impact| impact.impulse).sum();
            // A contact that began in the step has lasted since the last impact of the pair.
            let since = impacts.last().filter(|_| was.is_none());
            let lasted = since.map_or(dt, |impact| (start + dt - impact.time).clamp(0.0, dt));
            for contact in contacts {
                impulse += lasted * contact.force;
                // The impact that brought it to rest already includes this impulse.
                if impacts.is_empty() {
                    impulse += contact.impulse;
                }
            }
            let greatest = |list: &[Push]| {
                let size = |push: &Push| {
                    push.impulse.length_squared() + (dt * push.force).length_squared()
                };
                let greater = |one: Push, other: &Push| {
                    if size(other) > size(&one) {
                        *other
                    } else {
                        one
                    }
                };
                let (first, rest) = list.split_first()?;
                Some(rest.iter().fold(*first, greater))
            };
            let contact = greatest(contacts);
            let event = |kind, at: &Push, impulse| ContactEvent {
                kind,
                bodies,
                normal: at.normal,
                point: at.point,
                impulse,
            };
            match (was, contact) {
                (Some(_), Some(now)) => {
                    self.events
                        .push(event(ContactEventKind::Persisting, &now, impulse));
                }
                (None, Some(now)) => {
                    self.events
                        .push(event(ContactEventKind::Begun, &now, impulse))
                }
                (Some(was), None) => {
                    let last = impacts.last().unwrap_or(was);
                    self.events
                        .push(event(ContactEventKind::Ended, last, impulse));
                }
                (None, None) => {
                    if let Some((first, last)) = greatest(impacts).zip(impacts.last()) {
                        self.events
                            .push(event(ContactEventKind::Begun, &first, impulse));
                        self.events
                            .push(event(ContactEventKind::Ended, last, DVec3::ZERO));
                    }
                }
            }
            self.next.extend(contact);
        }
        core::mem::swap(&mut self.before, &mut self.next);
    }
}

/// Takes the entries of two bodies from the front of a list.
fn take<'a>(list: &mut &'a [Push], bodies: (usize, usize)) -> &'a [Push] {
    let count = list.iter().take_while(|push| push.bodies == bodies).count();
    let (taken, rest) = list.split_at(count);
    *list = rest;
    taken
}

impl World {
    /// Starts or stops the list of contacts that begin, persist and end, from the next step on. Contacts that exist
    /// now persist. The list does not change the results of steps.
    pub fn list_contact_events(&mut self, is_listed: bool) {
        let is_known = self.record.events.is_some();
        if !is_listed {
            self.record.events = None;
        } else if !is_known {
            let mut events = Box::new(Events::default());
            self.note_contacts(&mut events);
            events.list(self.time(), self.settings.dt);
            events.events.clear();
            self.record.events = Some(events);
        }
    }

    /// The contact events of the last step, by pairs in order of their indices, as long as
    /// [`World::list_contact_events`] is on. If a pair touched and parted in the step, its begin comes first.
    /// Outside of [`Collision::Continuous`](super::Collision::Continuous) no contact lasts.
    ///
    /// The number of contacts that have begun and not ended is the number of pairs in [`World::contacts`]. Events
    /// allocate only until there is room for those of a step.
    ///
    /// ```
    /// # use sim_core::{Body, ContactEventKind, DVec3, Settings, Shape, World};
    /// let mut world = World::new(Settings::default())?;
    /// let shape = Some(Shape::Sphere { radius: 0.5 });
    /// world.add(Body { shape: shape.clone(), ..Body::default() })?;
    /// world.add(Body { shape, position: 1.5 * DVec3::X, velocity: -DVec3::X, ..Body::default() })?;
    /// world.list_contact_events(true);
    /// while world.contact_events().is_empty() {
    ///     world.step()?;
    /// }
    /// let [begun, ended] = world.contact_events() else { panic!("they bounce") };
    /// assert_eq!((begun.kind, ended.kind), (ContactEventKind::Begun, ContactEventKind::Ended));
    /// assert_eq!((begun.bodies, begun.normal, begun.impulse), ((0, 1), DVec3::X, DVec3::X));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contact_events(&self) -> &[ContactEvent] {
        self.record
            .events
            .as_ref()
            .map_or(&[], |events| &events.events)
    }

    /// Lists the events of a completed step.
    #[cold]
    pub(super) fn list_events(&mut self) {
        if let Some(mut events) = self.record.events.take() {
            self.note_contacts(&mut events);
            let dt = self.settings.dt;
            events.list(self.time() - dt, dt);
            self.record.events = Some(events);
        }
    }

    fn note_contacts(&self, events: &mut Events) {
        let all = self.contacts.all().iter().zip(self.contacts());
        let pushes = all.enumerate().map(|(order, (constraint, contact))| Push {
            bodies: contact.bodies,
            order,
            time: self.time(),
            normal: contact.normal,
            point: contact.point,
            impulse: constraint.impulse * contact.normal,
            force: contact.force,
        });
        events.now.clear();
        events.now.extend(pushes);
    }
}
