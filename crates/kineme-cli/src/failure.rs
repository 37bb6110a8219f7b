//! What ends a run: the sentence, what to do about it, and the exit code.

use std::io::{ErrorKind, Write as _};

use kineme_formats::FormatError;

/// The work failed on valid input.
pub const FAILED: u8 = 1;
/// The command line asks for what cannot be.
pub const USAGE: u8 = 2;
/// An input cannot be read.
pub const UNREADABLE: u8 = 3;

/// An error with its exit code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// The process' exit code.
    pub code: u8,
    message: String,
    hint: Option<String>,
}

impl Failure {
    /// The work failed on valid input.
    pub fn failed(message: impl Into<String>) -> Self {
        Self::new(FAILED, message.into())
    }

    /// The command line asks for what cannot be.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(USAGE, message.into())
    }

    /// An input cannot be read.
    pub fn unreadable(message: impl Into<String>) -> Self {
        Self::new(UNREADABLE, message.into())
    }

    fn new(code: u8, message: String) -> Self {
        Self {
            code,
            message,
            hint: None,
        }
    }

    /// The same with advice.
    pub fn hint(self, hint: impl Into<String>) -> Self {
        Self {
            hint: Some(hint.into()),
            ..self
        }
    }

    /// The same with advice, unless it has some.
    pub fn or_hint(self, hint: &str) -> Self {
        if self.hint.is_some() {
            return self;
        }
        self.hint(hint)
    }

    /// The same, blamed on a place: `labels.csv:7`.
    pub fn at(self, place: &str) -> Self {
        Self {
            message: format!("{place}: {}", self.message),
            ..self
        }
    }

    /// Prints the message and the advice to stderr, a line each.
    pub fn print(&self) {
        complain(&self.message);
        if let Some(hint) = &self.hint {
            tell(&format!("hint: {hint}"));
        }
    }
}

impl From<FormatError> for Failure {
    fn from(error: FormatError) -> Self {
        Self::unreadable(error.to_string())
    }
}

impl From<kineme::Error> for Failure {
    fn from(error: kineme::Error) -> Self {
        Self::failed(error.to_string())
    }
}

/// A line on stderr, under the program's name.
pub fn complain(message: &str) {
    tell(&format!("kineme: {message}"));
}

/// A line on stderr; when nobody reads there, nobody is told.
fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Writes to stdout; a reader that has gone away is no failure.
pub fn print(bytes: &[u8]) -> Result<(), Failure> {
    offer(bytes).map(|_| ())
}

/// As [`print()`], and tells whether anybody reads still: streams end when nobody does.
pub fn offer(bytes: &[u8]) -> Result<bool, Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(e) => Err(Failure::failed(format!("standard output: {e}"))),
    }
}
