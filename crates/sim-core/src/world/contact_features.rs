//! The vertices, edges and faces that touch in a contact: computed on request, not in the step.

use alloc::{collections::BTreeMap, vec::Vec};
use core::ops::ControlFlow;
use glam::DVec3;

use super::{RestingContact, World};
use crate::{
    Bvh, Feature, Mesh, Shape,
    collide::{each_in_box, first_contact, nearest, snap},
};

/// A feature belongs to a contact if the cosine of the angle between their normals is above this: 0.8 degrees.
const SAME_NORMAL: f64 = 0.9999;
/// If the cosine between the normals of two adjacent faces is above this, they are in one plane, and their edge is not
/// a feature of the surface.
const FLAT: f64 = 1.0 - 1e-9;

/// The features that touch at one point of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Touching {
    /// The vertices, edges or faces.
    pub feature: ContactFeature,
    /// The point on the first body, in the world, m.
    pub point: DVec3,
    /// The distance of the features along the normal of the contact, m.
    pub gap: f64,
}

/// The features that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactFeature {
    /// Of two meshes: a vertex in a face, or two crossing edges.
    Meshes(Feature),
    /// A vertex of the mesh, against a sphere or a half-space.
    Vertex(u32),
    /// An edge of the mesh, against a sphere.
    Edge(u32),
    /// A face of the mesh, against a sphere.
    Face(u32),
    /// Two spheres, or a sphere and a half-space.
    Smooth,
}

impl World {
    /// All features that touch in a contact of [`World::contacts`], at the current positions of the bodies, in the
    /// order of their indices. They are the corners of the area in which two faces lie on each other, or the single
    /// point at which round shapes touch. Empty if the bodies overlap.
    ///
    /// Features count if their distance along the normal of the contact exceeds that of its nearest ones by no more
    /// than [`World::flush`], and if their own normal is within 0.8 degrees of it. Other features belong to other
    /// contacts of the same bodies. A vertex is listed once, with the lowest of the faces in which it lies. Edges
    /// between triangles in one plane are left out.
    ///
    /// The cost grows with the number of triangles near the other body.
    pub fn contact_features(&self, contact: &RestingContact) -> Vec<Touching> {
        let (i, j) = contact.bodies;
        if contact.is_overlap || i.max(j) >= self.bodies.len() {
            return Vec::new();
        }
        self.bodies.need_bvh(i);
        self.bodies.need_bvh(j);
        let offset = self.current.position[j] - self.current.position[i];
        let mut touching = Near {
            normal: contact.normal,
            offset,
            most: self.gap_of(contact, offset) + self.flush(i, j),
            least: -self.flush(i, j),
            found: BTreeMap::new(),
        };
        match (self.bodies.shape(i), self.bodies.shape(j)) {
            (Some(Shape::Mesh(first)), Some(Shape::Mesh(second))) => {
                if let Some(trees) = self.bvh(i).zip(self.bvh(j)) {
                    touching.meshes((first, trees.0), (second, trees.1));
                }
            }
            (Some(Shape::Mesh(mesh)), Some(&Shape::Sphere { radius })) => {
                if let Some(tree) = self.bvh(i) {
                    touching.ball((mesh, tree), offset, radius, 1.0);
                }
            }
            (Some(&Shape::Sphere { radius }), Some(Shape::Mesh(mesh))) => {
                if let Some(tree) = self.bvh(j) {
                    touching.ball((mesh, tree), -offset, radius, -1.0);
                }
            }
            (Some(Shape::Mesh(mesh)), Some(Shape::HalfSpace { .. })) => {
                touching.corners(mesh, offset, -1.0);
            }
            (Some(Shape::HalfSpace { .. }), Some(Shape::Mesh(mesh))) => {
                touching.corners(mesh, -offset, 1.0);
            }
            (
                Some(Shape::Sphere { .. } | Shape::HalfSpace { .. }),
                Some(Shape::Sphere { .. } | Shape::HalfSpace { .. }),
            )
            | (None, _)
            | (_, None) => {
                let point = contact.point - self.current.position[i];
                let gap = touching.most + touching.least;
                touching.add(ContactFeature::Smooth, point, gap);
            }
        }
        let at = self.current.position[i];
        let found = touching.found.into_iter();
        found
            .map(|(feature, (point, gap))| Touching {
                feature,
                point: at + point,
                gap,
            })
            .collect()
    }

    /// The current distance of two bodies in contact along its normal, m.
    fn gap_of(&self, contact: &RestingContact, offset: DVec3) -> f64 {
        let (i, j) = contact.bodies;
        let hover = self.layout().hover_gap(i, j);
        let reach = 2.0 * contact.gap.max(0.0) + 16.0 * hover;
        let (start, way) = (
            offset + hover * contact.normal,
            -(reach + hover) * contact.normal,
        );
        let forms = self.bodies.forms(i, j);
        let touch = forms.and_then(|(a, b)| first_contact(a, b, snap(start), snap(way)));
        touch.map_or(contact.gap, |touch| touch.time * (reach + hover) - hover)
    }
}

/// The features near a contact, in the frame of the first body.
struct Near {
    normal: DVec3,
    offset: DVec3,
    /// The greatest and the least gap along the normal that count, m.
    most: f64,
    least: f64,
    found: BTreeMap<ContactFeature, (DVec3, f64)>,
}

/// A triangle with its indices in its mesh.
struct Triangle {
    corners: [DVec3; 3],
    vertices: [u32; 3],
    edges: [u32; 3],
    face: u32,
    normal: DVec3,
}

impl Triangle {
    fn of(mesh: &Mesh, face: u32, offset: DVec3) -> Triangle {
        let corners = mesh.corners(face as usize).map(|v| v.as_dvec3() + offset);
        let [a, b, c] = corners;
        Triangle {
            corners,
            vertices: mesh.triangles()[face as usize],
            edges: mesh.triangle_edges()[face as usize],
            face,
            normal: (b - a).cross(c - a).normalize_or_zero(),
        }
    }
}

impl Near {
    fn add(&mut self, feature: ContactFeature, point: DVec3, gap: f64) {
        if (self.least..=self.most).contains(&gap) {
            self.found.entry(feature).or_insert((point, gap));
        }
    }

    fn is_across(&self, normal: DVec3) -> bool {
        normal.dot(self.normal).abs() >= SAME_NORMAL
    }

    /// The point where the line from a point along the normal meets a triangle, and its distance, m.
    fn projected(&self, point: DVec3, triangle: &Triangle) -> Option<(DVec3, f64)> {
        let across = triangle.normal.dot(self.normal);
        let length = triangle.normal.dot(triangle.corners[0] - point) / across;
        let there = point + length * self.normal;
        let slack = self.least;
        let is_in = (0..3).all(|k| {
            let (a, b) = (triangle.corners[k], triangle.corners[(k + 1) % 3]);
            let inward = triangle.normal.cross(b - a).normalize_or_zero();
            inward.dot(there - a) >= slack
        });
        is_in.then_some((there, length))
    }

    fn meshes(&mut self, first: (&Mesh, &Bvh), second: (&Mesh, &Bvh)) {
        let wide = DVec3::splat(self.most.max(0.0) - self.least);
        let bounds = first.1.bounds();
        let (low, high) = (
            bounds.min.as_dvec3() - wide - self.offset,
            bounds.max.as_dvec3() + wide - self.offset,
        );
        let mut crossings = Vec::new();
        let _ = each_in_box(second.1, low, high, |face, _| {
            let other = Triangle::of(second.0, face, self.offset);
            let [a, b, c] = other.corners;
            let (low, high) = (a.min(b).min(c) - wide, a.max(b).max(c) + wide);
            let _ = each_in_box(first.1, low, high, |face, _| {
                let own = Triangle::of(first.0, face, DVec3::ZERO);
                self.vertices_in_faces(&own, &other);
                self.crossing_edges((first.0, &own), (second.0, &other), &mut crossings);
                ControlFlow::<()>::Continue(())
            });
            ControlFlow::<()>::Continue(())
        });
        let flat = [
            flat_edges(first.0, &crossings, |f| f.0),
            flat_edges(second.0, &crossings, |f| f.1),
        ];
        for (edges, point, gap) in crossings {
            if flat[0].binary_search(&edges.0).is_err() && flat[1].binary_search(&edges.1).is_err()
            {
                let feature = Feature::EdgeEdge {
                    first: edges.0,
                    second: edges.1,
                };
                self.add(ContactFeature::Meshes(feature), point, gap);
            }
        }
        self.name_vertices_once();
    }

    fn vertices_in_faces(&mut self, own: &Triangle, other: &Triangle) {
        if self.is_across(own.normal) {
            for k in 0..3 {
                if let Some((point, length)) = self.projected(other.corners[k], own) {
                    let (face, vertex) = (own.face, other.vertices[k]);
                    let feature = Feature::FaceVertex { face, vertex };
                    self.add(ContactFeature::Meshes(feature), point, -length);
                }
            }
        }
        if self.is_across(other.normal) {
            for k in 0..3 {
                if let Some((_, length)) = self.projected(own.corners[k], other) {
                    let (vertex, face) = (own.vertices[k], other.face);
                    let feature = Feature::VertexFace { vertex, face };
                    self.add(ContactFeature::Meshes(feature), own.corners[k], length);
                }
            }
        }
    }

    fn crossing_edges(
        &self,
        (first, own): (&Mesh, &Triangle),
        (second, other): (&Mesh, &Triangle),
        found: &mut Vec<((u32, u32), DVec3, f64)>,
    ) {
        let ends = |mesh: &Mesh, edge: u32, offset: DVec3| {
            mesh.edges()[edge as usize].map(|v| mesh.vertices()[v as usize].as_dvec3() + offset)
        };
        for &edge in &own.edges {
            let [p, q] = ends(first, edge, DVec3::ZERO);
            for &other_edge in &other.edges {
                let [r, s] = ends(second, other_edge, self.offset);
                let (u, w) = (q - p, s - r);
                let Some(across) = u.cross(w).try_normalize() else {
                    continue;
                };
                if !self.is_across(across) {
                    continue;
                }
                // In the projection along the normal.
                let area = self.normal.dot(u.cross(w));
                let along_own = self.normal.dot((r - p).cross(w)) / area;
                let along_other = self.normal.dot((r - p).cross(u)) / area;
                let inside = |part: f64, length: f64| {
                    let slack = -self.least / length;
                    part > slack && part < 1.0 - slack
                };
                if inside(along_own, u.length()) && inside(along_other, w.length()) {
                    let point = p + along_own * u;
                    let gap = self.normal.dot(r + along_other * w - point);
                    found.push(((edge, other_edge), point, gap));
                }
            }
        }
    }

    /// For each vertex, keeps only the contact with the lowest of the faces in which it lies.
    fn name_vertices_once(&mut self) {
        let mut named: BTreeMap<(bool, u32), u32> = BTreeMap::new();
        self.found.retain(|feature, _| {
            let (key, face) = match *feature {
                ContactFeature::Meshes(Feature::VertexFace { vertex, face }) => {
                    ((true, vertex), face)
                }
                ContactFeature::Meshes(Feature::FaceVertex { face, vertex }) => {
                    ((false, vertex), face)
                }
                _ => return true,
            };
            *named.entry(key).or_insert(face) == face
        });
    }

    /// The features of a mesh that a sphere touches, in the frame of the mesh. `sign` is 1 if the mesh is the first
    /// body.
    fn ball(&mut self, (mesh, tree): (&Mesh, &Bvh), centre: DVec3, radius: f64, sign: f64) {
        let reach = DVec3::splat(radius + self.most.max(0.0));
        let slack = -self.least;
        let mut flat: Vec<(u32, DVec3, f64)> = Vec::new();
        let _ = each_in_box(tree, centre - reach, centre + reach, |face, _| {
            let triangle = Triangle::of(mesh, face, DVec3::ZERO);
            let point = nearest(centre, triangle.corners);
            let way = centre - point;
            let gap = way.length() - radius;
            // A distance as short as rounding has no direction.
            let is_along =
                |way: DVec3| sign * way.normalize_or_zero().dot(self.normal) >= SAME_NORMAL;
            if way.length() > slack && !is_along(way) {
                return ControlFlow::<()>::Continue(());
            }
            let from = match sign > 0.0 {
                true => point,
                // The point on the sphere.
                false => radius * self.normal,
            };
            if self.is_across(triangle.normal) {
                flat.push((face, from, gap));
                return ControlFlow::Continue(());
            }
            let corner = (0..3).find(|&k| (triangle.corners[k] - point).length() <= slack);
            let edge = (0..3).find(|&k| {
                let [a, b] = mesh.edges()[triangle.edges[k] as usize]
                    .map(|v| mesh.vertices()[v as usize].as_dvec3());
                let along = (b - a).normalize_or_zero();
                (point - a).reject_from_normalized(along).length() <= slack
            });
            match (corner, edge) {
                (Some(k), _) => self.add(ContactFeature::Vertex(triangle.vertices[k]), from, gap),
                (None, Some(k)) => self.add(ContactFeature::Edge(triangle.edges[k]), from, gap),
                (None, None) => self.add(ContactFeature::Face(face), from, gap),
            }
            ControlFlow::Continue(())
        });
        // Over a plane the sphere touches one face, and neither edges nor corners.
        if let Some(&(face, point, gap)) = flat.iter().min_by_key(|&&(face, ..)| face) {
            self.found.clear();
            self.add(ContactFeature::Face(face), point, gap);
        }
    }

    /// The vertices of a mesh near a plane through a point of its frame. `sign` is 1 if the mesh is the second body.
    fn corners(&mut self, mesh: &Mesh, plane: DVec3, sign: f64) {
        for (vertex, place) in mesh.vertices().iter().enumerate() {
            let place = place.as_dvec3();
            let gap = sign * self.normal.dot(place - plane);
            let own = match sign > 0.0 {
                true => place - plane - gap * self.normal,
                false => place,
            };
            self.add(ContactFeature::Vertex(vertex as u32), own, gap);
        }
    }
}

/// The edges in some crossings that lie between triangles in one plane, in order.
fn flat_edges(
    mesh: &Mesh,
    crossings: &[((u32, u32), DVec3, f64)],
    of: impl Fn(&(u32, u32)) -> u32,
) -> Vec<u32> {
    let mut edges: Vec<u32> = crossings.iter().map(|(edges, ..)| of(edges)).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut normals: BTreeMap<u32, Vec<DVec3>> = BTreeMap::new();
    if edges.is_empty() {
        return edges;
    }
    for (face, of_face) in mesh.triangle_edges().iter().enumerate() {
        for edge in of_face {
            if edges.binary_search(edge).is_ok() {
                let normal = Triangle::of(mesh, face as u32, DVec3::ZERO).normal;
                normals.entry(*edge).or_default().push(normal);
            }
        }
    }
    edges.retain(|edge| {
        let normals = normals.get(edge).map_or(&[][..], Vec::as_slice);
        normals.len() == 2 && normals[0].dot(normals[1]).abs() >= FLAT
    });
    edges
}
