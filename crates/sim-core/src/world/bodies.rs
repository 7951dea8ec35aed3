//! The properties of bodies: masses, materials and shapes, in columns. A step reads them and changes none.

use alloc::{boxed::Box, collections::BTreeMap, sync::Arc, vec::Vec};
use glam::DVec3;
use once_cell::race::OnceBox;

use super::{column::Column, filter::Filter, turning::Turners};
use crate::{
    Body, BodyKind, Bvh, Extent, Mesh, Shape,
    collide::{self, Form, snap},
};

/// The bodies of a world, by index.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    /// Mass for impulses and forces, kg: infinite for a body that is not dynamic.
    pub(super) mass: Vec<f64>,
    pub(super) kind: Column<BodyKind>,
    /// The masses, kg, that bodies which are not dynamic would have as dynamic bodies.
    pub(super) idle_mass: Column<f64>,
    /// Constant resultant, N.
    pub(super) force: Vec<DVec3>,
    /// The acceleration of each body by constant forces and weight, m/s².
    pub(super) acceleration: Vec<DVec3>,
    /// Coefficients of restitution.
    pub(super) restitution: Column<f64>,
    /// Coefficients of friction.
    pub(super) friction: Column<f64>,
    pub(super) user_data: Column<u64>,
    /// The pairs and groups that never collide, if there are any.
    pub(super) filter: Option<Box<Filter>>,
    /// The shape of each body, as an index of `shapes`; `None` is a point that meets nothing.
    shape: Vec<Option<u32>>,
    shapes: Vec<SharedShape>,
    /// The index of each shape in `shapes`.
    known_shapes: BTreeMap<ShapeKey, u32>,
    /// The bodies that have a shape.
    pub(super) solid: Vec<usize>,
    /// The data of turning bodies.
    pub(super) turners: Turners,
}

/// A shape, shared by all bodies that have it, and its tree, built when it is first needed.
#[derive(Clone, Debug)]
struct SharedShape {
    shape: Shape,
    extent: Extent,
    bvh: OnceBox<Arc<Bvh>>,
}

/// Equal shapes have equal keys: a mesh has its place in memory, because to compare triangles takes too long; other
/// shapes have the bits of their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ShapeKey {
    Mesh(usize),
    Sphere(u64),
    HalfSpace([u64; 3]),
}

impl ShapeKey {
    fn of(shape: &Shape) -> ShapeKey {
        match shape {
            Shape::Mesh(mesh) => ShapeKey::Mesh(Arc::as_ptr(mesh) as usize),
            Shape::Sphere { radius } => ShapeKey::Sphere(radius.to_bits()),
            Shape::HalfSpace { normal } => ShapeKey::HalfSpace(normal.to_array().map(f64::to_bits)),
        }
    }
}

impl Default for Bodies {
    /// No bodies.
    fn default() -> Bodies {
        Bodies {
            mass: Vec::new(),
            kind: Column::new(BodyKind::Dynamic),
            idle_mass: Column::new(1.0),
            force: Vec::new(),
            acceleration: Vec::new(),
            restitution: Column::new(1.0),
            friction: Column::new(0.0),
            user_data: Column::new(0),
            filter: None,
            shape: Vec::new(),
            shapes: Vec::new(),
            known_shapes: BTreeMap::new(),
            solid: Vec::new(),
            turners: Turners::default(),
        }
    }
}

impl Bodies {
    pub(super) fn len(&self) -> usize {
        self.mass.len()
    }

    /// Adds a body whose numbers have been checked.
    pub(super) fn push(&mut self, body: Body) {
        let index = self.len();
        let shape = body.shape.map(|shape| self.share(shape));
        self.mass.push(body.mass);
        self.set_kind(index, body.kind);
        self.force.push(body.force);
        self.acceleration.push(DVec3::ZERO);
        self.restitution.set(index, body.restitution);
        self.friction.set(index, body.friction);
        self.user_data.set(index, body.user_data);
        self.set_groups(index, body.groups);
        self.solid.extend(shape.map(|_| index));
        self.shape.push(shape);
    }

    /// Removes a body; the indices of the bodies after it decrease by one.
    pub(super) fn remove(&mut self, body: usize) {
        self.mass.remove(body);
        self.kind.remove(body);
        self.idle_mass.remove(body);
        self.force.remove(body);
        self.acceleration.remove(body);
        self.restitution.remove(body);
        self.friction.remove(body);
        self.user_data.remove(body);
        self.remove_from_filter(body);
        self.solid.retain(|&other| other != body);
        for other in self.solid.iter_mut().filter(|other| **other > body) {
            *other -= 1;
        }
        if let Some(shape) = self.shape.remove(body)
            && !self.shape.contains(&Some(shape))
        {
            self.forget_shape(shape);
        }
    }

    /// Removes a shape that no body has.
    fn forget_shape(&mut self, gone: u32) {
        self.shapes.remove(gone as usize);
        self.known_shapes.retain(|_, shape| *shape != gone);
        let known = self.known_shapes.values_mut();
        for shape in known.chain(self.shape.iter_mut().flatten()) {
            *shape -= u32::from(*shape > gone);
        }
    }

    /// Changes the kind of a body, which keeps its mass.
    pub(super) fn set_kind(&mut self, body: usize, kind: BodyKind) {
        let mass = self.own_mass(body);
        self.kind.set(body, kind);
        self.idle_mass
            .set(body, if kind.is_movable() { 1.0 } else { mass });
        self.mass[body] = if kind.is_movable() {
            mass
        } else {
            f64::INFINITY
        };
    }

    /// The mass of a body, kg; for a body that is not dynamic, the mass that it would have as a dynamic one.
    #[inline]
    pub(super) fn own_mass(&self, body: usize) -> f64 {
        match self.is_movable(body) {
            true => self.mass[body],
            false => self.idle_mass.get(body),
        }
    }

    pub(super) fn set_own_mass(&mut self, body: usize, mass: f64) {
        match self.is_movable(body) {
            true => self.mass[body] = mass,
            false => self.idle_mass.set(body, mass),
        }
    }

    /// The index of a shape; bodies with the same shape share it.
    fn share(&mut self, shape: Shape) -> u32 {
        let next = self.shapes.len() as u32;
        let place = *self
            .known_shapes
            .entry(ShapeKey::of(&shape))
            .or_insert(next);
        if place == next {
            self.shapes.push(SharedShape {
                extent: shape.extent(),
                shape,
                bvh: OnceBox::new(),
            });
        }
        place
    }

    /// Whether impulses and forces change the motion of a body.
    #[inline]
    pub(super) fn is_movable(&self, body: usize) -> bool {
        self.mass[body].is_finite()
    }

    #[inline]
    pub(super) fn restitution(&self, body: usize) -> f64 {
        self.restitution.get(body)
    }

    #[inline]
    pub(super) fn pair_restitution(&self, i: usize, j: usize) -> f64 {
        self.restitution(i).min(self.restitution(j))
    }

    pub(super) fn friction(&self, body: usize) -> f64 {
        self.friction.get(body)
    }

    /// The coefficient of friction between two bodies: the geometric mean of theirs; 0 if one of them is smooth,
    /// whatever the other is.
    pub(super) fn pair_friction(&self, i: usize, j: usize) -> f64 {
        let (first, second) = (self.friction(i), self.friction(j));
        if first == 0.0 || second == 0.0 {
            return 0.0;
        }
        // The root of the product, so that the mean of two equal coefficients is this coefficient to the bit.
        libm::sqrt(first * second)
    }

    /// Whether some body has friction.
    pub(super) fn is_rough(&self) -> bool {
        !self.friction.is_usual()
    }

    #[inline]
    fn shared_shape(&self, body: usize) -> Option<&SharedShape> {
        self.shape[body].map(|s| &self.shapes[s as usize])
    }

    #[inline]
    pub(super) fn has_shape(&self, body: usize) -> bool {
        self.shape[body].is_some()
    }

    #[inline]
    pub(super) fn shape(&self, body: usize) -> Option<&Shape> {
        self.shared_shape(body).map(|shared| &shared.shape)
    }

    /// Whether two bodies share a shape.
    pub(super) fn share_shape(&self, i: usize, j: usize) -> bool {
        self.shape[i] == self.shape[j]
    }

    /// Every shape once, in the order of their indices.
    #[cfg(feature = "serde")]
    pub(super) fn all_shapes(&self) -> impl Iterator<Item = &Shape> {
        self.shapes.iter().map(|shared| &shared.shape)
    }

    #[cfg(feature = "serde")]
    pub(super) fn shape_places(&self) -> impl Iterator<Item = Option<usize>> {
        let places = self.shape.iter();
        places.map(|place| place.map(|place| place as usize))
    }

    pub(super) fn mesh(&self, body: usize) -> Option<&Arc<Mesh>> {
        self.shape(body).and_then(Shape::mesh)
    }

    pub(super) fn is_half_space(&self, body: usize) -> bool {
        matches!(self.shape(body), Some(Shape::HalfSpace { .. }))
    }

    /// The extent of a body's shape about its position.
    #[inline]
    pub(super) fn extent(&self, body: usize) -> Extent {
        self.shared_shape(body)
            .map_or_else(Extent::default, |shared| shared.extent)
    }

    /// The tree over a body's mesh, if it has been built.
    #[inline]
    pub(super) fn bvh(&self, body: usize) -> Option<&Bvh> {
        let shared = self.shared_shape(body)?;
        shared.bvh.get().map(|bvh| &**bvh)
    }

    /// Builds the tree over a body's mesh, unless it exists.
    #[inline]
    pub(super) fn need_bvh(&self, body: usize) {
        if let Some(SharedShape {
            shape: Shape::Mesh(mesh),
            bvh,
            ..
        }) = self.shared_shape(body)
        {
            bvh.get_or_init(|| Box::new(Arc::new(Bvh::build(mesh))));
        }
    }

    /// A body's shape for tests of pairs; `None` for a mesh whose tree has not been built.
    #[inline]
    pub(super) fn form(&self, body: usize) -> Option<Form<'_>> {
        match *self.shape(body)? {
            Shape::Mesh(_) => self.bvh(body).map(Form::Mesh),
            Shape::Sphere { radius } => Some(Form::Sphere(radius)),
            Shape::HalfSpace { normal } => Some(Form::HalfSpace(normal)),
        }
    }

    /// The shapes of two bodies for tests of pairs; `None` if one of them tumbles.
    #[inline]
    pub(super) fn forms(&self, i: usize, j: usize) -> Option<(Form<'_>, Form<'_>)> {
        if self.pair_tumbles(i, j) {
            return None;
        }
        self.form(i).zip(self.form(j))
    }

    /// Whether two bodies meet, by their trees, with the second one at `offset` from the first.
    pub(super) fn meet_at(&self, i: usize, j: usize, offset: DVec3) -> bool {
        if let Some((first, second)) = self.mesh(i).zip(self.mesh(j))
            && !first.bounds().meets(&second.bounds(), snap(offset))
        {
            return false;
        }
        self.need_bvh(i);
        self.need_bvh(j);
        self.meet_built(i, j, offset)
    }

    /// The same, for trees that have been built.
    pub(super) fn meet_built(&self, i: usize, j: usize, offset: DVec3) -> bool {
        let offset = snap(offset);
        let forms = self.forms(i, j);
        forms.is_some_and(|(first, second)| collide::meet(first, second, offset))
    }
}
