//! The time of impact of two shapes that move and turn, never too late.
//!
//! A *certificate* is a direction that keeps two sets of points apart for a proven time. Let `s` be the gap along this
//! direction now and `w` its rate of change, and let the second derivative of the position of every point be bounded.
//! Then a parabola is a lower bound on the gap. Until the first root of the parabola the sets are apart: a plane lies
//! between their convex hulls, which a rigid motion moves with their points. `certificate` has the parabolas for
//! boxes. `separation` has directions for sets of points: triangles, single points, and boxes as a whole.
//!
//! A priority queue holds pairs of boxes and of triangles, each with the time until which it is certified. The search
//! takes the pair with the least time and certifies it anew from its pose at that time. If the certificate of a pair
//! of boxes is too short to be worth its cost, the search splits the pair into pairs of their children. The children
//! are searched only until the boxes may have moved past each other; then the pair of boxes returns to the queue, so
//! that the cost follows the pairs that are near. At every time every two triangles belong to exactly one pair in the
//! queue, or to a pair that was certified for longer. So no contact is before the least time in the queue: **a time
//! of impact is never later than the first contact, and the answer "no contact" is proven.** Triangles nearer than
//! [`NEAR`] roundings are a contact, unless they move apart or are certified to the end.
//!
//! Each time is computed from the poses at one time (`View`), in a frame at rest with the axes that the first shape
//! has at that time. All bounds are relative: the module has no constant length or time.

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

/// The geometry of a moving shape.
#[derive(Clone, Copy, Debug)]
pub enum Figure<'a> {
    /// A mesh, by its tree.
    Mesh(&'a Bvh),
    /// A ball about the origin of its frame, of this radius, m.
    Ball(f64),
    /// The half-space below the plane through the origin of its frame with this unit normal. It does not turn.
    HalfSpace(DVec3),
}

/// The rotation of a shape over time.
#[derive(Clone, Copy, Debug)]
pub enum Turning<'a> {
    /// This rotation at all times.
    Still(DQuat),
    /// Free flight. The flight turns the principal axes; the quaternion is their rotation in the shape's frame
    /// ([`Inertia::axes`](crate::Inertia::axes)).
    Flight(&'a Flight, DQuat),
}

/// A moving shape: its centre of mass follows a parabola, and the shape rotates about it.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// The geometry.
    pub figure: Figure<'a>,
    /// The centre of mass in the frame of the shape, m.
    pub centre: DVec3,
    /// The centre of mass at the start, m.
    pub position: DVec3,
    /// The velocity of the centre of mass at the start, m/s.
    pub velocity: DVec3,
    /// The acceleration of the centre of mass, m/s².
    pub acceleration: DVec3,
    /// The rotation about the centre of mass.
    pub turning: Turning<'a>,
}

/// The contact of two moving shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurningTouch {
    /// The time of the contact, s from the start: at or before the first contact.
    pub time: f64,
    /// The distance of the shapes at that time, m.
    pub distance: f64,
    /// The greatest distance that counts as a contact, m: 2^-46 of sizes, distance and path together. A greater
    /// `distance` shows that the search stopped after 2^20 pairs; the shapes are apart until `time`. This happens
    /// only to shapes that spin within each other's reach for many thousands of turns.
    pub near: f64,
    /// The nearest points at that time, of the first shape and of the second, relative to the first centre of mass, m.
    pub points: [DVec3; 2],
    /// Unit vector from the first shape to the second: the direction that separated them last.
    pub normal: DVec3,
    /// The triangles in contact; `None` for a shape that is not a mesh.
    pub faces: [Option<u32>; 2],
}

/// The cost of an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Number of times at which both poses were computed.
    pub views: u32,
    /// Pairs of boxes certified.
    pub boxes: u32,
    /// Pairs of triangles, points and planes certified.
    pub pieces: u32,
}

/// Two surfaces touch within this many roundings of 2^-53. Placing them has an error of up to 16 of these, and
/// certificates keep 32.
pub const NEAR: f64 = 128.0;

/// The most pairs of triangles, and returns of boxes to the queue, in a search whose result is visible outside. The
/// search then stops at the time that it has reached, which is no later than a contact.
const MOST: u32 = 1 << 20;

/// The first contact within `duration`, s; `None` proves that there is none.
///
/// Shapes that touch at the start are in contact then, unless they move apart.
pub fn first_contact(a: &Moving<'_>, b: &Moving<'_>, duration: f64) -> Option<TurningTouch> {
    first_contact_counted(a, b, duration).0
}

/// `first_contact`, and its cost.
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

/// Limits and tolerances of a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Care {
    /// Where approaching shapes stop: this many roundings of gap remain, beside those that certificates keep. The
    /// motion that starts there is rounded once more.
    pub(crate) halt: f64,
    /// The most pairs of pieces, and returns of boxes to the queue, in a search.
    pub(crate) most: u32,
    /// At the start, shapes no farther apart than this times the distance of a contact rest on each other, unless they
    /// part by more before they may come back.
    pub(crate) reach: f64,
}

impl Care {
    /// For shapes that move on from the contact.
    pub(crate) const TO_GO_ON: Care = Care {
        halt: 64.0,
        most: 1 << 12,
        reach: 1.0,
    };
}

/// `first_contact` with given limits and tolerances.
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
    /// The position of the centre of mass at a time, m.
    fn place(&self, t: f64) -> DVec3 {
        self.position + t * (self.velocity + 0.5 * t * self.acceleration)
    }

    /// The rotation from the shape's frame into the world at a time.
    pub fn rotation_at(&self, t: f64) -> DQuat {
        match self.turning {
            Turning::Still(rotation) => rotation,
            Turning::Flight(flight, axes) => flight.rotation_at(t) * axes.inverse(),
        }
    }

    /// The position of the origin of the shape's frame at a time, m.
    pub fn origin_at(&self, t: f64) -> DVec3 {
        self.place(t) - self.rotation_at(t) * self.centre
    }
}

/// A pair that is certified until `time` and has to be searched from `time` to `until`. From `until` on a pair of
/// larger boxes covers it.
struct Entry {
    time: f64,
    until: f64,
    a: Item,
    b: Item,
}

impl Entry {
    /// The same pair, with the faces of a cuboid in place of the cuboid as a whole.
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
    /// The entry with the least time is the greatest.
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

/// Whether two shapes are certainly apart for a time, s, for any rotation.
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
    // Two sets of points need no queue.
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
        // No direction separates the sets: one is inside a box, or too near it. The faces of the box are searched one
        // by one.
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

/// The result of one certificate for two sets.
enum Next {
    /// They stay apart to the end.
    Apart,
    /// They are apart until this time, separated by this direction in the world.
    Later(f64, DVec3),
    Contact(TurningTouch),
    /// One of the sets is a box, and no direction separates them.
    Untold,
}

impl Search<'_, '_> {
    fn view(&mut self, time: f64) -> View {
        self.effort.views += 1;
        View::new(self.bodies[0], self.bodies[1], time, self.end)
    }

    /// Whether the search has reached its limit of pairs and ends where it is. From then on boxes do not return to the
    /// queue, so that the search reaches some pieces.
    fn is_spent(&self) -> bool {
        self.effort.pieces + self.returns >= self.care.most
    }

    /// Whether the bounding boxes of both shapes prove that they stay apart.
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

    /// Certifies two sets from the time of a view on. `hint` is a direction in the world that has separated them
    /// before, if one is known.
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
        // A contact: no certificate lasts for any time, or the sets are near and approach.
        let is_contact = until <= view.time || gap.distance <= gap.near && !gap.opens;
        // Resting: before they may come back, they part by no more than `reach` times the distance of a contact.
        let farthest = gap.distance + gap.parting.max(0.0) * gap.lasts;
        let is_lying = reach > 1.0 && farthest <= reach * gap.near;
        match is_contact || is_lying || self.is_spent() {
            true => Next::Contact(touch(view, &gap)),
            false => Next::Later(until, view.axes * gap.normal),
        }
    }

    /// The first contact of the contents of two boxes from a time on.
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
            // The children are searched until the boxes may have moved past each other; then the pair of boxes returns.
            let is_spent = self.is_spent();
            let passed = now + view.passing(both);
            let until = match passed > now && !is_spent {
                true => entry.until.min(passed),
                false => entry.until,
            };
            // The view for boxes may be older than the entry by a part of the time that is left to search.
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
                // Whether shapes rest on each other at the start depends on all the time that is left.
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

/// A view older than this part of the time that is left to search is renewed, and a certificate of boxes shorter than
/// this part is not worth its cost. Changes the cost only.
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
