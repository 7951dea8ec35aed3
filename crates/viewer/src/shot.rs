//! A picture of a scene in a PNG file, drawn without a window.

use std::time::Duration;

use scene::{Scene, file, shown};

use crate::cli::{Depth, ShotArgs};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::picture;
use crate::render::offscreen::{self, ShotError};
use crate::session::Session;
use crate::stopwatch::Stopwatch;

/// Runs a scene for a number of steps, or as many as there are before an interrupt, draws it and writes the
/// file; says what was written.
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
    let image = offscreen::shot(&session.picture(), args.size).map_err(failure)?;
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

/// Selects a body and shows boxes, as the arguments ask for.
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

/// Why there is no picture, for the one who asked for it.
pub fn failure(error: ShotError) -> Failure {
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
