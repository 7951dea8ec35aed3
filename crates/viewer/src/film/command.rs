//! `cowbell gif`: draws a scene as a moving picture, without a window.

use std::time::Duration;

use scene::{Scene, file, shown};

use super::{Film, Form, MOST_FRAMES};
use crate::cli::FilmArgs;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Progress};
use crate::session::Session;
use crate::session::TICKS;
use crate::shot::{self, Studio};
use crate::stopwatch::Stopwatch;

/// Runs a scene, draws its frames and writes the file, up to an interrupt. Returns a description of the file.
pub fn write(scene: Scene, args: &FilmArgs, interrupt: &Interrupt) -> Result<String, Failure> {
    let form = Form::of(&args.output).ok_or_else(|| {
        let path = shown::path(&args.output);
        Failure::Refused(format!("-o {path}: must end in .gif or .png"))
    })?;
    // A GIF counts time in hundredths of a second.
    let delay = (TICKS / args.fps).round().max(2.0);
    let apart = args.speed * delay / TICKS;
    let frames = (args.time / apart).floor() as usize + 1;
    if frames > MOST_FRAMES {
        return Err(Failure::Refused(format!(
            "{frames} frames are too many, {MOST_FRAMES} the most: shorten --time, or raise --speed"
        )));
    }
    interrupt.listen();
    let mut session = Session::new(scene).map_err(Failure::refused)?;
    session.look_ahead(|| interrupt.came());
    shot::look(&mut session, args.select.as_deref(), args.bvh)?;
    if args.trails {
        session.show_trails(true);
    }
    session.camera.zoom(args.zoom);
    let mut studio = Studio::new()?;
    let mut film = Film::new(delay as u16);
    let mut progress = Progress::of(frames as u64, "frames");
    for n in 0..frames {
        if let Err(failure) = run_to(&mut session, args.from + n as f64 * apart, interrupt) {
            progress.end();
            return Err(failure);
        }
        // A film needs at least one picture.
        if interrupt.came() && !film.is_empty() {
            break;
        }
        film.push(studio.shot(&mut session, args.size)?);
        progress.at(n as u64 + 1);
    }
    progress.end();
    interrupt.tell(film.len() as u64, frames as u64, "frames");
    let bytes = film.bytes(form).map_err(Failure::Run)?;
    let path = shown::path(&args.output);
    file::write(&args.output, &bytes)
        .map_err(|error| Failure::Refused(format!("cannot write {path}: {error}")))?;
    let [width, height] = args.size;
    Ok(format!(
        "{path}: {} frames of {width} by {height} pixels, {} bytes\n",
        film.len(),
        bytes.len()
    ))
}

/// Takes the steps up to a simulated time, s, and shows that instant. An interrupt ends the steps earlier.
fn run_to(session: &mut Session, time: f64, interrupt: &Interrupt) -> Result<(), Failure> {
    let stopwatch = Stopwatch::start();
    while session.world().time() < time && !interrupt.came() {
        session.step_once();
        if let Some(job) = session.due(Duration::ZERO) {
            session.accept(job.run(|| stopwatch.read()));
        }
        if let Some(notice) = session
            .notices()
            .iter()
            .find(|notice| notice.about == "step")
        {
            return Err(Failure::Run(notice.text.clone()));
        }
    }
    if session.world().time() >= time {
        session.go_to_time(time);
    }
    Ok(())
}
