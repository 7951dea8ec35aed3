//! The gradient in the background.

use egui_wgpu::wgpu;

use super::frame::FrameBinding;
use super::pipeline::{Drawing, shader};

pub(super) struct Background {
    pipeline: wgpu::RenderPipeline,
}

impl Background {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/background.wgsl")
        );
        let drawing = Drawing {
            label: "background",
            shader: &shader(device, "background", wgsl),
            vertex: "vs_main",
            fragment: "fs_main",
            groups: &[Some(frame.layout())],
            buffers: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            blended: false,
            culled: false,
            on_top: false,
            samples,
        };
        Self {
            pipeline: drawing.pipeline(device),
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
