//! Ctrl-C, and how far a long run has come.

use std::io::{IsTerminal, Write, stderr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::cli::INTERRUPTED;
use crate::stopwatch::Stopwatch;

/// Whether someone wants the program to end.
#[derive(Debug, Default)]
pub struct Interrupt {
    came: Arc<AtomicBool>,
    /// The next signal ends the program, and nothing is told.
    at_once: Arc<AtomicBool>,
}

impl Interrupt {
    /// From now on a signal to end has the exit code of one: at once, until [`Self::listen`].
    pub fn begin(&self) -> std::io::Result<()> {
        self.at_once.store(true, Ordering::Relaxed);
        for signal in [SIGINT, SIGTERM] {
            // Asked first, so that it acts on what an earlier signal has noted.
            flag::register_conditional_shutdown(signal, INTERRUPTED.into(), self.at_once.clone())?;
            flag::register(signal, self.came.clone())?;
            flag::register(signal, self.at_once.clone())?;
        }
        Ok(())
    }

    /// From now on the first signal is only noted, and the second ends the program.
    pub fn listen(&self) {
        self.at_once.store(self.came(), Ordering::Relaxed);
    }

    /// Whether a signal came.
    pub fn came(&self) -> bool {
        self.came.load(Ordering::Relaxed)
    }

    /// Tells that a signal has cut something short, if one has.
    pub fn tell(&self, reached: u64, total: u64, what: &str) {
        if self.came() {
            // Nothing is lost if it cannot be told: the result has the count too.
            let _ = writeln!(
                stderr(),
                "cowbell: interrupted after {reached} of {total} {what}"
            );
        }
    }
}

/// A write beyond the limit of file sizes becomes an error, as on a full disk, instead of the end
/// of the program.
pub fn survive_file_limits() {
    #[cfg(unix)]
    {
        // Where this fails the program ends as it would have.
        let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    }
}

/// The line on a terminal that says how far a run is.
#[derive(Debug)]
pub struct Progress {
    stopwatch: Option<Stopwatch>,
    total: u64,
    /// What is counted.
    what: &'static str,
    /// The step to look at the clock after, and how many lie between two looks.
    next: u64,
    stride: u64,
    looked: Duration,
    shown: Option<Duration>,
}

impl Progress {
    /// How long a run may take before it tells how far it is, and from one time to the next.
    const PAUSE: Duration = Duration::from_millis(500);

    /// Of so many steps; silent where stderr is no terminal.
    pub fn new(total: u64) -> Progress {
        Progress::of(total, "steps")
    }

    /// The same of something else that is counted.
    pub fn of(total: u64, what: &'static str) -> Progress {
        Progress {
            what,
            stopwatch: stderr().is_terminal().then(Stopwatch::start),
            total,
            next: 1,
            stride: 1,
            looked: Duration::ZERO,
            shown: None,
        }
    }

    /// Tells it if it is time to; most calls compare two numbers.
    pub fn at(&mut self, steps: u64) {
        if steps < self.next {
            return;
        }
        let Some(stopwatch) = self.stopwatch else {
            self.next = u64::MAX;
            return;
        };
        let now = stopwatch.read();
        // Short steps are not slowed by the clock, long ones not left alone.
        let pause = now - self.looked;
        self.looked = now;
        if pause < Self::PAUSE / 16 {
            self.stride = self.stride.saturating_mul(2);
        } else if pause > Self::PAUSE / 4 {
            self.stride = (self.stride / 2).max(1);
        }
        self.next = steps.saturating_add(self.stride);
        if now - self.shown.unwrap_or_default() >= Self::PAUSE {
            self.shown = Some(now);
            let percent = 100.0 * steps as f64 / self.total as f64;
            // Nothing is lost if it cannot be told.
            let _ = write!(
                stderr(),
                "\r{steps} of {} {}, {percent:.1} % ",
                self.total,
                self.what
            );
        }
    }

    /// Removes the line.
    pub fn end(&self) {
        if self.shown.is_some() {
            let _ = write!(stderr(), "\r\x1b[K");
        }
    }
}
