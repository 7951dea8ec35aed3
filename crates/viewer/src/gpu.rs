//! The graphics device behind a window: its surface, and the canvas that paints on it.

use std::sync::Arc;

use anyhow::{Context, Result, anyhow};
use egui_wgpu::wgpu;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use crate::canvas::{Canvas, UiFrame};
use crate::picture::Picture;
use crate::render;

/// The objects that draw into one window.
pub struct Gpu {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    surface_lost: bool,
    config: wgpu::SurfaceConfiguration,
    canvas: Canvas,
}

/// The action after a surface's answer.
#[derive(Debug)]
enum Next {
    /// Paint on the texture.
    Paint(wgpu::SurfaceTexture),
    /// Resize the surface to the window and try again.
    Fit,
    /// Open the window's graphics again: the old surface must be gone first.
    Reopen,
    /// Paint nothing: the window is not visible now.
    Wait,
}

impl Next {
    fn after(answer: wgpu::CurrentSurfaceTexture) -> Self {
        match answer {
            wgpu::CurrentSurfaceTexture::Success(texture)
            | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => Self::Paint(texture),
            wgpu::CurrentSurfaceTexture::Outdated => Self::Fit,
            wgpu::CurrentSurfaceTexture::Lost => Self::Reopen,
            wgpu::CurrentSurfaceTexture::Timeout
            | wgpu::CurrentSurfaceTexture::Occluded
            | wgpu::CurrentSurfaceTexture::Validation => Self::Wait,
        }
    }
}

impl Gpu {
    /// Opens a device that can show pictures in `window`.
    pub fn new(event_loop: &ActiveEventLoop, window: Arc<Window>) -> Result<Self> {
        let display = Box::new(event_loop.owned_display_handle());
        let instance = wgpu::Instance::new(
            wgpu::InstanceDescriptor::new_with_display_handle_from_env(display),
        );
        // The error is a list of drivers, which is empty if there is none.
        let surface =
            instance
                .create_surface(window.clone())
                .map_err(|error| match error.to_string() {
                    text if text.ends_with("{}") => anyhow!("no graphics driver draws in windows"),
                    _ => anyhow::Error::new(error).context("no surface in the window"),
                })?;
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..Default::default()
        }))
        .context("no graphics adapter")?;
        let made = pollster::block_on(adapter.request_device(&render::device_descriptor(&adapter)))
            .context("no graphics device")?;

        let formats = surface.get_capabilities(&adapter).formats;
        let format = egui_wgpu::preferred_framebuffer_format(&formats)?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .context("the graphics adapter cannot show pictures in the window")?;
        config.format = format;
        config.present_mode = wgpu::PresentMode::AutoVsync;
        let mut gpu = Self {
            window,
            surface,
            surface_lost: false,
            config,
            canvas: Canvas::new(made, format, render::supported_samples(&adapter)),
        };
        gpu.configure();
        Ok(gpu)
    }

    /// The texture that holds the picture.
    pub fn picture_id(&self) -> egui::TextureId {
        self.canvas.picture_id()
    }

    /// The largest side of a texture, pixels.
    pub fn max_texture_side(&self) -> usize {
        self.canvas.device().limits().max_texture_dimension_2d as usize
    }

    /// Loses the device on purpose, to test the recovery.
    #[cfg(debug_assertions)]
    pub fn lose(&self) {
        let device = self.canvas.device();
        device.destroy();
        // The device reports the loss when all its work is done.
        let _ = device.poll(wgpu::PollType::wait_indefinitely());
    }

    /// Whether the device or the surface is lost, so that everything must be created again.
    pub fn is_lost(&self) -> bool {
        self.surface_lost || self.canvas.is_lost()
    }

    /// The error since the last call, if there was one.
    pub fn take_error(&mut self) -> Option<String> {
        self.canvas.take_error()
    }

    /// Draws a picture of `size` pixels and the control panel over it. Returns whether the window shows it: a hidden or
    /// minimised window does not.
    pub fn paint(&mut self, picture: &Picture, size: [u32; 2], mut frame: UiFrame) -> bool {
        self.canvas.take_textures(&mut frame);
        let target = self.acquire();
        let shown = target.is_some();
        match target {
            Some(target) => {
                let view = target.texture.create_view(&Default::default());
                let whole = [self.config.width, self.config.height];
                self.canvas.paint(&view, whole, (picture, size), &frame);
                self.window.pre_present_notify();
                self.canvas.queue().present(target);
            }
            None => self.canvas.flush(),
        }
        self.canvas.free_textures(&mut frame);
        shown
    }

    /// The next image of the window, if it accepts one now. Reconfigures the surface if necessary.
    fn acquire(&mut self) -> Option<wgpu::SurfaceTexture> {
        let size: [u32; 2] = self.window.inner_size().into();
        if size.contains(&0) {
            return None;
        }
        if self.canvas.fitting(size) != [self.config.width, self.config.height] {
            self.configure();
        }
        for _ in 0..2 {
            match Next::after(self.surface.get_current_texture()) {
                Next::Paint(texture) => return Some(texture),
                Next::Fit => self.configure(),
                Next::Reopen => {
                    self.surface_lost = true;
                    return None;
                }
                Next::Wait => return None,
            }
        }
        None
    }

    /// Resizes the surface to the window.
    fn configure(&mut self) {
        [self.config.width, self.config.height] =
            self.canvas.fitting(self.window.inner_size().into());
        self.surface.configure(self.canvas.device(), &self.config);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_is_opened_anew_for_a_surface_that_is_lost_and_a_hidden_one_is_waited_for() {
        use wgpu::CurrentSurfaceTexture as Answer;
        assert!(matches!(Next::after(Answer::Lost), Next::Reopen));
        assert!(matches!(Next::after(Answer::Outdated), Next::Fit));
        for answer in [Answer::Occluded, Answer::Timeout, Answer::Validation] {
            assert!(matches!(Next::after(answer), Next::Wait));
        }
    }
}
