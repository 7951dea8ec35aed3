//! Half-spaces: the part of each plane near the bodies, drawn as glass with a grid. From behind only the outline is
//! drawn, so that the near walls of a box do not hide its inside.

use sim_core::{DVec3, Shape};

use super::Session;
use crate::picture::{Line, Pane, Picture};

/// The least number of grid cells across half a wall.
const CELLS: f64 = 4.0;
/// Opacity of a wall, seen from its front.
const GLASS: f32 = 0.14;
const SELECTED: [f32; 3] = [0.10, 0.35, 1.0];

/// The factor by which the drawn room exceeds the bodies, and the least part of its radius drawn in each direction.
const MARGIN: f64 = 1.1;
const LEAST_PART: f64 = 0.6;

/// A point of a plane and its normal.
type Plane = (DVec3, DVec3);

/// The geometry of a drawn half-space.
struct Wall {
    body: usize,
    /// The middle of the drawn part.
    centre: DVec3,
    normal: DVec3,
    /// Unit vectors along the wall.
    axes: [DVec3; 2],
}

impl Session {
    pub(super) fn add_walls(&self, picture: &mut Picture) {
        let (centre, half) = self.room();
        let wall = |body: usize| match self.world.shape(body) {
            Some(&Shape::HalfSpace { normal }) => {
                // Parallel to the world's axes if the wall is vertical or horizontal.
                let level = normal.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
                Some(Wall {
                    body,
                    centre: self.foot(body, centre),
                    normal,
                    axes: [level, level.cross(normal)],
                })
            }
            _ => None,
        };
        let walls: Vec<Wall> = (0..self.world.len()).filter_map(wall).collect();
        let (min, max) = self.room_box();
        let size = (MARGIN * 0.5 * (max - min)).max(DVec3::splat(LEAST_PART * half));
        for wall in &walls {
            // Points inside another half-space, or outside the room, are not drawn.
            let others = walls.iter().filter(|other| other.body != wall.body);
            let sides = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
            let sides = sides.filter(|side| side.dot(wall.normal).abs() < 0.5);
            let bounds: Vec<Plane> = others
                .map(|other| (other.centre, other.normal))
                .chain(sides.map(|side| (centre - size * side, side)))
                .collect();
            self.add_wall(wall, 2.0 * half, &bounds, picture);
        }
    }

    fn add_wall(&self, wall: &Wall, half: f64, bounds: &[Plane], picture: &mut Picture) {
        let is_selected = self.selection == Some(wall.body);
        let is_front = (self.camera.eye() - wall.centre).dot(wall.normal) > 0.0;
        let [red, green, blue] = match is_selected {
            true => SELECTED,
            false => self.colour(wall.body),
        };
        let line = |(from, to): (DVec3, DVec3), opacity: f32, width: f32| Line {
            from,
            to,
            colour: [red, green, blue, opacity],
            width,
        };
        let outline = outline(wall, half, bounds);
        let ends = outline.iter().skip(1).chain(outline.first());
        let (opacity, width) = match (is_front, is_selected) {
            (_, true) => (1.0, 2.5),
            (true, false) => (0.9, 1.5),
            (false, false) => (0.7, 1.0),
        };
        let edges = outline.iter().copied().zip(ends.copied());
        let edges = edges.map(|edge| line(edge, opacity, width));
        picture.lines.extend(edges);
        if !is_front {
            return;
        }
        // The ground grid replaces the wall's own grid on the ground.
        let is_ground = wall.normal == DVec3::Y && wall.centre.y == 0.0 && self.display.grid;
        if !is_ground {
            let grid = grid(wall, half, bounds);
            picture.lines.extend(grid.map(|edge| line(edge, 0.4, 1.0)));
        }
        picture.panes.push(Pane {
            corners: outline,
            colour: [red, green, blue, GLASS],
        });
    }
}

/// The corners of the visible part of a square, in order.
fn outline(wall: &Wall, half: f64, bounds: &[Plane]) -> Vec<DVec3> {
    let [u, v] = wall.axes.map(|axis| half * axis);
    let square = [-u - v, u - v, u + v, v - u].map(|corner| wall.centre + corner);
    bounds.iter().fold(square.into(), |corners, bound| {
        let mut kept = Vec::with_capacity(corners.len() + 1);
        for (n, &from) in corners.iter().enumerate() {
            let to = corners[(n + 1) % corners.len()];
            let (start, end) = (height(bound, from), height(bound, to));
            if start >= 0.0 {
                kept.push(from);
            }
            if (start < 0.0) != (end < 0.0) {
                kept.push(from.lerp(to, start / (start - end)));
            }
        }
        kept
    })
}

/// Adds lines along both axes at round distances, where they are visible.
fn grid<'a>(
    wall: &'a Wall,
    half: f64,
    bounds: &'a [Plane],
) -> impl Iterator<Item = (DVec3, DVec3)> + 'a {
    let spacing = round_below(0.5 * half / CELLS);
    let [u, v] = wall.axes;
    [(u, v), (v, u)]
        .into_iter()
        .flat_map(move |(across, along)| {
            // Lines are at multiples of the spacing in world coordinates, so they stay in place when others move.
            let middle = wall.centre.dot(across);
            let (first, last) = ((middle - half) / spacing, (middle + half) / spacing);
            let count = (last.floor() - first.ceil()).clamp(0.0, 100.0) as u32;
            (0..=count).filter_map(move |n| {
                let at = (first.ceil() + f64::from(n)) * spacing - middle;
                let place = wall.centre + at * across;
                let ends = (place - half * along, place + half * along);
                bounds.iter().try_fold(ends, |(from, to), bound| {
                    let (start, end) = (height(bound, from), height(bound, to));
                    let cut = from.lerp(to, start / (start - end));
                    match (start >= 0.0, end >= 0.0) {
                        (true, true) => Some((from, to)),
                        (true, false) => Some((from, cut)),
                        (false, true) => Some((cut, to)),
                        (false, false) => None,
                    }
                })
            })
        })
}

/// Signed distance of a point from a plane, positive in front, m.
fn height((at, normal): &Plane, point: DVec3) -> f64 {
    (point - at).dot(*normal)
}

/// The greatest of 1, 2 and 5 times a power of ten that is at most `length`.
fn round_below(length: f64) -> f64 {
    let decade = 10_f64.powf(length.log10().floor());
    let factor = [5.0, 2.0]
        .into_iter()
        .find(|factor| factor * decade <= length);
    factor.unwrap_or(1.0) * decade
}
