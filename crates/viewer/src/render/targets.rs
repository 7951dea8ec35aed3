//! The textures of one size into which a picture is drawn before it is copied to its target.

use egui_wgpu::wgpu;

use super::finish::Finish;

/// Shaders read and write linear light; the texture stores sRGB.
pub(super) const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// A float format, for reversed depth.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

pub(super) struct Targets {
    size: [u32; 2],
    /// The multisampled texture, if there are several samples per pixel.
    multisampled: Option<wgpu::TextureView>,
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    finish_group: wgpu::BindGroup,
}

impl Targets {
    pub(super) fn new(
        device: &wgpu::Device,
        size: [u32; 2],
        samples: u32,
        finish: &Finish,
    ) -> Self {
        let view = |label, format, sample_count, usage| {
            device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some(label),
                    size: wgpu::Extent3d {
                        width: size[0],
                        height: size[1],
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage,
                    view_formats: &[],
                })
                .create_view(&Default::default())
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let colour = view(
            "colour",
            COLOUR,
            1,
            attachment | wgpu::TextureUsages::TEXTURE_BINDING,
        );
        Self {
            size,
            multisampled: (samples > 1).then(|| view("samples", COLOUR, samples, attachment)),
            depth: view("depth", DEPTH, samples, attachment),
            finish_group: finish.group(device, &colour),
            colour,
        }
    }

    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    pub(super) fn finish_group(&self) -> &wgpu::BindGroup {
        &self.finish_group
    }

    pub(super) fn begin<'a>(
        &'a self,
        encoder: &'a mut wgpu::CommandEncoder,
    ) -> wgpu::RenderPass<'a> {
        let (view, resolve_target, store) = match &self.multisampled {
            Some(samples) => (samples, Some(&self.colour), wgpu::StoreOp::Discard),
            None => (&self.colour, None, wgpu::StoreOp::Store),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }
}
