//! What to draw: plain data, made by whoever looks at a world and read by [`render`](crate::render).

use std::sync::Arc;

use glam::{DQuat, DVec3};
use sim_core::Mesh;

use crate::camera::Camera;

/// One picture. Positions are in world metres, `y` up; colours are sRGB, each part in `0..=1`.
#[derive(Clone, Default)]
pub struct Picture {
    /// Where it is seen from.
    pub camera: Camera,
    /// Meshes, shaded.
    pub models: Vec<Model>,
    /// Meshes that are seen through, and cast no shadow.
    pub ghosts: Vec<Ghost>,
    /// Coloured glass.
    pub panes: Vec<Pane>,
    /// Lines of a width in pixels.
    pub lines: Vec<Line>,
    /// Lines that nothing hides.
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
    /// Where the mesh's origin is, m.
    pub position: DVec3,
    /// Turns the mesh into the world.
    pub rotation: DQuat,
    /// Surface colour, sRGB.
    pub colour: [f32; 3],
    /// Whether the mesh's edges are drawn over it.
    pub selected: bool,
}

/// A mesh at a position, seen through: what is elsewhere or at another time.
#[derive(Clone)]
pub struct Ghost {
    /// The geometry, shared like that of a [`Model`].
    pub mesh: Arc<Mesh>,
    /// Where the mesh's origin is, m.
    pub position: DVec3,
    /// Turns the mesh into the world.
    pub rotation: DQuat,
    /// Colour, sRGB.
    pub colour: [f32; 3],
}

/// A flat pane that is seen through.
#[derive(Clone, Debug, PartialEq)]
pub struct Pane {
    /// Its corners in order, m, of a convex polygon; fewer than three are not drawn.
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
    /// The tip, m; an arrow of no length is not drawn.
    pub to: DVec3,
    /// Colour, sRGB.
    pub colour: [f32; 3],
    /// Radius of the shaft, m; a short arrow is drawn thinner, to keep its shape.
    pub radius: f32,
}

/// Colours for bodies that have none of their own, told apart also by people who are colour-blind
/// (after the set of Okabe and Ito, softened for large surfaces).
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

/// An image as the bytes of a PNG file.
pub fn png(image: &image::RgbaImage) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
