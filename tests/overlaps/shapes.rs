//! Bodies, and worlds in which they are placed in each other.

use std::sync::Arc;

use sim_core::{Body, DVec3, Force, Mesh, Settings, Shape, Vec3, World};

/// Numbers from a sequence of Marsaglia's (2003, "Xorshift RNGs").
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// From -1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() >> 33) as usize % count
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}

/// A box about the origin.
pub(crate) fn cuboid(half: Vec3) -> Shape {
    let vertices = (0..8).map(|i| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { half } else { -half }[axis];
        Vec3::new(pick(0), pick(1), pick(2))
    });
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let mesh = Mesh::new(vertices.collect(), triangles.collect()).expect("a box");
    Shape::Mesh(Arc::new(mesh))
}

pub(crate) fn cube() -> Shape {
    cuboid(Vec3::splat(0.5))
}

pub(crate) fn cow() -> Shape {
    Shape::Mesh(scene::mesh_file::builtin("cow.obj").expect("built in"))
}

pub(crate) fn ball(radius: f64) -> Shape {
    Shape::Sphere { radius }
}

pub(crate) fn half_space(normal: DVec3) -> Shape {
    Shape::HalfSpace { normal }
}

pub(crate) fn at(shape: &Shape, position: DVec3) -> Body {
    Body {
        shape: Some(shape.clone()),
        position,
        ..Body::default()
    }
}

pub(crate) fn immovable(body: Body) -> Body {
    Body {
        mass: f64::INFINITY,
        ..body
    }
}

pub(crate) fn world(bodies: impl IntoIterator<Item = Body>) -> World {
    let mut world = World::new(Settings::default()).expect("settings");
    for body in bodies {
        world.add(body).expect("a body");
    }
    world
}

pub(crate) fn add_gravity(world: &mut World) {
    let acceleration = DVec3::new(0.0, -9.81, 0.0);
    world
        .add_force(Force::Gravity { acceleration })
        .expect("gravity");
}

/// Whether two shapes meet, the second one at an offset from the first.
pub(crate) fn meet(first: &Shape, second: &Shape, offset: DVec3) -> bool {
    let pair = world([at(first, DVec3::ZERO), at(second, offset)]);
    !pair.overlapping().is_empty()
}

/// The least distance along a direction from which on two shapes are apart, within 1e-13 of the size.
pub(crate) fn touching(first: &Shape, second: &Shape, direction: DVec3) -> f64 {
    // Within the way they may be apart as well, as a mesh is hollow.
    let mut high = 64.0;
    while !meet(first, second, high * direction) {
        high *= 0.95;
    }
    let mut low = high;
    high /= 0.95;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match meet(first, second, middle * direction) {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}
