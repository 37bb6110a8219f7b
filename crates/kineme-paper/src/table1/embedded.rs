//! The part of Table I that needs no corpus, small enough for a page.

use kineme::Vocabulary;

use super::clip::{Altered, Clip, animations};
use super::measures::Measure;
use super::mode::Mode;
use super::movements::{MovementSettings, movements, ready_made};
use super::row::Row;
use super::run::{FRAME, Judge, SETS};
use super::written::{PUBLISHED, percent, way};
use crate::sets::Result;

/// The ways of deciding that are compared.
const MODES: [Mode; 4] = [
    Mode::Never,
    Mode::Paper { n: 1, stride: 1 },
    FRAME,
    Mode::FILTER,
];

/// The rows of the first two sets, what Ares did and one in `every` animations, for one vocabulary of behaviours.
///
/// # Errors
/// When a simulation fails.
pub fn embedded(
    vocabulary: &Vocabulary,
    settings: &MovementSettings,
    every: usize,
) -> Result<Vec<Row>> {
    let body = vocabulary.body();
    let own = movements(vocabulary, settings, &|| ready_made(body))?;
    let mut animated = animations(body)?;
    let mut number = 0..;
    let kept = |n: usize| n.is_multiple_of(every.max(1));
    animated.retain(|_| number.next().is_some_and(kept));
    let sets: [(&[Clip], Altered); 2] = [(&own, Altered::Nothing), (&animated, Altered::Hands)];
    let judges: Vec<Judge> = MODES
        .iter()
        .map(|mode| Judge::new(*mode, vocabulary))
        .collect::<Result<_>>()?;
    let mut rows = Vec::new();
    for (set, (clips, altered)) in SETS.iter().zip(sets) {
        let clips: Vec<&Clip> = clips.iter().collect();
        for judge in &judges {
            rows.push(judge.row(set, &clips, altered)?);
        }
    }
    Ok(rows)
}

/// Rows as the table of a page.
pub fn table(rows: &[Row]) -> kineme_report::Table {
    let mut cells: Vec<Vec<String>> = Vec::new();
    for (set, one, two) in PUBLISHED {
        let own: Vec<&Row> = rows.iter().filter(|r| r.set == set).collect();
        let Some(first) = own.first() else { continue };
        // Named once: the rows below are of the same set, and those below the paper's of as many frames.
        let frames = format!("here {} frames", first.frames);
        let mut named = [set.to_owned(), String::new(), frames].into_iter();
        let mut name = move || named.next().unwrap_or_default();
        for (n, accuracy) in [("n 1", one), ("n 2", two)] {
            let told = [
                name(),
                format!("the paper's own, {n}"),
                format!("{accuracy:.2}"),
            ];
            let unknown = std::iter::repeat_n("-".to_owned(), HEADER.len() - told.len());
            cells.push(told.into_iter().chain(unknown).collect());
        }
        for row in own {
            let decided = match row.mode {
                Mode::Never => "always denying".into(),
                mode => way(mode),
            };
            let [accuracy, recall, precision] =
                [Measure::Accuracy, Measure::Recall, Measure::Precision].map(|m| row.measure(m));
            cells.push(vec![
                name(),
                decided,
                percent(accuracy),
                percent(recall),
                percent(precision),
                row.alarms.to_string(),
            ]);
        }
    }
    kineme_report::Table {
        caption: CAPTION.into(),
        header: HEADER.map(str::to_owned).to_vec(),
        rows: cells,
    }
}

const HEADER: [&str; 6] = [
    "set",
    "decided by",
    "accuracy, %",
    "recall, %",
    "precision, %",
    "false alarms",
];
const CAPTION: &str = "Five classifiers, one of each boxing behaviour, decide of every frame whether it shows their \
     behaviour; accuracy is the mean over the five. Of every frame at least four of them should say no, so always denying \
     comes out high: recall and precision tell more. A false alarm is a stretch of frames in which a behaviour is affirmed \
     that nobody shows, nor within a quarter of a second. `paper` is section V-A as published, with n postures; `frame` is \
     the exact density, `filter` the stream. Both sets are small here (few plans, few of the animations); `kineme reproduce \
     table1` makes the whole table, with motion capture and intervals.";
