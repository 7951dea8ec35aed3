//! The vertical axis, a ruler with a tick at every spacing of the grid. The grid draws the two horizontal axes.

use glam::DVec3;

use super::frame::grid_step;
use crate::camera::Camera;
use crate::picture::Line;

const COLOUR: [f32; 4] = [0.16, 0.58, 0.24, 0.75];
/// The length of the axis, and that of a tick to either side, in spacings of the grid.
const SPACINGS: u32 = 10;
const TICK: f64 = 0.06;

/// The lines of the axis, upwards from the origin.
pub(super) fn upright(camera: &Camera) -> Vec<Line> {
    let step = grid_step(camera);
    let [right, _, _] = camera.axes();
    // From above the ticks would only hide the ground, so they become shorter.
    let tick = TICK * step * camera.pitch.cos() * right;
    let line = |from, to, width| Line {
        from,
        to,
        colour: COLOUR,
        width,
    };
    let top = f64::from(SPACINGS) * step * DVec3::Y;
    let mut lines = vec![line(DVec3::ZERO, top, 2.0)];
    lines.extend((1..=SPACINGS).map(|spacing| {
        let at = f64::from(spacing) * step * DVec3::Y;
        line(at - tick, at + tick, 1.5)
    }));
    lines
}
