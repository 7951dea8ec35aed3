//! Saves pictures of the run: a still of the view, and a film of the kept states.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::{Session, State};
use crate::picture::Picture;

/// Hundredths of a second, the time unit of films, as in GIF.
pub const TICKS: f64 = 100.0;
/// The duration of each picture of a film, hundredths of a second.
const DELAY: u16 = 4;
/// The most pictures of a film: 12 s.
const MOST_PICTURES: usize = 300;
/// The most models in all pictures of a film together.
const MOST_MODELS: usize = 100_000;
/// Width of a film, pixels.
const FILM_WIDTH: u32 = 720;

/// Pictures to be saved in a file: one for a still, several for a film.
#[derive(Clone)]
pub struct Shooting {
    /// The pictures.
    pub pictures: Vec<Picture>,
    /// Size of the file's pictures, pixels.
    pub size: [u32; 2],
    /// The duration of each, hundredths of a second.
    pub delay: u16,
    /// The progress, shared with the session.
    pub reel: Reel,
}

/// The progress of a shooting, and whether it is cancelled; shared between the thread that draws and the session.
#[derive(Clone, Debug, Default)]
pub struct Reel(Arc<Counts>);

#[derive(Debug, Default)]
struct Counts {
    done: AtomicUsize,
    total: AtomicUsize,
    cancelled: AtomicBool,
}

impl Reel {
    fn of(total: usize) -> Self {
        let reel = Self::default();
        reel.0.total.store(total, Ordering::Relaxed);
        reel
    }

    /// Pictures drawn, and pictures in all.
    pub fn progress(&self) -> [usize; 2] {
        [&self.0.done, &self.0.total].map(|count| count.load(Ordering::Relaxed))
    }

    /// Counts one more picture as drawn.
    pub fn advance(&self) {
        self.0.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Cancels the shooting; no file is written.
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether it is cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }
}

/// The state of the session's shooting.
#[derive(Default)]
pub(super) struct Studio {
    /// The shooting that has not been handed out yet.
    waiting: Option<Shooting>,
    /// The progress of the waiting or current shooting, and whether it is a film.
    reel: Option<(Reel, bool)>,
    /// The start of the next film, s, if it is not the oldest kept state.
    from: Option<f64>,
}

impl Session {
    /// Requests a still of the view, in a size in pixels.
    pub fn shoot_still(&mut self, size: [u32; 2]) {
        let picture = self.picture();
        self.shoot(vec![picture], size);
    }

    /// Sets the start of the next film to a kept state, or removes the start if it is there already.
    pub fn begin_film_at(&mut self, state: usize) {
        let time = self.playback.samples().nth(state).map(|sample| sample.time);
        self.studio.from = time.filter(|_| self.film_start() != time);
    }

    /// The start of the next film, s, if it was set and is still kept.
    pub fn film_start(&self) -> Option<f64> {
        let [first, last] = self.playback.span();
        self.studio
            .from
            .filter(|from| (first..=last).contains(from))
    }

    /// Requests a film of the kept run, from the chosen start up to the current state, at the current speed and in the
    /// proportions of a size in pixels. If it would be longer than 12 s, it shows the last 12 s.
    pub fn shoot_film(&mut self, [width, height]: [u32; 2]) {
        if self.state == State::Layout || self.playback.len() < 2 {
            let text = "There is nothing to film yet: start, or step.";
            return self.notices.info("shoot", text.to_owned());
        }
        let end = self.shown_time();
        self.pause();
        let (now, instant) = (self.playback.now(), self.instant);
        let apart = self.speed * f64::from(DELAY) / TICKS;
        let [first, _] = self.playback.span();
        let first = self
            .film_start()
            .filter(|&from| from < end)
            .unwrap_or(first);
        let most = MOST_PICTURES
            .min(MOST_MODELS / self.world.len().max(1))
            .max(2);
        let count = (((end - first) / apart).floor() as usize + 1).clamp(2, most);
        let times = (0..count).rev().map(|n| end - n as f64 * apart);
        let mut pictures = Vec::with_capacity(count);
        for time in times {
            self.go_to_time(time.max(first));
            pictures.push(self.picture());
        }
        self.go_to(now);
        self.instant = instant;
        let height = (f64::from(height) * f64::from(FILM_WIDTH) / f64::from(width.max(1))).round();
        self.shoot(
            pictures,
            [FILM_WIDTH, (height as u32).clamp(16, 4 * FILM_WIDTH)],
        );
    }

    fn shoot(&mut self, pictures: Vec<Picture>, size: [u32; 2]) {
        if self.studio.reel.is_some() {
            let text = "The last pictures are still being drawn.";
            return self.notices.info("shoot", text.to_owned());
        }
        let reel = Reel::of(pictures.len());
        self.studio.reel = Some((reel.clone(), pictures.len() > 1));
        self.studio.waiting = Some(Shooting {
            pictures,
            size,
            delay: DELAY,
            reel,
        });
    }

    /// The shooting to draw now; it is returned once.
    pub fn shooting_due(&mut self) -> Option<Shooting> {
        self.studio.waiting.take()
    }

    /// The progress of the waiting or current shooting.
    pub fn reel(&self) -> Option<&Reel> {
        self.studio.reel.as_ref().map(|(reel, _)| reel)
    }

    /// Accepts the bytes of a file, or the reason for a failure; nothing if it was cancelled.
    pub fn accept_shooting(&mut self, outcome: Result<Option<Vec<u8>>, String>) {
        let Some((_, is_film)) = self.studio.reel.take() else {
            return;
        };
        self.studio.waiting = None;
        match outcome {
            Ok(Some(bytes)) => self.export(if is_film { "gif" } else { "png" }, &bytes),
            Ok(None) => self.notices.info("shoot", "Cancelled.".to_owned()),
            Err(error) => self.notices.error("shoot", error),
        }
    }
}
