//! The graphics device behind a window: its surface, the picture's texture, and the two renderers.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use anyhow::{Context, Result};
use egui_wgpu::wgpu;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use crate::picture::Picture;
use crate::render::{self, Renderer};

/// Format of the picture's texture, the only one that egui shows.
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Everything that draws into one window.
pub struct Gpu {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    ui: egui_wgpu::Renderer,
    scene: Renderer,
    picture_view: wgpu::TextureView,
    picture_size: [u32; 2],
    picture_id: egui::TextureId,
    troubles: Arc<Troubles>,
}

/// What the driver reports at any time, from any thread.
#[derive(Default)]
struct Troubles {
    lost: AtomicBool,
    error: Mutex<Option<String>>,
}

/// One frame of the control panel, ready to be painted.
pub struct UiFrame {
    /// Triangles of the control panel.
    pub primitives: Vec<egui::ClippedPrimitive>,
    /// Textures to change before and to free after painting.
    pub textures: egui::TexturesDelta,
    /// Physical pixels per point.
    pub pixels_per_point: f32,
}

impl Gpu {
    /// Opens a device that can show pictures in `window`.
    pub fn new(event_loop: &ActiveEventLoop, window: Arc<Window>) -> Result<Self> {
        let display = Box::new(event_loop.owned_display_handle());
        let instance = wgpu::Instance::new(
            wgpu::InstanceDescriptor::new_with_display_handle_from_env(display),
        );
        let surface = instance
            .create_surface(window.clone())
            .context("no surface in the window")?;
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..Default::default()
        }))
        .context("no graphics adapter")?;
        let (device, queue) =
            pollster::block_on(adapter.request_device(&render::device_descriptor(&adapter)))
                .context("no graphics device")?;
        let troubles = Arc::new(Troubles::default());
        troubles.listen(&device);

        let formats = surface.get_capabilities(&adapter).formats;
        let format = egui_wgpu::preferred_framebuffer_format(&formats)?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .context("the graphics adapter cannot show pictures in the window")?;
        config.format = format;
        config.present_mode = wgpu::PresentMode::AutoVsync;

        let mut ui = egui_wgpu::Renderer::new(&device, format, Default::default());
        let scene = Renderer::new(&device, PICTURE, render::supported_samples(&adapter));
        let picture_view = picture_texture(&device, [1, 1]);
        let picture_id =
            ui.register_native_texture(&device, &picture_view, wgpu::FilterMode::Linear);
        let mut gpu = Self {
            window,
            instance,
            surface,
            config,
            device,
            queue,
            ui,
            scene,
            picture_view,
            picture_size: [1, 1],
            picture_id,
            troubles,
        };
        gpu.configure();
        Ok(gpu)
    }

    /// The texture that holds the picture.
    pub fn picture_id(&self) -> egui::TextureId {
        self.picture_id
    }

    /// The largest side of a texture, pixels.
    pub fn max_texture_side(&self) -> usize {
        self.device.limits().max_texture_dimension_2d as usize
    }

    /// Whether the device is gone, so that everything must be made anew.
    pub fn is_lost(&self) -> bool {
        self.troubles.lost.load(Ordering::Relaxed)
    }

    /// What went wrong since this was last asked.
    pub fn take_error(&self) -> Option<String> {
        self.troubles.error.lock().ok()?.take()
    }

    /// Draws a picture of `size` pixels and the control panel over it. Whether it came to the
    /// window: a hidden or minimised window takes no pictures.
    pub fn paint(&mut self, picture: &Picture, size: [u32; 2], mut frame: UiFrame) -> bool {
        // egui sends each texture once, so these are taken in even if nothing can be shown.
        for (id, deltas) in frame.textures.set.drain() {
            for delta in &deltas {
                self.ui.update_texture(&self.device, &self.queue, id, delta);
            }
        }
        let shown = self.paint_surface(picture, size, &frame);
        for id in frame.textures.free.drain() {
            self.ui.free_texture(&id);
        }
        shown
    }

    fn paint_surface(&mut self, picture: &Picture, size: [u32; 2], frame: &UiFrame) -> bool {
        let Some(target) = self.acquire() else {
            // Hands over the texture writes, which would pile up otherwise.
            self.queue.submit([]);
            return false;
        };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.fit_picture(size);
        self.scene.draw(
            &self.device,
            &self.queue,
            &mut encoder,
            &self.picture_view,
            self.picture_size,
            picture,
        );
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [self.config.width, self.config.height],
            pixels_per_point: frame.pixels_per_point,
        };
        let mut commands = self.ui.update_buffers(
            &self.device,
            &self.queue,
            &mut encoder,
            &frame.primitives,
            &screen,
        );
        let view = target.texture.create_view(&Default::default());
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("control panel"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                    depth_slice: None,
                })],
                ..Default::default()
            })
            .forget_lifetime();
        self.ui.render(&mut pass, &frame.primitives, &screen);
        drop(pass);
        commands.push(encoder.finish());
        self.queue.submit(commands);
        self.window.pre_present_notify();
        self.queue.present(target);
        true
    }

    /// The window's next image, if it takes one now. The surface is put right as needed.
    fn acquire(&mut self) -> Option<wgpu::SurfaceTexture> {
        let size = self.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return None;
        }
        if self.fitting(size.into()) != [self.config.width, self.config.height] {
            self.configure();
        }
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                wgpu::CurrentSurfaceTexture::Success(texture)
                | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => return Some(texture),
                wgpu::CurrentSurfaceTexture::Outdated => self.configure(),
                wgpu::CurrentSurfaceTexture::Lost => {
                    if let Ok(surface) = self.instance.create_surface(self.window.clone()) {
                        self.surface = surface;
                    }
                    self.configure();
                }
                wgpu::CurrentSurfaceTexture::Timeout
                | wgpu::CurrentSurfaceTexture::Occluded
                | wgpu::CurrentSurfaceTexture::Validation => return None,
            }
        }
        None
    }

    /// Fits the surface to the window.
    fn configure(&mut self) {
        [self.config.width, self.config.height] = self.fitting(self.window.inner_size().into());
        self.surface.configure(&self.device, &self.config);
    }

    /// Fits the picture's texture to its place in the window.
    fn fit_picture(&mut self, size: [u32; 2]) {
        let size = self.fitting(size);
        if size == self.picture_size {
            return;
        }
        self.picture_view = picture_texture(&self.device, size);
        self.picture_size = size;
        self.ui.update_egui_texture_from_wgpu_texture(
            &self.device,
            &self.picture_view,
            wgpu::FilterMode::Linear,
            self.picture_id,
        );
    }

    /// The nearest size that a texture can have.
    fn fitting(&self, size: [u32; 2]) -> [u32; 2] {
        let most = self.device.limits().max_texture_dimension_2d;
        size.map(|side| side.clamp(1, most))
    }
}

impl Troubles {
    fn listen(self: &Arc<Self>, device: &wgpu::Device) {
        let troubles = self.clone();
        device.set_device_lost_callback(move |_, _| troubles.lost.store(true, Ordering::Relaxed));
        let troubles = self.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut slot) = troubles.error.lock() {
                *slot = Some(error.to_string());
            }
        }));
    }
}

fn picture_texture(device: &wgpu::Device, [width, height]: [u32; 2]) -> wgpu::TextureView {
    device
        .create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: PICTURE,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
        .create_view(&Default::default())
}
