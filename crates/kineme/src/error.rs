//! The one error of the library.

use std::fmt;

/// What went wrong, told so that the caller can decide without reading prose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Invalid,
    UnknownName,
    Unsupported,
}

/// An error of the library: one opaque type, with predicates for those who must decide
/// and a sentence for those who read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Error {
    kind: Kind,
    message: String,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// `Result` with this library's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// A value that breaks a contract; the message says what was found and what would be right.
    pub fn invalid(message: impl Into<String>) -> Self {
        Self {
            kind: Kind::Invalid,
            message: message.into(),
        }
    }

    /// A name that is not known; the message lists the nearest and all known ones.
    pub fn unknown_name<'a>(
        what: &str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let mut known: Vec<&str> = known.into_iter().collect();
        known.sort_by_key(|k| (edit_distance(k, name), *k));
        let nearest = known.first().copied().unwrap_or("none");
        known.sort_unstable();
        Self {
            kind: Kind::UnknownName,
            message: format!(
                "unknown {what} `{name}`; nearest: `{nearest}`; known: {}",
                known.join(", ")
            ),
        }
    }

    /// Valid input that this method cannot serve.
    pub fn unsupported(message: impl Into<String>) -> Self {
        Self {
            kind: Kind::Unsupported,
            message: message.into(),
        }
    }

    /// True when a value broke a contract.
    pub fn is_invalid(&self) -> bool {
        self.kind == Kind::Invalid
    }

    /// True when a looked-up name is not known.
    pub fn is_unknown_name(&self) -> bool {
        self.kind == Kind::UnknownName
    }

    /// True when the input is valid but cannot be served.
    pub fn is_unsupported(&self) -> bool {
        self.kind == Kind::Unsupported
    }
}

/// Levenshtein distance, to suggest the nearest known name.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &cb) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(ca != cb);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
