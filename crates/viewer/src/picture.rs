//! What to draw, as plain data that [`render`](crate::render) reads.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use sim_core::Mesh;

use crate::camera::Camera;

/// One picture. Positions are in world metres, `y` up; colours are sRGB, each part in `0..=1`.
#[derive(Clone, Default)]
pub struct Picture {
    /// The viewpoint.
    pub camera: Camera,
    /// Meshes, shaded.
    pub models: Vec<Model>,
    /// Translucent meshes, which cast no shadow.
    pub ghosts: Vec<Ghost>,
    /// Translucent coloured panes.
    pub panes: Vec<Pane>,
    /// Lines of a width in pixels.
    pub lines: Vec<Line>,
    /// Lines that are drawn on top of everything.
    pub marks: Vec<Line>,
    /// Arrows with thickness, such as velocities.
    pub arrows: Vec<Arrow>,
    /// Whether the edges of all meshes are drawn over them.
    pub wireframe: bool,
    /// Whether the ground grid at `y = 0` and the axes are drawn.
    pub grid: bool,
}

/// A mesh at a position.
#[derive(Clone)]
pub struct Model {
    /// The geometry; models of the same `Arc` share one copy on the graphics device.
    pub mesh: Arc<Mesh>,
    /// The position of the mesh's origin, m.
    pub position: DVec3,
    /// The rotation of the mesh in the world.
    pub rotation: DQuat,
    /// Surface colour, sRGB.
    pub colour: [f32; 3],
    /// Whether the mesh's edges are drawn over it.
    pub selected: bool,
}

/// A translucent mesh at a position: a body elsewhere or at another time.
#[derive(Clone)]
pub struct Ghost {
    /// The geometry, shared like that of a [`Model`].
    pub mesh: Arc<Mesh>,
    /// The position of the mesh's origin, m.
    pub position: DVec3,
    /// The rotation of the mesh in the world.
    pub rotation: DQuat,
    /// Colour, sRGB.
    pub colour: [f32; 3],
}

/// A flat translucent pane.
#[derive(Clone, Debug, PartialEq)]
pub struct Pane {
    /// The corners of a convex polygon in order, m; fewer than three are not drawn.
    pub corners: Vec<DVec3>,
    /// sRGB and opacity.
    pub colour: [f32; 4],
}

/// A straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// One end, m.
    pub from: DVec3,
    /// The other end, m.
    pub to: DVec3,
    /// sRGB and opacity.
    pub colour: [f32; 4],
    /// Width in pixels; thinner than one pixel is drawn fainter instead.
    pub width: f32,
}

/// An arrow: a shaft and a cone that ends at `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// The tail, m.
    pub from: DVec3,
    /// The tip, m; an arrow of zero length is not drawn.
    pub to: DVec3,
    /// Colour, sRGB.
    pub colour: [f32; 3],
    /// Radius of the shaft, m; a short arrow is drawn thinner, to keep its proportions.
    pub radius: f32,
}

/// Colours for bodies without a colour of their own, distinguishable for colour-blind people too (after the set of
/// Okabe and Ito, softened for large surfaces).
pub const PALETTE: [[f32; 3]; 8] = [
    [0.35, 0.60, 0.82],
    [0.90, 0.62, 0.25],
    [0.30, 0.66, 0.53],
    [0.80, 0.50, 0.66],
    [0.93, 0.85, 0.42],
    [0.82, 0.43, 0.30],
    [0.56, 0.77, 0.90],
    [0.62, 0.63, 0.65],
];

/// Encodes an image as the bytes of a PNG file.
pub fn png(image: &image::RgbaImage) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
