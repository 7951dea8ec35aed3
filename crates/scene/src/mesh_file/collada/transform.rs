//! The transforms of a node: a product of elements in document order.

use glam::{DMat4, DVec3};
use roxmltree::Node;

use super::document::{Document, tag};
use crate::mesh_file::soup::ReadError;

/// The largest rounding error of exporters that calculate in f32, for a number that should be 0 or of size 1.
const ROUNDING: f64 = 1e-6;

/// The sine of an angle below which two directions count as equal: rounding gives about 1e-16.
const IN_LINE: f64 = 1e-12;

/// The unit vector along `v`, also if the squares of its components overflow or underflow.
fn direction(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}

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
        direction(DVec3::new(x, y, z))
            .ok_or_else(|| document.error(element, "the axis has no direction"))
    };
    let matrix = match tag(element) {
        "matrix" => matrix(document, element)?,
        "translate" => DMat4::from_translation(document.exactly::<3>(element)?.into()),
        "scale" => DMat4::from_scale(document.exactly::<3>(element)?.into()),
        "rotate" => {
            let [x, y, z, degrees] = document.exactly(element)?;
            // Exporters write the rotations of an unrotated node as 0 0 0 0.
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
            if degrees == 0.0 {
                return Ok(Some(DMat4::IDENTITY));
            }
            skew(degrees.to_radians(), axis(x1, y1, z1)?, axis(x2, y2, z2)?)
                .ok_or_else(|| document.error(element, "the angle must turn between the axes"))?
        }
        _ => return Ok(None),
    };
    Ok(Some(matrix))
}

/// A matrix of sixteen numbers, in rows.
pub(super) fn matrix<'d, 'x>(
    document: &Document<'d, 'x>,
    element: Node<'d, 'x>,
) -> Result<DMat4, ReadError> {
    let mut matrix = DMat4::from_cols_array(&document.exactly(element)?).transpose();
    let off = (matrix.row(3) - glam::DVec4::W).abs().max_element();
    if off > ROUNDING {
        return Err(document.error(element, "the last row must be 0 0 0 1"));
    }
    for (axis, last) in matrix
        .as_mut()
        .chunks_exact_mut(4)
        .zip(glam::DVec4::W.to_array())
    {
        axis[3] = last;
    }
    Ok(matrix)
}

/// The camera at the eye looks along -z at the point of interest. `None` if a direction is undefined.
fn look_at([ex, ey, ez, ix, iy, iz, ux, uy, uz]: [f64; 9]) -> Option<DMat4> {
    let eye = DVec3::new(ex, ey, ez);
    let back = direction(eye - DVec3::new(ix, iy, iz))?;
    let right = direction(DVec3::new(ux, uy, uz))?.cross(back);
    let right = (right.length() > IN_LINE).then(|| right.normalize())?;
    let up = back.cross(right);
    Some(DMat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        back.extend(0.0),
        eye.extend(1.0),
    ))
}

/// RenderMan's skew: moves points along `along` so that `from` rotates towards it by the angle.
fn skew(angle: f64, from: DVec3, along: DVec3) -> Option<DMat4> {
    let cosine = from.dot(along);
    let across = from - cosine * along;
    let across = (across.length() > IN_LINE).then(|| across.normalize())?;
    let sine = from.dot(across);
    let turned = sine.atan2(cosine) - angle;
    if !(IN_LINE..std::f64::consts::PI - IN_LINE).contains(&turned) {
        return None;
    }
    // `from` has the components (cosine, sine) along (`along`, `across`). Its sheared image must form the angle
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
        // Up to where the axes become one, but not there, where rounding alone gives a direction.
        let between = from.angle_between(along);
        assert!(skew(between, from, along).is_none());
        assert!(skew(between - 1e-9, from, along).is_some());
        assert!(skew(0.1, from, (3.0 * from).normalize()).is_none());
    }

    #[test]
    fn look_at_faces_the_point_of_interest() {
        let m = look_at([1.0, 2.0, 3.0, 1.0, 2.0, -4.0, 0.0, 1.0, 0.0]).expect("a direction");
        assert_eq!(m, DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0)));
        assert!(look_at([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]).is_none());
        assert!(look_at([0.3, 0.6, 0.7, 0.0, 0.0, 0.0, 0.03, 0.06, 0.07]).is_none());
        for size in [1e-200, 1e200] {
            let m = look_at([0.0, 0.0, size, 0.0, 0.0, 0.0, 0.0, size, 0.0]).expect("a direction");
            assert_eq!(m, DMat4::from_translation(DVec3::Z * size));
        }
    }
}
