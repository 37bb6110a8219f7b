//! Answers to every frame of recordings, judged.

use crate::error::{Error, Result};
use crate::math::statistics::quantile;
use crate::primitive::Reading;

/// A recording: frame by frame the truth and the answer, each a primitive or `None` for none of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Stream {
    rate_hz: f64,
    truth: Vec<Option<usize>>,
    answers: Vec<Option<usize>>,
}

impl Stream {
    /// A recording at `rate_hz` with one answer a frame, an index into the vocabulary.
    ///
    /// # Errors
    /// Without frames, when there are not as many answers as truths, or the rate is not positive.
    pub fn new(
        rate_hz: f64,
        truth: Vec<Option<usize>>,
        answers: Vec<Option<usize>>,
    ) -> Result<Self> {
        if truth.is_empty() || truth.len() != answers.len() {
            return Err(Error::invalid(format!(
                "a stream needs frames and one answer each, found {} frames and {} answers",
                truth.len(),
                answers.len()
            )));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Error::invalid(format!(
                "a stream needs a positive rate, found {rate_hz} Hz"
            )));
        }
        Ok(Self {
            rate_hz,
            truth,
            answers,
        })
    }

    /// The same with what a recogniser thought of every frame.
    ///
    /// # Errors
    /// As for [`Stream::new`].
    pub fn of_readings(
        rate_hz: f64,
        truth: Vec<Option<usize>>,
        readings: &[Reading],
    ) -> Result<Self> {
        let answers = readings.iter().map(|r| r.posterior.best()).collect();
        Self::new(rate_hz, truth, answers)
    }
}

/// What is forgiven in streams.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamSettings {
    /// How long before and after a true span its own label is no false alarm, seconds: people who label and
    /// recognisers that look back agree no better on where a movement ends.
    pub margin_secs: f64,
}

impl Default for StreamSettings {
    fn default() -> Self {
        Self { margin_secs: 0.25 }
    }
}

/// How long right answers were in coming, seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delays {
    /// The median.
    pub median_secs: f64,
    /// What nine of ten stay below.
    pub p90_secs: f64,
}

/// How well recordings were recognised frame by frame. A *true span* is a maximal run of frames whose truth is one
/// primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamScores {
    /// The mean over the classes that are present, none being one, of the share of their frames answered rightly.
    pub balanced_accuracy: f64,
    /// True spans.
    pub spans: usize,
    /// Those in no frame of which the right answer was given.
    pub missed: usize,
    /// From the beginning of a true span to its first frame with the right answer, over those not missed; `None`
    /// without any.
    pub onset: Option<Delays>,
    /// Maximal runs of frames that give one primitive as the answer where it is not the truth, nor within the margin
    /// of a frame where it is.
    pub false_alarms: usize,
    /// How long the recordings are, minutes.
    pub minutes: f64,
}

impl StreamScores {
    /// False alarms a minute.
    pub fn false_alarms_a_minute(&self) -> f64 {
        self.false_alarms as f64 / self.minutes
    }
}

/// How well recordings were recognised, frames, spans and alarms of all of them together.
///
/// # Errors
/// Without recordings, or when the margin is negative or not finite.
pub fn stream_scores(streams: &[Stream], settings: &StreamSettings) -> Result<StreamScores> {
    let margin = settings.margin_secs;
    if streams.is_empty() || !(margin.is_finite() && margin >= 0.0) {
        return Err(Error::invalid(format!(
            "frames are judged in streams, with a margin of 0 s or more; found {} streams, margin {margin} s",
            streams.len()
        )));
    }
    let mut delays = Vec::new();
    let (mut spans, mut false_alarms, mut minutes) = (0, 0, 0.0);
    for stream in streams {
        for (start, end, label) in runs(&stream.truth) {
            spans += 1;
            let mut answers = stream.answers[start..end].iter();
            let after = answers.position(|a| *a == Some(label));
            delays.extend(after.map(|frames| frames as f64 / stream.rate_hz));
        }
        false_alarms += alarms(stream, margin);
        minutes += stream.truth.len() as f64 / stream.rate_hz / 60.0;
    }
    let onset = quantile(&delays, 0.5).zip(quantile(&delays, 0.9));
    Ok(StreamScores {
        balanced_accuracy: balanced_accuracy(streams),
        spans,
        missed: spans - delays.len(),
        onset: onset.map(|(median_secs, p90_secs)| Delays {
            median_secs,
            p90_secs,
        }),
        false_alarms,
        minutes,
    })
}

/// Maximal runs of one label: first frame, frame after the last, label.
fn runs(labels: &[Option<usize>]) -> Vec<(usize, usize, usize)> {
    let mut start = 0;
    let mut runs = Vec::new();
    for run in labels.chunk_by(|a, b| a == b) {
        if let Some(label) = run[0] {
            runs.push((start, start + run.len(), label));
        }
        start += run.len();
    }
    runs
}

/// False alarms of a stream.
fn alarms(stream: &Stream, margin_secs: f64) -> usize {
    let frames = stream.truth.len();
    let margin = (margin_secs * stream.rate_hz).round().min(frames as f64) as usize;
    let true_runs = runs(&stream.truth);
    let mut wrong = stream.answers.clone();
    for (start, end, label) in true_runs {
        let forgiven = start.saturating_sub(margin)..(end + margin).min(frames);
        for answer in &mut wrong[forgiven] {
            if *answer == Some(label) {
                *answer = None;
            }
        }
    }
    runs(&wrong).len()
}

fn balanced_accuracy(streams: &[Stream]) -> f64 {
    // Frames and right answers of each class; none comes first.
    let mut counts: Vec<[usize; 2]> = Vec::new();
    for stream in streams {
        for (truth, answer) in stream.truth.iter().zip(&stream.answers) {
            let class = truth.map_or(0, |t| t + 1);
            if counts.len() <= class {
                counts.resize(class + 1, [0; 2]);
            }
            counts[class][0] += 1;
            counts[class][1] += usize::from(truth == answer);
        }
    }
    let recalls: Vec<f64> = counts
        .iter()
        .filter(|[all, _]| *all > 0)
        .map(|&[all, right]| right as f64 / all as f64)
        .collect();
    recalls.iter().sum::<f64>() / recalls.len() as f64
}
