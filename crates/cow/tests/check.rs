//! The validation finds each kind of defect.

use cow::{
    CowMesh,
    check::{Report, check},
};

fn mesh(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> CowMesh {
    CowMesh {
        vertices: vertices.to_vec(),
        triangles: triangles.to_vec(),
    }
}

/// A tetrahedron with corners at `at` and one unit from there along the axes.
fn tetrahedron(at: [f32; 3]) -> CowMesh {
    let [x, y, z] = at;
    mesh(
        &[at, [x + 1.0, y, z], [x, y + 1.0, z], [x, y, z + 1.0]],
        &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    )
}

fn together(a: &CowMesh, b: &CowMesh) -> CowMesh {
    let first = a.vertices.len() as u32;
    let moved = b.triangles.iter().map(|t| t.map(|i| i + first));
    CowMesh {
        vertices: [a.vertices.as_slice(), &b.vertices].concat(),
        triangles: a.triangles.iter().copied().chain(moved).collect(),
    }
}

/// Self-intersections of two triangles.
fn crossings(vertices: &[[f32; 3]], triangles: [[u32; 3]; 2]) -> usize {
    check(&mesh(vertices, &triangles)).intersections
}

#[test]
fn a_tetrahedron_is_sound() {
    let report = check(&tetrahedron([0.0; 3]));
    assert!(report.is_sound(), "{report}");
    assert_eq!(report.euler, 2);
    assert!((report.volume - 1.0 / 6.0).abs() < 1e-12);
}

#[test]
fn a_hole_is_found() {
    let mut open = tetrahedron([0.0; 3]);
    open.triangles.pop();
    let report = check(&open);
    assert_eq!(report.open_edges, 3);
    assert_eq!(report.pinched_vertices, 3);
    assert!(!report.is_sound());
}

#[test]
fn wrong_orientations_are_found() {
    let mut one = tetrahedron([0.0; 3]);
    one.triangles[0].swap(0, 1);
    assert_eq!(check(&one).flipped_edges, 3);

    let mut all = tetrahedron([0.0; 3]);
    all.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let report = check(&all);
    assert_eq!(report.flipped_edges, 0);
    assert!(report.volume < 0.0 && !report.is_sound());
}

#[test]
fn components_are_counted() {
    let apart = together(&tetrahedron([0.0; 3]), &tetrahedron([3.0, 0.0, 0.0]));
    let report = check(&apart);
    assert_eq!(report.components, 2);
    assert_eq!(report.intersections, 0);
    assert!(!report.is_sound());
}

#[test]
fn a_pinched_vertex_is_found() {
    let mut pinched = together(&tetrahedron([0.0; 3]), &tetrahedron([1.0, 0.0, 0.0]));
    // The second one's corner 4 is the first one's corner 1.
    for i in pinched.triangles.as_flattened_mut() {
        *i = [0, 1, 2, 3, 1, 4, 5, 6][*i as usize];
    }
    pinched.vertices.remove(4);
    let report = check(&pinched);
    let expected = Report {
        vertices: 7,
        triangles: 8,
        pinched_vertices: 1,
        components: 1,
        euler: 3,
        volume: report.volume,
        ..Report::default()
    };
    assert_eq!(report, expected);
}

#[test]
fn a_flat_triangle_is_found() {
    let flat = mesh(
        &[[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.4, 0.4, 0.4]],
        &[[0, 1, 2]],
    );
    assert_eq!(check(&flat).flat_triangles, 1);
}

#[test]
fn one_body_in_another_is_found() {
    let crossed = together(&tetrahedron([0.0; 3]), &tetrahedron([0.25, 0.2, 0.1]));
    let report = check(&crossed);
    assert!(report.intersections > 0);
    assert!(!report.is_sound());
}

#[test]
fn triangles_apart_meet_even_in_a_point() {
    let base = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let with = |more: [[f32; 3]; 3]| {
        let all = [base, more].concat();
        crossings(&all, [[0, 1, 2], [3, 4, 5]])
    };
    // A corner on the face, just above it, and the face pierced.
    let above = f32::MIN_POSITIVE;
    assert_eq!(
        with([[0.25, 0.25, 0.0], [0.2, 0.3, 1.0], [0.3, 0.3, 1.0]]),
        1
    );
    assert_eq!(
        with([[0.25, 0.25, above], [0.2, 0.3, 1.0], [0.3, 0.3, 1.0]]),
        0
    );
    assert_eq!(
        with([[0.25, 0.25, -1.0], [0.2, 0.3, 1.0], [0.3, 0.3, 1.0]]),
        1
    );
    // In one plane: across, inside, and beside with touching boxes.
    assert_eq!(
        with([[-0.5, 0.3, 0.0], [1.5, 0.3, 0.0], [1.5, 0.4, 0.0]]),
        1
    );
    assert_eq!(with([[0.1, 0.1, 0.0], [0.2, 0.1, 0.0], [0.1, 0.2, 0.0]]), 1);
    assert_eq!(with([[1.0, 1.0, 0.0], [0.6, 0.6, 0.0], [1.0, 0.6, 0.0]]), 0);
}

#[test]
fn triangles_with_a_common_vertex_meet_beyond_it() {
    let base = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let with = |more: [[f32; 3]; 2]| {
        let all = [base.as_slice(), &more].concat();
        // The common vertex is not the first of either.
        crossings(&all, [[1, 2, 0], [4, 0, 3]])
    };
    // Through the face, long and short; on one side; in the same plane.
    assert_eq!(with([[1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]), 1);
    assert_eq!(with([[0.1, 0.1, 0.1], [0.1, 0.1, -0.1]]), 1);
    assert_eq!(with([[0.1, 0.1, 0.1], [0.1, 0.2, 0.1]]), 0);
    assert_eq!(with([[-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]]), 0);
    assert_eq!(with([[1.0, 0.5, 0.0], [0.5, 1.0, 0.0]]), 1);
    assert_eq!(with([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), 0);
}

#[test]
fn triangles_with_a_common_edge_meet_when_folded() {
    let with = |apex: [f32; 3]| {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], apex];
        // The common edge is in another place in each.
        crossings(&corners, [[2, 0, 1], [0, 3, 1]])
    };
    assert_eq!(with([0.3, 0.8, 0.0]), 1);
    assert_eq!(with([0.3, 0.8, f32::MIN_POSITIVE]), 0);
    assert_eq!(with([0.3, -0.8, 0.0]), 0);
}
