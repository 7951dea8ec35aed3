//! Arrows on bodies: velocities, forces and rotation. Each kind has its own scale, which the picture shows.

use sim_core::{DVec3, Shape};

use super::Session;
use super::framing::Bounds;
use crate::number;
use crate::picture::{Arrow, Line, Picture};

const VELOCITY: [f32; 3] = [0.10, 0.35, 1.0];
const FORCE: [f32; 3] = [0.85, 0.12, 0.10];
const SPIN: [f32; 3] = [0.0, 0.47, 0.42];
const ANGULAR_MOMENTUM: [f32; 3] = [0.72, 0.02, 0.42];
/// Radius of an arrow's shaft, in half sizes of its body.
const THICKNESS: f64 = 0.07;
/// Half the size assumed for bodies without size.
const POINT: f64 = 0.05;

/// A kind of arrow in the picture, and its scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// The quantity that it shows.
    pub name: &'static str,
    /// sRGB.
    pub colour: [f32; 3],
    /// What a length represents.
    pub text: String,
}

/// The largest of 1, 2 and 5 times a power of ten that is at most `most`; `most` itself if there is none.
fn round_down(most: f64) -> f64 {
    let power = 10_f64.powf(most.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|&step| step <= most).unwrap_or(most)
}

impl Session {
    /// Reduces the scales of the rotation arrows so that none is longer than twice the reach of its body.
    pub(super) fn fit_arrows(&mut self) {
        let fitted = |usual: f64, value: &dyn Fn(usize) -> DVec3| {
            let turning = (0..self.world.len()).filter(|&i| self.world.turns(i));
            turning.fold(usual, |scale, i| {
                let most = 2.0 * self.reach(i) / value(i).length();
                if most < scale {
                    round_down(most)
                } else {
                    scale
                }
            })
        };
        let spin = fitted(self.display.spin_metres, &|i| self.world.spin(i));
        let momentum = fitted(self.display.momentum_metres, &|i| {
            self.world.angular_momentum(i)
        });
        self.display.spin_metres = spin;
        self.display.momentum_metres = momentum;
    }

    /// Adds the arrows of body `i`, and its axis of rotation.
    pub(super) fn add_arrows(&self, i: usize, picture: &mut Picture) {
        let display = &self.display;
        let selected = self.selection() == Some(i);
        let mut add = |value: DVec3, scale: f64, colour| {
            picture.arrows.extend(self.arrow(i, scale * value, colour));
        };
        if selected || display.all_velocities {
            add(self.shown_velocity(i), display.arrow_time, VELOCITY);
        }
        if display.forces {
            add(self.world().applied_force(i), display.arrow_metres, FORCE);
        }
        if self.world().turns(i) && (selected || display.spins) {
            let momentum = self.world().angular_momentum(i);
            add(momentum, display.momentum_metres, ANGULAR_MOMENTUM);
            let spin = self.world().spin(i);
            add(spin, display.spin_metres, SPIN);
            picture.lines.extend(self.axis(i, spin));
        }
    }

    /// The kinds of arrows in the picture now, with their scales.
    pub fn scales(&self) -> Vec<Scale> {
        let (display, world) = (&self.display, self.world());
        let seen = |of_all: bool, value: &dyn Fn(usize) -> DVec3| {
            (0..world.len())
                .filter(|&i| of_all || self.selection() == Some(i))
                .any(|i| !self.is_hidden(i) && value(i) != DVec3::ZERO)
        };
        let metre = |scale: f64, unit: &str| format!("1 m: {} {unit}", number::tidy(1.0 / scale));
        let mut scales = Vec::new();
        let mut add = |is_seen: bool, name, colour, text| {
            if is_seen {
                scales.push(Scale { name, colour, text });
            }
        };
        let is_seen = seen(display.all_velocities, &|i| self.shown_velocity(i));
        add(
            is_seen,
            "velocity",
            VELOCITY,
            metre(display.arrow_time, "m/s"),
        );
        let is_seen = display.forces && seen(true, &|i| world.applied_force(i));
        add(is_seen, "force", FORCE, metre(display.arrow_metres, "N"));
        let is_seen = seen(display.spins, &|i| world.spin(i));
        let text = metre(display.spin_metres, "rad/s");
        add(is_seen, "angular velocity", SPIN, text);
        let is_seen = seen(display.spins, &|i| world.angular_momentum(i));
        let text = metre(display.momentum_metres, "kg m²/s");
        add(is_seen, "angular momentum", ANGULAR_MOMENTUM, text);
        if let Some(strongest) = self.strongest_impulse() {
            let text = format!("longest: {} N s", number::figure(strongest));
            add(true, "impulse", super::impacts::ORANGE, text);
        }
        scales
    }

    /// An arrow from the surface of the body's box, so that a short arrow is not hidden inside it. The arrow of a
    /// turning body starts at a sphere around the body, so that it does not move while the body rotates.
    fn arrow(&self, i: usize, span: DVec3, colour: [f32; 3]) -> Option<Arrow> {
        let direction = span.try_normalize()?;
        let (from, size) = if self.world().turns(i) {
            let reach = self.reach(i);
            (self.shown_centre(i) + reach * direction, reach)
        } else {
            let Bounds { centre, half } = self.bounds(i);
            let place = match self.world().shape(i) {
                Some(Shape::HalfSpace { .. }) => self.foot(i, self.room().0),
                _ => self.shown_position(i) + centre,
            };
            let half = match half {
                DVec3::ZERO => DVec3::splat(POINT),
                half => half,
            };
            let exit = (half / direction.abs()).min_element();
            (place + direction * exit, half.max_element())
        };
        Some(Arrow {
            from,
            to: from + span,
            colour,
            radius: (THICKNESS * size) as f32,
        })
    }

    /// The axis of rotation of a body, as long as the reach of the body.
    fn axis(&self, i: usize, spin: DVec3) -> Option<Line> {
        let way = self.reach(i) * spin.try_normalize()?;
        let middle = self.shown_centre(i);
        let [red, green, blue] = SPIN;
        Some(Line {
            from: middle - way,
            to: middle + way,
            colour: [red, green, blue, 1.0],
            width: 2.0,
        })
    }

    /// An upper bound on the distance of a turning body's points from its centre of mass, m.
    fn reach(&self, i: usize) -> f64 {
        if let Some(&Shape::Sphere { radius }) = self.world().shape(i) {
            return radius;
        }
        let Bounds { centre, half } = self.bounds_unturned(i);
        let turns_about = self.world().inertia(i).map(|inertia| inertia.centre());
        match (centre - turns_about.unwrap_or_default()).length() + half.length() {
            0.0 => POINT,
            reach => reach,
        }
    }
}
