//! Flat translucent panes, unshaded.

use egui_wgpu::wgpu;
use glam::DVec3;

use super::frame::FrameBinding;
use super::growing::Growing;
use super::linear;
use super::pipeline::{Drawing, shader};
use crate::picture::Pane;

/// The layout matches `shaders/pane.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Corner {
    position: [f32; 3],
    colour: [f32; 4],
}

const CORNER: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x4];

pub(super) struct Panes {
    pipeline: wgpu::RenderPipeline,
    corners: Vec<Corner>,
    buffer: Growing<Corner>,
    count: u32,
}

impl Panes {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/pane.wgsl")
        );
        let drawing = Drawing {
            label: "panes",
            shader: &shader(device, "panes", wgsl),
            vertex: "vs_main",
            fragment: "fs_main",
            groups: &[Some(frame.layout())],
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Corner>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &CORNER,
            })],
            topology: wgpu::PrimitiveTopology::TriangleList,
            blended: true,
            culled: false,
            on_top: false,
            samples,
        };
        Self {
            pipeline: drawing.pipeline(device),
            corners: Vec::new(),
            buffer: Growing::new(device, "panes", wgpu::BufferUsages::VERTEX),
            count: 0,
        }
    }

    /// Collects the panes of a picture.
    pub(super) fn gather(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        panes: &[Pane],
        eye: DVec3,
    ) {
        self.corners.clear();
        let drawn = |pane: &&Pane| pane.corners.iter().all(|corner| corner.is_finite());
        for pane in panes.iter().filter(drawn) {
            let [red, green, blue, opacity] = pane.colour;
            let opacity = opacity.clamp(0.0, 1.0);
            let [red, green, blue] = linear([red, green, blue]).map(|part| part * opacity);
            let corner = |&at: &DVec3| Corner {
                position: (at - eye).as_vec3().to_array(),
                colour: [red, green, blue, opacity],
            };
            let Some((first, rest)) = pane.corners.split_first() else {
                continue;
            };
            let triangles = rest.windows(2).flat_map(|pair| [first, &pair[0], &pair[1]]);
            self.corners.extend(triangles.map(corner));
        }
        self.count = self.buffer.write(device, queue, &self.corners);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, self.buffer.buffer().slice(..));
        pass.draw(0..self.count, 0..1);
    }
}
