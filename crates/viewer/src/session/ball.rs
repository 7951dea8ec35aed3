//! Meshes for drawing spheres: octahedra whose faces are repeatedly subdivided in four.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use glam::{DQuat, DVec3, Vec3};
use sim_core::Mesh;

/// The number of subdivisions: the error of the outline is then below a thousandth of the radius.
const CUTS: u32 = 5;

/// One mesh for each radius drawn.
#[derive(Default)]
pub(super) struct Balls(Vec<(f64, Arc<Mesh>)>);

impl Balls {
    /// The mesh of a sphere; `None` if the radius is too small or too large for one.
    pub(super) fn mesh(&mut self, radius: f64) -> Option<Arc<Mesh>> {
        if let Some((_, known)) = self.0.iter().find(|known| known.0 == radius) {
            return Some(known.clone());
        }
        static UNIT: OnceLock<Option<Mesh>> = OnceLock::new();
        let unit = UNIT.get_or_init(unit).as_ref()?;
        let mesh = unit.transformed(DQuat::IDENTITY, DVec3::splat(radius));
        let mesh = Arc::new(mesh.ok()?);
        self.0.push((radius, mesh.clone()));
        Some(mesh)
    }
}

fn unit() -> Option<Mesh> {
    let mut vertices: Vec<Vec3> = Vec3::AXES
        .into_iter()
        .flat_map(|axis| [axis, -axis])
        .collect();
    let mut triangles = Vec::new();
    for x in [0, 1] {
        for y in [2, 3] {
            for z in [4, 5] {
                let is_even = (x + y + z) % 2 == 0;
                triangles.push(if is_even { [x, y, z] } else { [y, x, z] });
            }
        }
    }
    for _ in 0..CUTS {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let between = vertices[a as usize] + vertices[b as usize];
                vertices.push(between.normalize());
                vertices.len() as u32 - 1
            })
        };
        let cut = triangles.iter().flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        });
        triangles = cut.collect();
    }
    Mesh::new(vertices, triangles).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_are_round_closed_and_made_once() {
        let mut balls = Balls::default();
        let ball = balls.mesh(2.5).expect("a mesh");
        assert!(ball.is_closed() && ball.is_oriented());
        let volume = ball.volume().expect("closed");
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 2.5_f64.powi(3);
        assert!(
            (0.99..1.0).contains(&(volume / exact)),
            "{volume} of {exact}"
        );
        let again = balls.mesh(2.5).expect("a mesh");
        assert!(Arc::ptr_eq(&ball, &again));
        for radius in [0.0, 1e100] {
            assert!(balls.mesh(radius).is_none(), "{radius}");
        }
    }
}
