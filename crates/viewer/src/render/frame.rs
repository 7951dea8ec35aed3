//! The data of a picture that all pipelines share: camera, light, and the positions of grid and shadow.

use egui_wgpu::wgpu;
use glam::{DVec2, DVec3};

use crate::camera::Camera;

/// The range of heights of the eye above the ground, in spacings, for which one set of four grid spacings is used.
const HEIGHT_PER_STEP: f64 = 1000.0;
/// The radius of the grid, in distances of the camera or heights of the eye.
const GRID_REACH: f64 = 30.0;
/// Half the side of the ground that receives shadows, in distances of the camera.
const SHADOW_HALF: f64 = 1.6;

/// The layout matches `shaders/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Frame {
    view_projection: [[f32; 4]; 4],
    right: [f32; 3],
    near: f32,
    up: [f32; 3],
    pixel: f32,
    forward: [f32; 3],
    eye_height: f32,
    light: [f32; 3],
    shadow_half: f32,
    half_size: [f32; 2],
    shadow_centre: [f32; 2],
    origin: [f32; 2],
    grid_step: f32,
    grid_reach: f32,
    grid_x: [f32; 4],
    grid_z: [f32; 4],
    depth_share: f32,
    padding: [f32; 3],
}

impl Frame {
    pub(super) fn new(camera: &Camera, size: [u32; 2]) -> Self {
        let [width, height] = size.map(f64::from);
        let aspect = width / height;
        let eye = camera.eye();
        let [right, up, backward] = camera.axes();
        let [half_width, half_height] = camera.half_extents(aspect);

        // The light comes over the viewer's left shoulder, so that no visible side is dark.
        let level = right.cross(DVec3::Y);
        let light = (-0.45 * right + 0.8 * DVec3::Y + 0.55 * level).normalize();

        let grid_step = grid_step(camera);
        let within = |at: f64| {
            [1.0, 10.0, 100.0, 1000.0].map(|spacings| {
                let cells = at / (grid_step * spacings);
                (cells - cells.floor()) as f32
            })
        };
        let plane = |point: DVec3| DVec2::new(point.x, point.z);
        Self {
            view_projection: camera.view_projection(aspect).to_cols_array_2d(),
            right: (half_width * right).as_vec3().to_array(),
            // In a parallel projection nothing comes near the eye.
            near: if camera.parallel {
                0.0
            } else {
                camera.near() as f32
            },
            up: (half_height * up).as_vec3().to_array(),
            pixel: (2.0 * half_height / height) as f32,
            forward: (-backward).as_vec3().to_array(),
            eye_height: eye.y as f32,
            light: light.as_vec3().to_array(),
            shadow_half: (SHADOW_HALF * camera.distance) as f32,
            half_size: [0.5 * width as f32, 0.5 * height as f32],
            shadow_centre: plane(camera.target - eye).as_vec2().to_array(),
            origin: plane(-eye).as_vec2().to_array(),
            grid_step: grid_step as f32,
            grid_reach: (GRID_REACH * camera.distance.max(eye.y.abs())) as f32,
            grid_x: within(eye.x),
            grid_z: within(eye.z),
            depth_share: camera.depth_share() as f32,
            padding: [0.0; 3],
        }
    }
}

/// The finest spacing of the grid, m: one metre, or a power of ten if the camera is so far up that metres are too fine.
pub(super) fn grid_step(camera: &Camera) -> f64 {
    let decades = (camera.eye().y.abs() / HEIGHT_PER_STEP).log10().floor();
    10f64.powf(decades.max(0.0))
}

/// The frame's data on the device, bound as group 0.
pub(super) struct FrameBinding {
    buffer: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
}

impl FrameBinding {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<Frame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("frame"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: buffer.as_entire_binding(),
            }],
        });
        Self {
            buffer,
            layout,
            group,
        }
    }

    pub(super) fn write(&self, queue: &wgpu::Queue, frame: &Frame) {
        queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(frame));
    }

    pub(super) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    pub(super) fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }
}
