//! Messages to the person at the window.

use scene::shown;

/// One message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// What it is about; a newer message about the same thing takes its place.
    pub about: &'static str,
    /// Whether something was refused or failed.
    pub error: bool,
    /// The message.
    pub text: String,
}

/// The messages still shown, newest last.
#[derive(Debug, Default)]
pub struct Notices(Vec<Notice>);

/// Messages shown at once; older ones make room.
const SHOWN: usize = 4;

impl Notices {
    /// Tells of a success.
    pub fn info(&mut self, about: &'static str, text: String) {
        self.push(Notice {
            about,
            error: false,
            text: shown::message(&text),
        });
    }

    /// Tells of something refused or failed.
    pub fn error(&mut self, about: &'static str, text: String) {
        self.push(Notice {
            about,
            error: true,
            text: shown::message(&text),
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

    fn push(&mut self, notice: Notice) {
        self.dismiss(notice.about);
        if self.0.len() == SHOWN {
            self.0.remove(0);
        }
        self.0.push(notice);
    }
}
