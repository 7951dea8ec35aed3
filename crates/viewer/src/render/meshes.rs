//! The meshes of a picture on the device, one copy of each, and the places of their instances.

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
use crate::number;
use crate::picture::{Ghost, Model};

/// An instance of a mesh; the layout matches `shaders/surface.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Instance {
    /// The position relative to the eye, m.
    offset: [f32; 3],
    radius: f32,
    colour: [f32; 3],
    /// A unit quaternion: x, y, z, w.
    rotation: [f32; 4],
}

const CORNER: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
const INSTANCE: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![2 => Float32x3, 3 => Float32, 4 => Float32x3, 5 => Float32x4];

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

/// A selection of the meshes and their instances.
#[derive(Clone, Copy)]
pub(super) struct Which {
    /// Whether the meshes are those without a visible inside, or the others.
    pub solid: bool,
    pub look: Look,
}

/// How a mesh is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    Plain,
    /// With its edges, which require the triangles' corners in order.
    Edged,
    /// With its edges, brighter and with a rim.
    Selected,
    /// Translucent.
    Ghost,
}

impl Look {
    /// Whether the corners of triangles must be in order.
    fn is_edged(self) -> bool {
        matches!(self, Look::Edged | Look::Selected)
    }
}

impl Which {
    /// The opaque meshes, which cast shadows.
    pub(super) const OPAQUE: [Which; 6] = [
        Which::new(true, Look::Plain),
        Which::new(false, Look::Plain),
        Which::new(true, Look::Edged),
        Which::new(false, Look::Edged),
        Which::new(true, Look::Selected),
        Which::new(false, Look::Selected),
    ];
    pub(super) const GHOSTS: [Which; 2] = [
        Which::new(true, Look::Ghost),
        Which::new(false, Look::Ghost),
    ];

    const fn new(solid: bool, look: Look) -> Which {
        Which { solid, look }
    }
}

/// The meshes, identified by the address of their [`Arc`].
pub(super) struct Meshes {
    known: HashMap<usize, DeviceMesh>,
    /// The order of the picture, so that drawing is deterministic.
    order: Vec<usize>,
    instances: Vec<Instance>,
    buffer: Growing<Instance>,
    cut: Vec<Cut>,
}

/// A mesh that is too large for a buffer of the device.
#[derive(Clone, Debug)]
pub struct Cut {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// The number of its triangles that are drawn.
    pub drawn: usize,
}

impl Cut {
    /// The message about the graphics adapter; `mesh` is the name of the geometry in it.
    pub fn told(&self, mesh: &str) -> String {
        let [drawn, all] =
            [self.drawn, self.mesh.triangles().len()].map(|count| number::count(count as f64));
        format!("has room for {drawn} of the {all} triangles of {mesh}, and draws no more")
    }
}

impl Meshes {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        Self {
            known: HashMap::new(),
            order: Vec::new(),
            instances: Vec::new(),
            buffer: Growing::new(device, "instances", wgpu::BufferUsages::VERTEX),
            cut: Vec::new(),
        }
    }

    /// The meshes found to be too large since the last call.
    pub(super) fn take_cut(&mut self) -> Vec<Cut> {
        std::mem::take(&mut self.cut)
    }

    /// Collects the models of a picture, and forgets meshes that the picture does not show.
    pub(super) fn gather(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        models: &[Model],
        ghosts: &[Ghost],
        wireframe: bool,
        eye: DVec3,
    ) {
        self.order.clear();
        let models = models.iter().map(|model| {
            let look = match model.selected {
                true => Look::Selected,
                false if wireframe => Look::Edged,
                false => Look::Plain,
            };
            let pose = (model.position, model.rotation);
            (&model.mesh, pose, model.colour, look)
        });
        let ghosts = ghosts.iter().map(|ghost| {
            let pose = (ghost.position, ghost.rotation);
            (&ghost.mesh, pose, ghost.colour, Look::Ghost)
        });
        for (geometry, (position, rotation), colour, look) in models.chain(ghosts) {
            if !(position.is_finite() && rotation.is_finite()) {
                continue;
            }
            let address = Arc::as_ptr(geometry).addr();
            let mut note = |drawn: &Triangles| {
                let (mesh, drawn) = (geometry.clone(), drawn.count());
                self.cut
                    .extend((drawn < mesh.triangles().len()).then_some(Cut { mesh, drawn }));
            };
            let mesh = self.known.entry(address).or_insert_with(|| {
                let mesh = DeviceMesh::new((device, queue), geometry);
                note(&mesh.shared);
                mesh
            });
            if mesh.places.iter().all(|places| places.instances.is_empty()) {
                self.order.push(address);
            }
            if look.is_edged() && mesh.apart.is_none() {
                let apart = Triangles::apart((device, queue), geometry);
                note(&apart);
                mesh.apart = Some(apart);
            }
            mesh.places[look as usize].instances.push(Instance {
                offset: (position - eye).as_vec3().to_array(),
                radius: mesh.radius,
                colour: linear(colour),
                rotation: rotation.as_quat().to_array(),
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

    /// Draws a selection of the meshes, each with all its instances at once, with a pipeline of [`layouts`].
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, which: Which) {
        pass.set_vertex_buffer(1, self.buffer.buffer().slice(..));
        let meshes = self
            .order
            .iter()
            .filter_map(|address| self.known.get(address));
        for mesh in meshes.filter(|mesh| mesh.solid == which.solid) {
            let range = mesh.places[which.look as usize].range.clone();
            if range.is_empty() {
                continue;
            }
            let apart = mesh.apart.as_ref();
            let apart = apart.filter(|_| which.look.is_edged());
            apart.unwrap_or(&mesh.shared).draw(pass, range);
        }
    }
}

/// One mesh on the device.
struct DeviceMesh {
    /// Prevents the mesh's address from being used again; the geometry itself may be freed.
    _mesh: Weak<Mesh>,
    shared: Triangles,
    /// The triangles with separate corners in order, once the mesh has been shown with edges.
    apart: Option<Triangles>,
    /// Whether the mesh has no visible inside.
    solid: bool,
    /// Half the diagonal of its bounds, m.
    radius: f32,
    /// The instances in each [`Look`].
    places: [Places; 4],
}

#[derive(Default)]
struct Places {
    /// The instances of this picture, while they are collected.
    instances: Vec<Instance>,
    /// Their range among all instances.
    range: Range<u32>,
}

impl DeviceMesh {
    fn new(made_on: (&wgpu::Device, &wgpu::Queue), mesh: &Arc<Mesh>) -> Self {
        let radius = mesh.bounds().half_extent().length() as f32;
        Self {
            _mesh: Arc::downgrade(mesh),
            shared: Triangles::shared(made_on, mesh),
            apart: None,
            solid: mesh.volume().is_some_and(|volume| volume > 0.0),
            radius: radius.max(f32::MIN_POSITIVE),
            places: Default::default(),
        }
    }
}
