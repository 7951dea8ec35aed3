//! Samples of the signed distance on a regular grid, exact only near the surface.

use crate::model::Model;
use glam::Vec3;
use std::{sync::Mutex, thread};

/// Samples along one side of the blocks that are sampled, or skipped, as one.
const BLOCK: usize = 4;

/// A sampled box of space.
pub(crate) struct Grid {
    /// Samples along x, y and z.
    pub(crate) size: [usize; 3],
    /// Position of the first sample, m.
    pub(crate) origin: Vec3,
    /// Distance between neighbouring samples, m.
    pub(crate) spacing: f32,
    /// Signed distances, m, x fastest. Far from the surface only the sign counts.
    pub(crate) values: Vec<f32>,
}

impl Grid {
    /// Samples `model` in the box from `low` to `high`, which must hold it.
    pub(crate) fn sample(model: &Model, low: Vec3, high: Vec3, spacing: f32) -> Self {
        let size = ((high - low) / spacing)
            .to_array()
            .map(|n| (n.ceil() as usize + 1).next_multiple_of(BLOCK));
        let mut grid = Self {
            size,
            origin: low,
            spacing,
            values: Vec::new(),
        };
        let layer = size[0] * size[1];
        let mut values = vec![0.0; layer * size[2]];
        let slabs = Mutex::new(values.chunks_mut(layer * BLOCK).zip((0..).step_by(BLOCK)));
        thread::scope(|scope| {
            for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
                scope.spawn(|| {
                    while let Ok(Some((slab, k))) = slabs.lock().map(|mut slabs| slabs.next()) {
                        grid.sample_slab(model, k, slab);
                    }
                });
            }
        });
        grid.values = values;
        grid.disambiguate();
        grid
    }

    /// Fills the `BLOCK` layers from layer `k0` on.
    fn sample_slab(&self, model: &Model, k0: usize, slab: &mut [f32]) {
        let half_side = 0.5 * BLOCK as f32 * self.spacing;
        let reach = half_side * 3.0_f32.sqrt();
        for j0 in (0..self.size[1]).step_by(BLOCK) {
            for i0 in (0..self.size[0]).step_by(BLOCK) {
                let middle = self.position(i0, j0, k0) + Vec3::splat(half_side);
                let far = model.distance(middle);
                // Ellipsoids' distances are not exact; the factor covers their error.
                let near = (far.abs() < 2.0 * reach).then(|| model.near(middle, reach));
                for k in 0..BLOCK {
                    for j in j0..j0 + BLOCK {
                        for i in i0..i0 + BLOCK {
                            slab[(k * self.size[1] + j) * self.size[0] + i] = match &near {
                                Some(near) => near.distance(self.position(i, j, k0 + k)),
                                None => far,
                            };
                        }
                    }
                }
            }
        }
    }

    fn position(&self, i: usize, j: usize, k: usize) -> Vec3 {
        self.origin + Vec3::new(i as f32, j as f32, k as f32) * self.spacing
    }

    /// Flips the signs that let two sheets of the surface pass through one face
    /// or one cell of the grid, where surface nets would join them in an edge
    /// of four triangles or in a pinched vertex.
    ///
    /// This happens in creases narrower than a cell. The sample that is nearest
    /// to the surface changes sides, which moves the surface by less than a cell.
    fn disambiguate(&mut self) {
        let [dx, dy, dz] = [1, self.size[0], self.size[0] * self.size[1]];
        let faces = [
            [0, dx, dx + dy, dy],
            [0, dy, dy + dz, dz],
            [0, dz, dz + dx, dx],
        ];
        // Each corner of a cell, next to the opposite one.
        let diagonals = [
            [0, dx + dy + dz],
            [dx, dy + dz],
            [dy, dz + dx],
            [dz, dx + dy],
        ];
        let cell = diagonals.as_flattened();
        let mut clean = false;
        while !clean {
            clean = true;
            for i in 0..self.values.len() - (dx + dy + dz) {
                // A cell near the surface has all its corners near the surface.
                if self.values[i].abs() > 4.0 * self.spacing {
                    continue;
                }
                let inside = |offset: usize| self.values[i + offset] < 0.0;
                let count = cell.iter().filter(|&&o| inside(o)).count();
                if !(2..=6).contains(&count) {
                    continue;
                }
                let mixed_face = faces.iter().find(|[a, b, c, d]| {
                    inside(*a) == inside(*c) && inside(*b) == inside(*d) && inside(*a) != inside(*b)
                });
                // The ends of one diagonal against the six other corners.
                let mixed_cell = diagonals.iter().any(|&[a, b]| {
                    inside(a) == inside(b) && count == if inside(a) { 2 } else { 6 }
                });
                let corners = match mixed_face {
                    Some(face) => face.as_slice(),
                    None if mixed_cell => cell,
                    None => continue,
                };
                let distance = |o: &usize| self.values[i + o].abs();
                let nearest = corners
                    .iter()
                    .min_by(|a, b| distance(a).total_cmp(&distance(b)));
                if let Some(offset) = nearest {
                    self.values[i + offset] *= -1.0;
                    clean = false;
                }
            }
        }
    }
}
