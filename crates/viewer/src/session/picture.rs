//! The view of the user: the world as a [`Picture`].

use sim_core::{DVec3, Shape};

use super::Session;
use super::framing::Bounds;
use super::overlaps::edges;
use crate::picture::{Line, Model, PALETTE, Picture};

/// The colour of half-spaces that have none of their own.
const SLATE: [f32; 3] = [0.40, 0.45, 0.52];

/// The approximate lightness of bodies at rest.
const GREY: f32 = 0.62;

/// Which boxes of the bounding volume hierarchies are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BvhView {
    /// Whether any boxes are drawn.
    pub shown: bool,
    /// Whether boxes are drawn for every body rather than the selected one. Without a selection they are drawn for
    /// every body.
    pub every_body: bool,
    /// Whether all depths are drawn rather than [`depth`](Self::depth) alone.
    pub every_depth: bool,
    /// The depth: 0 is the box around the whole mesh; a value beyond the deepest level means the deepest.
    pub depth: usize,
}

/// The items drawn besides the bodies.
#[derive(Clone, Copy, Debug)]
pub struct Display {
    /// Bounding volume hierarchies.
    pub bvh: BvhView,
    /// Velocity arrows on all bodies rather than on the selected one.
    pub all_velocities: bool,
    /// The time, s, that gives an arrow its length: `velocity * arrow_time`.
    pub arrow_time: f64,
    /// Force arrows on all bodies rather than none.
    pub forces: bool,
    /// The length of a force arrow per force, m/N.
    pub arrow_metres: f64,
    /// Arrows of angular velocity and angular momentum on all turning bodies rather than on the selected one.
    pub spins: bool,
    /// The length of an arrow per angular velocity, in metres for each rad/s.
    pub spin_metres: f64,
    /// The length of an arrow per angular momentum, in metres for each kg m²/s.
    pub momentum_metres: f64,
    /// The ground grid.
    pub grid: bool,
    /// Letters and numbers on the axes, if the grid is shown.
    pub numbers: bool,
    /// The names of all bodies rather than of the selected one.
    pub names: bool,
    /// The edges of all meshes.
    pub wireframe: bool,
    /// The trails of bodies; see [`Session::show_trails`].
    pub trails: bool,
    /// Bodies at rest in grey.
    pub rest: bool,
    /// Springs, anchors and centres of attraction.
    pub ties: bool,
    /// Points, normals and impulses of recent impacts. While off, none are recorded.
    pub impacts: bool,
    /// The level of the descent through two hierarchies that is shown, if any.
    pub descent: Option<usize>,
    /// The comparison of the descent that is shown instead, if any.
    pub pair: Option<usize>,
    /// While running, interpolate bodies between the last two states.
    pub between: bool,
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
            forces: false,
            arrow_metres: 0.1,
            spins: false,
            spin_metres: 0.1,
            momentum_metres: 1.0,
            grid: true,
            numbers: true,
            names: false,
            wireframe: false,
            trails: false,
            rest: false,
            ties: true,
            impacts: true,
            descent: None,
            pair: None,
            between: true,
        }
    }
}

impl Session {
    /// The world as it is to be drawn now.
    pub fn picture(&mut self) -> Picture {
        if self.display.bvh.shown {
            self.world.build_bvhs();
        }
        self.keep_up();
        let mut picture = Picture {
            camera: self.camera,
            models: Vec::with_capacity(self.world.len()),
            ghosts: Vec::new(),
            panes: Vec::new(),
            lines: Vec::new(),
            marks: Vec::new(),
            arrows: Vec::new(),
            wireframe: self.display.wireframe,
            grid: self.display.grid,
        };
        for i in (0..self.world.len())
            .filter(|&i| !self.is_hidden(i))
            .collect::<Vec<_>>()
        {
            let selected = self.selection == Some(i);
            if let Some(mesh) = self.body_mesh(i) {
                picture.models.push(Model {
                    mesh,
                    position: self.shown_position(i),
                    rotation: self.shown_rotation(i),
                    colour: match self.display.rest && self.is_at_rest(i) {
                        true => self.colour(i).map(|part| GREY + 0.15 * (part - GREY)),
                        false => self.colour(i),
                    },
                    selected,
                });
            }
            self.add_arrows(i, &mut picture);
            let all = self.display.bvh.every_body || self.selection.is_none();
            if self.display.bvh.shown && (selected || all) {
                self.add_boxes(i, &mut picture.lines);
            }
            if self.display.trails {
                self.add_trail(i, &mut picture.lines);
            }
        }
        self.add_dots(&mut picture.lines);
        self.add_ghosts(&mut picture.ghosts, &mut picture.lines);
        if self.display.ties {
            self.add_ties(&mut picture.lines);
        }
        let Picture {
            ghosts,
            lines,
            marks,
            ..
        } = &mut picture;
        self.add_missed(ghosts, lines, marks);
        self.add_descent(lines);
        self.add_walls(&mut picture);
        if self.display.impacts {
            let Picture { panes, marks, .. } = &mut picture;
            self.add_impacts(panes, marks);
        }
        self.add_overlaps(&mut picture.marks);
        picture
    }

    /// The mesh with which body `i` is drawn, if it is a mesh or a sphere.
    pub(super) fn body_mesh(&mut self, i: usize) -> Option<std::sync::Arc<sim_core::Mesh>> {
        match self.world.shape(i) {
            Some(Shape::Mesh(mesh)) => Some(mesh.clone()),
            Some(&Shape::Sphere { radius }) => self.balls.mesh(radius),
            Some(Shape::HalfSpace { .. }) | None => None,
        }
    }

    /// Colour of body `i`, sRGB.
    pub fn colour(&self, i: usize) -> [f32; 3] {
        let default = match self.is_half_space(i) {
            true => SLATE,
            false => PALETTE[i % PALETTE.len()],
        };
        self.scene.bodies[i].colour.unwrap_or(default)
    }

    /// Whether a movable body is exactly at rest.
    pub fn is_at_rest(&self, i: usize) -> bool {
        let world = &self.world;
        let still = world.velocity(i) == DVec3::ZERO && world.spin(i) == DVec3::ZERO;
        still && world.kind(i).is_movable()
    }

    /// Number of levels in the deepest hierarchy among the meshes; builds missing hierarchies.
    pub fn bvh_depth(&mut self) -> usize {
        self.world.build_bvhs();
        (0..self.world.len())
            .filter_map(|i| Some(self.world.bvh(i)?.depth()))
            .max()
            .unwrap_or(0)
    }

    /// Draws points, and bodies too small to be visible, as dots.
    fn add_dots(&self, lines: &mut Vec<Line>) {
        for i in (0..self.world.len()).filter(|&i| self.is_dot(i) && !self.is_hidden(i)) {
            let at = self.shown_position(i);
            let [red, green, blue] = self.colour(i);
            // A line of zero length is drawn as its round end.
            lines.push(Line {
                from: at,
                to: at,
                colour: [red, green, blue, 1.0],
                width: if self.selection == Some(i) { 13.0 } else { 9.0 },
            });
        }
    }

    /// Changes the depth of the boxes shown.
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

    fn add_boxes(&self, i: usize, lines: &mut Vec<Line>) {
        let view = self.display.bvh;
        let Some(bvh) = self.world.bvh(i) else {
            // A body without triangles has one box.
            let Bounds { centre, half } = self.bounds(i);
            if half != DVec3::ZERO && (view.every_depth || view.depth == 0) {
                let edges = edges(self.shown_position(i) + centre, half);
                lines.extend(edges.map(|(from, to)| Line {
                    from,
                    to,
                    colour: depth_colour(0, 1),
                    width: 1.5,
                }));
            }
            return;
        };
        let levels = bvh.depth();
        let chosen = view.depth.min(levels.saturating_sub(1));
        let (origin, rotation) = (self.shown_position(i), self.shown_rotation(i));
        for (depth, aabb) in bvh.boxes() {
            if view.every_depth || depth == chosen {
                let colour = depth_colour(depth, levels);
                let edges = edges(aabb.centre(), aabb.half_extent());
                lines.extend(edges.map(|(from, to)| Line {
                    from: origin + rotation * from,
                    to: origin + rotation * to,
                    colour,
                    width: 1.5,
                }));
            }
        }
    }
}

/// The colour of a depth: from red at the root over green to violet at the deepest level, dark enough for the light
/// background. Deeper levels are fainter.
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
