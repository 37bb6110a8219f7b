//! The exercises of CMU subject 13: two recordings learned from in pieces, the third watched as a stream.

use std::path::Path;
use std::sync::Arc;

use kineme::alignment::period;
use kineme::motion::landmark_dims;
use kineme::primitive::{Exemplar, Observations, readings};
use kineme::{Motion, Skeleton};

use super::known::{Known, Method, learned};
use super::summary::{Aim, Line};
use crate::sets::{IndexRow, LabelledSet, Result, index, load};
use crate::table::annotations;

/// The row's name.
pub const ROW: &str = "CMU exercises, every 0.1 s";
/// How long pieces of a run without a period are, about, seconds.
const PIECE_SECS: f64 = 2.5;
/// Steps of the annotation whose answers stand and fall together: about the length of a repetition, 2 s.
const BLOCK: usize = 20;
/// Recordings learned from, and the one that is watched.
const TRIALS: [&str; 3] = ["13_29", "13_30", "13_31"];

/// Exemplars of exercises, and a recording of them one after another.
#[derive(Debug, Clone)]
pub struct Exercises {
    /// Single repetitions, or pieces of 2.5 s where there is no period, of the first two recordings.
    pub pieces: LabelledSet,
    /// Where each piece begins in its recording, seconds.
    pub begin_secs: Vec<f64>,
    /// The third.
    pub stream: Motion,
    /// Its class at every 0.1 s.
    pub truth: Vec<usize>,
}

impl Exercises {
    /// Reads and cuts them.
    ///
    /// # Errors
    /// When the corpus lacks a file.
    pub fn read(corpus: &Path, body: &Arc<Skeleton>) -> Result<Self> {
        let rows = index(corpus)?;
        let picked: Vec<&IndexRow> = TRIALS
            .iter()
            .filter_map(|t| {
                let name = format!("{t}.amc");
                let of = |r: &&IndexRow| r.archive == "cmu-asfamc.zip" && r.file.ends_with(&name);
                rows.iter().find(of)
            })
            .collect();
        let asf = "cmu-asfamc.zip/cmu-asfamc/02/02.asf";
        let whole = load(corpus, &picked, body, Some(asf), &|r| r.file.clone())?;
        let (mut truth, classes) = annotations(corpus, &TRIALS)?;
        let mut pieces = LabelledSet {
            motions: Vec::new(),
            labels: Vec::new(),
            classes,
        };
        let mut begin_secs = Vec::new();
        let [first, second, stream] = whole.motions.as_slice() else {
            return Err("three recordings of exercises are needed".into());
        };
        for (motion, annotation) in [first, second].into_iter().zip(&truth) {
            let mut step = 0;
            for run in annotation.labels.chunk_by(|a, b| a == b) {
                let frame = |s: usize| (s as f64 * motion.rate_hz() / annotation.rate_hz) as usize;
                let part = motion.slice(frame(step)..frame(step + run.len()))?;
                let mut first = frame(step);
                for piece in repetitions(&part)? {
                    begin_secs.push(first as f64 / motion.rate_hz());
                    first += piece.frames();
                    pieces.motions.push(piece);
                    pieces.labels.push(run[0]);
                }
                step += run.len();
            }
        }
        Ok(Self {
            pieces,
            begin_secs,
            stream: stream.clone(),
            truth: truth.remove(2).labels,
        })
    }

    /// The last frame of a step of the annotation.
    pub fn frame(&self, step: usize) -> usize {
        let frames = (step + 1) as f64 * self.stream.rate_hz() / 10.0;
        (frames.round() as usize - 1).min(self.stream.frames() - 1)
    }

    /// Whether the likeliest primitive at the end of each step, told from the past alone, is the true one.
    ///
    /// # Errors
    /// When a primitive cannot be learned.
    pub fn rights(&self, known: &Known, method: Method) -> Result<Vec<f64>> {
        let recogniser = method.over(&known.vocabulary)?;
        let seen = Observations::complete(self.stream.clone());
        let readings = readings(&*recogniser, &seen)?;
        let right = |(step, truth): (usize, &usize)| {
            let leading = readings[self.frame(step)].posterior.leading();
            f64::from(u8::from(
                leading.is_some_and(|(p, _)| known.class_of[p] == *truth),
            ))
        };
        Ok(self.truth.iter().enumerate().map(right).collect())
    }

    /// All pieces learned, each with its place in its recording, which tells what followed what.
    ///
    /// # Errors
    /// When a primitive cannot be learned.
    pub fn learn(&self) -> Result<Known> {
        let exemplars = |class: usize| -> Vec<Exemplar> {
            let of = |i: &usize| self.pieces.labels[*i] == class;
            let placed = |i: usize| {
                let mut piece = Exemplar::whole(self.pieces.motions[i].clone(), None);
                piece.provenance.start_secs = self.begin_secs[i];
                piece.provenance.end_secs += self.begin_secs[i];
                piece
            };
            (0..self.begin_secs.len()).filter(of).map(placed).collect()
        };
        Known::of(learned(&self.pieces.classes, &exemplars)?)
    }

    /// The row among the aims.
    ///
    /// # Errors
    /// When a primitive cannot be learned.
    pub fn line(&self) -> Result<Line> {
        let known = self.learn()?;
        Line::of(
            ROW,
            &self.rights(&known, Method::Filter)?,
            &self.rights(&known, Method::Dtw)?,
            BLOCK,
            Some(Aim::beside(0.93, 0.883)),
        )
    }
}

/// A run of one exercise in single repetitions where it has a period, else in equal pieces.
fn repetitions(run: &Motion) -> Result<Vec<Motion>> {
    let frames = run.frames();
    let found = period(
        &run.landmarks(),
        landmark_dims(run.skeleton()),
        run.rate_hz(),
    )?;
    let length = match found {
        Some(p) => p.frames,
        None => {
            let pieces = (run.duration_secs() / PIECE_SECS).round().max(1.0);
            frames as f64 / pieces
        }
    };
    let count = (frames as f64 / length + 1e-9) as usize;
    (0..count)
        .map(|k| {
            let at = |k: usize| ((k as f64 * length).round() as usize).min(frames);
            Ok(run.slice(at(k)..at(k + 1))?)
        })
        .collect()
}
