//! Draws forces: springs as zigzags, anchors and centres of attraction as crosses.

use sim_core::DVec3;
use sim_core::force::Tie;

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
            let mut bodies = force.bodies();
            match force.nature().tie {
                Tie::Nothing => {}
                Tie::Centre(centre) => self.add_cross(centre, lines),
                Tie::SpringFrom(anchor) => {
                    for body in bodies {
                        self.add_spring(anchor, self.shown_point(body, force.point()), lines);
                    }
                    self.add_cross(anchor, lines);
                }
                Tie::SpringBetween => {
                    if let (Some(first), Some(second)) = (bodies.next(), bodies.next()) {
                        let [from, to] = force
                            .points()
                            .map_or([None; 2], |[p, q]| [Some(p), Some(q)]);
                        let from = self.shown_point(first, from);
                        let to = self.shown_point(second, to);
                        self.add_spring(from, to, lines);
                    }
                }
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
