//! The edges of selected models, over their surfaces.

use egui_wgpu::wgpu;
use glam::DVec3;

use super::frame::FrameBinding;
use super::growing::Growing;
use super::meshes::Meshes;
use super::pipeline::{Drawing, shader};
use super::{linear, lines};
use crate::picture::Model;

const COLOUR: [f32; 3] = [0.10, 0.12, 0.16];
const OPACITY: f32 = 0.75;
/// Pixels.
const WIDTH: f32 = 1.2;

/// One model's share of the uniform buffer, as `shaders/line.wgsl` has it; the rest keeps each on an offset
/// that every device can bind.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Place {
    offset: [f32; 3],
    width: f32,
    colour: [f32; 4],
    rest: [[f32; 4]; 14],
}

pub(super) struct Edges {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
    places: Vec<Place>,
    buffer: Growing<Place>,
    /// Per place, the ends of the edges and their number.
    ends: Vec<(wgpu::Buffer, u32)>,
}

impl Edges {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("edges"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let drawing = Drawing {
            label: "edges",
            shader: &shader(device, "edges", lines::WGSL),
            vertex: "vs_edge",
            groups: &[Some(frame.layout()), Some(&layout)],
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<[[f32; 3]; 2]>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &attributes,
            })],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            blended: true,
            culled: false,
            samples,
        };
        let buffer = Growing::new(device, "edges", wgpu::BufferUsages::UNIFORM);
        Self {
            pipeline: drawing.pipeline(device),
            group: group(device, &layout, buffer.buffer()),
            layout,
            places: Vec::new(),
            buffer,
            ends: Vec::new(),
        }
    }

    /// Takes in the selected among models that `meshes` has gathered.
    pub(super) fn gather(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        meshes: &mut Meshes,
        models: &[Model],
        eye: DVec3,
    ) {
        self.places.clear();
        self.ends.clear();
        let [red, green, blue] = linear(COLOUR);
        let selected = models
            .iter()
            .filter(|model| model.selected && model.position.is_finite());
        for model in selected {
            if let Some(ends) = meshes.edges(device, &model.mesh) {
                self.ends.push(ends);
                self.places.push(Place {
                    offset: (model.position - eye).as_vec3().to_array(),
                    width: WIDTH,
                    colour: [red, green, blue, OPACITY],
                    rest: Default::default(),
                });
            }
        }
        let written = self.buffer.write(device, queue, &self.places);
        self.ends.truncate(written as usize);
        self.group = group(device, &self.layout, self.buffer.buffer());
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        for (place, (ends, count)) in self.ends.iter().enumerate() {
            let offset = (place * size_of::<Place>()) as u32;
            pass.set_bind_group(1, &self.group, &[offset]);
            pass.set_vertex_buffer(0, ends.slice(..));
            pass.draw(0..4, 0..*count);
        }
    }
}

fn group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffer: &wgpu::Buffer,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("edges"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset: 0,
                size: std::num::NonZeroU64::new(size_of::<Place>() as u64),
            }),
        }],
    })
}
