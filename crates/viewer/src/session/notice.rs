//! Messages to the person at the window.

use scene::shown;
use std::time::Duration;

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// What it is about; a newer message about the same thing takes its place.
    pub about: &'static str,
    /// Whether something was refused or failed.
    pub error: bool,
    /// The message.
    pub text: String,
    /// Whether it stays until it is dismissed.
    stays: bool,
    /// What would set it right, if one change does.
    pub remedy: Option<Remedy>,
    /// Real time since it came.
    age: Duration,
}

/// A change of the settings that the person can agree to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remedy {
    /// Steps per second of simulated time.
    Rate(f64),
    /// How collisions are found.
    Collision(sim_core::Collision),
}

/// The messages still shown, newest last.
#[derive(Debug, Default)]
pub struct Notices(Vec<Notice>);

/// Messages shown at once; older ones make room.
const SHOWN: usize = 4;
/// How long a success is told.
const STAY: Duration = Duration::from_secs(5);

impl Notices {
    /// Tells of a success.
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

    /// Tells of a success that takes time to read, line by line: until it is dismissed.
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

    /// Tells of something refused or failed.
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

    /// Forgets what was said about something.
    pub fn dismiss(&mut self, about: &str) {
        self.0.retain(|notice| notice.about != about);
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Offers to set right what the message about `about` tells.
    pub fn offer(&mut self, about: &str, remedy: Remedy) {
        let mut notices = self.0.iter_mut();
        if let Some(notice) = notices.find(|notice| notice.about == about) {
            notice.remedy = Some(remedy);
        }
    }

    /// Lets real time pass: successes go by themselves.
    pub fn pass(&mut self, elapsed: Duration) {
        for notice in &mut self.0 {
            notice.age += elapsed;
        }
        self.0.retain(|notice| notice.stays || notice.age < STAY);
    }

    /// Whether one will go by itself.
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
