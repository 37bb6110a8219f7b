//! The same clips and splits for the programs of others: plain tables.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use kineme::alignment::resample;
use kineme::motion::{landmark_dims, landmarks_of};
use kineme::{Motion, Skeleton};

use super::corpora::{BANDAI_NAMCO, Corpus, HDM05, MSR, Part, Split, UTD, corpora};
use super::exercises::{Exercises, ROW};
use super::trials::{SHOTS, Trials, few, halves};
use crate::sets::Result;

/// Frames to which clips are resampled.
pub const SAMPLES: usize = 64;

/// Writes `clips-N.csv`, one a set (class, then 64 frames of landmarks, metres, named `role_axis`), and `rows.csv`
/// (row, `hands` or `all`, whether it is an open set, the set's N, the clips learned from, the clips asked).
///
/// # Errors
/// When the corpus lacks a file or `folder` cannot be written to.
pub fn export(corpus: &Path, folder: &Path) -> Result<()> {
    fs::create_dir_all(folder)?;
    let body = Arc::new(kineme::ares()?);
    let mut rows = String::from("row,features,open,set,train,test\n");
    let sets = corpora(corpus, &body, &[UTD, MSR, HDM05, BANDAI_NAMCO], Part::WHOLE)?;
    for (n, of) in sets.iter().enumerate() {
        write_clips(folder, n, &body, &of.set.motions, &of.set.labels)?;
        for trials in trials(of) {
            write_rows(&mut rows, n, "all", &trials)?;
        }
        let hands = Trials {
            row: format!("{}, hands", of.name),
            ..whole(of)
        };
        write_rows(&mut rows, n, "hands", &hands)?;
    }
    let n = sets.len();
    let (motions, labels, split) = windows(&Exercises::read(corpus, &body)?)?;
    write_clips(folder, n, &body, &motions, &labels)?;
    let exercises = Trials {
        row: ROW.into(),
        open: false,
        splits: vec![split],
    };
    write_rows(&mut rows, n, "all", &exercises)?;
    Ok(fs::write(folder.join("rows.csv"), rows)?)
}

fn whole(corpus: &Corpus) -> Trials {
    Trials {
        row: corpus.name.into(),
        open: false,
        splits: corpus.splits.clone(),
    }
}

/// The rows of a set that see all landmarks.
fn trials(corpus: &Corpus) -> Vec<Trials> {
    let mut trials = vec![whole(corpus)];
    if [UTD, HDM05].contains(&corpus.name) {
        trials.push(halves(corpus));
        trials.extend(SHOTS.map(|shots| few(corpus, shots)));
    }
    trials
}

/// The last second of every piece each 0.1 s, learned from; the last second of the stream at each step, asked.
fn windows(exercises: &Exercises) -> Result<(Vec<Motion>, Vec<usize>, Split)> {
    let (mut motions, mut labels) = (Vec::new(), Vec::new());
    let second = exercises.stream.rate_hz().round() as usize;
    for (piece, &label) in exercises
        .pieces
        .motions
        .iter()
        .zip(&exercises.pieces.labels)
    {
        let mut end = second.min(piece.frames());
        while end <= piece.frames() {
            motions.push(piece.slice(end.saturating_sub(second)..end)?);
            labels.push(label);
            end += second / 10;
        }
    }
    let learned = motions.len();
    for (step, &label) in exercises.truth.iter().enumerate() {
        let end = exercises.frame(step) + 1;
        motions.push(exercises.stream.slice(end.saturating_sub(second)..end)?);
        labels.push(label);
    }
    let split = Split {
        train: (0..learned).collect(),
        test: (learned..motions.len()).collect(),
    };
    Ok((motions, labels, split))
}

fn write_clips(
    folder: &Path,
    n: usize,
    body: &Skeleton,
    motions: &[Motion],
    labels: &[usize],
) -> Result<()> {
    let mut out = String::from("class");
    for k in 0..SAMPLES {
        for (role, _) in landmarks_of(body) {
            for axis in ["x", "y", "z"] {
                write!(out, ",{}_{axis}_{k}", role.name())?;
            }
        }
    }
    let places: Vec<f64> = (0..SAMPLES)
        .map(|k| k as f64 / (SAMPLES - 1) as f64)
        .collect();
    for (motion, label) in motions.iter().zip(labels) {
        write!(out, "\n{label}")?;
        for v in resample(&motion.landmarks(), landmark_dims(body), &places) {
            write!(out, ",{v:.5}")?;
        }
    }
    out.push('\n');
    Ok(fs::write(folder.join(format!("clips-{n}.csv")), out)?)
}

fn write_rows(out: &mut String, n: usize, features: &str, trials: &Trials) -> Result<()> {
    let joined = |clips: &[usize]| {
        let names: Vec<String> = clips.iter().map(usize::to_string).collect();
        names.join(" ")
    };
    for split in &trials.splits {
        writeln!(
            out,
            "\"{}\",{features},{},{n},{},{}",
            trials.row,
            trials.open,
            joined(&split.train),
            joined(&split.test)
        )?;
    }
    Ok(())
}
