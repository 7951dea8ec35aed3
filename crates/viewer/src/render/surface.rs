//! Shaded meshes.

use egui_wgpu::wgpu;

use super::frame::FrameBinding;
use super::meshes::{self, Meshes};
use super::pipeline::{Drawing, shader};

pub(super) struct Surface {
    /// For meshes with no inside to be seen: the far half of their faces is not worth drawing.
    solid: wgpu::RenderPipeline,
    open: wgpu::RenderPipeline,
}

impl Surface {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/light.wgsl"),
            include_str!("shaders/surface.wgsl")
        );
        let module = shader(device, "surface", wgsl);
        let groups = [Some(frame.layout())];
        let buffers = meshes::layouts();
        let drawing = |solid| Drawing {
            label: "surface",
            shader: &module,
            vertex: "vs_main",
            groups: &groups,
            buffers: &buffers,
            topology: wgpu::PrimitiveTopology::TriangleList,
            blended: false,
            culled: solid,
            samples,
        };
        Self {
            solid: drawing(true).pipeline(device),
            open: drawing(false).pipeline(device),
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, meshes: &Meshes) {
        pass.set_pipeline(&self.solid);
        meshes.draw(pass, true);
        pass.set_pipeline(&self.open);
        meshes.draw(pass, false);
    }
}
