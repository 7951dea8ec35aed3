//! A body under a constant force that bounces off immovable bodies: parabolas from impact to impact.

use sim_core::DVec3;

/// The number of impacts after which one call gives up.
const MOST_IMPACTS: u32 = 200_000;
/// Lengths below this fraction of the coordinates are rounding errors.
const ROUNDING: f64 = 1e-9;
/// A flight shorter than this fraction of the time since the start counts as rest.
const REST: f64 = 1e-13;

/// A plane that the body's origin cannot pass: the positions of the origin where the surfaces touch.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// A point of it at the start, m, and its steady velocity, m/s.
    pub(super) place: DVec3,
    pub(super) velocity: DVec3,
    /// Unit normal, towards the body.
    pub(super) normal: DVec3,
    /// The extent of the face from `place` along each axis, m: a lower and an upper bound. Along the normal both are
    /// infinite.
    pub(super) sure: DVec3,
    pub(super) most: DVec3,
    /// The coefficient of restitution.
    pub(super) restitution: f64,
    /// Whether friction acts; the known path then ends at the impact.
    pub(super) rough: bool,
}

/// A parabola with its start time, s.
#[derive(Clone, Copy, Debug)]
struct Flight {
    time: f64,
    place: DVec3,
    velocity: DVec3,
    push: DVec3,
    /// The face on which the body slides.
    on: Option<usize>,
}

/// The path up to the present time.
#[derive(Clone, Debug)]
pub(super) struct Bounce {
    first: Flight,
    now: Flight,
    faces: Vec<Face>,
    push: DVec3,
    /// The time at which the path is no longer known, s.
    end: f64,
}

impl Bounce {
    /// A path from a position, m, with a velocity, m/s, and a constant acceleration, m/s².
    pub(super) fn new(place: DVec3, velocity: DVec3, push: DVec3, faces: Vec<Face>) -> Self {
        let flight = Flight {
            time: 0.0,
            place,
            velocity,
            push,
            on: None,
        };
        Self {
            first: flight,
            now: flight,
            faces,
            push,
            end: f64::INFINITY,
        }
    }

    /// Position and velocity at `time` after the start, s; `None` once they are no longer known.
    pub(super) fn at(&mut self, time: f64) -> Option<(DVec3, DVec3)> {
        if time >= self.end {
            return None;
        }
        if time < self.now.time {
            self.now = self.first;
        }
        for _ in 0..MOST_IMPACTS {
            match self.next_impact(time) {
                None => return Some(self.now.at(time)),
                Some((when, face)) => {
                    if !self.hit(when, face) {
                        self.end = when;
                        return None;
                    }
                }
            }
        }
        self.end = self.now.time;
        None
    }

    /// The first impact before `time`, if there is one: its time and face.
    fn next_impact(&self, time: f64) -> Option<(f64, usize)> {
        let hits = self.faces.iter().enumerate().filter_map(|(n, face)| {
            if self.now.on == Some(n) {
                return None;
            }
            let after = self.time_to(face)?;
            let when = self.now.time + after;
            let (place, _) = self.now.at(when);
            let away = place - face.place - face.velocity * when;
            (when <= time && face.holds(away, face.most)).then_some((when, n))
        });
        let first = hits.min_by(|a, b| a.0.total_cmp(&b.0));
        // A body that slides over the edge of its face is not followed further.
        let off = self.now.on.filter(|&n| {
            let face = &self.faces[n];
            let (place, _) = self.now.at(time);
            !face.holds(place - face.place - face.velocity * time, face.sure)
        });
        first.or(off.map(|n| (time, n)))
    }

    /// The time from the start of the present flight until the body reaches a face from its front.
    fn time_to(&self, face: &Face) -> Option<f64> {
        let flight = &self.now;
        let gap = (flight.place - face.place - face.velocity * flight.time).dot(face.normal);
        let speed = (flight.velocity - face.velocity).dot(face.normal);
        let bend = 0.5 * flight.push.dot(face.normal);
        let slack = face.slack(flight.place);
        if gap < -slack {
            // The body is behind the face.
            return None;
        }
        if gap.abs() <= slack && speed >= 0.0 {
            // The body moves away: the other root is its return, if it returns.
            return (bend < 0.0).then(|| -speed / bend);
        }
        let under = speed * speed - 4.0 * bend * gap;
        if under < 0.0 {
            return None;
        }
        let root = under.sqrt();
        // The root at which the body approaches, computed without cancellation.
        let when = if speed <= 0.0 {
            2.0 * gap / (root - speed)
        } else if bend < 0.0 {
            (-speed - root) / (2.0 * bend)
        } else {
            return None;
        };
        (when.is_finite()).then_some(when.max(0.0))
    }

    /// Resolves an impact. Returns whether the path is known after it.
    fn hit(&mut self, when: f64, n: usize) -> bool {
        if self.now.on == Some(n) {
            return false;
        }
        let face = &self.faces[n];
        let (place, velocity) = self.now.at(when);
        let away = place - face.place - face.velocity * when;
        if face.rough || !face.holds(away, face.sure) {
            return false;
        }
        let approaching = (velocity - face.velocity).dot(face.normal);
        let parting = -face.restitution * approaching.min(0.0);
        // The position is projected onto the plane, so that rounding errors do not accumulate.
        let place = place - away.dot(face.normal) * face.normal;
        let velocity = velocity + (parting - approaching) * face.normal;
        let mut flight = Flight {
            time: when,
            place,
            velocity,
            push: self.now.push,
            on: self.now.on,
        };
        let pressed = self.push.dot(face.normal);
        let rests = pressed < 0.0 && -2.0 * parting / pressed <= REST * when.max(1e-3);
        if rests || approaching >= 0.0 && pressed < 0.0 && face.restitution < 1.0 {
            if self.now.on.is_some() {
                return false;
            }
            let on = (velocity - face.velocity).dot(face.normal);
            flight.velocity -= on * face.normal;
            flight.push = self.push - pressed * face.normal;
            flight.on = Some(n);
        } else if let Some(on) = self.now.on {
            // The impact on a wall is resolved only if the wall is perpendicular to the face below.
            if self.faces[on].normal.dot(face.normal).abs() > 1e-12 {
                return false;
            }
        }
        self.now = flight;
        true
    }
}

impl Flight {
    fn at(&self, time: f64) -> (DVec3, DVec3) {
        let after = time - self.time;
        (
            self.place + after * (self.velocity + 0.5 * after * self.push),
            self.velocity + after * self.push,
        )
    }
}

impl Face {
    /// Whether a point at this offset from the middle is over the face.
    fn holds(&self, away: DVec3, reach: DVec3) -> bool {
        away.abs().cmple(reach).all()
    }

    fn slack(&self, place: DVec3) -> f64 {
        ROUNDING * (1e-3 + place.abs().max(self.place.abs()).max_element())
    }
}
