//! Shaded meshes.

use egui_wgpu::wgpu;

use super::frame::FrameBinding;
use super::meshes::{self, Meshes};
use super::pipeline::{Drawing, shader};

pub(super) struct Surface {
    pipeline: wgpu::RenderPipeline,
}

impl Surface {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/light.wgsl"),
            include_str!("shaders/surface.wgsl")
        );
        let drawing = Drawing {
            label: "surface",
            shader: &shader(device, "surface", wgsl),
            vertex: "vs_main",
            groups: &[Some(frame.layout())],
            buffers: &meshes::layouts(),
            topology: wgpu::PrimitiveTopology::TriangleList,
            blended: false,
            samples,
        };
        Self {
            pipeline: drawing.pipeline(device),
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, meshes: &Meshes) {
        pass.set_pipeline(&self.pipeline);
        meshes.draw(pass);
    }
}
