//! How the program fails.

/// Why the program ends without having done what it was asked, as one line for a person.
#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// A run failed on the way.
    Run(String),
    /// The arguments or a file were refused.
    Refused(String),
    /// There is no display or no graphics adapter.
    NoDisplay(String),
}

impl Failure {
    /// Refuses something for the reason of an error.
    pub fn refused(error: impl std::fmt::Display) -> Self {
        Self::Refused(error.to_string())
    }

    /// Exit code of the program.
    pub fn code(&self) -> u8 {
        match self {
            Self::Run(_) => 1,
            Self::Refused(_) => 2,
            Self::NoDisplay(_) => 3,
        }
    }

    /// What is wrong and what to do about it.
    pub fn message(&self) -> &str {
        match self {
            Self::Run(message) | Self::Refused(message) | Self::NoDisplay(message) => message,
        }
    }
}
