//! Draws pictures onto a texture: shaded meshes, ground grid, lines and arrows, with wgpu.
//!
//! Positions are sent to the graphics device relative to the eye, subtracted in f64, so that a scene far from the
//! origin is drawn as precisely as one near it.

mod arrows;
mod axes;
mod background;
mod blur;
mod device;
mod finish;
mod frame;
mod ground;
mod growing;
mod lines;
mod meshes;
mod normals;
pub mod offscreen;
mod panels;
mod panes;
mod pipeline;
mod shadow;
mod surface;
mod targets;
mod triangles;

pub use device::{device_descriptor, supported_samples};
pub use meshes::Cut;
pub use panels::paint_panels;

use egui_wgpu::wgpu;

use crate::picture::Picture;
use frame::Frame;
use targets::Targets;

/// Draws pictures onto textures of one format.
///
/// A mesh stays on the device as long as every picture shows it.
pub struct Renderer {
    samples: u32,
    targets: Option<Targets>,
    frame: frame::FrameBinding,
    meshes: meshes::Meshes,
    background: background::Background,
    surface: surface::Surface,
    shadow: shadow::Shadow,
    ground: ground::Ground,
    panes: panes::Panes,
    lines: lines::Lines,
    marks: lines::Lines,
    arrows: arrows::Arrows,
    finish: finish::Finish,
}

impl Renderer {
    /// A renderer for targets of a format, sRGB or not, with a number of samples per pixel: 1, or the number from
    /// [`supported_samples`].
    pub fn new(device: &wgpu::Device, target: wgpu::TextureFormat, samples: u32) -> Self {
        let frame = frame::FrameBinding::new(device);
        let shadow = shadow::Shadow::new(device, &frame);
        Self {
            samples,
            targets: None,
            meshes: meshes::Meshes::new(device),
            background: background::Background::new(device, &frame, samples),
            surface: surface::Surface::new(device, &frame, samples),
            ground: ground::Ground::new(device, &frame, &shadow, samples),
            panes: panes::Panes::new(device, &frame, samples),
            lines: lines::Lines::new(device, &frame, samples, false),
            marks: lines::Lines::new(device, &frame, samples, true),
            arrows: arrows::Arrows::new(device, &frame, samples),
            finish: finish::Finish::new(device, target),
            shadow,
            frame,
        }
    }

    /// The meshes of which this device can draw only a part, each once per appearance in the picture.
    pub fn take_cut(&mut self) -> Vec<Cut> {
        self.meshes.take_cut()
    }

    /// Records the commands that draw a picture over the whole of a target of a size in pixels.
    ///
    /// The picture's data is written to the queue at once, so each submission can have only one drawing. At size 0
    /// nothing is drawn. Objects with a position that is not finite are left out.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        target_view: &wgpu::TextureView,
        size: [u32; 2],
        picture: &Picture,
    ) {
        if size.contains(&0) {
            return;
        }
        let frame = Frame::new(&picture.camera, size);
        self.frame.write(queue, &frame);
        let eye = picture.camera.eye();
        let (models, ghosts) = (&picture.models, &picture.ghosts);
        self.meshes
            .gather(device, queue, models, ghosts, picture.wireframe, eye);
        let axis = if picture.grid {
            axes::upright(&picture.camera)
        } else {
            Vec::new()
        };
        self.panes.gather(device, queue, &picture.panes, eye);
        self.lines
            .gather(device, queue, axis.iter().chain(&picture.lines), eye);
        self.marks.gather(device, queue, picture.marks.iter(), eye);
        self.arrows.gather(device, queue, &picture.arrows, eye);

        if picture.grid {
            self.shadow.draw(encoder, &self.frame, &self.meshes);
        }
        let samples = self.samples;
        if self
            .targets
            .as_ref()
            .is_none_or(|targets| targets.size() != size)
        {
            self.targets = Some(Targets::new(device, size, samples, &self.finish));
        }
        let Some(targets) = &self.targets else { return };
        {
            let mut pass = targets.begin(encoder);
            pass.set_bind_group(0, self.frame.group(), &[]);
            self.surface.draw(&mut pass, &self.meshes);
            self.arrows.draw(&mut pass);
            self.background.draw(&mut pass);
            if picture.grid {
                self.ground.draw(&mut pass, &self.shadow);
            }
            self.surface.draw_rims(&mut pass, &self.meshes);
            self.panes.draw(&mut pass);
            self.surface.draw_ghosts(&mut pass, &self.meshes);
            self.lines.draw(&mut pass);
            self.marks.draw(&mut pass);
        }
        self.finish
            .draw(encoder, target_view, targets.finish_group());
    }
}

/// Converts sRGB to linear light; each component is clamped to `0..=1`.
fn linear(colour: [f32; 3]) -> [f32; 3] {
    colour.map(|part| {
        let part = part.clamp(0.0, 1.0);
        if part <= 0.04045 {
            part / 12.92
        } else {
            ((part + 0.055) / 1.055).powf(2.4)
        }
    })
}
