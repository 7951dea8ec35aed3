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

use super::soup::{ReadError, Soup};
use super::{Format, encoding};
use crate::shown;
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
    let text = encoding::xml(bytes)?;
    let text = text.as_ref();
    guard::check(text)?;
    // The default options refuse document type definitions, and with them entity expansion.
    let xml = roxmltree::Document::parse(text).map_err(|error| {
        let line = error.pos().row as usize;
        ReadError::at(line, format!("is not well-formed XML: {error}"))
    })?;
    let document = Document::new(&xml)?;
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

/// From the document's unit and up axis to metres and y up, and those as far as it tells them. An
/// empty element or attribute tells nothing.
fn into_metres_y_up(document: &Document) -> Result<(DMat4, Option<f64>, Option<char>), ReadError> {
    let asset = child(document.root, "asset");
    let unit = asset.and_then(|asset| child(asset, "unit"));
    let mut metres = None;
    let meter = unit.and_then(|unit| Some((unit, unit.attribute("meter")?.trim())));
    if let Some((unit, text)) = meter.filter(|(_, text)| !text.is_empty()) {
        let number = text.parse().ok();
        let valid = number.filter(|metres: &f64| *metres > 0.0 && metres.is_finite());
        metres = Some(valid.ok_or_else(|| {
            let text = shown::name(text);
            let what = format!("meter is `{text}`: it must be a number above 0");
            document.error(unit, what)
        })?);
    }
    let (axes, up_axis) = match asset.and_then(|asset| child(asset, "up_axis")) {
        None => (DMat3::IDENTITY, None),
        Some(up_axis) => match document.text(up_axis).trim() {
            "" => (DMat3::IDENTITY, None),
            "Y_UP" => (DMat3::IDENTITY, Some('y')),
            // Columns: where x, y and z of the document point.
            "X_UP" => (DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z), Some('x')),
            "Z_UP" => (DMat3::from_cols(DVec3::X, -DVec3::Z, DVec3::Y), Some('z')),
            other => {
                let other = shown::name(other);
                let what = format!("the up axis is `{other}`: it must be X_UP, Y_UP or Z_UP");
                return Err(document.error(up_axis, what));
            }
        },
    };
    let placement = DMat4::from_mat3(axes * metres.unwrap_or(1.0));
    Ok((placement, metres, up_axis))
}
