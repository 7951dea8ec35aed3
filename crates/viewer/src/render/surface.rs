//! Shaded meshes, selected ones with their edges, and translucent ghosts.

use egui_wgpu::wgpu;

use super::frame::FrameBinding;
use super::meshes::{self, Look, Meshes, Which};
use super::pipeline::{Drawing, shader};

pub(super) struct Surface {
    opaque: Vec<(Which, wgpu::RenderPipeline)>,
    ghosts: Vec<(Which, wgpu::RenderPipeline)>,
    rims: Vec<(Which, wgpu::RenderPipeline)>,
}

impl Surface {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/light.wgsl"),
            include_str!("shaders/surface.wgsl")
        );
        let module = shader(device, "surface", wgsl);
        let pipeline = |which: Which| {
            let drawing = Drawing {
                label: "surface",
                shader: &module,
                vertex: match which.look {
                    Look::Selected | Look::Edged => "vs_edged",
                    Look::Plain | Look::Ghost => "vs_plain",
                },
                fragment: match which.look {
                    Look::Plain => "fs_plain",
                    Look::Selected | Look::Edged => "fs_edged",
                    Look::Ghost => "fs_ghost",
                },
                groups: &[Some(frame.layout())],
                buffers: &meshes::layouts(),
                topology: wgpu::PrimitiveTopology::TriangleList,
                blended: which.look == Look::Ghost,
                // If the inside of a mesh is never visible, its back faces are culled.
                culled: which.solid,
                on_top: false,
                samples,
            };
            (which, drawing.pipeline(device))
        };
        let rim = |which: Which, vertex| {
            let drawing = Drawing {
                label: "rim of the selection",
                shader: &module,
                vertex,
                fragment: "fs_rim",
                groups: &[Some(frame.layout())],
                buffers: &meshes::layouts(),
                topology: wgpu::PrimitiveTopology::TriangleList,
                blended: true,
                culled: which.solid,
                on_top: false,
                samples,
            };
            (which, drawing.pipeline(device))
        };
        let selected = Which::OPAQUE
            .into_iter()
            .filter(|w| w.look == Look::Selected);
        let sides = ["vs_rim0", "vs_rim1", "vs_rim2", "vs_rim3"];
        let rims = selected.flat_map(|which| sides.map(|side| rim(which, side)));
        Self {
            opaque: Which::OPAQUE.map(pipeline).into(),
            ghosts: Which::GHOSTS.map(pipeline).into(),
            rims: rims.collect(),
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, meshes: &Meshes) {
        draw(&self.opaque, pass, meshes);
    }

    /// Draws a rim around the selected meshes, after all opaque ones.
    pub(super) fn draw_rims(&self, pass: &mut wgpu::RenderPass<'_>, meshes: &Meshes) {
        draw(&self.rims, pass, meshes);
    }

    /// Draws the ghosts, after everything that is visible through them.
    pub(super) fn draw_ghosts(&self, pass: &mut wgpu::RenderPass<'_>, meshes: &Meshes) {
        draw(&self.ghosts, pass, meshes);
    }
}

fn draw(
    pipelines: &[(Which, wgpu::RenderPipeline)],
    pass: &mut wgpu::RenderPass<'_>,
    meshes: &Meshes,
) {
    for (which, pipeline) in pipelines {
        pass.set_pipeline(pipeline);
        meshes.draw(pass, *which);
    }
}
