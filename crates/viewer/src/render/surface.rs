//! Shaded meshes, the selected ones with their edges.

use egui_wgpu::wgpu;

use super::frame::FrameBinding;
use super::meshes::{self, Meshes, Which};
use super::pipeline::{Drawing, shader};

pub(super) struct Surface {
    pipelines: Vec<(Which, wgpu::RenderPipeline)>,
}

impl Surface {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, samples: u32) -> Self {
        let wgsl = concat!(
            include_str!("shaders/frame.wgsl"),
            include_str!("shaders/light.wgsl"),
            include_str!("shaders/surface.wgsl")
        );
        let module = shader(device, "surface", wgsl);
        let pipeline = |which: Which| {
            let drawing = Drawing {
                label: "surface",
                shader: &module,
                vertex: if which.selected {
                    "vs_edged"
                } else {
                    "vs_plain"
                },
                fragment: if which.selected {
                    "fs_edged"
                } else {
                    "fs_plain"
                },
                groups: &[Some(frame.layout())],
                buffers: &meshes::layouts(),
                topology: wgpu::PrimitiveTopology::TriangleList,
                blended: false,
                // With no inside to be seen, the far half of the faces is not worth drawing.
                culled: which.solid,
                on_top: false,
                samples,
            };
            (which, drawing.pipeline(device))
        };
        Self {
            pipelines: Which::ALL.map(pipeline).into(),
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, meshes: &Meshes) {
        for (which, pipeline) in &self.pipelines {
            pass.set_pipeline(pipeline);
            meshes.draw(pass, *which);
        }
    }
}
