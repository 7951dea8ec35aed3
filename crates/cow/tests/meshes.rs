//! The cows that the crate makes, and those that it has made for `assets`.

use cow::{CowError, CowMesh, check::check, cow};
use std::{fs, path::PathBuf};

type Result = std::result::Result<(), Box<dyn std::error::Error>>;

fn asset(name: &str) -> PathBuf {
    let meshes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/meshes");
    PathBuf::from(meshes).join(name)
}

fn read_obj(name: &str) -> std::result::Result<CowMesh, tobj::LoadError> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ..Default::default()
    };
    let (models, _) = tobj::load_obj(asset(name), &options)?;
    assert_eq!(models.len(), 1);
    Ok(CowMesh {
        vertices: models[0].mesh.positions.as_chunks().0.to_vec(),
        triangles: models[0].mesh.indices.as_chunks().0.to_vec(),
    })
}

/// Asserts that `mesh` is a cow of about `triangles` triangles.
fn assert_cow(mesh: &CowMesh, triangles: usize) {
    let report = check(mesh);
    assert!(report.is_sound(), "{report}");
    assert_eq!(report.euler, 2);
    assert!(
        report.triangles.abs_diff(triangles) * 50 <= triangles,
        "{report}"
    );
    for (axis, length) in [2.46, 1.70, 0.74].into_iter().enumerate() {
        let coordinates = || mesh.vertices.iter().map(|v| v[axis]);
        let low = coordinates().fold(f32::MAX, f32::min);
        let high = coordinates().fold(f32::MIN, f32::max);
        assert!((low + high).abs() < 1e-4, "axis {axis} is off centre");
        assert!(
            (high - low - length).abs() < 0.05,
            "axis {axis}: {low} to {high}"
        );
    }
}

#[test]
fn cows_of_few_triangles_are_sound() -> Result {
    for triangles in [1_000, 6_000] {
        let mesh = cow(triangles)?;
        assert_cow(&mesh, triangles);
        assert_eq!(mesh, cow(triangles)?, "the same number, another cow");
    }
    Ok(())
}

#[test]
fn numbers_out_of_range_are_refused() {
    for triangles in [0, 999, 400_001] {
        assert_eq!(cow(triangles), Err(CowError::Count(triangles)));
    }
}

#[test]
fn the_cow_in_obj_is_sound() -> Result {
    assert_cow(&read_obj("cow.obj")?, 6_000);
    Ok(())
}

#[test]
fn the_cow_in_dae_is_the_one_in_obj() -> Result {
    let text = fs::read_to_string(asset("cow.dae"))?;
    let document = roxmltree::Document::parse(&text)?;
    let words = |tag| {
        let node = document.descendants().find(|n| n.has_tag_name(tag));
        node.and_then(|n| n.text()).unwrap_or_default().split(' ')
    };
    let positions = words("float_array")
        .map(str::parse)
        .collect::<std::result::Result<Vec<f32>, _>>()?;
    let indices = words("p")
        .map(str::parse)
        .collect::<std::result::Result<Vec<u32>, _>>()?;
    let obj = read_obj("cow.obj")?;
    assert_eq!(positions, obj.vertices.as_flattened());
    assert_eq!(indices, obj.triangles.as_flattened());
    Ok(())
}

#[test]
fn the_cube_in_obj_is_sound() -> Result {
    let report = check(&read_obj("cube.obj")?);
    assert!(report.is_sound(), "{report}");
    assert_eq!((report.vertices, report.triangles), (8, 12));
    assert_eq!(report.volume, 1.0);
    Ok(())
}
