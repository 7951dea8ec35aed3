//! The corner, edge or face of each body at an impact.

use sim_core::{Bvh, DVec3, Feature, Impact, Mesh, Shape, World};

use super::Session;
use crate::picture::{Line, Pane};

const VIOLET: [f32; 3] = [0.58, 0.05, 0.85];
/// The distance up to which a point counts as lying on a feature, and its height above the surface, in sizes of the
/// mesh.
const NEAR: f64 = 1e-5;
/// The height of the drawing above the surface, in sizes of the mesh.
const OUT: f64 = 2e-3;

/// A part of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A vertex, by its index.
    Corner(u32),
    /// An edge, by its index.
    Edge(u32),
    /// A triangle, by its index.
    Face(u32),
}

impl Part {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corner(_) => "corner",
            Self::Edge(_) => "edge",
            Self::Face(_) => "face",
        }
    }
}

/// The parts of the first and of the second body that touch in an impact; `None` for a body without triangles.
pub(super) fn parts(world: &World, impact: &Impact) -> [Option<Part>; 2] {
    if let Some(feature) = impact.feature {
        return match feature {
            Feature::VertexFace { vertex, face } => [Part::Corner(vertex), Part::Face(face)],
            Feature::FaceVertex { face, vertex } => [Part::Face(face), Part::Corner(vertex)],
            Feature::EdgeEdge { first, second } => [Part::Edge(first), Part::Edge(second)],
        }
        .map(Some);
    }
    let ((i, j), (a, b)) = (impact.bodies, impact.positions);
    let (first, second) = impact.rotations;
    let sides = [(i, a, first, impact.normal), (j, b, second, -impact.normal)];
    sides.map(|(body, place, rotation, outward)| {
        let mesh = world.mesh(body)?;
        // In the frame of the mesh. The position of a turning body is its centre of mass.
        let back = rotation.inverse();
        let centre = world.inertia(body).map(|inertia| inertia.centre());
        let point = back * (impact.point - place) + centre.unwrap_or_default();
        at(mesh, world.bvh(body)?, point, back * outward)
    })
}

/// The part of a mesh at a point of its surface, viewed from outside.
fn at(mesh: &Mesh, bvh: &Bvh, point: DVec3, outward: DVec3) -> Option<Part> {
    let size = mesh.bounds().half_extent().max_element();
    let hit = bvh.ray(point + 1e3 * NEAR * size * outward, -outward)?;
    let near = NEAR * size;
    let corners = mesh
        .corners(hit.face as usize)
        .map(|corner| corner.as_dvec3());
    if let Some(k) = (0..3).find(|&k| corners[k].distance(point) <= near) {
        return Some(Part::Corner(mesh.triangles()[hit.face as usize][k]));
    }
    let on_edge = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let along = (b - a).normalize_or_zero();
        (point - a).reject_from_normalized(along).length() <= near
    };
    match (0..3).find(|&k| on_edge(k)) {
        Some(k) => Some(Part::Edge(mesh.triangle_edges()[hit.face as usize][k])),
        None => Some(Part::Face(hit.face)),
    }
}

impl Session {
    /// The parts of the first and of the second body that touch in an impact; `None` for a body without triangles.
    pub fn touching(&self, impact: &Impact) -> [Option<Part>; 2] {
        parts(&self.world, impact)
    }

    /// Draws the touching parts of an impact on its bodies as drawn now.
    pub(super) fn add_touching(
        &self,
        impact: &Impact,
        opacity: f32,
        panes: &mut Vec<Pane>,
        marks: &mut Vec<Line>,
    ) {
        let (i, j) = impact.bodies;
        let outward = [impact.normal, -impact.normal];
        let sides = [i, j].into_iter().zip(outward);
        for ((body, outward), part) in sides.zip(self.touching(impact)) {
            let (Some(Shape::Mesh(mesh)), Some(part)) = (self.world.shape(body), part) else {
                continue;
            };
            let size = mesh.bounds().half_extent().max_element();
            let (place, rotation) = (self.shown_position(body), self.shown_rotation(body));
            let vertex = |v: u32| place + rotation * mesh.vertices()[v as usize].as_dvec3();
            let [red, green, blue] = VIOLET;
            let mut line = |from: DVec3, to: DVec3, width: f32| {
                marks.push(Line {
                    from,
                    to,
                    colour: [red, green, blue, opacity],
                    width,
                });
            };
            match part {
                // Wider than the point of the impact drawn on it.
                Part::Corner(v) => line(vertex(v), vertex(v), 16.0),
                Part::Edge(e) => {
                    let [a, b] = mesh.edges()[e as usize].map(vertex);
                    line(a, b, 5.0);
                }
                Part::Face(f) => {
                    let corners = mesh.triangles()[f as usize].map(vertex);
                    for k in 0..3 {
                        line(corners[k], corners[(k + 1) % 3], 2.5);
                    }
                    panes.push(Pane {
                        corners: corners.map(|at| at + OUT * size * outward).to_vec(),
                        colour: [red, green, blue, 0.5 * opacity],
                    });
                }
            }
        }
    }
}
