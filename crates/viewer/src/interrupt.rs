//! Ctrl-C, and the progress of a long run.

use std::io::{IsTerminal, Write, stderr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::cli::INTERRUPTED;
use crate::stopwatch::Stopwatch;

/// Whether the user wants the program to end.
#[derive(Debug, Default)]
pub struct Interrupt {
    came: Arc<AtomicBool>,
    /// If set, the next signal ends the program without a message.
    at_once: Arc<AtomicBool>,
}

impl Interrupt {
    /// From now on a signal ends the program with the exit code of an interrupt: at once, until [`Self::listen`] is
    /// called.
    pub fn begin(&self) -> std::io::Result<()> {
        self.at_once.store(true, Ordering::Relaxed);
        for signal in [SIGINT, SIGTERM] {
            // This handler is registered first, so that it acts on what an earlier signal has stored.
            flag::register_conditional_shutdown(signal, INTERRUPTED.into(), self.at_once.clone())?;
            flag::register(signal, self.came.clone())?;
            flag::register(signal, self.at_once.clone())?;
        }
        Ok(())
    }

    /// From now on the first signal is only stored, and the second ends the program.
    pub fn listen(&self) {
        self.at_once.store(self.came(), Ordering::Relaxed);
    }

    /// Whether a signal has come.
    pub fn came(&self) -> bool {
        self.came.load(Ordering::Relaxed)
    }

    /// Prints that a signal has ended something early, if that happened.
    pub fn tell(&self, reached: u64, total: u64, what: &str) {
        if self.came() {
            // A failure is harmless, because the result has the count too.
            let _ = writeln!(
                stderr(),
                "cowbell: interrupted after {reached} of {total} {what}"
            );
        }
    }
}

/// Makes a write beyond the limit of file sizes an error, as on a full disk, instead of ending the program.
pub fn survive_file_limits() {
    #[cfg(unix)]
    {
        // If this fails, a signal ends the program as by default.
        let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    }
}

/// The line on a terminal that shows the progress of a run.
#[derive(Debug)]
pub struct Progress {
    stopwatch: Option<Stopwatch>,
    total: u64,
    /// What is counted.
    what: &'static str,
    /// The step after which to read the clock, and the number of steps between two readings.
    next: u64,
    stride: u64,
    looked: Duration,
    shown: Option<Duration>,
}

impl Progress {
    /// The time before the first message of a run and between two messages.
    const PAUSE: Duration = Duration::from_millis(500);

    /// Progress of a number of steps; silent if stderr is not a terminal.
    pub fn new(total: u64) -> Progress {
        Progress::of(total, "steps")
    }

    /// Progress of another quantity.
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

    /// Prints the progress if it is time to; most calls only compare two numbers.
    pub fn at(&mut self, steps: u64) {
        if steps < self.next {
            return;
        }
        let Some(stopwatch) = self.stopwatch else {
            self.next = u64::MAX;
            return;
        };
        let now = stopwatch.read();
        // The clock must not slow down short steps, and long steps must still be reported.
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
            // A failure to print is harmless.
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
