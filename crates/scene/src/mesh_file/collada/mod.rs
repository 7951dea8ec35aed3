//! COLLADA (`.dae`): the meshes in the scene of one XML document, as one mesh.
//!
//! Units become metres and the up axis becomes y. Every instance of a geometry gets its own copy, placed by the
//! transforms of its nodes. A skinned or morphed geometry gets its bind shape. Lines and splines are left out. Without
//! a
//! `<scene>`, every geometry is added once, in its own coordinates. The `count` attributes are ignored: the numbers
//! are counted.

mod document;
mod geometry;
mod guard;
mod node;
mod transform;

use glam::{DMat3, DMat4, DVec3};
use roxmltree::Node;

use super::soup::{ReadError, Soup};
use super::{Format, encoding};
use crate::shown;
use document::{Document, child, tag};
use node::Assembly;

/// COLLADA.
pub(super) const FORMAT: Format = Format {
    name: "dae",
    title: "COLLADA",
    extensions: &["dae"],
    read,
};

fn read(bytes: &[u8]) -> Result<Soup, ReadError> {
    let text = encoding::xml(bytes)?;
    let text = text.as_ref();
    guard::check(text)?;
    // The default options refuse document type definitions, and thus entity expansion.
    let xml = roxmltree::Document::parse(text).map_err(|error| {
        let line = error.pos().row as usize;
        ReadError::at(line, format!("is not well-formed XML: {error}"))
    })?;
    let document = Document::new(&xml)?;
    check_version(&document)?;
    let mut assembly = Assembly::new(&document);
    let (placement, unit, up_axis) = into_metres_y_up(&document)?;
    let scene = child(document.root, "scene")
        .and_then(|scene| child(scene, "instance_visual_scene"))
        .map(|instance| document.target(instance, "url", &["visual_scene"]))
        .transpose()?;
    match scene {
        Some(scene) => assembly.add_nodes(scene, placement)?,
        None => assembly.add_all_geometries(placement)?,
    }
    let mut soup = assembly.soup;
    (soup.unit, soup.up_axis) = (unit, up_axis);
    if soup.triangles.is_empty() && soup.flat_instances > 0 {
        return Err(ReadError::new(format!(
            "shows no triangles with an area: transforms flatten all {} instances of geometries",
            soup.flat_instances
        )));
    }
    if soup.triangles.is_empty() {
        return Err(ReadError::new(
            "shows no triangles: its scene must instance a geometry with polygons",
        ));
    }
    Ok(soup)
}

/// Refuses versions other than 1.4 and 1.5: version 1.3 stores geometries differently, and later versions are unknown.
/// A document without a version is read as 1.4 or 1.5.
fn check_version(document: &Document) -> Result<(), ReadError> {
    let Some(version) = document.root.attribute("version") else {
        return Ok(());
    };
    let known = ["1.4", "1.4.0", "1.4.1", "1.5", "1.5.0"];
    if known.contains(&version.trim()) {
        return Ok(());
    }
    let version = shown::name(version);
    let what = format!("the version is `{version}`: only 1.4 and 1.5 are known");
    Err(document.error(document.root, what))
}

/// The matrix from the document's unit and up axis to metres and y up, and that unit and axis if the document states
/// them.
fn into_metres_y_up(document: &Document) -> Result<(DMat4, Option<f64>, Option<char>), ReadError> {
    let (metres, up_axis) = match child(document.root, "asset") {
        Some(asset) => (metres(document, asset)?, up_axis(document, asset)?),
        None => (None, None),
    };
    check_parts(document, metres, up_axis)?;
    let axes = match up_axis {
        // The columns: the directions of the document's x, y and z.
        Some('x') => DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z),
        Some('z') => DMat3::from_cols(DVec3::X, -DVec3::Z, DVec3::Y),
        _ => DMat3::IDENTITY,
    };
    let placement = DMat4::from_mat3(axes * metres.unwrap_or(1.0));
    Ok((placement, metres, up_axis))
}

/// The unit of an `<asset>` in metres. An empty element or attribute counts as absent.
fn metres(document: &Document, asset: Node) -> Result<Option<f64>, ReadError> {
    let unit = child(asset, "unit");
    let meter = unit.and_then(|unit| Some((unit, unit.attribute("meter")?.trim())));
    let Some((unit, text)) = meter.filter(|(_, text)| !text.is_empty()) else {
        return Ok(None);
    };
    let number = text.parse().ok();
    let valid = number.filter(|metres: &f64| *metres > 0.0 && metres.is_finite());
    valid.map(Some).ok_or_else(|| {
        let text = shown::name(text);
        let what = format!("meter is `{text}`: it must be a number above 0");
        document.error(unit, what)
    })
}

/// The up axis of an `<asset>`. An empty element counts as absent.
fn up_axis(document: &Document, asset: Node) -> Result<Option<char>, ReadError> {
    let Some(up_axis) = child(asset, "up_axis") else {
        return Ok(None);
    };
    match document.text(up_axis).trim() {
        "" => Ok(None),
        "X_UP" => Ok(Some('x')),
        "Y_UP" => Ok(Some('y')),
        "Z_UP" => Ok(Some('z')),
        other => {
            let other = shown::name(other);
            let what = format!("the up axis is `{other}`: it must be X_UP, Y_UP or Z_UP");
            Err(document.error(up_axis, what))
        }
    }
}

/// Refuses a part with geometry that has its own unit or up axis: its coordinates would be read in those of the
/// document.
fn check_parts(
    document: &Document,
    of_all: Option<f64>,
    up_of_all: Option<char>,
) -> Result<(), ReadError> {
    let placed = [
        "library_geometries",
        "library_controllers",
        "library_nodes",
        "library_visual_scenes",
    ];
    let libraries = document.root.children();
    let libraries = libraries.filter(|library| placed.contains(&tag(*library)));
    let parts = libraries.flat_map(|library| library.descendants());
    for asset in parts.filter(|part| tag(*part) == "asset") {
        let same_unit = |metres| metres == of_all.unwrap_or(1.0);
        let same_axis = |axis| axis == up_of_all.unwrap_or('y');
        let what = if !metres(document, asset)?.is_none_or(same_unit) {
            "its unit is another one than the document's: export the document in one unit"
        } else if !up_axis(document, asset)?.is_none_or(same_axis) {
            "its up axis is another one than the document's: export the document with one"
        } else {
            continue;
        };
        return Err(document.error(asset, what));
    }
    Ok(())
}
