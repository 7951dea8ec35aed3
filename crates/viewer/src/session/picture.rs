//! What the person sees: the world as a [`Picture`].

use sim_core::{Aabb, DVec3};

use super::Session;
use crate::picture::{Arrow, Line, Model, PALETTE, Picture};

/// Velocity arrows.
const BLUE: [f32; 3] = [0.10, 0.35, 1.0];
/// The last impact.
const ORANGE: [f32; 3] = [1.0, 0.45, 0.05];
/// Simulated time for which an impact stays in sight, s.
const IMPACT_SHOWN: f64 = 0.75;
/// Which boxes of the bounding volume hierarchies are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BvhView {
    /// Whether any are.
    pub shown: bool,
    /// Of every body rather than of the selected one.
    pub every_body: bool,
    /// All depths rather than [`depth`](Self::depth) alone.
    pub every_depth: bool,
    /// Which depth; 0 is the box around the whole mesh, and beyond the deepest is the deepest.
    pub depth: usize,
}

/// What is drawn besides the bodies.
#[derive(Clone, Copy, Debug)]
pub struct Display {
    /// Bounding volume hierarchies.
    pub bvh: BvhView,
    /// Velocity arrows on all bodies rather than on the selected one.
    pub all_velocities: bool,
    /// Time, s, whose travel an arrow shows: its length is `velocity * arrow_time`.
    pub arrow_time: f64,
    /// The ground grid.
    pub grid: bool,
    /// Where bodies have been; see [`Session::show_trails`].
    pub trails: bool,
    /// Springs, anchors and centres of attraction.
    pub ties: bool,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            bvh: BvhView {
                shown: false,
                every_body: false,
                every_depth: false,
                depth: 3,
            },
            all_velocities: false,
            arrow_time: 0.5,
            grid: true,
            trails: false,
            ties: true,
        }
    }
}

impl Session {
    /// The world as it is to be drawn now.
    pub fn picture(&mut self) -> Picture {
        if self.display.bvh.shown {
            self.world.build_bvhs();
        }
        let mut picture = Picture {
            camera: self.camera,
            models: Vec::with_capacity(self.world.len()),
            lines: Vec::new(),
            arrows: Vec::new(),
            grid: self.display.grid,
        };
        for i in 0..self.world.len() {
            let selected = self.selection == Some(i);
            if let Some(mesh) = self.world.mesh(i) {
                picture.models.push(Model {
                    mesh: mesh.clone(),
                    position: self.shown_position(i),
                    colour: self.colour(i),
                    selected,
                });
            }
            if selected || self.display.all_velocities {
                picture.arrows.extend(self.velocity_arrow(i));
            }
            if self.display.bvh.shown && (selected || self.display.bvh.every_body) {
                self.add_boxes(i, &mut picture.lines);
            }
            if self.display.trails {
                self.add_trail(i, &mut picture.lines);
            }
        }
        self.add_dots(&mut picture.lines);
        if self.display.ties {
            self.add_ties(&mut picture.lines);
        }
        self.add_impact(&mut picture);
        picture
    }

    /// Colour of body `i`, sRGB.
    pub fn colour(&self, i: usize) -> [f32; 3] {
        self.scene.bodies[i]
            .colour
            .unwrap_or(PALETTE[i % PALETTE.len()])
    }

    /// Number of levels in the deepest hierarchy among the meshes; builds those missing.
    pub fn bvh_depth(&mut self) -> usize {
        self.world.build_bvhs();
        (0..self.world.len())
            .filter_map(|i| Some(self.world.bvh(i)?.depth()))
            .max()
            .unwrap_or(0)
    }

    /// Points, and bodies too small to be seen, as dots.
    fn add_dots(&self, lines: &mut Vec<Line>) {
        for i in (0..self.world.len()).filter(|&i| self.is_dot(i)) {
            let at = self.shown_position(i);
            let [red, green, blue] = self.colour(i);
            // A line of no length is its round end.
            lines.push(Line {
                from: at,
                to: at,
                colour: [red, green, blue, 1.0],
                width: if self.selection == Some(i) { 13.0 } else { 9.0 },
            });
        }
    }

    /// Goes to another depth of the boxes shown.
    pub fn step_depth(&mut self, by: isize) {
        if !self.display.bvh.shown {
            return;
        }
        let deepest = self.bvh_depth().saturating_sub(1);
        let view = &mut self.display.bvh;
        view.every_depth = false;
        view.depth = view
            .depth
            .min(deepest)
            .saturating_add_signed(by)
            .min(deepest);
    }

    /// From the surface of the body's box, so that a slow body's arrow is not hidden inside it.
    fn velocity_arrow(&self, i: usize) -> Option<Arrow> {
        let velocity = self.world.velocity(i);
        let direction = velocity.try_normalize()?;
        let (centre, half) = match self.world.mesh(i) {
            Some(mesh) => (mesh.bounds().centre(), mesh.bounds().half_extent()),
            None => (DVec3::ZERO, DVec3::splat(0.05)),
        };
        let exit = (half / direction.abs()).min_element();
        let from = self.shown_position(i) + centre + direction * exit;
        Some(Arrow {
            from,
            to: from + velocity * self.display.arrow_time,
            colour: BLUE,
            radius: (0.07 * half.max_element()) as f32,
        })
    }

    fn add_boxes(&self, i: usize, lines: &mut Vec<Line>) {
        let Some(bvh) = self.world.bvh(i) else { return };
        let view = self.display.bvh;
        let levels = bvh.depth();
        let chosen = view.depth.min(levels.saturating_sub(1));
        let origin = self.shown_position(i);
        for (depth, aabb) in bvh.boxes() {
            if view.every_depth || depth == chosen {
                let colour = depth_colour(depth, levels);
                lines.extend(edges(aabb).map(|(from, to)| Line {
                    from: origin + from,
                    to: origin + to,
                    colour,
                    width: 1.5,
                }));
            }
        }
    }

    /// A cross at the point of a fresh impact and an arrow along its normal.
    fn add_impact(&self, picture: &mut Picture) {
        let Some(impact) = self.world.last_impact() else {
            return;
        };
        if self.world.time() - impact.time > IMPACT_SHOWN {
            return;
        }
        let size = 0.15
            * [impact.bodies.0, impact.bodies.1]
                .into_iter()
                .filter_map(|i| Some(self.world.mesh(i)?.bounds().half_extent().max_element()))
                .fold(f64::INFINITY, f64::min)
                .min(1e6);
        for axis in DVec3::AXES {
            picture.lines.push(Line {
                from: impact.point - axis * size,
                to: impact.point + axis * size,
                colour: [ORANGE[0], ORANGE[1], ORANGE[2], 1.0],
                width: 2.5,
            });
        }
        picture.arrows.push(Arrow {
            from: impact.point,
            to: impact.point + impact.normal * 5.0 * size,
            colour: ORANGE,
            radius: (0.15 * size) as f32,
        });
    }
}

/// From red at the root over green to violet at the deepest level, dark enough for the light
/// background; the deeper, the fainter.
fn depth_colour(depth: usize, levels: usize) -> [f32; 4] {
    let t = depth as f32 / levels.saturating_sub(1).max(1) as f32;
    let hue = 4.8 * t;
    // Red, green and blue peak at the hues 0, 2 and 4 of a circle of 6.
    let channel = |peak: f32| {
        let away = (hue - peak + 3.0).rem_euclid(6.0) - 3.0;
        0.8 * (2.0 - away.abs()).clamp(0.0, 1.0)
    };
    [channel(0.0), channel(2.0), channel(4.0), 1.0 - 0.5 * t]
}

/// The twelve edges of a box.
fn edges(aabb: Aabb) -> impl Iterator<Item = (DVec3, DVec3)> {
    let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
    let corner = move |bits: usize| {
        DVec3::new(
            if bits & 1 == 0 { min.x } else { max.x },
            if bits & 2 == 0 { min.y } else { max.y },
            if bits & 4 == 0 { min.z } else { max.z },
        )
    };
    (0..8).flat_map(move |from| {
        [1, 2, 4]
            .into_iter()
            .filter(move |axis| from & axis == 0)
            .map(move |axis| (corner(from), corner(from | axis)))
    })
}
