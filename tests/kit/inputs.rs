//! What exact tests are tried with.

use sim_core::{Mesh, Vec3};

/// Triangles that share nothing, each by a corner and three tenths of the ways to the others.
pub fn soup(triangles: &[([f32; 3], [[f32; 3]; 2])]) -> Mesh {
    let corners = triangles.iter().flat_map(|&(at, arms)| {
        let [first, second] = arms.map(|arm| Vec3::from_array(at) + Vec3::from_array(arm) * 0.3);
        [Vec3::from_array(at), first, second]
    });
    let triangles = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    Mesh::new(corners.collect(), triangles.collect()).expect("three corners each")
}

/// A coordinate in a lattice that is moved by an offset, off by an ulp to either side or none.
pub fn hard_coordinate(cell: i32, ulps: i32, offset: f64) -> f64 {
    let x = f64::from(cell) + offset;
    match ulps {
        // Next to zero an ulp would leave the range of exact products.
        _ if x == 0.0 => f64::from(ulps) * f64::EPSILON,
        1 => x.next_up(),
        -1 => x.next_down(),
        _ => x,
    }
}
