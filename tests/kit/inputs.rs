//! Inputs for exact tests.

use sim_core::{Mesh, Vec3};

/// Triangles without shared vertices. Each is given by a corner and two vectors; 0.3 times these lead to the other
/// corners.
pub fn soup(triangles: &[([f32; 3], [[f32; 3]; 2])]) -> Mesh {
    let corners = triangles.iter().flat_map(|&(at, arms)| {
        let [first, second] = arms.map(|arm| Vec3::from_array(at) + Vec3::from_array(arm) * 0.3);
        [Vec3::from_array(at), first, second]
    });
    let triangles = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    Mesh::new(corners.collect(), triangles.collect()).expect("three corners each")
}

/// A coordinate on a lattice that is moved by an offset, changed by up to one ulp.
pub fn hard_coordinate(cell: i32, ulps: i32, offset: f64) -> f64 {
    let x = f64::from(cell) + offset;
    match ulps {
        // Near zero an ulp would leave the range of exact products.
        _ if x == 0.0 => f64::from(ulps) * f64::EPSILON,
        1 => x.next_up(),
        -1 => x.next_down(),
        _ => x,
    }
}
