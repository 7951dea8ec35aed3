//! The poses of two shapes at one time, and bounds on their further motion.

use glam::{DMat3, DQuat, DVec3};

use super::{Moving, Turning, certificate::Margin};

/// Poses and velocities at one time, in a frame at rest. It has the axes of the first shape at that time, and its
/// origin at the first centre of mass.
pub(super) struct View {
    pub(super) time: f64,
    /// The time from here to the end, s.
    pub(super) left: f64,
    /// The rotation from this frame into the world.
    pub(super) axes: DQuat,
    /// The rotation from the second shape's frame into this one.
    pub(super) turn: DMat3,
    /// The second centre of mass relative to the first.
    pub(super) offset: DVec3,
    pub(super) velocity: DVec3,
    pub(super) acceleration: DVec3,
    pub(super) first: Spinning,
    pub(super) second: Spinning,
}

/// The rotational motion of one shape at that time, and bounds for the time left.
#[derive(Clone, Copy, Default)]
pub(super) struct Spinning {
    pub(super) spin: DVec3,
    pub(super) turning: DVec3,
    /// Bounds on the speed, and on the second and third derivatives of position, of a point 1 m from the centre of
    /// mass.
    pub(super) fastest: f64,
    pub(super) second: f64,
    pub(super) third: f64,
}

/// A direction, with the extent of the boxes along it and the speed of that extent, both per metre of half extent.
#[derive(Clone, Copy)]
pub(super) struct Direction {
    pub(super) along: DVec3,
    pub(super) reach: [DVec3; 2],
    pub(super) sweep: [DVec3; 2],
}

impl View {
    pub(super) fn new(a: &Moving<'_>, b: &Moving<'_>, time: f64, end: f64) -> View {
        let left = end - time;
        let (rotation_a, first) = spinning(a, time, left);
        let (rotation_b, second) = spinning(b, time, left);
        let to_frame = rotation_a.inverse();
        let seen = |of: Spinning| Spinning {
            spin: to_frame * of.spin,
            turning: to_frame * of.turning,
            ..of
        };
        let (first, second) = (seen(first), seen(second));
        let turn = DMat3::from_quat((to_frame * rotation_b).normalize());
        // Differences first, so that the result does not depend on where in the world both shapes are.
        let (v, acceleration) = (b.velocity - a.velocity, b.acceleration - a.acceleration);
        let offset = (b.position - a.position) + time * (v + 0.5 * time * acceleration);
        View {
            time,
            left,
            axes: rotation_a,
            turn,
            offset: to_frame * offset,
            velocity: to_frame * (v + time * acceleration),
            acceleration: to_frame * acceleration,
            first,
            second,
        }
    }

    /// The directions along which boxes are compared: the axes of both shapes.
    pub(super) fn directions(&self) -> [Direction; 6] {
        let [x, y, z] = DVec3::AXES.map(|axis| self.direction(axis));
        let [u, v, w] = DVec3::AXES.map(|axis| self.direction(self.turn * axis));
        [x, y, z, u, v, w]
    }

    /// The extents along a unit vector.
    pub(super) fn direction(&self, along: DVec3) -> Direction {
        let back = self.turn.transpose();
        Direction {
            along,
            reach: [along.abs(), (back * along).abs()],
            sweep: [
                along.cross(self.first.spin).abs(),
                (back * along.cross(self.second.spin)).abs(),
            ],
        }
    }

    /// Bounds on rounding for points at these distances from the two centres of mass, m.
    pub(super) fn margin(&self, [a, b]: [f64; 2]) -> Margin {
        let speed = self.velocity.length() + self.first.fastest * a + self.second.fastest * b;
        // Angles and offsets are rounded relative to their change since the start.
        let size = self.offset.length() + a + b + speed * self.time;
        let bend = self.acceleration.length() + self.first.second * a + self.second.second * b;
        Margin { size, speed, bend }
    }
}

/// The rotation of the shape's frame, its motion, and bounds for the time left.
fn spinning(moving: &Moving<'_>, time: f64, left: f64) -> (DQuat, Spinning) {
    match moving.turning {
        Turning::Still(rotation) => (rotation.normalize(), Spinning::default()),
        Turning::Flight(flight, axes) => {
            let pose = flight.at(time);
            let bounds = flight.bounds(&pose, left);
            let spinning = Spinning {
                spin: pose.spin,
                turning: pose.acceleration,
                fastest: bounds.spin,
                second: bounds.second,
                third: bounds.third,
            };
            ((pose.rotation * axes.inverse()).normalize(), spinning)
        }
    }
}
