//! The grid on the ground with its axes, and the shadows.

use egui_wgpu::wgpu;

use super::frame::FrameBinding;
use super::pipeline::{Drawing, shader};
use super::shadow::Shadow;

pub(super) struct Ground {
    pipeline: wgpu::RenderPipeline,
}

impl Ground {
    pub(super) fn new(
        device: &wgpu::Device,
        frame: &FrameBinding,
        shadow: &Shadow,
        samples: u32,
    ) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/ground.wgsl")
        );
        let drawing = Drawing {
            label: "ground",
            shader: &shader(device, "ground", wgsl),
            vertex: "vs_main",
            fragment: "fs_main",
            groups: &[Some(frame.layout()), Some(shadow.layout())],
            buffers: &[],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            blended: true,
            culled: false,
            on_top: false,
            samples,
        };
        Self {
            pipeline: drawing.pipeline(device),
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shadow: &Shadow) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, shadow.group(), &[]);
        pass.draw(0..4, 0..1);
    }
}
