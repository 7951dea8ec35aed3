//! Soft shadows straight down onto the ground. They show above which place a body is.

use egui_wgpu::wgpu;

use super::blur::Blur;
use super::frame::FrameBinding;
use super::meshes::{self, Meshes, Which};
use super::pipeline::shader;

/// Texels along a side, as drawn and after blurring.
const SIZE: u32 = 512;
const BLURRED_SIZE: u32 = 256;
pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

pub(super) struct Shadow {
    pipeline: wgpu::RenderPipeline,
    blur: Blur,
    map: wgpu::TextureView,
    map_group: wgpu::BindGroup,
    blurred: wgpu::TextureView,
    blurred_group: wgpu::BindGroup,
    layout: wgpu::BindGroupLayout,
}

impl Shadow {
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding) -> Self {
        let map = texture(device, SIZE);
        let blurred = texture(device, BLURRED_SIZE);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let visibility = wgpu::ShaderStages::FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("shadow"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let group = |map: &wgpu::TextureView| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("shadow"),
                layout: &layout,
                entries: &[
                    wgpu::BindGroupEntry {
                        binding: 0,
                        resource: wgpu::BindingResource::TextureView(map),
                    },
                    wgpu::BindGroupEntry {
                        binding: 1,
                        resource: wgpu::BindingResource::Sampler(&sampler),
                    },
                ],
            })
        };
        Self {
            pipeline: pipeline(device, frame),
            blur: Blur::new(device, &layout),
            map_group: group(&map),
            map,
            blurred_group: group(&blurred),
            blurred,
            layout,
        }
    }

    /// Draws the collected meshes into the map.
    pub(super) fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &FrameBinding,
        meshes: &Meshes,
    ) {
        {
            let mut pass = begin(encoder, &self.map);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, frame.group(), &[]);
            for which in Which::OPAQUE {
                meshes.draw(&mut pass, which);
            }
        }
        let mut pass = begin(encoder, &self.blurred);
        // Without meshes the cleared texture is correct.
        if !meshes.is_empty() {
            self.blur.draw(&mut pass, &self.map_group);
        }
    }

    /// The layout for pipelines that receive the shadow.
    pub(super) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    pub(super) fn group(&self) -> &wgpu::BindGroup {
        &self.blurred_group
    }
}

fn texture(device: &wgpu::Device, size: u32) -> wgpu::TextureView {
    device
        .create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow"),
            size: wgpu::Extent3d {
                width: size,
                height: size,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
        .create_view(&Default::default())
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    view: &wgpu::TextureView,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("shadow"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    })
}

fn pipeline(device: &wgpu::Device, frame: &FrameBinding) -> wgpu::RenderPipeline {
    let wgsl = concat!(
        include_str!("shaders/frame.wgsl"),
        include_str!("shaders/shadow.wgsl")
    );
    let module = shader(device, "shadow", wgsl);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("shadow"),
        bind_group_layouts: &[Some(frame.layout())],
        immediate_size: 0,
    });
    // The body nearest to the ground determines the shadow, in any order of drawing.
    let darkest = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Max,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("shadow"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs_main"),
            compilation_options: Default::default(),
            buffers: &meshes::layouts(),
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fs_main"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: FORMAT,
                blend: Some(wgpu::BlendState {
                    color: darkest,
                    alpha: darkest,
                }),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
