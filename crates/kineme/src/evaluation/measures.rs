//! What is measured on a collection of clips in which each clip may stand several times.

use super::clips::Judged;
use crate::error::{Error, Result};

/// How many there are; the order is that of the fields of [`super::Scores`].
pub(super) const MEASURES: usize = 7;

/// Bins of the calibration error.
const BINS: usize = 10;

/// The share of the known that a rejection must keep.
const KEPT: f64 = 0.95;

/// Probabilities below this count as this much in the log loss: an impossible answer costs 34.5 nats, not all.
const LEAST_PROBABILITY: f64 = 1e-15;

/// How far probabilities may be from a sum of 1.
const SUM_SLACK: f64 = 1e-6;

/// Clips with all that does not change between collections.
pub(super) struct Sample {
    clips: Vec<Clip>,
    /// Classes: the primitives and, last, none of them.
    classes: usize,
    /// Indices of the clips by rising novelty.
    by_novelty: Vec<usize>,
    /// Whether all posteriors sum to one.
    probabilistic: bool,
}

struct Clip {
    truth: usize,
    answer: usize,
    /// Minus the logarithm of the truth's probability.
    loss: f64,
    /// The answer's probability.
    confidence: f64,
    bin: usize,
    novelty: f64,
}

impl Sample {
    pub fn new(judged: &[Judged]) -> Result<Self> {
        let Some(first) = judged.first() else {
            return Err(Error::invalid("nothing to judge: no clips"));
        };
        let none = first.posterior.primitives.len();
        let clips = judged
            .iter()
            .enumerate()
            .map(|(i, j)| {
                check(j, none).map_err(|what| Error::invalid(format!("clip {i}: {what}")))?;
                let p = &j.posterior;
                let neither = p.rest + p.none;
                let true_probability = j.truth.map_or(neither, |t| p.primitives[t]);
                let answer = j.answer();
                let confidence = answer.map_or(p.rest.max(p.none), |a| p.primitives[a]);
                let bin = (confidence * BINS as f64).ceil() as usize;
                Ok(Clip {
                    truth: j.truth.unwrap_or(none),
                    answer: answer.unwrap_or(none),
                    loss: -true_probability.max(LEAST_PROBABILITY).ln(),
                    confidence,
                    bin: bin.clamp(1, BINS) - 1,
                    novelty: j.novelty,
                })
            })
            .collect::<Result<Vec<Clip>>>()?;
        let mut by_novelty: Vec<usize> = (0..clips.len()).collect();
        by_novelty.sort_by(|&a, &b| clips[a].novelty.total_cmp(&clips[b].novelty));
        let sums_to_one = |j: &Judged| {
            let p = &j.posterior;
            let sum = p.primitives.iter().sum::<f64>() + p.rest + p.none;
            (sum - 1.0).abs() <= SUM_SLACK
        };
        Ok(Self {
            clips,
            classes: none + 1,
            by_novelty,
            probabilistic: judged.iter().all(sums_to_one),
        })
    }

    /// All measures of a collection that holds each clip `counts` times.
    pub fn measures(&self, counts: &[u32]) -> [Option<f64>; MEASURES] {
        let all: f64 = counts.iter().map(|&c| f64::from(c)).sum();
        if all == 0.0 {
            return [None; MEASURES];
        }
        let mut right = vec![0.0; self.classes];
        let mut true_count = vec![0.0; self.classes];
        let mut answered = vec![0.0; self.classes];
        let mut loss = 0.0;
        let mut gaps = [0.0; BINS];
        for (clip, &count) in self.clips.iter().zip(counts) {
            let n = f64::from(count);
            true_count[clip.truth] += n;
            answered[clip.answer] += n;
            let hit = f64::from(u8::from(clip.truth == clip.answer));
            right[clip.truth] += n * hit;
            loss += n * clip.loss;
            gaps[clip.bin] += n * (clip.confidence - hit);
        }
        let present: Vec<usize> = (0..self.classes).filter(|&c| true_count[c] > 0.0).collect();
        let mean = |of: &dyn Fn(usize) -> f64| {
            present.iter().map(|&c| of(c)).sum::<f64>() / present.len() as f64
        };
        let (auroc, found) = self.rejection(counts).unzip();
        [
            Some(right.iter().sum::<f64>() / all),
            Some(mean(&|c| right[c] / true_count[c])),
            Some(mean(&|c| 2.0 * right[c] / (true_count[c] + answered[c]))),
            self.probabilistic.then_some(loss / all),
            self.probabilistic
                .then_some(gaps.iter().map(|g: &f64| g.abs()).sum::<f64>() / all),
            auroc,
            found,
        ]
    }

    /// Whether all posteriors sum to one.
    pub fn is_probabilistic(&self) -> bool {
        self.probabilistic
    }

    /// The calibration error if answers were right as `is_right` says of each and its probability.
    pub fn calibration_error(&self, is_right: impl Fn(usize, f64) -> bool) -> f64 {
        let mut gaps = [0.0; BINS];
        for (i, clip) in self.clips.iter().enumerate() {
            let hit = f64::from(u8::from(is_right(i, clip.confidence)));
            gaps[clip.bin] += clip.confidence - hit;
        }
        gaps.iter().map(|g: &f64| g.abs()).sum::<f64>() / self.clips.len() as f64
    }

    /// The area under the curve of rejection, and the share of the unknown that is more novel than nearly all of the
    /// known; `None` without known or without unknown clips.
    fn rejection(&self, counts: &[u32]) -> Option<(f64, f64)> {
        let is_known = |i: usize| self.clips[i].truth + 1 < self.classes;
        let total = |known: bool| -> f64 {
            let of = (0..counts.len()).filter(|&i| is_known(i) == known);
            of.map(|i| f64::from(counts[i])).sum()
        };
        let (known, unknown) = (total(true), total(false));
        if known == 0.0 || unknown == 0.0 {
            return None;
        }
        let (mut known_below, mut unknown_below) = (0.0, 0.0);
        let (mut area, mut missed) = (0.0, unknown);
        let same = |&a: &usize, &b: &usize| self.clips[a].novelty == self.clips[b].novelty;
        for ties in self.by_novelty.chunk_by(same) {
            let (mut known_here, mut unknown_here) = (0.0, 0.0);
            for &i in ties {
                let n = f64::from(counts[i]);
                if is_known(i) {
                    known_here += n;
                } else {
                    unknown_here += n;
                }
            }
            area += unknown_here * (known_below + 0.5 * known_here);
            let kept_before = known_below >= KEPT * known;
            known_below += known_here;
            unknown_below += unknown_here;
            // The limit is the least novelty that keeps enough of the known.
            if !kept_before && known_below >= KEPT * known {
                missed = unknown_below;
            }
        }
        Some((area / (known * unknown), (unknown - missed) / unknown))
    }
}

/// What is wrong with a clip among `primitives` primitives.
fn check(judged: &Judged, primitives: usize) -> std::result::Result<(), String> {
    let p = &judged.posterior;
    if p.primitives.len() != primitives {
        return Err(format!(
            "a posterior of {} primitives, {primitives} in the first clip",
            p.primitives.len()
        ));
    }
    if let Some(t) = judged.truth.filter(|&t| t >= primitives) {
        return Err(format!("the truth is primitive {t} of {primitives}"));
    }
    let mut probabilities = p.primitives.iter().chain([&p.rest, &p.none]);
    if let Some(v) = probabilities.find(|v| !(-SUM_SLACK..=1.0 + SUM_SLACK).contains(*v)) {
        return Err(format!("probabilities are from 0 to 1, found {v}"));
    }
    if judged.novelty.is_nan() {
        return Err("a novelty that is no number".into());
    }
    Ok(())
}
