//! Draws a picture of a scene into a PNG file, without a window.

use std::io::{Write, stderr};
use std::sync::Arc;
use std::time::Duration;

use image::RgbaImage;
use scene::{Scene, file, shown};
use sim_core::{Mesh, Shape};

use crate::cli::{Depth, ShotArgs};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::picture;
use crate::render::Cut;
use crate::render::offscreen::{Offscreen, ShotError};
use crate::session::Session;
use crate::stopwatch::Stopwatch;

/// Runs a scene for a number of steps, fewer after an interrupt, draws it and writes the file. Returns a message about
/// the file.
pub fn write(scene: Scene, args: &ShotArgs, interrupt: &Interrupt) -> Result<String, Failure> {
    interrupt.listen();
    let mut session = Session::new(scene).map_err(Failure::refused)?;
    session.look_ahead(|| interrupt.came());
    look(&mut session, args.select.as_deref(), args.bvh)?;
    let stopwatch = Stopwatch::start();
    for _ in 0..args.step {
        if interrupt.came() {
            break;
        }
        session.step_once();
        if let Some(job) = session.due(Duration::ZERO) {
            session.accept(job.run(|| stopwatch.read()));
        }
        if let Some(notice) = session.notices().iter().find(|notice| notice.error) {
            return Err(Failure::Run(notice.text.clone()));
        }
    }
    interrupt.tell(session.world().steps(), args.step, "steps");
    let image = Studio::new()?.shot(&mut session, args.size)?;
    let png = picture::png(&image)
        .map_err(|error| Failure::Run(format!("cannot encode the picture: {error}")))?;
    file::write(&args.output, &png).map_err(|error| {
        let path = shown::path(&args.output);
        Failure::Refused(format!("cannot write {path}: {error}"))
    })?;
    Ok(format!(
        "{}: {} by {} pixels, step {}\n",
        shown::path(&args.output),
        args.size[0],
        args.size[1],
        session.world().steps()
    ))
}

/// Takes pictures of a session, and reports each mesh that is drawn only in part once.
pub struct Studio {
    offscreen: Offscreen,
    told: Vec<Arc<Mesh>>,
}

impl Studio {
    /// A studio on the fastest adapter.
    pub fn new() -> Result<Self, Failure> {
        Offscreen::new().map(Self::with).map_err(failure)
    }

    fn with(offscreen: Offscreen) -> Self {
        Self {
            offscreen,
            told: Vec::new(),
        }
    }

    /// Draws the present world, in a size in pixels.
    pub fn shot(&mut self, session: &mut Session, size: [u32; 2]) -> Result<RgbaImage, Failure> {
        let (image, lines) = self.drawn(session, size)?;
        for line in lines {
            // A failure to print the report does not affect the picture.
            let _ = writeln!(stderr(), "cowbell: {}", shown::message(&line));
        }
        Ok(image)
    }

    /// The picture, and the reports about it.
    fn drawn(
        &mut self,
        session: &mut Session,
        size: [u32; 2],
    ) -> Result<(RgbaImage, Vec<String>), Failure> {
        let image = self.offscreen.shot(&session.picture(), size);
        let image = image.map_err(failure)?;
        let mut lines = Vec::new();
        for cut in self.offscreen.take_cut() {
            if !self.told.iter().any(|told| Arc::ptr_eq(told, &cut.mesh)) {
                lines.push(in_part(session, &cut));
                self.told.push(cut.mesh);
            }
        }
        Ok((image, lines))
    }
}

fn in_part(session: &Session, cut: &Cut) -> String {
    let is_its = |body: &usize| match session.world().shape(*body) {
        Some(Shape::Mesh(mesh)) => Arc::ptr_eq(mesh, &cut.mesh),
        _ => false,
    };
    let body = (0..session.world().len()).find(is_its);
    let name = body.map(|body| format!(" of {}", shown::name(&session.scene().bodies[body].name)));
    let mesh = format!("the mesh{}", name.unwrap_or_default());
    format!(
        "the graphics adapter {} (all of them collide): use a coarser mesh, or another adapter",
        cut.told(&mesh)
    )
}

/// Selects a body and shows boxes as the arguments request.
pub fn look(
    session: &mut Session,
    select: Option<&str>,
    bvh: Option<Depth>,
) -> Result<(), Failure> {
    if let Some(name) = select {
        let body = session.scene().bodies.iter().position(|b| b.name == name);
        if body.is_none() {
            return Err(no_such_body(session.scene(), name));
        }
        session.select(body);
    }
    session.display.bvh.shown = bvh.is_some();
    session.display.bvh.every_body = select.is_none();
    match bvh {
        Some(Depth::Level(depth)) => {
            let levels = session.bvh_depth();
            if depth >= levels {
                return Err(Failure::Refused(format!(
                    "--bvh {depth}: the hierarchies of {} have depths below {levels}",
                    shown::name(&session.scene().name)
                )));
            }
            session.display.bvh.depth = depth;
        }
        Some(Depth::All) => session.display.bvh.every_depth = true,
        None => {}
    }
    Ok(())
}

/// Converts the error to a failure of the command.
fn failure(error: ShotError) -> Failure {
    let message = error.to_string();
    match error {
        ShotError::NoAdapter | ShotError::Device(_) => Failure::NoDisplay(message),
        ShotError::Size { .. } => Failure::Refused(message),
        ShotError::Drawing(_) => Failure::Run(message),
    }
}

fn no_such_body(scene: &Scene, name: &str) -> Failure {
    let names: Vec<String> = scene
        .bodies
        .iter()
        .map(|body| shown::name(&body.name))
        .collect();
    Failure::Refused(format!(
        "{} has no body {}; it has {}",
        shown::name(&scene.name),
        shown::name(name),
        names.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part of a mesh is drawn, and the cut is reported.
    #[test]
    fn a_mesh_that_is_drawn_in_part_is_told_once_with_the_name_of_its_body() {
        // The vertices of the cow, 24 bytes each, exceed this limit.
        let small = Offscreen::limited(|limits| egui_wgpu::wgpu::Limits {
            max_buffer_size: 1 << 16,
            ..limits
        });
        let offscreen = match small {
            Ok(offscreen) => offscreen,
            Err(error) => {
                assert!(std::env::var_os("CI").is_none(), "{error}");
                println!("skipped: {error}");
                return;
            }
        };
        let scene = scene::Scene::load("cube-cow").expect("a scene");
        let mut session = Session::new(scene).expect("a session");
        let mut studio = Studio::with(offscreen);
        for frame in 0..3 {
            // The triangles of a selected mesh are in another buffer.
            session.select((frame == 2).then_some(0));
            let (image, told) = studio.drawn(&mut session, [64, 48]).expect("a picture");
            assert_eq!(image.dimensions(), (64, 48));
            match frame {
                0 => {
                    let [line] = &told[..] else {
                        panic!("{told:?}")
                    };
                    assert!(
                        line.contains("of the 6,000 triangles of the mesh of cow,"),
                        "{line}"
                    );
                    assert!(
                        line.ends_with("use a coarser mesh, or another adapter"),
                        "{line}"
                    );
                }
                _ => assert_eq!(told, [""; 0], "once"),
            }
        }
    }
}
