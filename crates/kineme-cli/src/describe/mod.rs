//! What there is to know of a vocabulary, for people and for scripts.

mod document;
mod tables;

use kineme::{Primitive, Vocabulary};

use crate::args::Global;
use crate::failure::Failure;

/// The whole vocabulary: the document of `--json`, else tables.
pub fn all(vocabulary: &Vocabulary, name: &str, global: &Global) -> Result<String, Failure> {
    let primitives: Vec<&Primitive> = vocabulary.primitives().iter().collect();
    if global.json {
        document::document(vocabulary, &primitives)
    } else {
        Ok(tables::tables(vocabulary, name))
    }
}

/// One primitive: the same document of it alone, else all there is to tell.
pub fn one(
    vocabulary: &Vocabulary,
    primitive: &Primitive,
    global: &Global,
) -> Result<String, Failure> {
    if global.json {
        document::document(vocabulary, &[primitive])
    } else {
        Ok(tables::details(primitive))
    }
}

/// The recognisers whose calibration a vocabulary holds.
fn calibrated(vocabulary: &Vocabulary) -> impl Iterator<Item = &str> {
    let all = vocabulary.calibrations().iter();
    all.map(|c| c.recogniser.as_str())
}

/// Seconds that the shortest and the longest exemplar take; of cycles, one of them.
fn durations(primitive: &Primitive) -> [f64; 2] {
    let pairs = primitive.exemplars().iter().zip(&primitive.fitted().used);
    pairs
        .map(|(e, used)| (used.end - used.start) / e.motion.rate_hz())
        .fold([f64::INFINITY, 0.0], |[low, high], secs| {
            [low.min(secs), high.max(secs)]
        })
}

/// A number in as few digits as tell people enough.
pub fn short(value: f64) -> String {
    let digits = if value.abs() < 10.0 { 3 } else { 1 };
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}
