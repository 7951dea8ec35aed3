//! The meshes of the benchmarks, each made once and prepared for every peer.

use std::cell::RefCell;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::rc::Rc;

use parry3d::math::Vector;
use parry3d::shape::TriMesh;
use sim_core::{Bvh, DVec3, Mesh};

/// A mesh by its construction. Numbers are of triangles, accurate to within 1 %.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Shape {
    /// The built-in cube.
    Cube,
    /// The project's cow.
    Cow(usize),
    /// A tube along a trefoil knot: concave everywhere, with holes in its bounding box.
    Knot(usize),
    /// A sphere with bumps of a tenth of its radius.
    Bumpy(usize),
    /// A sphere with a radius in thousandths.
    Sphere(usize, u32),
}

impl Shape {
    pub(crate) fn triangles(self) -> usize {
        match self {
            Shape::Cube => 12,
            Shape::Cow(n) | Shape::Knot(n) | Shape::Bumpy(n) | Shape::Sphere(n, _) => n,
        }
    }

    /// Such as `cow 6k`.
    pub(crate) fn name(self) -> String {
        let thousands = self.triangles() as f64 / 1000.0;
        match self {
            Shape::Cube => "cube".into(),
            Shape::Cow(_) => format!("cow {thousands}k"),
            Shape::Knot(_) => format!("knot {thousands}k"),
            Shape::Bumpy(_) => format!("bumpy {thousands}k"),
            Shape::Sphere(..) => format!("sphere {thousands}k"),
        }
    }

    fn make(self) -> Mesh {
        match self {
            Shape::Cube => {
                (*scene::mesh_file::builtin("cube.obj").expect("the cube is built in")).clone()
            }
            Shape::Cow(triangles) => {
                let cow = cow::cow(triangles).expect("a cow of this size can be made");
                let vertices = cow.vertices.into_iter().map(Into::into).collect();
                Mesh::new(vertices, cow.triangles).expect("the cow is a mesh")
            }
            Shape::Knot(triangles) => knot(triangles),
            Shape::Bumpy(triangles) => sphere(triangles, |p| {
                1.0 + 0.1 * (7.0 * p.x).sin() * (6.0 * p.y + 1.0).sin() * (8.0 * p.z + 2.0).cos()
            }),
            Shape::Sphere(triangles, thousandths) => {
                sphere(triangles, |_| f64::from(thousandths) / 1000.0)
            }
        }
    }
}

/// A mesh with its tree, and the same mesh in parry.
pub(crate) struct Solid {
    pub(crate) mesh: Mesh,
    pub(crate) bvh: Bvh,
    pub(crate) parry: TriMesh,
}

impl Solid {
    pub(crate) fn of(mesh: Mesh) -> Solid {
        Solid {
            bvh: Bvh::build(&mesh),
            parry: parry_mesh(&mesh),
            mesh,
        }
    }
}

fn parry_mesh(mesh: &Mesh) -> TriMesh {
    let vertices = mesh
        .vertices()
        .iter()
        .map(|v| Vector::from_array(v.to_array()));
    TriMesh::new(vertices.collect(), mesh.triangles().to_vec()).expect("parry takes every mesh")
}

/// The solids made so far.
#[derive(Default)]
pub(crate) struct Solids {
    made: RefCell<HashMap<Shape, Rc<Solid>>>,
}

impl Solids {
    pub(crate) fn get(&self, shape: Shape) -> Rc<Solid> {
        let mut made = self.made.borrow_mut();
        let solid = made.entry(shape).or_insert_with(|| {
            let mesh = shape.make();
            let volume = mesh.volume().expect("shapes are closed and oriented");
            assert!(volume > 0.0, "shapes are wound outward");
            Rc::new(Solid::of(mesh))
        });
        Rc::clone(solid)
    }
}

/// A (2, 3) torus knot.
fn knot(triangles: usize) -> Mesh {
    // The triangles are about as long as wide: the tube is some fifteen times as long as its circumference.
    let around = (triangles as f64 / 30.0).sqrt().round() as usize;
    let along = triangles / 2 / around;
    let curve = |t: f64| {
        let r = 0.7 + 0.25 * (3.0 * t).cos();
        DVec3::new(
            r * (2.0 * t).cos(),
            r * (2.0 * t).sin(),
            0.25 * (3.0 * t).sin(),
        )
    };
    let mut vertices = Vec::with_capacity(around * along);
    for i in 0..along {
        let t = TAU * i as f64 / along as f64;
        let tangent = (curve(t + 1e-4) - curve(t - 1e-4)).normalize();
        // The tangent is nowhere close to the direction from the core circle.
        let core = DVec3::new(0.7 * (2.0 * t).cos(), 0.7 * (2.0 * t).sin(), 0.0);
        let normal = (curve(t) - core)
            .reject_from_normalized(tangent)
            .normalize();
        let binormal = tangent.cross(normal);
        vertices.extend((0..around).map(|j| {
            let (sin, cos) = (TAU * j as f64 / around as f64).sin_cos();
            (curve(t) + 0.12 * (cos * normal + sin * binormal)).as_vec3()
        }));
    }
    let at = |i: usize, j: usize| ((i % along) * around + j % around) as u32;
    let faces = (0..along).flat_map(|i| {
        (0..around).flat_map(move |j| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, c, b], [a, d, c]]
        })
    });
    Mesh::new(vertices, faces.collect()).expect("the knot is a mesh")
}

/// An octahedron with each face cut into `n * n`, projected to a radius that depends on the direction.
fn sphere(triangles: usize, radius: impl Fn(DVec3) -> f64) -> Mesh {
    let n = (triangles as f64 / 8.0).sqrt().round() as i32;
    let mut vertices = Vec::new();
    let mut index_of = HashMap::new();
    let mut index = |point: [i32; 3]| {
        *index_of.entry(point).or_insert_with(|| {
            let direction = DVec3::from_array(point.map(f64::from)).normalize();
            vertices.push((direction * radius(direction)).as_vec3());
            vertices.len() as u32 - 1
        })
    };
    let mut faces = Vec::new();
    for octant in 0..8 {
        let sign = [0, 1, 2].map(|axis| 1 - 2 * (octant >> axis & 1));
        let mut point = |i: i32, j: i32| index([i * sign[0], j * sign[1], (n - i - j) * sign[2]]);
        let mut face = |[a, b, c]: [u32; 3]| {
            let outward = sign.iter().product::<i32>() > 0;
            faces.push(if outward { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..n {
            for j in 0..n - i {
                let [a, b, c] = [point(i, j), point(i + 1, j), point(i, j + 1)];
                face([a, b, c]);
                if i + j + 1 < n {
                    face([b, point(i + 1, j + 1), c]);
                }
            }
        }
    }
    Mesh::new(vertices, faces).expect("the sphere is a mesh")
}
