//! The time of impact of two shapes that move and turn, never too late.
//!
//! A *certificate* is a direction that keeps two sets of points apart for some time: let `s` be the gap
//! along it now, `w` how fast that changes, and the second derivative of every point's place be bounded;
//! then the gap is above a parabola, and until that has its root the sets are apart (a plane lies between
//! their hulls, which a rigid motion moves with their points). `certificate` has the parabolas for
//! boxes; `separation` has directions for sets of points: triangles, points, and boxes as a whole.
//!
//! A priority queue holds pairs of boxes and of triangles, each with the time until which it is certified. The
//! search takes the pair with the least time and certifies it anew from its place at that time. Boxes for which that
//! is not worth its price are split into pairs of their children, which are looked at until the boxes may have gone
//! past each other; then the boxes come back instead, so that the cost follows what is near. Every two triangles belong
//! at every time to one pair in the queue, or to one that was certified for longer. So no contact is before the least
//! time in the queue: **a time of impact is never later than the first contact, and the answer "no contact" is
//! proven.** Triangles nearer than [`NEAR`] roundings that neither move apart nor are certified to the end are a
//! contact.
//!
//! Times come from poses at one time (`View`), in a frame at rest that then has the first shape's axes.
//! All bounds are relative: the module has no constant length or time.

mod certificate;
mod contact_set;
mod nearest;
mod pieces;
mod separation;
mod view;

use alloc::collections::BinaryHeap;
use core::cmp::Ordering;

use glam::{DQuat, DVec3};

use crate::{Bvh, rotation::Flight};
pub use contact_set::{ContactPoint, features_within, normals_within};
use pieces::{Boxed, Item, Points};
use separation::Gap;
use view::{Direction, View};

/// What moves.
#[derive(Clone, Copy, Debug)]
pub enum Figure<'a> {
    /// A mesh, by its tree.
    Mesh(&'a Bvh),
    /// A ball about the origin of its frame, of this radius, m.
    Ball(f64),
    /// All below the plane through the origin of its frame with this unit normal. It does not turn.
    HalfSpace(DVec3),
}

/// How it is turned.
#[derive(Clone, Copy, Debug)]
pub enum Turning<'a> {
    /// As this tells, always.
    Still(DQuat),
    /// On its way: the flight turns principal axes, which are `axes` in the shape's frame
    /// ([`Inertia::axes`](crate::Inertia::axes)).
    Flight(&'a Flight, DQuat),
}

/// A shape on its way: its centre of mass on a parabola, and about it a rotation.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// What moves.
    pub figure: Figure<'a>,
    /// The centre of mass in the frame of the shape, m.
    pub centre: DVec3,
    /// Where the centre of mass is at the start, m.
    pub position: DVec3,
    /// Its velocity at the start, m/s.
    pub velocity: DVec3,
    /// Its acceleration, m/s².
    pub acceleration: DVec3,
    /// How it turns.
    pub turning: Turning<'a>,
}

/// Where two shapes come together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurningTouch {
    /// When, s from the start: at or before the first contact.
    pub time: f64,
    /// How far apart they are then, m.
    pub distance: f64,
    /// No more than this, m, is a contact: 2^-46 of sizes, distance and way together. A greater distance
    /// tells that the search has ended after 2^20 pairs: until then they are apart. It takes things that whirl
    /// within each other's reach for many thousands of turns.
    pub near: f64,
    /// The points nearest each other at that time, of the first shape and of the second, as seen from the
    /// first one's centre of mass, m.
    pub points: [DVec3; 2],
    /// A unit vector from the first to the second, along which they were kept apart last.
    pub normal: DVec3,
    /// The triangles, where they are meshes.
    pub faces: [Option<u32>; 2],
}

/// What an answer has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Poses at one time.
    pub views: u32,
    /// Pairs of boxes certified.
    pub boxes: u32,
    /// Pairs of triangles, points and planes certified.
    pub pieces: u32,
}

/// Roundings of 2^-53 in which two surfaces touch; placing them is right to 16, and certificates keep 32.
pub const NEAR: f64 = 128.0;

/// No search that others may judge looks at more pairs of triangles, or at boxes again: it stops where it is, which is
/// no later than a contact.
const MOST: u32 = 1 << 20;

/// The first contact within `duration`, s; `None` proves that there is none.
///
/// Shapes that touch at the start are in contact then, unless they move apart.
pub fn first_contact(a: &Moving<'_>, b: &Moving<'_>, duration: f64) -> Option<TurningTouch> {
    first_contact_counted(a, b, duration).0
}

/// The same, with its cost.
pub fn first_contact_counted(
    a: &Moving<'_>,
    b: &Moving<'_>,
    duration: f64,
) -> (Option<TurningTouch>, Effort) {
    let exactly = Care {
        halt: 0.0,
        most: MOST,
        reach: 1.0,
    };
    first_contact_with(a, b, duration, exactly)
}

/// How a search is made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Care {
    /// Roundings that are left of a gap where shapes stop that come from afar, beside those that certificates
    /// keep: what goes on from there is rounded once more.
    pub(crate) halt: f64,
    /// Pairs of pieces that are looked at, and boxes that are again, at most.
    pub(crate) most: u32,
    /// Shapes that are no farther apart at the start than this times what is a contact lie on each other there, unless
    /// they part by more before they may be back.
    pub(crate) reach: f64,
}

impl Care {
    /// For what goes on from the contact.
    pub(crate) const TO_GO_ON: Care = Care {
        halt: 64.0,
        most: 1 << 12,
        reach: 1.0,
    };
}

/// The same, made with some care.
pub(crate) fn first_contact_with(
    a: &Moving<'_>,
    b: &Moving<'_>,
    duration: f64,
    care: Care,
) -> (Option<TurningTouch>, Effort) {
    let mut effort = Effort::default();
    let touch = match (&a.figure, &b.figure) {
        (Figure::HalfSpace(_), Figure::HalfSpace(_)) => None,
        (_, Figure::HalfSpace(_)) => search(b, a, duration, care, &mut effort).map(|touch| {
            let [first, second] = touch.points;
            let between = b.place(touch.time) - a.place(touch.time);
            TurningTouch {
                points: [second + between, first + between],
                normal: -touch.normal,
                faces: [touch.faces[1], touch.faces[0]],
                ..touch
            }
        }),
        _ => search(a, b, duration, care, &mut effort),
    };
    (touch, effort)
}

impl Moving<'_> {
    /// Where the centre of mass is at a time, m.
    fn place(&self, t: f64) -> DVec3 {
        self.position + t * (self.velocity + 0.5 * t * self.acceleration)
    }

    /// Turns the shape's frame into the world at a time.
    pub fn rotation_at(&self, t: f64) -> DQuat {
        match self.turning {
            Turning::Still(rotation) => rotation,
            Turning::Flight(flight, axes) => flight.rotation_at(t) * axes.inverse(),
        }
    }

    /// Where the origin of the shape's frame is at a time, m.
    pub fn origin_at(&self, t: f64) -> DVec3 {
        self.place(t) - self.rotation_at(t) * self.centre
    }
}

/// A pair that is apart until a time, and is looked at from there until another one: then it belongs to a pair of
/// greater boxes again.
struct Entry {
    time: f64,
    until: f64,
    a: Item,
    b: Item,
}

impl Entry {
    /// The same pair by the faces of whole boxes.
    fn opened(self, roots: &[Boxed; 2]) -> Entry {
        let open = |item: Item, root: &Boxed| match item {
            Item::Cuboid => root.item,
            _ => item,
        };
        Entry {
            a: open(self.a, &roots[0]),
            b: open(self.b, &roots[1]),
            ..self
        }
    }
}

impl Ord for Entry {
    /// The greatest is the one with the least time.
    fn cmp(&self, other: &Entry) -> Ordering {
        let pair = (self.a, self.b).cmp(&(other.a, other.b));
        other.time.total_cmp(&self.time).then(pair)
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Entry) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Entry) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// Whether two shapes are certainly apart for a time, s, however they turn.
pub(crate) fn stay_apart(a: &Moving<'_>, b: &Moving<'_>, end: f64) -> bool {
    let only = match (a.figure, b.figure) {
        (Figure::HalfSpace(normal), _) => Some(normal),
        (_, Figure::HalfSpace(normal)) => Some(-normal),
        _ => None,
    };
    certificate::balls_apart(a, b, only) >= end
}

fn search(
    a: &Moving<'_>,
    b: &Moving<'_>,
    end: f64,
    care: Care,
    effort: &mut Effort,
) -> Option<TurningTouch> {
    let only = match a.figure {
        Figure::HalfSpace(normal) => Some(normal),
        _ => None,
    };
    let mut search = Search {
        bodies: [a, b],
        end,
        only,
        care,
        effort,
        returns: 0,
    };
    let (whole_a, whole_b) = (Item::whole(a), Item::whole(b));
    let roots = [Boxed::root(a), Boxed::root(b)];
    let (mut now, mut apart, mut hint) = (0.0, true, None);
    // Two sets need no queue.
    while apart && whole_a.is_set() && whole_b.is_set() {
        let view = search.view(now);
        if now == 0.0 && search.apart_to_end(&view, &view.directions(), &roots) {
            return None;
        }
        match search.advance(&view, (whole_a, whole_b), end, hint) {
            Next::Apart => return None,
            Next::Later(time, along) => (now, hint) = (time, Some(along)),
            Next::Contact(touch) => return Some(touch),
            Next::Untold => apart = false,
        }
    }
    let first = match apart {
        true => (whole_a, whole_b),
        // What is within a box, or too near it to tell, is looked at face by face.
        false => (roots[0].item, roots[1].item),
    };
    search.in_boxes(now, first, &roots)
}

/// A search, and what it has cost so far.
struct Search<'a, 'b> {
    bodies: [&'a Moving<'a>; 2],
    end: f64,
    only: Option<DVec3>,
    care: Care,
    effort: &'b mut Effort,
    /// How often a pair of boxes has come back into the queue.
    returns: u32,
}

/// What becomes of two sets.
enum Next {
    /// They stay apart to the end.
    Apart,
    /// They are apart until then, by a direction in the world.
    Later(f64, DVec3),
    Contact(TurningTouch),
    /// No direction has them on either side, of which one is a box.
    Untold,
}

impl Search<'_, '_> {
    fn view(&mut self, time: f64) -> View {
        self.effort.views += 1;
        View::new(self.bodies[0], self.bodies[1], time, self.end)
    }

    /// Whether so many pairs have been looked at that the search ends where it is: boxes do not come back from then on,
    /// so it gets to some pieces.
    fn is_spent(&self) -> bool {
        self.effort.pieces + self.returns >= self.care.most
    }

    /// Whether the boxes around both shapes tell that they stay apart.
    fn apart_to_end(
        &mut self,
        view: &View,
        directions: &[Direction; 6],
        roots: &[Boxed; 2],
    ) -> bool {
        self.effort.boxes += 1;
        let [a, b] = roots;
        view.boxes_apart(directions, [a, b], self.only) >= view.left
    }

    /// What becomes of two sets from the time of a view on. A direction in the world may be known that has kept them
    /// apart before.
    fn advance(
        &mut self,
        view: &View,
        (a, b): (Item, Item),
        end: f64,
        hint: Option<DVec3>,
    ) -> Next {
        self.effort.pieces += 1;
        let (first, second) = (Points::of(self.bodies[0], a), Points::of(self.bodies[1], b));
        let reach = if view.time == 0.0 {
            self.care.reach
        } else {
            1.0
        };
        let hint = hint.map(|hint| view.axes.inverse() * hint);
        let known = (self.only, hint);
        let gap = view.sets_apart(&first, &second, known, (self.care.halt, reach));
        let is_box = a == Item::Cuboid || b == Item::Cuboid;
        if !gap.is_apart && is_box && self.only.is_none() {
            return Next::Untold;
        }
        let until = view.time + gap.lasts;
        if until >= end {
            return Next::Apart;
        }
        // Without a proof for any time, and where they are near and come nearer.
        let is_contact = until <= view.time || gap.distance <= gap.near && !gap.opens;
        // Nor do they part at the start by more than that before they may be back.
        let farthest = gap.distance + gap.parting.max(0.0) * gap.lasts;
        let is_lying = reach > 1.0 && farthest <= reach * gap.near;
        match is_contact || is_lying || self.is_spent() {
            true => Next::Contact(touch(view, &gap)),
            false => Next::Later(until, view.axes * gap.normal),
        }
    }

    /// The first contact of what is in two boxes from a time on.
    fn in_boxes(
        &mut self,
        from: f64,
        first: (Item, Item),
        roots: &[Boxed; 2],
    ) -> Option<TurningTouch> {
        let mut view = self.view(from);
        let mut directions = view.directions();
        if self.apart_to_end(&view, &directions, roots) {
            return None;
        }
        let mut queue = BinaryHeap::new();
        queue.push(Entry {
            time: from,
            until: self.end,
            a: first.0,
            b: first.1,
        });
        while let Some(entry) = queue.pop() {
            let now = entry.time;
            let [a, b] = self.bodies;
            let (of_a, of_b) = (Boxed::within(a, entry.a), Boxed::within(b, entry.b));
            let both = [&of_a.around(entry.a), &of_b.around(entry.b)];
            let are_sets = entry.a.is_set() && entry.b.is_set();
            // What is within them is looked at until they may have gone past each other, and then they themselves are.
            let is_spent = self.is_spent();
            let passed = now + view.passing(both);
            let until = match passed > now && !is_spent {
                true => entry.until.min(passed),
                false => entry.until,
            };
            // Boxes take a view that is not much older than they are.
            let short = RENEW * (until - now);
            if now - view.time > if are_sets { 0.0 } else { short } {
                view = self.view(now);
                directions = view.directions();
            }
            self.effort.boxes += 1;
            let time = view.time + view.boxes_apart(&directions, both, self.only);
            if time >= entry.until {
                continue;
            }
            if time > now + short && !is_spent {
                self.returns += 1;
                queue.push(Entry { time, ..entry });
                continue;
            }
            if are_sets {
                // Whether they lie on each other at the start is told by all that is left.
                let end = if now == 0.0 { self.end } else { entry.until };
                view.left = end - now;
                match self.advance(&view, (entry.a, entry.b), end, None) {
                    Next::Apart => (),
                    Next::Later(time, _) if time >= entry.until => (),
                    Next::Later(time, _) => queue.push(Entry { time, ..entry }),
                    Next::Contact(touch) => return Some(touch),
                    Next::Untold => queue.push(entry.opened(roots)),
                }
                continue;
            }
            for a in of_a.iter() {
                for b in of_b.iter() {
                    self.effort.boxes += 1;
                    let lasts = view.boxes_apart(&directions, [a, b], self.only);
                    let time = (view.time + lasts).max(now);
                    if time < until {
                        let (a, b) = (a.item, b.item);
                        queue.push(Entry { time, until, a, b });
                    }
                }
            }
            if until < entry.until {
                self.returns += 1;
                let time = until;
                queue.push(Entry { time, ..entry });
            }
        }
        None
    }
}

/// Part of the time for which boxes are looked at after which they get new poses, and for which a certificate of theirs
/// is worth its price. It changes cost only.
const RENEW: f64 = 0.25;

fn touch(view: &View, gap: &Gap) -> TurningTouch {
    TurningTouch {
        time: view.time,
        distance: gap.distance,
        near: gap.near,
        points: gap.points.map(|point| view.axes * point),
        normal: view.axes * gap.normal,
        faces: gap.faces,
    }
}
