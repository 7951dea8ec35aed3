//! The triangles of a mesh in buffers of the device.

use std::ops::Range;

use egui_wgpu::wgpu;
use sim_core::Mesh;

use super::normals::{Shaded, Vertex};

/// Triangles on the device. If the mesh exceeds the device's buffers, they are the first ones that fit.
pub(super) struct Triangles {
    vertices: wgpu::Buffer,
    /// `None` if each corner has a vertex of its own, in order.
    indices: Option<wgpu::Buffer>,
    corners: u32,
}

impl Triangles {
    /// Triangles whose corners share vertices.
    pub(super) fn shared((device, queue): (&wgpu::Device, &wgpu::Queue), mesh: &Mesh) -> Self {
        let shaded = Shaded::new(mesh);
        let vertices = &shaded.vertices[..shaded.vertices.len().min(most::<Vertex>(device))];
        let mut indices = &shaded.indices[..shaded.indices.len().min(most::<u32>(device))];
        if vertices.len() < shaded.vertices.len() {
            let beyond = |&index: &u32| index as usize >= vertices.len();
            let end = indices.iter().position(beyond).unwrap_or(indices.len());
            indices = &indices[..end / 3 * 3];
        }
        Self {
            vertices: buffer((device, queue), wgpu::BufferUsages::VERTEX, vertices),
            indices: Some(buffer((device, queue), wgpu::BufferUsages::INDEX, indices)),
            corners: indices.len() as u32,
        }
    }

    /// Triangles with separate corners, the three of a triangle in order.
    pub(super) fn apart((device, queue): (&wgpu::Device, &wgpu::Queue), mesh: &Mesh) -> Self {
        let shaded = Shaded::new(mesh);
        let corners = shaded.indices.iter().take(most::<Vertex>(device));
        let vertices: Vec<Vertex> = corners
            .map(|&index| shaded.vertices[index as usize])
            .collect();
        Self {
            vertices: buffer((device, queue), wgpu::BufferUsages::VERTEX, &vertices),
            indices: None,
            corners: vertices.len() as u32,
        }
    }

    /// The number of triangles that are drawn.
    pub(super) fn count(&self) -> usize {
        self.corners as usize / 3
    }

    /// Draws the instances of a buffer that is already bound.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, instances: Range<u32>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        match &self.indices {
            Some(indices) => {
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..self.corners, 0, instances);
            }
            None => pass.draw(0..self.corners, instances),
        }
    }
}

/// The most items of a buffer, for whole triangles.
fn most<T>(device: &wgpu::Device) -> usize {
    let items = device.limits().max_buffer_size / size_of::<T>() as u64;
    (items.min(u64::from(u32::MAX)) / 3 * 3) as usize
}

/// The queue writes the buffer, because a buffer that the device failed to create, for lack of memory or after a loss,
/// cannot be mapped.
fn buffer<T: bytemuck::Pod>(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    usage: wgpu::BufferUsages,
    items: &[T],
) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(items);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("triangles"),
        size: bytes.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    if !bytes.is_empty() {
        queue.write_buffer(&buffer, 0, bytes);
    }
    buffer
}
