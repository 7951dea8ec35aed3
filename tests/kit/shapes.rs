//! Shapes of bodies.

use sim_core::{DVec3, Shape, Vec3};

use crate::meshes;

/// A ball, or a point.
pub fn ball(radius: f64) -> Shape {
    Shape::Sphere { radius }
}

/// The half-space below a plane.
pub fn half_space(normal: DVec3) -> Shape {
    Shape::HalfSpace { normal }
}

/// A mesh from valid vertices and triangles.
pub fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Shape {
    Shape::Mesh(meshes::mesh(vertices, triangles))
}

/// A box centred at the origin, by its half extents.
pub fn cuboid(half: impl Into<Vec3>) -> Shape {
    Shape::Mesh(meshes::cuboid(half))
}

/// The cube of the gallery, whose side is 1 m.
pub fn cube() -> Shape {
    Shape::Mesh(meshes::builtin("cube.obj"))
}

/// The cow of the gallery.
pub fn cow() -> Shape {
    Shape::Mesh(meshes::builtin("cow.obj"))
}

/// A scaled mesh.
pub fn scaled(shape: &Shape, scale: DVec3) -> Shape {
    Shape::Mesh(meshes::scaled(shape.mesh().expect("a mesh"), scale))
}
