//! COLLADA (`.dae`): the meshes that the scene of one XML document shows, as one mesh.
//!
//! Units become metres and the up axis becomes y. Every instance of a geometry gets its own
//! copy, placed by the transforms of its nodes. A skinned or morphed geometry comes in its bind
//! shape. Lines and splines are left out. Without a `<scene>`, every geometry counts once, where
//! its own coordinates put it. `count` attributes are not believed: the numbers are counted.

mod document;
mod geometry;
mod guard;
mod node;
mod transform;

use glam::{DMat3, DMat4, DVec3};

use super::Format;
use super::soup::{ReadError, Soup};
use document::{Document, child};
use node::Assembly;

/// COLLADA.
pub(super) const FORMAT: Format = Format {
    name: "dae",
    title: "COLLADA",
    extensions: &["dae"],
    read,
};

fn read(bytes: &[u8]) -> Result<Soup, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        ReadError::at(line, "is not UTF-8 text: save the COLLADA file as UTF-8")
    })?;
    guard::check(text)?;
    // The default options refuse document type definitions, and with them entity expansion.
    let xml = roxmltree::Document::parse(text).map_err(|error| {
        let line = error.pos().row as usize;
        ReadError::at(line, format!("is not well-formed XML: {error}"))
    })?;
    let document = Document::new(&xml)?;
    let mut assembly = Assembly::new(&document);
    let placement = into_metres_y_up(&document)?;
    let scene = child(document.root, "scene")
        .and_then(|scene| child(scene, "instance_visual_scene"))
        .map(|instance| document.target(instance, "url", &["visual_scene"]))
        .transpose()?;
    match scene {
        Some(scene) => assembly.add_nodes(scene, placement)?,
        None => assembly.add_all_geometries(placement)?,
    }
    let soup = assembly.soup;
    if soup.triangles.is_empty() {
        return Err(ReadError::new(
            "shows no triangles: its scene must instance a geometry with polygons",
        ));
    }
    Ok(soup)
}

/// From the document's unit and up axis to metres and y up.
fn into_metres_y_up(document: &Document) -> Result<DMat4, ReadError> {
    let asset = child(document.root, "asset");
    let unit = asset.and_then(|asset| child(asset, "unit"));
    let mut metres = 1.0;
    if let Some((unit, text)) = unit.and_then(|unit| Some((unit, unit.attribute("meter")?))) {
        let number = text.trim().parse().ok();
        let valid = number.filter(|metres: &f64| *metres > 0.0 && metres.is_finite());
        metres = valid.ok_or_else(|| {
            let what = format!("meter is `{text}`: it must be a number above 0");
            document.error(unit, what)
        })?;
    }
    let axes = match asset.and_then(|asset| child(asset, "up_axis")) {
        None => DMat3::IDENTITY,
        Some(up_axis) => match document.text(up_axis).trim() {
            "Y_UP" => DMat3::IDENTITY,
            // Columns: where x, y and z of the document point.
            "X_UP" => DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z),
            "Z_UP" => DMat3::from_cols(DVec3::X, -DVec3::Z, DVec3::Y),
            other => {
                let what = format!("the up axis is `{other}`: it must be X_UP, Y_UP or Z_UP");
                return Err(document.error(up_axis, what));
            }
        },
    };
    Ok(DMat4::from_mat3(axes * metres))
}
