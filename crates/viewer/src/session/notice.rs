//! Messages to the user at the window.

use scene::shown;
use std::time::Duration;

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Its subject; a newer message about the same subject replaces it.
    pub about: &'static str,
    /// Whether it reports a refusal or a failure.
    pub error: bool,
    /// The message.
    pub text: String,
    /// Whether it stays until it is dismissed.
    stays: bool,
    /// A change that would remedy the error, if one change suffices.
    pub remedy: Option<Remedy>,
    /// Real time since it appeared.
    age: Duration,
}

/// A change of the settings that the user can accept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remedy {
    /// Steps per second of simulated time.
    Rate(f64),
    /// A collision mode.
    Collision(sim_core::Collision),
}

/// The messages still shown, newest last.
#[derive(Debug, Default)]
pub struct Notices(Vec<Notice>);

/// The most messages shown at once; older ones are removed.
const SHOWN: usize = 4;
/// The time for which a success is shown.
const STAY: Duration = Duration::from_secs(5);

impl Notices {
    /// Reports a success.
    pub fn info(&mut self, about: &'static str, text: String) {
        self.push(Notice {
            about,
            error: false,
            stays: false,
            text: shown::message(&text),
            remedy: None,
            age: Duration::ZERO,
        });
    }

    /// Reports a success of several lines, which stays until it is dismissed.
    pub fn keep(&mut self, about: &'static str, lines: &[String]) {
        let lines: Vec<String> = lines.iter().map(|line| shown::message(line)).collect();
        self.push(Notice {
            about,
            error: false,
            stays: true,
            text: lines.join("\n"),
            remedy: None,
            age: Duration::ZERO,
        });
    }

    /// Reports a refusal or a failure.
    pub fn error(&mut self, about: &'static str, text: String) {
        self.push(Notice {
            about,
            error: true,
            stays: true,
            text: shown::message(&text),
            remedy: None,
            age: Duration::ZERO,
        });
    }

    /// All messages, newest last.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Notice> {
        self.0.iter()
    }

    /// Removes the message about a subject.
    pub fn dismiss(&mut self, about: &str) {
        self.0.retain(|notice| notice.about != about);
    }

    /// Removes all messages.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds a remedy to the message about `about`.
    pub fn offer(&mut self, about: &str, remedy: Remedy) {
        let mut notices = self.0.iter_mut();
        if let Some(notice) = notices.find(|notice| notice.about == about) {
            notice.remedy = Some(remedy);
        }
    }

    /// Advances real time; successes disappear by themselves.
    pub fn pass(&mut self, elapsed: Duration) {
        for notice in &mut self.0 {
            notice.age += elapsed;
        }
        self.0.retain(|notice| notice.stays || notice.age < STAY);
    }

    /// Whether a message will disappear by itself.
    pub fn is_passing(&self) -> bool {
        self.0.iter().any(|notice| !notice.stays)
    }

    fn push(&mut self, notice: Notice) {
        self.dismiss(notice.about);
        if self.0.len() == SHOWN {
            self.0.remove(0);
        }
        self.0.push(notice);
    }
}
