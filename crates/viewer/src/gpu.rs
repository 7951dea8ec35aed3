//! The graphics device behind a window: its surface, and the canvas that paints on it.

use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;

use anyhow::{Context, Result, anyhow, bail};
use egui_wgpu::wgpu;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use crate::canvas::{Canvas, UiFrame};
use crate::picture::Picture;
use crate::render;
use crate::reopening::Loss;

/// How many frames in a row may fail because the surface does not fit the window, before it counts as lost.
const MISFITS: u32 = 10;

/// The objects that draw into one window.
pub struct Gpu {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    surface_lost: bool,
    /// Frames in a row that failed because the surface did not fit the window.
    misfits: u32,
    config: wgpu::SurfaceConfiguration,
    canvas: Canvas,
}

/// What the window shows after a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The frame.
    Frame,
    /// Nothing: the window is hidden or minimised, or its graphics are lost.
    Nothing,
    /// An older frame: this one must be painted again.
    Older,
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
            misfits: 0,
            config,
            canvas: Canvas::new(made, format, render::supported_samples(&adapter)),
        };
        gpu.configure();
        match gpu.loss() {
            None => Ok(gpu),
            Some(loss) => bail!(loss),
        }
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

    /// The reason why everything must be created again, if there is one.
    pub fn loss(&self) -> Option<Loss> {
        let of_surface = self.surface_lost.then_some(Loss::Surface);
        self.canvas.loss().or(of_surface)
    }

    /// The error since the last call, if there was one.
    pub fn take_error(&mut self) -> Option<String> {
        self.canvas.take_error()
    }

    /// Draws a picture of `size` pixels and the control panel over it.
    pub fn paint(&mut self, picture: &Picture, size: [u32; 2], mut frame: UiFrame) -> Shown {
        self.canvas.take_textures(&mut frame);
        let target = self.acquire();
        match target {
            Ok(target) => {
                let view = target.texture.create_view(&Default::default());
                let whole = [self.config.width, self.config.height];
                self.canvas.paint(&view, whole, (picture, size), &frame);
                drop(view);
                if self.loss().is_some() {
                    release(target);
                    return Shown::Nothing;
                }
                self.window.pre_present_notify();
                self.canvas.queue().present(target);
                self.canvas.free_textures(&mut frame);
                Shown::Frame
            }
            Err(shown) => {
                self.canvas.flush();
                self.canvas.free_textures(&mut frame);
                shown
            }
        }
    }

    /// The next image of the window, or what it shows without one. Reconfigures the surface if necessary.
    fn acquire(&mut self) -> Result<wgpu::SurfaceTexture, Shown> {
        let size: [u32; 2] = self.window.inner_size().into();
        if size.contains(&0) {
            return Err(Shown::Nothing);
        }
        if self.canvas.fitting(size) != [self.config.width, self.config.height] {
            self.configure();
        }
        for _ in 0..2 {
            // wgpu panics if a surface is asked for an image that it has never been configured for.
            if self.loss().is_some() {
                return Err(Shown::Nothing);
            }
            match Next::after(self.surface.get_current_texture()) {
                Next::Paint(texture) => {
                    self.misfits = 0;
                    return Ok(texture);
                }
                Next::Fit => self.configure(),
                Next::Reopen => {
                    self.surface_lost = true;
                    return Err(Shown::Nothing);
                }
                Next::Wait => return Err(Shown::Nothing),
            }
        }
        self.misfits += 1;
        self.surface_lost |= self.misfits >= MISFITS;
        Err(Shown::Older)
    }

    /// Resizes the surface to the window. A surface that refuses this is lost.
    fn configure(&mut self) {
        [self.config.width, self.config.height] =
            self.canvas.fitting(self.window.inner_size().into());
        let device = self.canvas.device();
        let refused = device.push_error_scope(wgpu::ErrorFilter::Validation);
        self.surface.configure(device, &self.config);
        self.surface_lost |= pollster::block_on(refused.pop()).is_some();
    }
}

/// Gives back an image of a surface whose graphics are lost. wgpu gives it back only during a panic if the device is lost;
/// without that it panics when the surface is dropped (gfx-rs/wgpu issue 9277).
fn release(image: wgpu::SurfaceTexture) {
    let released = panic::catch_unwind(AssertUnwindSafe(|| {
        let _image = image;
        panic::resume_unwind(Box::new(()));
    }));
    debug_assert!(released.is_err());
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
