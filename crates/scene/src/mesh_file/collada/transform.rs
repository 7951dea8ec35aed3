//! The transforms of a node: a product of elements in document order.

use glam::{DMat4, DVec3};
use roxmltree::Node;

use super::document::{Document, tag};
use crate::mesh_file::soup::ReadError;

/// The matrix of a node's transform elements, from the node's frame to its parent's.
pub(super) fn of_node<'d, 'x>(
    document: &Document<'d, 'x>,
    node: Node<'d, 'x>,
) -> Result<DMat4, ReadError> {
    let mut product = DMat4::IDENTITY;
    for element in node.children() {
        if let Some(matrix) = of_element(document, element)? {
            product *= matrix;
        }
    }
    Ok(product)
}

fn of_element<'d, 'x>(
    document: &Document<'d, 'x>,
    element: Node<'d, 'x>,
) -> Result<Option<DMat4>, ReadError> {
    let axis = |x: f64, y: f64, z: f64| {
        DVec3::new(x, y, z)
            .try_normalize()
            .ok_or_else(|| document.error(element, "the axis has no direction"))
    };
    let matrix = match tag(element) {
        "matrix" => matrix(document, element)?,
        "translate" => DMat4::from_translation(document.exactly::<3>(element)?.into()),
        "scale" => DMat4::from_scale(document.exactly::<3>(element)?.into()),
        "rotate" => {
            let [x, y, z, degrees] = document.exactly(element)?;
            // Exporters write the rotations of an unturned node as 0 0 0 0.
            if degrees == 0.0 {
                DMat4::IDENTITY
            } else {
                DMat4::from_axis_angle(axis(x, y, z)?, degrees.to_radians())
            }
        }
        "lookat" => look_at(document.exactly(element)?)
            .ok_or_else(|| document.error(element, "eye, point of interest and up are in line"))?,
        "skew" => {
            let [degrees, x1, y1, z1, x2, y2, z2] = document.exactly(element)?;
            skew(degrees.to_radians(), axis(x1, y1, z1)?, axis(x2, y2, z2)?)
                .ok_or_else(|| document.error(element, "the angle must turn between the axes"))?
        }
        _ => return Ok(None),
    };
    Ok(Some(matrix))
}

/// Sixteen numbers, row after row.
pub(super) fn matrix<'d, 'x>(
    document: &Document<'d, 'x>,
    element: Node<'d, 'x>,
) -> Result<DMat4, ReadError> {
    let matrix = DMat4::from_cols_array(&document.exactly(element)?).transpose();
    if matrix.row(3) != glam::DVec4::W {
        return Err(document.error(element, "the last row must be 0 0 0 1"));
    }
    Ok(matrix)
}

/// Stands at the eye, looks along -z at the point of interest; None without a direction.
fn look_at([ex, ey, ez, ix, iy, iz, ux, uy, uz]: [f64; 9]) -> Option<DMat4> {
    let eye = DVec3::new(ex, ey, ez);
    let back = (eye - DVec3::new(ix, iy, iz)).try_normalize()?;
    let right = DVec3::new(ux, uy, uz).cross(back).try_normalize()?;
    let up = back.cross(right);
    Some(DMat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        back.extend(0.0),
        eye.extend(1.0),
    ))
}

/// RenderMan's skew: shifts points along `along` so that `from` turns towards it by the angle.
fn skew(angle: f64, from: DVec3, along: DVec3) -> Option<DMat4> {
    let cosine = from.dot(along);
    let across = (from - cosine * along).try_normalize()?;
    let sine = from.dot(across);
    let turned = sine.atan2(cosine) - angle;
    if !(turned > 0.0 && turned < std::f64::consts::PI) {
        return None;
    }
    // `from` is (cosine, sine) along (`along`, `across`); its shifted image must make the angle
    // `turned` with `along`.
    let shift = (sine / turned.tan() - cosine) / sine * along;
    let column = |unit: DVec3| (unit + shift * across.dot(unit)).extend(0.0);
    Some(DMat4::from_cols(
        column(DVec3::X),
        column(DVec3::Y),
        column(DVec3::Z),
        glam::DVec4::W,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skew_of_y_along_x_is_the_usual_shear() {
        let angle = 0.3_f64;
        let skewed = skew(angle, DVec3::Y, DVec3::X).expect("a skew");
        let image = skewed.transform_point3(DVec3::new(5.0, 2.0, 3.0));
        let expected = DVec3::new(5.0 + 2.0 * angle.tan(), 2.0, 3.0);
        assert!((image - expected).length() < 1e-12, "{image}");
    }

    #[test]
    fn skew_turns_its_axis_by_the_angle_and_leaves_the_other() {
        let from = DVec3::new(1.0, 2.0, 0.5).normalize();
        let along = DVec3::new(1.0, -0.2, 0.3).normalize();
        let skewed = skew(0.4, from, along).expect("a skew");
        let image = skewed.transform_vector3(from);
        assert!((image.angle_between(from) - 0.4).abs() < 1e-12);
        assert!(image.angle_between(along) < from.angle_between(along));
        assert!((skewed.transform_vector3(along) - along).length() < 1e-12);
        assert!((skewed.determinant() - 1.0).abs() < 1e-12);
        assert!(skew(3.0, from, along).is_none());
        assert!(skew(0.1, from, from).is_none());
    }

    #[test]
    fn look_at_faces_the_point_of_interest() {
        let m = look_at([1.0, 2.0, 3.0, 1.0, 2.0, -4.0, 0.0, 1.0, 0.0]).expect("a direction");
        assert_eq!(m, DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0)));
        assert!(look_at([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]).is_none());
    }
}
