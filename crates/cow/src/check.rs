//! Validation of a triangle mesh: topology, orientation and self-intersections.

use crate::{
    mesh::CowMesh,
    overlap::{Point, disjoint_triangles_meet, fans_meet, hinge_is_shut, is_degenerate},
};
use std::{collections::HashMap, fmt};

/// What [`check`] found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Edges that do not have exactly two triangles.
    pub open_edges: usize,
    /// Edges that two triangles run through in the same direction.
    pub flipped_edges: usize,
    /// Vertices whose triangles are not one fan.
    pub pinched_vertices: usize,
    /// Connected components; a vertex without triangles is one.
    pub components: usize,
    /// Euler characteristic V - E + F; 2 for a sphere.
    pub euler: i64,
    /// Enclosed volume, m³; negative when the mesh is inside out.
    pub volume: f64,
    /// Triangles whose corners lie on one line.
    pub flat_triangles: usize,
    /// Pairs of triangles that share a point off their common vertices and edge.
    pub intersections: usize,
}

impl Report {
    /// Whether the mesh is closed, manifold, oriented outward, connected and
    /// free of self-intersections.
    pub fn is_sound(&self) -> bool {
        self.open_edges == 0
            && self.flipped_edges == 0
            && self.pinched_vertices == 0
            && self.components == 1
            && self.volume > 0.0
            && self.flat_triangles == 0
            && self.intersections == 0
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "vertices            {}", self.vertices)?;
        writeln!(f, "triangles           {}", self.triangles)?;
        writeln!(f, "open edges          {}", self.open_edges)?;
        writeln!(f, "flipped edges       {}", self.flipped_edges)?;
        writeln!(f, "pinched vertices    {}", self.pinched_vertices)?;
        writeln!(f, "components          {}", self.components)?;
        writeln!(f, "Euler characteristic {}", self.euler)?;
        writeln!(f, "volume              {:.4} m³", self.volume)?;
        writeln!(f, "flat triangles      {}", self.flat_triangles)?;
        writeln!(f, "self-intersections  {}", self.intersections)?;
        write!(
            f,
            "{}",
            if self.is_sound() {
                "sound"
            } else {
                "NOT SOUND"
            }
        )
    }
}

/// Validates a mesh.
///
/// # Panics
///
/// If an index is not that of a vertex.
pub fn check(mesh: &CowMesh) -> Report {
    let mut edges: HashMap<[u32; 2], [usize; 2]> = HashMap::new();
    for t in &mesh.triangles {
        for [a, b] in directed_edges(*t) {
            edges.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
        }
    }
    Report {
        vertices: mesh.vertices.len(),
        triangles: mesh.triangles.len(),
        open_edges: edges.values().filter(|n| n[0] + n[1] != 2).count(),
        flipped_edges: edges.values().filter(|n| n[0] > 1 || n[1] > 1).count(),
        pinched_vertices: pinched_vertices(mesh),
        components: components(mesh),
        euler: mesh.vertices.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64,
        volume: volume(mesh),
        flat_triangles: mesh
            .triangles
            .iter()
            .filter(|t| is_degenerate(corners(mesh, **t)))
            .count(),
        intersections: intersections(mesh).len(),
    }
}

/// Pairs of triangles that share a point off their common vertices and edge.
///
/// # Panics
///
/// If an index is not that of a vertex.
pub fn intersections(mesh: &CowMesh) -> Vec<[u32; 2]> {
    let boxes: Vec<_> = mesh
        .triangles
        .iter()
        .map(|t| bounds(corners(mesh, *t)))
        .collect();
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    order.sort_by(|&i, &j| boxes[i as usize].0[0].total_cmp(&boxes[j as usize].0[0]));

    let mut found = Vec::new();
    for (rank, &i) in order.iter().enumerate() {
        let (low, high) = boxes[i as usize];
        for &j in order[rank + 1..]
            .iter()
            .take_while(|&&j| boxes[j as usize].0[0] <= high[0])
        {
            let (other_low, other_high) = boxes[j as usize];
            if (1..3).all(|k| other_low[k] <= high[k] && low[k] <= other_high[k])
                && meet(mesh, mesh.triangles[i as usize], mesh.triangles[j as usize])
            {
                found.push([i, j]);
            }
        }
    }
    found
}

fn meet(mesh: &CowMesh, mut s: [u32; 3], mut t: [u32; 3]) -> bool {
    // Turn both so that what they share comes first.
    let shared = s.iter().filter(|i| t.contains(i)).count();
    let leading = |s: [u32; 3], t: [u32; 3]| match shared {
        1 => s.iter().position(|i| t.contains(i)).unwrap_or(0),
        2 => (s.iter().position(|i| !t.contains(i)).unwrap_or(0) + 1) % 3,
        _ => 0,
    };
    let (turn_s, turn_t) = (leading(s, t), leading(t, s));
    s.rotate_left(turn_s);
    t.rotate_left(turn_t);
    let (p, q) = (corners(mesh, s), corners(mesh, t));
    match shared {
        0 => disjoint_triangles_meet(p, q),
        1 => fans_meet(p, q),
        2 => hinge_is_shut([p[0], p[1]], p[2], q[2]),
        _ => true,
    }
}

fn pinched_vertices(mesh: &CowMesh) -> usize {
    // For each vertex, the edges opposite it; one fan is one closed chain.
    let mut links: Vec<Vec<[u32; 2]>> = vec![Vec::new(); mesh.vertices.len()];
    for &[a, b, c] in &mesh.triangles {
        links[a as usize].push([b, c]);
        links[b as usize].push([c, a]);
        links[c as usize].push([a, b]);
    }
    links.iter().filter(|link| !is_one_cycle(link)).count()
}

fn is_one_cycle(link: &[[u32; 2]]) -> bool {
    let Some(&[first, mut at]) = link.first() else {
        return false;
    };
    let mut length = 1;
    while at != first && length < link.len() {
        let mut onward = link.iter().filter(|e| e[0] == at);
        let (Some(&[_, next]), None) = (onward.next(), onward.next()) else {
            return false;
        };
        at = next;
        length += 1;
    }
    at == first && length == link.len()
}

fn components(mesh: &CowMesh) -> usize {
    let mut parent: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    let mut count = parent.len();
    for &[a, b, c] in &mesh.triangles {
        for other in [b, c] {
            let (p, q) = (root(&mut parent, a), root(&mut parent, other));
            if p != q {
                parent[p as usize] = q;
                count -= 1;
            }
        }
    }
    count
}

fn volume(mesh: &CowMesh) -> f64 {
    let six_volumes = mesh.triangles.iter().map(|t| {
        let [a, b, c] = corners(mesh, *t);
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    six_volumes.sum::<f64>() / 6.0
}

fn directed_edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn corners(mesh: &CowMesh, t: [u32; 3]) -> [Point; 3] {
    t.map(|i| mesh.vertices[i as usize].map(f64::from))
}

fn bounds(t: [Point; 3]) -> (Point, Point) {
    let mut low = t[0];
    let mut high = t[0];
    for p in &t[1..] {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    (low, high)
}
