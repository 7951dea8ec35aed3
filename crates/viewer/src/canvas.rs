//! Draws a frame of the window onto any texture: the picture, and the control panel around it.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, Once};

use egui_wgpu::wgpu;

use crate::picture::Picture;
use crate::render::{self, Renderer};
use crate::reopening::Loss;

/// Format of the picture's texture, the only one that egui can show.
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The notice while the picture is left out.
pub const NO_MEMORY: &str = "The graphics adapter has no memory left, and the picture is left out for some seconds: make the \
                             window smaller, show fewer or coarser meshes, or end other programs. Edits are kept.";

/// A device with the two renderers, and the picture's texture.
pub struct Canvas {
    device: wgpu::Device,
    queue: wgpu::Queue,
    ui: egui_wgpu::Renderer,
    scene: Renderer,
    picture_view: wgpu::TextureView,
    picture_size: [u32; 2],
    picture_id: egui::TextureId,
    troubles: Arc<Troubles>,
}

/// The errors that the driver reports at any time, from any thread.
#[derive(Default)]
struct Troubles {
    lost: AtomicBool,
    /// Memory was short, so that objects are missing for good.
    short: AtomicBool,
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

impl Canvas {
    /// A canvas that paints on textures of a format; the picture has a number of samples per pixel.
    pub fn new(
        (device, queue): (wgpu::Device, wgpu::Queue),
        format: wgpu::TextureFormat,
        samples: u32,
    ) -> Self {
        let troubles = Arc::new(Troubles::default());
        troubles.listen(&device);
        let mut ui = egui_wgpu::Renderer::new(&device, format, Default::default());
        let scene = Renderer::new(&device, PICTURE, samples);
        let picture_view = texture(&device, [1, 1], PICTURE);
        let picture_id =
            ui.register_native_texture(&device, &picture_view, wgpu::FilterMode::Linear);
        Self {
            device,
            queue,
            ui,
            scene,
            picture_view,
            picture_size: [1, 1],
            picture_id,
            troubles,
        }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The device's queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The texture that holds the picture.
    pub fn picture_id(&self) -> egui::TextureId {
        self.picture_id
    }

    /// The reason why everything must be created again, if there is one.
    pub fn loss(&self) -> Option<Loss> {
        if self.troubles.short.load(Ordering::Relaxed) {
            Some(Loss::Memory)
        } else {
            let lost = self.troubles.lost.load(Ordering::Relaxed);
            lost.then_some(Loss::Device)
        }
    }

    /// The error since the last call, if there was one.
    pub fn take_error(&mut self) -> Option<String> {
        let cut = self.scene.take_cut();
        let of_driver = self
            .troubles
            .error
            .lock()
            .ok()
            .and_then(|mut slot| slot.take());
        of_driver.or_else(|| {
            Some(format!(
                "The graphics adapter {}. All of them collide.",
                cut.last()?.told("a mesh")
            ))
        })
    }

    /// Uploads textures of the control panel. egui sends each once, so every one must be uploaded, even if nothing can
    /// be shown.
    pub fn take_textures(&mut self, frame: &mut UiFrame) {
        for (id, deltas) in frame.textures.set.drain() {
            for delta in &deltas {
                self.ui.update_texture(&self.device, &self.queue, id, delta);
            }
        }
    }

    /// Frees the textures that no later frame uses.
    pub fn free_textures(&mut self, frame: &mut UiFrame) {
        for id in frame.textures.free.drain() {
            self.ui.free_texture(&id);
        }
    }

    /// Submits the queued writes of textures, which would otherwise accumulate while nothing is painted.
    pub fn flush(&self) {
        self.queue.submit([]);
    }

    /// Paints a picture of `size` pixels and the control panel over it on a texture of `whole` pixels. Nothing is painted
    /// if the device is lost or its memory is short on the way.
    pub fn paint(
        &mut self,
        view: &wgpu::TextureView,
        whole: [u32; 2],
        (picture, size): (&Picture, [u32; 2]),
        frame: &UiFrame,
    ) {
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
        if self.loss().is_some() {
            return;
        }
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: whole,
            pixels_per_point: frame.pixels_per_point,
        };
        let painted = quietly(|| {
            render::paint_panels(
                &mut self.ui,
                (&self.device, &self.queue),
                (&mut encoder, view),
                &frame.primitives,
                &screen,
            )
        });
        if self.loss().is_some() {
            return;
        }
        let mut commands = painted.unwrap_or_else(|fault| panic!("no panels: {fault}"));
        commands.push(encoder.finish());
        self.queue.submit(commands);
    }

    /// The nearest size that a texture can have.
    pub fn fitting(&self, size: [u32; 2]) -> [u32; 2] {
        let most = self.device.limits().max_texture_dimension_2d;
        size.map(|side| side.clamp(1, most))
    }

    /// Resizes the picture's texture to its area in the window.
    fn fit_picture(&mut self, size: [u32; 2]) {
        let size = self.fitting(size);
        if size == self.picture_size {
            return;
        }
        self.picture_view = texture(&self.device, size, PICTURE);
        self.picture_size = size;
        self.ui.update_egui_texture_from_wgpu_texture(
            &self.device,
            &self.picture_view,
            wgpu::FilterMode::Linear,
            self.picture_id,
        );
    }
}

/// Whether an error is about a lack of memory, by the words of wgpu.
pub fn is_short(error: &str) -> bool {
    error.to_lowercase().contains("memory")
}

/// Calls a function that may panic, without its message on the standard error. egui panics if the device is lost or has
/// no memory while its data is written.
fn quietly<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    thread_local!(static IS_QUIET: Cell<bool> = const { Cell::new(false) });
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let hook = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if !IS_QUIET.get() {
                hook(panic);
            }
        }));
    });
    IS_QUIET.set(true);
    let done = panic::catch_unwind(AssertUnwindSafe(work));
    IS_QUIET.set(false);
    done.map_err(|fault| {
        let text = fault.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| fault.downcast_ref::<&str>().copied());
        text.unwrap_or("egui has panicked").to_owned()
    })
}

/// Combines the reported error with another one. After a lack of memory, further errors follow from missing objects.
fn after(told: Option<String>, error: &wgpu::Error) -> String {
    match (told, error) {
        (_, wgpu::Error::OutOfMemory { .. }) => NO_MEMORY.to_owned(),
        (Some(told), _) if told == NO_MEMORY => told,
        (_, error) => error.to_string(),
    }
}

impl Troubles {
    fn listen(self: &Arc<Self>, device: &wgpu::Device) {
        let troubles = self.clone();
        device.set_device_lost_callback(move |_, reason| {
            // wgpu also gives up a device that has no memory for its own work.
            if is_short(&reason) {
                troubles.short.store(true, Ordering::Relaxed);
            }
            troubles.lost.store(true, Ordering::Relaxed);
        });
        let troubles = self.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let wgpu::Error::OutOfMemory { .. } = error {
                troubles.short.store(true, Ordering::Relaxed);
            }
            if let Ok(mut slot) = troubles.error.lock() {
                *slot = Some(after(slot.take(), &error));
            }
        }));
    }
}

fn texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
) -> wgpu::TextureView {
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
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
        .create_view(&Default::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Model;
    use crate::render::offscreen;
    use crate::words::Language;
    use glam::{DQuat, DVec3};

    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// A canvas without a window, if there is an adapter.
    fn canvas() -> Option<Canvas> {
        canvas_of(|limits| limits)
    }

    /// A canvas on a device with other limits.
    fn canvas_of(limited: impl Fn(wgpu::Limits) -> wgpu::Limits) -> Option<Canvas> {
        let Some(adapter) = offscreen::adapter() else {
            assert!(std::env::var_os("CI").is_none(), "no graphics adapter");
            println!("skipped: no graphics adapter");
            return None;
        };
        let mut descriptor = render::device_descriptor(&adapter);
        descriptor.required_limits = limited(descriptor.required_limits);
        let made = pollster::block_on(adapter.request_device(&descriptor));
        let samples = render::supported_samples(&adapter);
        Some(Canvas::new(made.expect("a device"), FORMAT, samples))
    }

    fn model(mesh: &Arc<sim_core::Mesh>, selected: bool) -> Model {
        Model {
            mesh: mesh.clone(),
            position: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            colour: [0.5; 3],
            selected,
        }
    }

    fn frame() -> UiFrame {
        UiFrame {
            primitives: Vec::new(),
            textures: egui::TexturesDelta::default(),
            pixels_per_point: 1.0,
        }
    }

    #[test]
    fn a_place_of_no_size_and_one_beyond_the_device_are_painted() {
        let Some(mut canvas) = canvas() else { return };
        let view = texture(canvas.device(), [64, 48], FORMAT);
        let picture = Picture {
            grid: true,
            ..Picture::default()
        };
        for size in [[0, 0], [0, 48], [64, 48], [1, 1], [u32::MAX, 1], [0, 0]] {
            canvas.paint(&view, [64, 48], (&picture, size), &frame());
            assert_eq!(canvas.take_error(), None, "{size:?}");
        }
        assert!(canvas.loss().is_none());
    }

    /// A part of a mesh is drawn, and the cut is reported.
    #[test]
    fn a_mesh_beyond_the_buffers_of_the_device_is_drawn_in_part_and_told_once() {
        // The vertices of the cow, 24 bytes each, exceed this limit.
        let limited = |limits| wgpu::Limits {
            max_buffer_size: 1 << 16,
            ..limits
        };
        let Some(mut canvas) = canvas_of(limited) else {
            return;
        };
        let view = texture(canvas.device(), [64, 48], FORMAT);
        let mesh = scene::MeshRef::builtin("cow.obj").expect("built in");
        for (selected, least) in [(false, 1000), (true, 900)] {
            let picture = Picture {
                models: vec![model(mesh.mesh(), selected)],
                ..Picture::default()
            };
            canvas.paint(&view, [64, 48], (&picture, [64, 48]), &frame());
            let told = canvas.take_error().expect("it is told");
            let drawn = told.split_whitespace().nth(6).expect("a number");
            let drawn: usize = drawn.replace(',', "").parse().expect("a number");
            assert!((least..6000).contains(&drawn), "{told}");
            assert!(told.contains("of the 6,000 triangles"), "{told}");
            assert!(Language::Chinese.translated(&told).is_some(), "{told}");
            canvas.paint(&view, [64, 48], (&picture, [64, 48]), &frame());
            assert_eq!(canvas.take_error(), None, "once");
        }
        assert!(canvas.loss().is_none());
    }

    #[test]
    fn want_of_memory_is_told_with_a_remedy_and_before_what_comes_of_it() {
        let no_memory = wgpu::Error::OutOfMemory {
            source: "out of memory".into(),
        };
        let invalid = wgpu::Error::Validation {
            source: "invalid".into(),
            description: "the buffer is invalid".to_owned(),
        };
        let other = after(None, &invalid);
        assert!(other.contains("the buffer is invalid"), "{other}");
        let told = after(Some(other), &no_memory);
        assert_eq!(told, NO_MEMORY);
        assert!(Language::Chinese.translated(&told).is_some(), "{told}");
        assert_eq!(after(Some(told), &invalid), NO_MEMORY);
    }

    #[test]
    fn a_device_without_memory_must_be_opened_anew_also_if_wgpu_has_given_it_up() {
        for (reason, loss) in [
            ("Out of memory", Loss::Memory),
            ("Device is lost", Loss::Device),
        ] {
            let short = is_short(reason);
            assert_eq!(short, loss == Loss::Memory, "{reason}");
        }
        let Some(canvas) = canvas() else { return };
        assert_eq!(canvas.loss(), None);
        canvas.troubles.lost.store(true, Ordering::Relaxed);
        assert_eq!(canvas.loss(), Some(Loss::Device));
        canvas.troubles.short.store(true, Ordering::Relaxed);
        assert_eq!(canvas.loss(), Some(Loss::Memory));
    }

    #[test]
    fn a_panic_in_egui_is_caught_with_its_text() {
        assert_eq!(quietly(|| 1), Ok(1));
        let fault = quietly(|| panic!("no buffer of {} bytes", 8));
        assert_eq!(fault, Err("no buffer of 8 bytes".to_owned()));
    }

    #[test]
    fn a_lost_device_is_noticed_and_painting_on_does_no_harm() {
        let Some(mut canvas) = canvas() else { return };
        let view = texture(canvas.device(), [64, 48], FORMAT);
        canvas.paint(&view, [64, 48], (&Picture::default(), [64, 48]), &frame());
        assert!(canvas.loss().is_none());
        canvas.device().destroy();
        // The device reports the loss when all its work is done.
        let _ = canvas.device().poll(wgpu::PollType::wait_indefinitely());
        assert_eq!(canvas.loss(), Some(Loss::Device));
        // The picture also has a mesh that the canvas has not seen yet.
        let mesh = scene::MeshRef::builtin("cube.obj").expect("built in");
        let picture = Picture {
            models: vec![model(mesh.mesh(), true)],
            ..Picture::default()
        };
        // egui panics where it cannot write the triangles of its panels.
        let mut panels = frame();
        let mut mesh = egui::Mesh::default();
        mesh.add_colored_rect(egui::Rect::EVERYTHING, egui::Color32::WHITE);
        panels.primitives.push(egui::ClippedPrimitive {
            clip_rect: egui::Rect::EVERYTHING,
            primitive: egui::epaint::Primitive::Mesh(mesh),
        });
        canvas.paint(&view, [64, 48], (&picture, [32, 32]), &panels);
        canvas.flush();
        // Another canvas replaces it.
        let Some(mut canvas) = self::canvas() else {
            return;
        };
        let view = texture(canvas.device(), [64, 48], FORMAT);
        canvas.paint(&view, [64, 48], (&Picture::default(), [64, 48]), &frame());
        assert_eq!((canvas.loss(), canvas.take_error()), (None, None));
    }
}
