//! The failures of the program.

/// The reason why the program ends without a result, as one line for the user.
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
    /// Refuses input because of an error.
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

    /// The message: the error and its remedy.
    pub fn message(&self) -> &str {
        match self {
            Self::Run(message) | Self::Refused(message) | Self::NoDisplay(message) => message,
        }
    }
}
