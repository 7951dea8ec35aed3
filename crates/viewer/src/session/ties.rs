//! Draws forces: springs as zigzags, anchors and centres of attraction as crosses.

use sim_core::{DVec3, Force};

use super::Session;
use crate::picture::Line;

/// The colour of springs and their attachments.
const COLOUR: [f32; 4] = [0.16, 0.36, 0.30, 1.0];
/// Half the size of a cross, and half the width of a spring, in distances of the camera.
const SIZE: f64 = 0.012;
/// Turns of a spring.
const TURNS: u32 = 14;

impl Session {
    pub(super) fn add_ties(&self, lines: &mut Vec<Line>) {
        for force in self.world.forces() {
            match *force {
                Force::Anchor {
                    body,
                    point,
                    anchor,
                    ..
                } => {
                    self.add_spring(anchor, self.shown_point(body, point), lines);
                    self.add_cross(anchor, lines);
                }
                Force::Spring {
                    bodies: [first, second],
                    points,
                    ..
                } => {
                    let from = self.shown_point(first, points.map(|points| points[0]));
                    let to = self.shown_point(second, points.map(|points| points[1]));
                    self.add_spring(from, to, lines);
                }
                Force::Attraction { centre, .. } => self.add_cross(centre, lines),
                Force::Gravity { .. }
                | Force::LinearDrag { .. }
                | Force::QuadraticDrag { .. }
                | Force::Push { .. }
                | Force::Gravitation { .. }
                | Force::Body { .. }
                | Force::Pair { .. } => {}
            }
        }
    }

    fn add_cross(&self, at: DVec3, lines: &mut Vec<Line>) {
        let size = SIZE * self.camera.distance;
        let arms = DVec3::AXES.map(|axis| line(at - axis * size, at + axis * size));
        lines.extend(arms);
    }

    fn add_spring(&self, from: DVec3, to: DVec3, lines: &mut Vec<Line>) {
        let [_, _, backward] = self.camera.axes();
        let across = (to - from).cross(backward).normalize_or_zero();
        let side = SIZE * self.camera.distance * across;
        let mut last = from;
        for turn in 0..=TURNS {
            let along = (f64::from(turn) + 0.5) / f64::from(TURNS + 1);
            let sign = match turn {
                0 | TURNS => 0.0,
                _ if turn % 2 == 0 => 1.0,
                _ => -1.0,
            };
            let next = from.lerp(to, along) + sign * side;
            lines.push(line(last, next));
            last = next;
        }
        lines.push(line(last, to));
    }
}

fn line(from: DVec3, to: DVec3) -> Line {
    Line {
        from,
        to,
        colour: COLOUR,
        width: 2.0,
    }
}
