//! Placements that are hard for floating point, with answers by construction or rational arithmetic.

use std::rc::Rc;

use kit::oracle;
use kit::random::Random;
use sim_core::{DQuat, DVec3, Mesh, Vec3};

use crate::meshes::{Shape, Solid, Solids};
use crate::placements::Placement;

/// Two solids that touch, overlap, or are slightly apart.
pub(crate) struct Degenerate {
    pub(crate) first: Rc<Solid>,
    pub(crate) second: Rc<Solid>,
    pub(crate) placement: Placement,
}

/// Every kind. The meshes are small, so a few hundred are made quickly.
pub(crate) fn all(solids: &Solids) -> Vec<Degenerate> {
    let cube = solids.get(Shape::Cube);
    let mut all = cubes(&cube.mesh);
    all.extend(triangles());
    all
}

/// Lengths from 1e-10 to 1e10, as powers of two so that everything stays exact.
const SCALES: [f64; 3] = [1.0 / (1u64 << 33) as f64, 1.0, (1u64 << 33) as f64];

/// Two cubes on a lattice of half edges: faces, edges and corners that touch, and cubes inside cubes. They meet if
/// their boxes do and neither is strictly inside the other.
fn cubes(unit_cube: &Mesh) -> Vec<Degenerate> {
    let cube = |edge: f64| {
        let cube = unit_cube.transformed(DQuat::IDENTITY, DVec3::splat(edge));
        cube.expect("a cube may have any size")
    };
    let mut placements = Vec::new();
    for scale in SCALES {
        let first = Rc::new(Solid::of(cube(2.0 * scale)));
        for edge in [1.0, 2.0, 6.0] {
            let second = Rc::new(Solid::of(cube(edge * scale)));
            for halves in lattice(4) {
                placements.push(Degenerate {
                    first: Rc::clone(&first),
                    second: Rc::clone(&second),
                    placement: Placement {
                        offset: halves * 0.5 * scale,
                        meet: cubes_meet(halves * 0.5, edge),
                    },
                });
            }
        }
    }
    // The second cube has coordinates 1.3e8 away from its origin, and the offset compensates that.
    let (unit, far) = (64.0, DVec3::splat((1 << 27) as f64));
    let first = Rc::new(Solid::of(cube(2.0 * unit)));
    for edge in [1.0, 2.0, 6.0] {
        let near = cube(edge * unit);
        let away = near
            .vertices()
            .iter()
            .map(|v| (v.as_dvec3() - far).as_vec3());
        let second = Mesh::new(away.collect(), near.triangles().to_vec()).expect("a cube");
        let second = Rc::new(Solid::of(second));
        placements.extend(lattice(4).map(|halves| Degenerate {
            first: Rc::clone(&first),
            second: Rc::clone(&second),
            placement: Placement {
                offset: far + halves * 0.5 * unit,
                meet: cubes_meet(halves * 0.5, edge),
            },
        }));
    }
    placements
}

/// Whether the surfaces of a cube of edge 2 and one of `edge`, `apart` from each other, meet.
fn cubes_meet(apart: DVec3, edge: f64) -> bool {
    let (most, half) = (apart.abs().max_element(), edge / 2.0);
    let inside = most < 1.0 - half || most < half - 1.0;
    most <= 1.0 + half && !inside
}

/// Points with integer coordinates up to `most`, of both signs.
fn lattice(most: i32) -> impl Iterator<Item = DVec3> {
    let cells = (0..=most)
        .flat_map(move |x| (0..=most).flat_map(move |y| (0..=most).map(move |z| [x, y, z])));
    cells.enumerate().map(|(i, cell)| {
        let sign = |axis: usize| 1 - 2 * (i as i32 >> axis & 1);
        DVec3::from_array([0, 1, 2].map(|axis| f64::from(sign(axis) * cell[axis])))
    })
}

/// Single triangles on a small lattice: many touch at corners and edges, lie in one plane, or have no area. Every other
/// one is a sliver, with a corner one ulp off the line of the others.
fn triangles() -> Vec<Degenerate> {
    let mut random = Random::splitmix(1);
    let mut placements = Vec::new();
    for i in 0..300 {
        let scale = SCALES[i % 3];
        let flat = i % 4 == 0;
        let mut triangle = || {
            let mut corner = || {
                let cell = [0; 3].map(|_: i32| random.below(4) as f32);
                Vec3::from_array(cell)
                    * if flat {
                        Vec3::new(1.0, 1.0, 0.0)
                    } else {
                        Vec3::ONE
                    }
            };
            let mut corners = [corner(), corner(), corner()];
            if i % 2 == 1 {
                corners[2] = (corners[0] + corners[1]) / 2.0;
                corners[2].x = corners[2].x.next_up();
            }
            Mesh::new(corners.map(|v| v * scale as f32).to_vec(), vec![[0, 1, 2]])
                .expect("a triangle")
        };
        let (first, second) = (triangle(), triangle());
        let offset = DVec3::from_array([0; 3].map(|_: i32| random.below(3) as f64 - 1.0));
        let offset = offset
            * if flat {
                DVec3::new(1.0, 1.0, 0.0)
            } else {
                DVec3::ONE
            }
            * scale;
        let corners = [&first, &second].map(|mesh| mesh.corners(0).map(|v| v.as_dvec3()));
        let meet = oracle::triangles_meet(corners[0], corners[1].map(|v| v + offset));
        placements.push(Degenerate {
            first: Rc::new(Solid::of(first)),
            second: Rc::new(Solid::of(second)),
            placement: Placement { offset, meet },
        });
    }
    placements
}
