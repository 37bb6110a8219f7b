//! Bytes to lines, words and numbers, and what errors say about them.

use std::collections::HashSet;

use crate::error::{FormatError, Place};

/// The lines of a text with any line end, numbered from 1, trimmed of ASCII white space.
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    /// The lines of `bytes`, without a byte order mark.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            number: 0,
        }
    }

    /// The next line that is not blank, with its number.
    pub(crate) fn next_full(&mut self) -> Option<(usize, &'a [u8])> {
        self.find(|(_, line)| !line.is_empty())
    }

    /// The number of the line last given: where a text that ends too early ends.
    pub(crate) fn number(&self) -> usize {
        self.number.max(1)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let (line, rest) = match end {
            Some(at) if self.rest[at..].starts_with(b"\r\n") => {
                (&self.rest[..at], &self.rest[at + 2..])
            }
            Some(at) => (&self.rest[..at], &self.rest[at + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        self.number += 1;
        Some((self.number, line.trim_ascii()))
    }
}

/// The words of a line: what white space separates.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
}

/// A finite number.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    let value: f64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// Text of a file: UTF-8, else Latin-1, which older tools wrote.
pub(crate) fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}

/// What was found, quoted and cut to a length that a message can carry.
pub(crate) fn quoted(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    if bytes.is_empty() {
        return "nothing".into();
    }
    let head = decoded(&bytes[..bytes.len().min(LONGEST * 4)]);
    let mut text: String = head.chars().take(LONGEST).collect();
    text = text.escape_debug().to_string();
    let cut = if head.chars().count() > LONGEST {
        "..."
    } else {
        ""
    };
    format!("`{text}{cut}`")
}

/// Errors of one file, so that readers name it once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blame<'a>(pub(crate) &'a str);

impl Blame<'_> {
    /// An error in a line.
    pub(crate) fn line(
        &self,
        line: usize,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> FormatError {
        FormatError::new(self.0, Place::Line(line), found, expected)
    }

    /// An error of the file as a whole.
    pub(crate) fn file(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> FormatError {
        FormatError::new(self.0, Place::File, found, expected)
    }

    /// A recording that the core refuses.
    pub(crate) fn refused(&self, error: kineme::Error) -> FormatError {
        self.file(error.to_string(), "a valid recording")
    }

    /// Refuses what would take memory out of proportion to the file: many joints without numbers
    /// of their own, repeated over many frames.
    pub(crate) fn proportionate(
        &self,
        joints: usize,
        frames: usize,
        bytes: usize,
    ) -> Result<(), FormatError> {
        if joints.saturating_mul(frames) <= bytes.saturating_mul(4).saturating_add(1 << 16) {
            return Ok(());
        }
        Err(self.file(
            format!("{joints} joints in {frames} frames in only {bytes} bytes"),
            "a file whose joints have numbers of their own",
        ))
    }
}

/// Makes names unique by numbering the later ones; says so in a warning for people.
pub(crate) fn make_unique(names: &mut [String]) -> Option<String> {
    let mut seen: HashSet<String> = names.iter().cloned().collect();
    let mut taken: HashSet<String> = HashSet::new();
    let mut repeated = Vec::new();
    for name in names.iter_mut() {
        if taken.insert(name.clone()) {
            continue;
        }
        repeated.push(name.clone());
        let mut copy = 2;
        while !seen.insert(format!("{name}_{copy}")) {
            copy += 1;
        }
        *name = format!("{name}_{copy}");
        taken.insert(name.clone());
    }
    let first = repeated.first()?;
    Some(format!(
        "{} joints repeat a name (first `{first}`) and were numbered",
        repeated.len()
    ))
}

/// The shortest decimal that reads back as the same number.
pub(crate) fn shortest(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".into()
    } else if (1e-5..1e16).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
