//! Errors of readers and writers: which file, where in it, what was found, what would be right.

use std::{fmt, io};

/// Where in a file something is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line, counted from 1.
    Line(usize),
    /// A row of a table that has no lines, counted from 1.
    Row(usize),
    /// A byte, counted from 0.
    Byte(usize),
    /// The file as a whole.
    File,
}

/// A file that cannot be read or written, told completely.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct FormatError {
    /// The file as the user named it, with the path inside an archive.
    pub file: String,
    /// Where in it.
    pub place: Place,
    /// What was found there.
    pub found: String,
    /// What would have been right.
    pub expected: String,
}

/// `Result` with a [`FormatError`].
pub type Result<T> = std::result::Result<T, FormatError>;

impl FormatError {
    /// An error at a place of a file.
    pub fn new(
        file: impl Into<String>,
        place: Place,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            file: file.into(),
            place,
            found: found.into(),
            expected: expected.into(),
        }
    }
}

/// What the system says of a file, in words for people.
///
/// ```
/// let missing = std::io::Error::from(std::io::ErrorKind::NotFound);
/// assert_eq!(kineme_formats::told(&missing), "no such file or folder");
/// ```
pub fn told(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file or folder".into(),
        io::ErrorKind::IsADirectory => "a folder".into(),
        io::ErrorKind::NotADirectory => "a file where a folder should be".into(),
        io::ErrorKind::PermissionDenied => "no permission".into(),
        io::ErrorKind::StorageFull => "a full disk".into(),
        io::ErrorKind::ReadOnlyFilesystem => "a disk that cannot be written".into(),
        _ => error.to_string(),
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        match self.place {
            Place::Line(line) => write!(f, ":{line}")?,
            Place::Row(row) => write!(f, " in row {row}")?,
            Place::Byte(byte) => write!(f, " at byte {byte}")?,
            Place::File => {}
        }
        write!(f, ": found {}, expected {}", self.found, self.expected)
    }
}
