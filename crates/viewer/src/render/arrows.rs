//! Shaded arrows with thickness.

use std::f32::consts::TAU;

use egui_wgpu::wgpu;
use egui_wgpu::wgpu::util::DeviceExt;
use glam::DVec3;

use super::frame::FrameBinding;
use super::growing::Growing;
use super::linear;
use super::pipeline::{Drawing, shader};
use crate::picture::Arrow;

/// The radius of the head, in radii of the shaft.
const HEAD_RADIUS: f64 = 2.4;
const HEAD_LENGTH: f64 = 6.5;
/// The largest fraction of an arrow's length that its head takes; a shorter arrow is thinner throughout.
const HEAD_PART: f64 = 0.5;
const SIDES: u16 = 24;

/// A vertex of the arrow's shape, before it is scaled; the layout matches `shaders/arrow.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Corner {
    around: [f32; 2],
    outward: [f32; 2],
    along: [f32; 2],
    normal: [f32; 2],
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Instance {
    tail: [f32; 3],
    radius: f32,
    span: [f32; 3],
    head_length: f32,
    colour: [f32; 3],
    head_radius: f32,
}

pub(super) struct Arrows {
    pipeline: wgpu::RenderPipeline,
    corners: wgpu::Buffer,
    corner_count: u32,
    instances: Vec<Instance>,
    buffer: Growing<Instance>,
    count: u32,
}

impl Arrows {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/light.wgsl"),
            include_str!("shaders/arrow.wgsl")
        );
        let corner = wgpu::vertex_attr_array![
            0 => Float32x2, 1 => Float32x2, 2 => Float32x2, 3 => Float32x2
        ];
        let instance = wgpu::vertex_attr_array![
            4 => Float32x3, 5 => Float32, 6 => Float32x3, 7 => Float32, 8 => Float32x3, 9 => Float32
        ];
        let drawing = Drawing {
            label: "arrows",
            shader: &shader(device, "arrows", wgsl),
            vertex: "vs_main",
            fragment: "fs_main",
            groups: &[Some(frame.layout())],
            buffers: &[
                Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Corner>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &corner,
                }),
                Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Instance>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: &instance,
                }),
            ],
            topology: wgpu::PrimitiveTopology::TriangleList,
            blended: false,
            culled: true,
            on_top: false,
            samples,
        };
        let corners = shape();
        Self {
            pipeline: drawing.pipeline(device),
            corners: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("arrow"),
                contents: bytemuck::cast_slice(&corners),
                usage: wgpu::BufferUsages::VERTEX,
            }),
            corner_count: corners.len() as u32,
            instances: Vec::new(),
            buffer: Growing::new(device, "arrows", wgpu::BufferUsages::VERTEX),
            count: 0,
        }
    }

    /// Collects the arrows of a picture.
    pub(super) fn gather(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        arrows: &[Arrow],
        eye: DVec3,
    ) {
        self.instances.clear();
        self.instances
            .extend(arrows.iter().filter_map(|arrow| instance(arrow, eye)));
        self.count = self.buffer.write(device, queue, &self.instances);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.set_vertex_buffer(1, self.buffer.buffer().slice(..));
        pass.draw(0..self.corner_count, 0..self.count);
    }
}

/// The data of an arrow; `None` if it has no direction or no thickness.
fn instance(arrow: &Arrow, eye: DVec3) -> Option<Instance> {
    let span = arrow.to - arrow.from;
    let length = span.length();
    if !(length > 1e-30 && length.is_finite() && arrow.radius > 0.0) {
        return None;
    }
    let radius = f64::from(arrow.radius).min(HEAD_PART * length / HEAD_LENGTH);
    Some(Instance {
        tail: (arrow.from - eye).as_vec3().to_array(),
        radius: radius as f32,
        span: span.as_vec3().to_array(),
        head_length: (HEAD_LENGTH * radius) as f32,
        colour: linear(arrow.colour),
        head_radius: (HEAD_RADIUS * radius) as f32,
    })
}

/// The triangles of tail disc, shaft, back of the head and cone.
fn shape() -> Vec<Corner> {
    const BACK: [f32; 2] = [0.0, -1.0];
    const OUT: [f32; 2] = [1.0, 0.0];
    const SLOPE: [f32; 2] = [1.0, 1.0];
    const TAIL: [f32; 2] = [0.0, 0.0];
    const NECK: [f32; 2] = [1.0, -1.0];
    const TIP: [f32; 2] = [1.0, 0.0];
    const LINE: [f32; 2] = [0.0, 0.0];
    const SHAFT: [f32; 2] = [1.0, 0.0];
    const HEAD: [f32; 2] = [0.0, 1.0];
    // Bands between two rings. For each ring: radial and axial coordinate; for the band: its normal.
    let bands = [
        ([LINE, TAIL], [SHAFT, TAIL], BACK),
        ([SHAFT, TAIL], [SHAFT, NECK], OUT),
        ([SHAFT, NECK], [HEAD, NECK], BACK),
        ([HEAD, NECK], [LINE, TIP], SLOPE),
    ];
    let direction = |side: u16| {
        let (sin, cos) = (TAU * f32::from(side) / f32::from(SIDES)).sin_cos();
        [cos, sin]
    };
    let mut corners = Vec::new();
    for ([near_out, near_along], [far_out, far_along], normal) in bands {
        for side in 0..SIDES {
            let near = |side| Corner {
                around: direction(side),
                outward: near_out,
                along: near_along,
                normal,
            };
            let far = |side| Corner {
                around: direction(side),
                outward: far_out,
                along: far_along,
                normal,
            };
            corners.extend([near(side), near(side + 1), far(side + 1)]);
            corners.extend([near(side), far(side + 1), far(side)]);
        }
    }
    corners
}
