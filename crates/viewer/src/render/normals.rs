//! Normals for each corner of a mesh: smooth across gentle folds, separate at sharp ones.

use glam::Vec3;
use sim_core::Mesh;

/// The cosine of the fold angle above which an edge is sharp: 35 degrees between the normals of its faces.
const CREASE: f32 = 0.819_152;
/// The cosine of half that angle: two faces within it of one normal are within the full angle of each other.
const GENTLE: f32 = 0.953_717;

/// A vertex; the layout matches `shaders/surface.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
}

/// A mesh's triangles with normals. Corners with equal position and normal share a vertex.
pub(super) struct Shaded {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
}

impl Shaded {
    /// Faces at a vertex that are connected by gentle folds share the mean of their normals, weighted by their angles
    /// there.
    pub(super) fn new(mesh: &Mesh) -> Self {
        let triangles = mesh.triangles();
        let positions = mesh.vertices();
        let faces: Vec<Face> = triangles
            .iter()
            .map(|triangle| Face::new(triangle.map(|corner| positions[corner as usize])))
            .collect();
        let around = CornersAround::new(triangles, positions.len());

        let mut vertices = Vec::with_capacity(positions.len());
        let mut indices = vec![0; 3 * triangles.len()];
        let mut fan = Fan::default();
        for (vertex, &position) in positions.iter().enumerate() {
            let corners = around.of(vertex);
            fan.group(vertex as u32, corners, triangles, &faces);
            for (place, &corner) in corners.iter().enumerate() {
                let group = fan.groups[place];
                if group == place {
                    let first = faces[corner as usize / 3].normal;
                    let sum: Vec3 = (place..corners.len())
                        .filter(|&other| fan.groups[other] == group)
                        .map(|other| {
                            let corner = corners[other] as usize;
                            faces[corner / 3].angles[corner % 3] * faces[corner / 3].normal
                        })
                        .sum();
                    fan.emitted[place] = vertices.len() as u32;
                    vertices.push(Vertex {
                        position: position.to_array(),
                        normal: sum.try_normalize().unwrap_or(first).to_array(),
                    });
                }
                indices[corner as usize] = fan.emitted[group];
            }
        }
        Self { vertices, indices }
    }
}

/// A face's unit normal (zero if it has no area) and the angles at its corners, radians.
struct Face {
    normal: Vec3,
    angles: [f32; 3],
}

impl Face {
    fn new([a, b, c]: [Vec3; 3]) -> Self {
        let sides = [b - a, c - b, a - c].map(Vec3::normalize_or_zero);
        let angle = |before: Vec3, after: Vec3| (-before.dot(after)).clamp(-1.0, 1.0).acos();
        Self {
            // The sides are normalized first, so that even the smallest faces have a direction.
            normal: sides[0].cross(sides[1]).normalize_or_zero(),
            angles: [
                angle(sides[2], sides[0]),
                angle(sides[0], sides[1]),
                angle(sides[1], sides[2]),
            ],
        }
    }
}

/// For each vertex the corners at it: `3 * face + place`.
struct CornersAround {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl CornersAround {
    fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let mut starts = vec![0; vertices + 1];
        for &vertex in triangles.as_flattened() {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut corners = vec![0; 3 * triangles.len()];
        for (corner, &vertex) in triangles.as_flattened().iter().enumerate() {
            corners[next[vertex as usize] as usize] = corner as u32;
            next[vertex as usize] += 1;
        }
        Self { starts, corners }
    }

    fn of(&self, vertex: usize) -> &[u32] {
        &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

/// The corners at one vertex, in groups that share a normal. The structure is reused to save allocations.
#[derive(Default)]
struct Fan {
    /// For each corner, the first corner of its group.
    groups: Vec<usize>,
    /// For the first corner of each group, its vertex in the result.
    emitted: Vec<u32>,
    /// The sides at the vertex: the vertex at the other end of each side of each corner, and the corner's place.
    spokes: Vec<(u32, usize)>,
}

impl Fan {
    fn group(&mut self, vertex: u32, corners: &[u32], triangles: &[[u32; 3]], faces: &[Face]) {
        self.emitted.clear();
        self.emitted.resize(corners.len(), 0);
        self.groups.clear();
        let normal = |corner: u32| faces[corner as usize / 3].normal;
        let first = corners.first().map_or(Vec3::ZERO, |&corner| normal(corner));
        if corners
            .iter()
            .all(|&corner| normal(corner).dot(first) > GENTLE)
        {
            self.groups.resize(corners.len(), 0);
            return;
        }
        self.groups.extend(0..corners.len());
        self.spokes.clear();
        for (place, &corner) in corners.iter().enumerate() {
            let others = triangles[corner as usize / 3].into_iter();
            let others = others.filter(|&other| other != vertex);
            self.spokes.extend(others.map(|other| (other, place)));
        }
        self.spokes.sort_unstable();
        for pair in 1..self.spokes.len() {
            let (spoke, place) = self.spokes[pair - 1];
            let (next_spoke, next_place) = self.spokes[pair];
            if spoke == next_spoke
                && normal(corners[place]).dot(normal(corners[next_place])) > CREASE
            {
                self.join(place, next_place);
            }
        }
        for place in 0..corners.len() {
            self.groups[place] = self.first(place);
        }
    }

    fn first(&self, mut place: usize) -> usize {
        while self.groups[place] != place {
            place = self.groups[place];
        }
        place
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.groups[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shaded(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Shaded {
        Shaded::new(&Mesh::new(vertices, triangles).expect("a mesh"))
    }

    /// The corners' normals in the order of the triangles.
    fn normals(shaded: &Shaded) -> Vec<Vec3> {
        let normal = |&index: &u32| Vec3::from(shaded.vertices[index as usize].normal);
        shaded.indices.iter().map(normal).collect()
    }

    /// A strip of two squares along `x`, folded by an angle at `x = 0`.
    fn folded(degrees: f32) -> Shaded {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let xs = [Vec3::NEG_X, Vec3::ZERO, Vec3::new(cos, sin, 0.0)];
        let vertices = xs.into_iter().flat_map(|x| [x, x + Vec3::Z]).collect();
        let triangles = vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]];
        shaded(vertices, triangles)
    }

    #[test]
    fn cube_is_flat() {
        let vertices = (0..8u8)
            .map(|index| Vec3::from([1, 2, 4].map(|bit| if index & bit == 0 { -1.0 } else { 1.0 })))
            .collect();
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let triangles = faces
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        let cube = shaded(vertices, triangles);
        assert_eq!(cube.vertices.len(), 24);
        let outward = [
            Vec3::NEG_X,
            Vec3::X,
            Vec3::NEG_Y,
            Vec3::Y,
            Vec3::NEG_Z,
            Vec3::Z,
        ];
        for (corner, normal) in normals(&cube).into_iter().enumerate() {
            assert!(normal.distance(outward[corner / 6]) < 1e-6);
        }
    }

    #[test]
    fn gentle_folds_are_smooth_and_sharp_ones_not() {
        for degrees in [1.0, 10.0, 34.0] {
            let smooth = folded(degrees);
            assert_eq!(smooth.vertices.len(), 6);
            let middle = Vec3::new(
                -(0.5 * degrees).to_radians().sin(),
                (0.5 * degrees).to_radians().cos(),
                0.0,
            );
            assert!(
                Vec3::from(smooth.vertices[2].normal).distance(middle) < 1e-3,
                "{degrees}"
            );
        }
        for degrees in [36.0, 90.0, 150.0] {
            assert_eq!(folded(degrees).vertices.len(), 8, "{degrees}");
        }
    }

    #[test]
    fn triangles_about_a_corner_weigh_by_their_angles() {
        // The quarter on one side of the fold is cut in two, which must not change the normal there.
        let mut vertices = vec![Vec3::ZERO, Vec3::Z, Vec3::NEG_X];
        let (sin, cos) = 30f32.to_radians().sin_cos();
        let far = Vec3::new(cos, sin, 0.0);
        vertices.extend([far, 0.5 * (Vec3::Z + far)]);
        let cut = shaded(vertices, vec![[0, 2, 1], [0, 1, 4], [0, 4, 3]]);
        let middle = Vec3::new(-15f32.to_radians().sin(), 15f32.to_radians().cos(), 0.0);
        assert!(
            normals(&cut)[0].distance(middle) < 1e-3,
            "{}",
            normals(&cut)[0]
        );
    }

    #[test]
    fn faces_that_only_touch_at_a_corner_stay_apart() {
        let up = [Vec3::ZERO, Vec3::Z, Vec3::X];
        let steep = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(-1.0, -1.0, 1.0)];
        let vertices = up.into_iter().chain(steep).collect();
        let bow_tie = shaded(vertices, vec![[0, 1, 2], [0, 3, 4]]);
        assert_eq!(bow_tie.vertices.len(), 6);
    }

    #[test]
    fn faces_of_no_area_do_no_harm() {
        let vertices = vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::NEG_Z];
        let flat = shaded(vertices, vec![[0, 1, 2], [0, 1, 3]]);
        assert!(normals(&flat).iter().all(|normal| normal.is_finite()));
        assert!(normals(&flat)[3].distance(Vec3::Y) < 1e-6);
    }
}
