//! Lines with a width in pixels: rectangles on the screen with soft borders and round ends.

use egui_wgpu::wgpu;
use glam::DVec3;

use super::frame::FrameBinding;
use super::growing::Growing;
use super::linear;
use super::pipeline::{Drawing, shader};
use crate::picture::Line;

/// The layout matches `shaders/line.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Instance {
    from: [f32; 3],
    to: [f32; 3],
    colour: [f32; 4],
    width: f32,
}

/// The largest width, pixels.
const MAX_WIDTH: f32 = 1000.0;

const INSTANCE: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32];

pub(super) struct Lines {
    pipeline: wgpu::RenderPipeline,
    instances: Vec<Instance>,
    buffer: Growing<Instance>,
    count: u32,
}

impl Lines {
    /// A pipeline for lines that nearer surfaces hide, or for lines on top of everything.
    pub(super) fn new(
        device: &wgpu::Device,
        frame: &FrameBinding,
        samples: u32,
        on_top: bool,
    ) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/line.wgsl")
        );
        let drawing = Drawing {
            label: "lines",
            shader: &shader(device, "lines", wgsl),
            vertex: "vs_main",
            fragment: "fs_main",
            groups: &[Some(frame.layout())],
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Instance>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &INSTANCE,
            })],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            blended: true,
            culled: false,
            on_top,
            samples,
        };
        Self {
            pipeline: drawing.pipeline(device),
            instances: Vec::new(),
            buffer: Growing::new(device, "lines", wgpu::BufferUsages::VERTEX),
            count: 0,
        }
    }

    /// Collects the lines of a picture.
    pub(super) fn gather<'a>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        lines: impl Iterator<Item = &'a Line>,
        eye: DVec3,
    ) {
        self.instances.clear();
        let drawn =
            lines.filter(|line| line.from.is_finite() && line.to.is_finite() && line.width > 0.0);
        self.instances.extend(drawn.map(|line| {
            let [red, green, blue, opacity] = line.colour;
            let [red, green, blue] = linear([red, green, blue]);
            Instance {
                from: (line.from - eye).as_vec3().to_array(),
                to: (line.to - eye).as_vec3().to_array(),
                colour: [red, green, blue, opacity.clamp(0.0, 1.0)],
                width: line.width.min(MAX_WIDTH),
            }
        }));
        self.count = self.buffer.write(device, queue, &self.instances);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, self.buffer.buffer().slice(..));
        pass.draw(0..4, 0..self.count);
    }
}
