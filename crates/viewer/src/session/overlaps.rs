//! Overlapping bodies: reported, marked, and moved apart.

use scene::shown;
use sim_core::{DVec3, Overlap, Shape};

use super::framing::Bounds;
use super::{Input, Session, State};
use crate::picture::Line;

/// The most pairs that are measured and marked.
const MOST: usize = 64;
/// The colour of boxes around overlapping bodies.
const AMBER: [f32; 4] = [0.95, 0.60, 0.05, 1.0];

/// The overlaps of a state of the world, cached because measuring them is slow.
#[derive(Debug, Default)]
pub(super) struct Overlaps {
    /// Hash of the state.
    state: Option<u64>,
    found: Vec<Overlap>,
}

impl Session {
    /// The overlapping pairs of the present state, with their depths; if there are many, the first ones.
    pub fn overlaps(&mut self) -> &[Overlap] {
        let state = Some(self.world.state_hash());
        if self.overlaps.state != state {
            let pairs = self.world.overlapping().iter().take(MOST);
            let found = pairs
                .filter_map(|&(i, j)| self.world.overlap(i, j))
                .collect();
            self.overlaps = Overlaps { state, found };
        }
        &self.overlaps.found
    }

    /// Moves overlapping bodies apart; in the layout state also in the set-up.
    pub fn separate(&mut self) {
        let moved = match self.change(Input::Separate) {
            Ok(moved) => moved,
            Err(error) => {
                let text = error.text(&self.scene);
                return self
                    .notices
                    .error("separate", format!("Nothing was moved: {text}."));
            }
        };
        self.disown_jobs();
        if self.state == State::Layout {
            for &body in &moved {
                self.scene.bodies[body].position = self.world.origin(body);
            }
            self.edited();
        }
        self.begin_record();
        if self.display.trails {
            self.trails.begin(&self.world);
        }
        let text = match moved[..] {
            [] => "Nothing overlaps.".to_owned(),
            [body] => format!("Moved {} out.", shown::name(&self.scene.bodies[body].name)),
            _ => format!("Moved {} bodies out of each other.", moved.len()),
        };
        self.notices.info("separate", text);
    }

    /// Draws boxes around the overlapping bodies.
    pub(super) fn add_overlaps(&mut self, marks: &mut Vec<Line>) {
        let both = |overlap: &Overlap| [overlap.bodies.0, overlap.bodies.1];
        let mut bodies: Vec<usize> = self.overlaps().iter().flat_map(both).collect();
        bodies.sort_unstable();
        bodies.dedup();
        for body in bodies {
            if matches!(self.world.shape(body), Some(Shape::HalfSpace { .. })) {
                continue;
            }
            let Bounds { centre, half } = self.bounds(body);
            let middle = self.shown_position(body) + centre;
            marks.extend(edges(middle, half).map(|(from, to)| Line {
                from,
                to,
                colour: AMBER,
                width: 2.0,
            }));
        }
    }
}

/// The twelve edges of a box about a point.
pub(super) fn edges(middle: DVec3, half: DVec3) -> impl Iterator<Item = (DVec3, DVec3)> {
    let corner = move |bits: usize| {
        let sign = |axis: usize| if bits >> axis & 1 == 1 { 1.0 } else { -1.0 };
        middle + DVec3::new(sign(0), sign(1), sign(2)) * half
    };
    (0..8).flat_map(move |from| {
        let axes = [1, 2, 4].into_iter().filter(move |axis| from & axis == 0);
        axes.map(move |axis| (corner(from), corner(from | axis)))
    })
}
