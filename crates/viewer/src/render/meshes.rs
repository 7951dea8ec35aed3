//! The meshes of a picture on the device, one copy of each, and where each is drawn.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Weak};

use egui_wgpu::wgpu;
use egui_wgpu::wgpu::util::DeviceExt;
use glam::DVec3;
use sim_core::Mesh;

use super::growing::Growing;
use super::linear;
use super::normals::{Shaded, Vertex};
use crate::picture::Model;

/// One place a mesh is drawn at, as `shaders/surface.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Instance {
    /// From the eye, m.
    offset: [f32; 3],
    radius: f32,
    colour: [f32; 3],
    selected: f32,
}

const CORNER: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
const INSTANCE: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![2 => Float32x3, 3 => Float32, 4 => Float32x3, 5 => Float32];

/// The layouts of the two vertex buffers that [`Meshes::draw`] sets.
pub(super) fn layouts() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
    [
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &CORNER,
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Instance>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &INSTANCE,
        }),
    ]
}

/// One mesh on the device.
struct DeviceMesh {
    /// Keeps the address that the mesh is known by from being used again; its geometry may go.
    _mesh: Weak<Mesh>,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
    /// Whether it has no inside to be seen.
    solid: bool,
    /// Half the diagonal of its bounds, m.
    radius: f32,
    edges: Option<(wgpu::Buffer, u32)>,
    /// Where this picture draws it, while that is gathered.
    instances: Vec<Instance>,
    /// Where those are among all.
    range: Range<u32>,
}

/// Meshes known by the address of their [`Arc`].
pub(super) struct Meshes {
    known: HashMap<usize, DeviceMesh>,
    /// In the order of the picture, to draw every picture alike.
    order: Vec<usize>,
    instances: Vec<Instance>,
    buffer: Growing<Instance>,
}

impl Meshes {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        Self {
            known: HashMap::new(),
            order: Vec::new(),
            instances: Vec::new(),
            buffer: Growing::new(device, "instances", wgpu::BufferUsages::VERTEX),
        }
    }

    /// Takes in the models of a picture; forgets the meshes that it does not show.
    pub(super) fn gather(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        models: &[Model],
        eye: DVec3,
    ) {
        self.order.clear();
        for model in models.iter().filter(|model| model.position.is_finite()) {
            let address = address(&model.mesh);
            let mesh = self
                .known
                .entry(address)
                .or_insert_with(|| DeviceMesh::new(device, &model.mesh));
            if mesh.instances.is_empty() {
                self.order.push(address);
            }
            mesh.instances.push(Instance {
                offset: (model.position - eye).as_vec3().to_array(),
                radius: mesh.radius,
                colour: linear(model.colour),
                selected: if model.selected { 1.0 } else { 0.0 },
            });
        }
        self.known.retain(|_, mesh| !mesh.instances.is_empty());

        self.instances.clear();
        for address in &self.order {
            if let Some(mesh) = self.known.get_mut(address) {
                let start = self.instances.len() as u32;
                self.instances.append(&mut mesh.instances);
                mesh.range = start..self.instances.len() as u32;
            }
        }
        let written = self.buffer.write(device, queue, &self.instances);
        for mesh in self.known.values_mut() {
            mesh.range = mesh.range.start.min(written)..mesh.range.end.min(written);
        }
    }

    /// Draws at all their places the meshes that are solid, or else the others, with a pipeline of [`layouts`].
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, solid: bool) {
        pass.set_vertex_buffer(1, self.buffer.buffer().slice(..));
        let meshes = self
            .order
            .iter()
            .filter_map(|address| self.known.get(address));
        for mesh in meshes.filter(|mesh| mesh.solid == solid) {
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, mesh.range.clone());
        }
    }

    /// The edges of a gathered mesh, pairs of points, made when first asked for; and their number.
    pub(super) fn edges(
        &mut self,
        device: &wgpu::Device,
        mesh: &Arc<Mesh>,
    ) -> Option<(wgpu::Buffer, u32)> {
        let known = self.known.get_mut(&address(mesh))?;
        let edges = known.edges.get_or_insert_with(|| edge_buffer(device, mesh));
        Some(edges.clone())
    }
}

impl DeviceMesh {
    fn new(device: &wgpu::Device, mesh: &Arc<Mesh>) -> Self {
        let shaded = Shaded::new(mesh);
        // A mesh too large for the device's buffers is drawn in part.
        let most_indices = device.limits().max_buffer_size / size_of::<u32>() as u64;
        let mut indices = shaded.indices.as_slice();
        indices = &indices[..indices.len().min((most_indices / 3 * 3) as usize)];
        let most_vertices = device.limits().max_buffer_size / size_of::<Vertex>() as u64;
        let mut vertices = shaded.vertices.as_slice();
        if vertices.len() as u64 > most_vertices {
            vertices = &vertices[..most_vertices as usize];
            let beyond = |&index: &u32| u64::from(index) >= most_vertices;
            let end = indices.iter().position(beyond).unwrap_or(indices.len());
            indices = &indices[..end / 3 * 3];
        }
        let bounds = mesh.bounds();
        Self {
            _mesh: Arc::downgrade(mesh),
            vertices: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("vertices"),
                contents: bytemuck::cast_slice(vertices),
                usage: wgpu::BufferUsages::VERTEX,
            }),
            indices: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("indices"),
                contents: bytemuck::cast_slice(indices),
                usage: wgpu::BufferUsages::INDEX,
            }),
            index_count: indices.len() as u32,
            solid: mesh.volume().is_some_and(|volume| volume > 0.0),
            radius: (bounds.half_extent().length() as f32).max(f32::MIN_POSITIVE),
            edges: None,
            instances: Vec::new(),
            range: 0..0,
        }
    }
}

fn address(mesh: &Arc<Mesh>) -> usize {
    Arc::as_ptr(mesh).addr()
}

fn edge_buffer(device: &wgpu::Device, mesh: &Mesh) -> (wgpu::Buffer, u32) {
    let most = device.limits().max_buffer_size as usize / size_of::<[[f32; 3]; 2]>();
    let vertices = mesh.vertices();
    let ends: Vec<[[f32; 3]; 2]> = mesh
        .edges()
        .iter()
        .take(most)
        .map(|edge| edge.map(|end| vertices[end as usize].to_array()))
        .collect();
    let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("edges"),
        contents: bytemuck::cast_slice(&ends),
        usage: wgpu::BufferUsages::VERTEX,
    });
    (buffer, ends.len() as u32)
}
