//! CPU time of a frame of the window, part by part, with 1,000 bodies and some 100,000 triangles: what the
//! thread of the window spends, apart from the steps and from the rasteriser, which have threads of their own.
//!
//! `cargo run --release -p viewer --example frame_cost` prints it, and fails above 4 ms.

use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use egui_wgpu::wgpu;
use scene::Scene;
use viewer::canvas::{Canvas, UiFrame};
use viewer::render;
use viewer::session::Session;
use viewer::ui::{self, Ui};

/// The most that a frame may take, ms.
const MOST: f64 = 4.0;
const FRAMES: usize = 120;
const SIZE: [u32; 2] = [1360, 880];

/// CPU time of this thread, ms, where the system tells it. To the nanosecond: what `/proc` has is brought up to
/// date a few times in a frame only.
fn cpu() -> Option<f64> {
    #[cfg(unix)]
    {
        use rustix::time::{ClockId, clock_gettime};
        let now = clock_gettime(ClockId::ThreadCPUTime);
        Some(1e3 * now.tv_sec as f64 + 1e-6 * now.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

/// A grid of cubes, and of sixteen cows of 6,000 triangles.
fn crowd() -> String {
    let mut text = String::from("rate = 60\ncollision = \"continuous\"\n");
    for n in 0..1000 {
        let mesh = if n % 63 == 0 { "cow.obj" } else { "cube.obj" };
        let place = [n % 10, n / 10 % 10, n / 100].map(|k| 3 * k);
        let speed = [n % 7 - 3, n % 5 - 2, n % 3 - 1].map(|k| 0.05 * f64::from(k));
        text += &format!(
            "[[body]]\nname = \"{n}\"\nmesh = \"{mesh}\"\nposition = {place:?}\nvelocity = {speed:?}\n"
        );
    }
    text
}

fn main() -> ExitCode {
    let scene = Scene::parse(&crowd(), Path::new("crowd.toml")).expect("a scene");
    let mut session = Session::new(scene).expect("a world");
    let triangles: usize = (0..session.world().len())
        .filter_map(|i| session.world().mesh(i))
        .map(|mesh| mesh.triangles().len())
        .sum();
    let Some(adapter) = render::offscreen::adapter() else {
        eprintln!("no graphics adapter");
        return ExitCode::from(3);
    };
    let made = pollster::block_on(adapter.request_device(&render::device_descriptor(&adapter)));
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let samples = render::supported_samples(&adapter);
    let mut canvas = Canvas::new(made.expect("a device"), format, samples);
    let view = canvas
        .device()
        .create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: SIZE[0],
                height: SIZE[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
        .create_view(&Default::default());
    let context = egui::Context::default();
    ui::apply_style(&context);
    let mut panels = Ui::default();
    session.start();

    let names = [
        "states taken in",
        "picture",
        "panels",
        "tessellation",
        "commands",
    ];
    let mut costs: Vec<[f64; 5]> = Vec::new();
    for _ in 0..FRAMES {
        let job = session.due(Duration::from_millis(17));
        let done = job.map(|job| job.run(|| Duration::ZERO));
        let mut marks = vec![cpu()];
        if let Some(done) = done {
            session.accept(done);
        }
        marks.push(cpu());
        let picture = session.picture();
        marks.push(cpu());
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(
                egui::Pos2::ZERO,
                egui::vec2(SIZE[0] as f32, SIZE[1] as f32),
            )),
            ..Default::default()
        };
        let mut place = egui::Rect::ZERO;
        let id = canvas.picture_id();
        let output = context.run_ui(input, |root| place = panels.show(root, &mut session, id));
        marks.push(cpu());
        let mut frame = UiFrame {
            primitives: context.tessellate(output.shapes, output.pixels_per_point),
            textures: output.textures_delta,
            pixels_per_point: output.pixels_per_point,
        };
        marks.push(cpu());
        canvas.take_textures(&mut frame);
        let size = [place.width() as u32, place.height() as u32];
        canvas.paint(&view, SIZE, (&picture, size), &frame);
        canvas.free_textures(&mut frame);
        marks.push(cpu());
        // Whatever is still being drawn is not this thread's work, but it would pile up.
        let _ = canvas.device().poll(wgpu::PollType::wait_indefinitely());
        let Some(marks) = marks.into_iter().collect::<Option<Vec<f64>>>() else {
            eprintln!("this system does not tell the CPU time of a thread");
            return ExitCode::FAILURE;
        };
        costs.push([0, 1, 2, 3, 4].map(|k| marks[k + 1] - marks[k]));
    }
    // The first frames make what is kept.
    let steady = &costs[FRAMES / 4..];
    println!(
        "{} bodies, {triangles} triangles, CPU time of a frame, ms: median",
        session.world().len()
    );
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    for (k, name) in names.iter().enumerate() {
        let part = median(steady.iter().map(|cost| cost[k]).collect());
        println!("{name:<16} {part:.3}");
    }
    let whole = median(steady.iter().map(|cost| cost.iter().sum()).collect());
    println!("{:<16} {whole:.3} of at most {MOST}", "together");
    match whole <= MOST {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}
