//! Draws pictures into memory, without window or display.

use std::fmt;

use egui_wgpu::wgpu;
use image::RgbaImage;

use super::{Cut, Renderer, device_descriptor, paint_panels, supported_samples};
use crate::picture::Picture;

/// Bytes per pixel.
const PIXEL: u32 = 4;

/// The reason why there is no picture.
#[derive(Debug)]
pub enum ShotError {
    /// The computer has no graphics adapter.
    NoAdapter,
    /// The adapter provides no device.
    Device(wgpu::RequestDeviceError),
    /// The size is 0, or exceeds the device's largest texture.
    Size {
        /// The requested size, pixels.
        size: [u32; 2],
        /// The largest side of a picture on this device, pixels.
        most: u32,
    },
    /// The device failed while drawing, probably from lack of memory.
    Drawing(String),
}

impl fmt::Display for ShotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter => f.write_str(
                "no graphics adapter: install a Vulkan driver (on Debian `mesa-vulkan-drivers` draws in \
                 software), or use `run` or `check`, which need none",
            ),
            Self::Device(error) => write!(f, "the graphics adapter gives no device: {error}"),
            Self::Size { size: [width, height], most } => write!(
                f,
                "cannot draw {width} x {height} pixels: both must be from 1 to {most} on this graphics adapter"
            ),
            Self::Drawing(error) => write!(
                f,
                "the graphics adapter failed to draw, try a smaller picture: {error}"
            ),
        }
    }
}

impl std::error::Error for ShotError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Device(error) => Some(error),
            _ => None,
        }
    }
}

/// A device with a renderer that needs no display.
pub struct Offscreen {
    device: wgpu::Device,
    queue: wgpu::Queue,
    format: wgpu::TextureFormat,
    renderer: Renderer,
}

impl Offscreen {
    /// A device on the fastest adapter, or on a software adapter if there is no other.
    pub fn new() -> Result<Self, ShotError> {
        Self::with_format(wgpu::TextureFormat::Rgba8UnormSrgb)
    }

    fn with_format(format: wgpu::TextureFormat) -> Result<Self, ShotError> {
        Self::made(format, |limits| limits)
    }

    fn made(
        format: wgpu::TextureFormat,
        limited: impl FnOnce(wgpu::Limits) -> wgpu::Limits,
    ) -> Result<Self, ShotError> {
        let adapter = adapter().ok_or(ShotError::NoAdapter)?;
        let mut descriptor = device_descriptor(&adapter);
        descriptor.required_limits = limited(descriptor.required_limits);
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(ShotError::Device)?;
        let renderer = Renderer::new(&device, format, supported_samples(&adapter));
        Ok(Self {
            device,
            queue,
            format,
            renderer,
        })
    }

    /// A device with other limits.
    #[cfg(test)]
    pub(crate) fn limited(
        limited: impl FnOnce(wgpu::Limits) -> wgpu::Limits,
    ) -> Result<Self, ShotError> {
        Self::made(wgpu::TextureFormat::Rgba8UnormSrgb, limited)
    }

    /// The meshes of which this device can draw only a part, each once per appearance in the picture.
    pub fn take_cut(&mut self) -> Vec<Cut> {
        self.renderer.take_cut()
    }

    /// Draws one picture of a size in pixels.
    pub fn shot(&mut self, picture: &Picture, size: [u32; 2]) -> Result<RgbaImage, ShotError> {
        let (device, queue, renderer) = (&self.device, &self.queue, &mut self.renderer);
        let target = Target {
            device,
            queue,
            format: self.format,
        };
        target.taken(size, |encoder, view| {
            renderer.draw(device, queue, encoder, view, size, picture);
        })
    }
}

/// Draws a part of the control panel, laid out by `contents` in the style of a context, with two pixels per point.
pub fn panel(
    context: &egui::Context,
    size: [u32; 2],
    mut contents: impl FnMut(&mut egui::Ui),
) -> Result<RgbaImage, ShotError> {
    // The format in which egui blends colours.
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let Offscreen { device, queue, .. } = Offscreen::with_format(format)?;
    let pixels_per_point = 2.0;
    let [width, height] = size.map(|side| side as f32 / pixels_per_point);
    let mut painter = egui_wgpu::Renderer::new(&device, format, Default::default());
    let mut primitives = Vec::new();
    // The first layout measures sizes that the second one uses.
    for _ in 0..2 {
        let mut input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(
                egui::Pos2::ZERO,
                egui::vec2(width, height),
            )),
            ..Default::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&input.viewport_id) {
            viewport.native_pixels_per_point = Some(pixels_per_point);
        }
        let mut output = context.run_ui(input, |root| {
            egui::CentralPanel::default().show(root, &mut contents);
        });
        for (id, deltas) in output.textures_delta.set.drain() {
            for delta in &deltas {
                painter.update_texture(&device, &queue, id, delta);
            }
        }
        primitives = context.tessellate(output.shapes, output.pixels_per_point);
    }
    let screen = egui_wgpu::ScreenDescriptor {
        size_in_pixels: size,
        pixels_per_point,
    };
    let target = Target {
        device: &device,
        queue: &queue,
        format,
    };
    target.taken(size, |encoder, view| {
        let parts = (&device, &queue);
        let before = paint_panels(&mut painter, parts, (encoder, view), &primitives, &screen);
        queue.submit(before);
    })
}

/// A target for a picture that is then read back.
struct Target<'a> {
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    format: wgpu::TextureFormat,
}

impl Target<'_> {
    /// Draws with `draw` on a texture of a size in pixels, and reads the result.
    fn taken(
        &self,
        size: [u32; 2],
        draw: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::TextureView),
    ) -> Result<RgbaImage, ShotError> {
        let [width, height] = size;
        let most = self.device.limits().max_texture_dimension_2d;
        if size.contains(&0) || width.max(height) > most {
            return Err(ShotError::Size { size, most });
        }
        let padded_row = (width * PIXEL).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(padded_row) * u64::from(height);

        // Without error scopes a failure would end the program.
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let readback = self.draw(draw, size, padded_row, bytes);
        for scope in [internal, validation, memory] {
            if let Some(error) = pollster::block_on(scope.pop()) {
                return Err(ShotError::Drawing(error.to_string()));
            }
        }

        let failed = |error: &dyn fmt::Display| ShotError::Drawing(error.to_string());
        let slice = readback.slice(..);
        let (sender, receiver) = std::sync::mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |mapped| {
            // A failed send means that the receiver is gone; then nobody needs the result.
            let _ = sender.send(mapped);
        });
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| failed(&error))?;
        receiver
            .recv()
            .map_err(|error| failed(&error))?
            .map_err(|error| failed(&error))?;
        let mapped = slice.get_mapped_range().map_err(|error| failed(&error))?;
        let mut pixels = Vec::with_capacity((width * PIXEL) as usize * height as usize);
        for row in mapped.chunks_exact(padded_row as usize) {
            pixels.extend_from_slice(&row[..(width * PIXEL) as usize]);
        }
        RgbaImage::from_raw(width, height, pixels)
            .ok_or_else(|| ShotError::Drawing("too few pixels came back".to_owned()))
    }

    /// Draws, and copies the rows into a readable buffer.
    fn draw(
        &self,
        draw: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::TextureView),
        [width, height]: [u32; 2],
        padded_row: u32,
        bytes: u64,
    ) -> wgpu::Buffer {
        let extent = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shot"),
            size: extent,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let readback = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shot"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let view = texture.create_view(&Default::default());
        draw(&mut encoder, &view);
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &readback,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row),
                    rows_per_image: None,
                },
            },
            extent,
        );
        self.queue.submit([encoder.finish()]);
        readback
    }
}

/// An adapter of the backends in the environment, else of the platform's own backends, and last of OpenGL.
pub fn adapter() -> Option<wgpu::Adapter> {
    let choices = match wgpu::Backends::from_env() {
        Some(backends) => vec![backends],
        None => vec![wgpu::Backends::PRIMARY, wgpu::Backends::GL],
    };
    choices.into_iter().find_map(|backends| {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
        });
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        pollster::block_on(instance.request_adapter(&options)).ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_with_and_without_srgb_get_the_same_bytes() -> Result<(), ShotError> {
        let picture = Picture {
            grid: true,
            ..Picture::default()
        };
        let [encoded, plain] = [
            wgpu::TextureFormat::Rgba8UnormSrgb,
            wgpu::TextureFormat::Rgba8Unorm,
        ]
        .map(|format| Offscreen::with_format(format)?.shot(&picture, [90, 60]));
        if let Err(ShotError::NoAdapter) = encoded {
            assert!(std::env::var_os("CI").is_none(), "{}", ShotError::NoAdapter);
            println!("skipped: {}", ShotError::NoAdapter);
            return Ok(());
        }
        for (encoded, plain) in encoded?.iter().zip(plain?.iter()) {
            assert!(encoded.abs_diff(*plain) <= 1);
        }
        Ok(())
    }
}
