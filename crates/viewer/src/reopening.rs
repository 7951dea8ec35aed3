//! When the graphics of a window are opened again after they were lost, and when that is given up.

use std::error::Error;
use std::fmt;
use std::time::Duration;

/// How many times in a row the graphics are opened again, and the time between the tries. A restarting driver may need
/// some time.
const MOST: u32 = 8;
const PAUSE: Duration = Duration::from_millis(500);

/// Graphics that last longer than this work: the next loss begins a new row of tries.
const STEADY: Duration = Duration::from_secs(10);

/// How long the picture is left out after memory was short twice in a row. It is longer than [`STEADY`], so the program
/// goes on as long as there is memory for the panels.
const SPARING: Duration = Duration::from_secs(15);

/// Why the graphics of a window were lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// The device is gone.
    Device,
    /// The window's surface is gone.
    Surface,
    /// The device has no memory left, and objects are missing.
    Memory,
}

impl Loss {
    /// The notice after the graphics were opened again.
    pub fn mended(self) -> &'static str {
        match self {
            Self::Device => "The graphics device was lost, and another one has taken its place.",
            Self::Surface => "The window's surface was lost, and another one has taken its place.",
            Self::Memory => {
                "The graphics adapter had no memory left for a moment. The picture is complete again."
            }
        }
    }
}

/// The reason for the end of the program, with a remedy.
impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Device => {
                "the graphics device was lost again and again. Restart the computer, update its graphics driver"
            }
            Self::Surface => {
                "the graphics driver shows no pictures in the window. Restart the desktop, update the driver"
            }
            Self::Memory => {
                "the graphics adapter has no memory left. End other programs, show fewer or coarser meshes"
            }
        })
    }
}

impl Error for Loss {}

/// The tries to open the graphics again.
#[derive(Debug, Default)]
pub struct Reopening {
    /// Tries since the graphics last were steady.
    tries: u32,
    /// When the graphics were last opened.
    opened: Duration,
    /// Until when the picture is left out.
    sparing: Option<Duration>,
    /// Whether the picture was left out until now.
    resumes: bool,
}

impl Reopening {
    /// The graphics are open.
    pub fn opened(&mut self, now: Duration) {
        self.opened = now;
    }

    /// The graphics were lost. Returns when to open them again; `None` if they were lost too often in a row.
    pub fn lost(&mut self, loss: Loss, now: Duration) -> Option<Duration> {
        if now.saturating_sub(self.opened) > STEADY {
            self.tries = 0;
        }
        if loss == Loss::Memory && self.tries > 0 {
            self.sparing = Some(now + SPARING);
        }
        self.again(now)
    }

    /// The graphics could not be opened, or were lost. Returns when to try next; `None` after too many tries.
    pub fn again(&mut self, now: Duration) -> Option<Duration> {
        if self.tries == MOST {
            return None;
        }
        let pause = if self.tries == 0 {
            Duration::ZERO
        } else {
            PAUSE
        };
        self.tries += 1;
        Some(now + pause)
    }

    /// Until when the picture is left out, because there was no memory for it.
    pub fn sparing(&mut self, now: Duration) -> Option<Duration> {
        self.resumes |= self.sparing.take_if(|until| *until <= now).is_some();
        self.sparing
    }

    /// Whether this picture is the first one after some were left out.
    pub fn resumes(&mut self) -> bool {
        std::mem::take(&mut self.resumes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::Language;

    const LOSSES: [Loss; 3] = [Loss::Device, Loss::Surface, Loss::Memory];

    #[test]
    fn graphics_that_do_not_open_are_given_up_after_some_tries() {
        let mut reopening = Reopening::default();
        let begin = Duration::from_secs(60);
        let mut now = begin;
        assert_eq!(reopening.lost(Loss::Device, now), Some(now), "at once");
        let mut tries = 1;
        while let Some(next) = reopening.again(now) {
            assert_eq!(next, now + PAUSE);
            // It takes long to find no driver.
            now = next + STEADY;
            tries += 1;
        }
        assert_eq!(tries, MOST);
    }

    #[test]
    fn graphics_that_open_and_are_lost_at_once_are_given_up_and_those_that_last_are_not() {
        for loss in [Loss::Device, Loss::Surface] {
            let mut reopening = Reopening::default();
            let mut now = Duration::ZERO;
            let mut losses = 0;
            while let Some(next) = reopening.lost(loss, now) {
                reopening.opened(next);
                now = next + STEADY / 2;
                losses += 1;
            }
            assert_eq!(losses, MOST);
            assert_eq!(reopening.sparing(now), None);
        }
        let mut reopening = Reopening::default();
        let mut now = Duration::ZERO;
        for _ in 0..10 * MOST {
            now += STEADY * 2;
            assert_eq!(reopening.lost(Loss::Device, now), Some(now), "at once");
            reopening.opened(now);
        }
    }

    #[test]
    fn the_picture_is_left_out_if_memory_is_short_twice_in_a_row() {
        let mut reopening = Reopening::default();
        let mut now = Duration::from_secs(60);
        // A picture that never fits does not end a program whose panels fit.
        for _ in 0..10 * MOST {
            assert!(reopening.lost(Loss::Memory, now).is_some());
            reopening.opened(now);
            assert_eq!(reopening.sparing(now), None, "once");
            assert!(reopening.lost(Loss::Memory, now).is_some());
            reopening.opened(now);
            let until = reopening.sparing(now).expect("twice");
            now = until;
            assert!(!reopening.resumes());
            assert_eq!(reopening.sparing(now), None, "later");
            assert!(reopening.resumes(), "told once");
            assert!(!reopening.resumes());
        }
        // Panels that do not fit end it.
        let mut losses = 0;
        while reopening.lost(Loss::Memory, now).is_some() {
            reopening.opened(now);
            losses += 1;
            assert!(losses <= MOST);
        }
    }

    #[test]
    fn losses_are_told_in_each_language_and_with_a_remedy() {
        for loss in LOSSES {
            let told = loss.mended();
            assert!(Language::Chinese.translated(told).is_some(), "{told}");
            assert!(loss.to_string().contains(". "), "{loss}");
        }
    }
}
