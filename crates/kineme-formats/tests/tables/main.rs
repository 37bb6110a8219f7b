//! Tables, the files people write, and the vocabulary file.

mod angles;
mod body_angles;
mod hostile;
mod learned;
mod manifest;
mod msr;
mod npz;
mod observed;
mod parquet;
mod positions;
mod real_data;
mod vocabulary;
mod written;

use kineme::Recording;
use kineme_formats::{FormatError, Place, Result};
use nalgebra::Vector3;

/// A table of damaged inputs: what is wrong, the file, where, and a word that `found` must contain.
type Damaged<'a> = &'a [(&'a str, &'a str, Place, &'a str)];

/// Every input is refused, at its place, for its reason.
fn refuses<T: std::fmt::Debug>(cases: Damaged<'_>, parse: impl Fn(&[u8]) -> Result<T>) {
    for (what, text, place, word) in cases {
        match parse(text.as_bytes()) {
            Ok(value) => panic!("{what}: read as {value:?}"),
            Err(error) => refused(what, &error, *place, word),
        }
    }
}

fn refused(what: &str, error: &FormatError, place: Place, word: &str) {
    assert_eq!(error.place, place, "{what}: {error}");
    assert!(error.found.contains(word), "{what}: {error}");
}

/// A joint's position at a frame, by name.
fn point(recording: &Recording, frame: usize, joint: &str) -> Option<Vector3<f64>> {
    let j = recording
        .joints()
        .iter()
        .position(|j| j.name == joint)
        .unwrap_or_else(|| panic!("no joint {joint}"));
    recording.placements(frame)[j].position
}

/// Whether one of the recording's warnings contains these words.
fn warns(recording: &Recording, words: &str) -> bool {
    let warnings = &recording.source().warnings;
    warnings.iter().any(|w| w.contains(words))
}
