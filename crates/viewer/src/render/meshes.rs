//! The meshes of a picture on the device, one copy of each, and where each is drawn.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Weak};

use egui_wgpu::wgpu;
use glam::DVec3;
use sim_core::Mesh;

use super::growing::Growing;
use super::linear;
use super::normals::Vertex;
use super::triangles::Triangles;
use crate::picture::Model;

/// One place a mesh is drawn at, as `shaders/surface.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Instance {
    /// From the eye, m.
    offset: [f32; 3],
    radius: f32,
    colour: [f32; 3],
}

const CORNER: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
const INSTANCE: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![2 => Float32x3, 3 => Float32, 4 => Float32x3];

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

/// Which of the meshes and their places to draw.
#[derive(Clone, Copy)]
pub(super) struct Which {
    /// Those that have no inside to be seen, or else the others.
    pub solid: bool,
    /// The selected, with the corners of triangles in order, or else the others.
    pub selected: bool,
}

impl Which {
    pub(super) const ALL: [Which; 4] = [
        Which {
            solid: true,
            selected: false,
        },
        Which {
            solid: false,
            selected: false,
        },
        Which {
            solid: true,
            selected: true,
        },
        Which {
            solid: false,
            selected: true,
        },
    ];
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
            let address = Arc::as_ptr(&model.mesh).addr();
            let mesh = self
                .known
                .entry(address)
                .or_insert_with(|| DeviceMesh::new(device, &model.mesh));
            if mesh.places.iter().all(|places| places.instances.is_empty()) {
                self.order.push(address);
            }
            if model.selected && mesh.apart.is_none() {
                mesh.apart = Some(Triangles::apart(device, &model.mesh));
            }
            mesh.places[usize::from(model.selected)]
                .instances
                .push(Instance {
                    offset: (model.position - eye).as_vec3().to_array(),
                    radius: mesh.radius,
                    colour: linear(model.colour),
                });
        }
        self.known.retain(|_, mesh| {
            mesh.places
                .iter()
                .any(|places| !places.instances.is_empty())
        });

        self.instances.clear();
        for address in &self.order {
            for places in self
                .known
                .get_mut(address)
                .into_iter()
                .flat_map(|mesh| &mut mesh.places)
            {
                let start = self.instances.len() as u32;
                self.instances.append(&mut places.instances);
                places.range = start..self.instances.len() as u32;
            }
        }
        let written = self.buffer.write(device, queue, &self.instances);
        for places in self.known.values_mut().flat_map(|mesh| &mut mesh.places) {
            places.range = places.range.start.min(written)..places.range.end.min(written);
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Draws some of the meshes, each at all its places at once, with a pipeline of [`layouts`].
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, which: Which) {
        pass.set_vertex_buffer(1, self.buffer.buffer().slice(..));
        let meshes = self
            .order
            .iter()
            .filter_map(|address| self.known.get(address));
        for mesh in meshes.filter(|mesh| mesh.solid == which.solid) {
            let range = mesh.places[usize::from(which.selected)].range.clone();
            if range.is_empty() {
                continue;
            }
            let apart = mesh.apart.as_ref().filter(|_| which.selected);
            apart.unwrap_or(&mesh.shared).draw(pass, range);
        }
    }
}

/// One mesh on the device.
struct DeviceMesh {
    /// Keeps the address that the mesh is known by from being used again; its geometry may go.
    _mesh: Weak<Mesh>,
    shared: Triangles,
    /// Each corner by itself and in order, since the mesh was first selected.
    apart: Option<Triangles>,
    /// Whether it has no inside to be seen.
    solid: bool,
    /// Half the diagonal of its bounds, m.
    radius: f32,
    /// Where it is drawn, not selected and selected.
    places: [Places; 2],
}

#[derive(Default)]
struct Places {
    /// Of this picture, while it is gathered.
    instances: Vec<Instance>,
    /// Where those are among all.
    range: Range<u32>,
}

impl DeviceMesh {
    fn new(device: &wgpu::Device, mesh: &Arc<Mesh>) -> Self {
        let radius = mesh.bounds().half_extent().length() as f32;
        Self {
            _mesh: Arc::downgrade(mesh),
            shared: Triangles::shared(device, mesh),
            apart: None,
            solid: mesh.volume().is_some_and(|volume| volume > 0.0),
            radius: radius.max(f32::MIN_POSITIVE),
            places: Default::default(),
        }
    }
}
