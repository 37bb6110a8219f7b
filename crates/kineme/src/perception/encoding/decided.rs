//! [`Decided`]: one decision of the paper's method, with all that it was taken from (Figure 7).

use nalgebra::Vector3;

use super::encoder::{Encoder, Seen};
use super::literal::{Literal, Points};
use super::paths::{Chains, EffectorPaths};
use super::result::decisions;
use crate::error::{Error, Result};

/// An unlikeness (square metres) at which likeness has fallen to 1/e: effectors 30 cm off.
const UNLIKE: f64 = 0.09;

/// A decision: the current state is the posture at its start, every primitive predicts from it over the horizon, and
/// the likest prediction takes the interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Decided {
    /// Its beginning, seconds.
    pub start_secs: f64,
    /// Its end, the next one's beginning.
    pub end_secs: f64,
    /// Seconds from one instant to the next.
    pub step_secs: f64,
    /// The primitive that takes it.
    pub winner: usize,
    /// The likeness of each primitive's prediction, in [0, 1].
    pub similarities: Vec<f64>,
    /// The effectors as seen, scaled to the body, at each instant of the horizon, the first that of the decision;
    /// metres in the upright thorax frame, in the order of the encoder's effectors.
    pub seen: Vec<Vec<Option<Vector3<f64>>>>,
    /// The effectors as each primitive predicts them, at the same instants; before the end of the decision, the winner's
    /// are those of the encoded motion.
    pub predicted: Vec<Vec<Vec<Option<Vector3<f64>>>>>,
}

impl Decided {
    /// How many of the instants after the first belong to the decision, not to its horizon alone.
    pub fn instants(&self) -> usize {
        ((self.end_secs - self.start_secs) / self.step_secs).round() as usize
    }
}

impl Encoder<'_> {
    /// The decisions by which [`super::EncodingMethod::Paper`] encodes paths, one after another.
    ///
    /// # Errors
    /// As [`Self::encode`], and when the encoder has another method.
    pub fn decisions(&self, paths: &EffectorPaths) -> Result<Vec<Decided>> {
        let Some(literal) = &self.literal else {
            return Err(Error::invalid(
                "the encoder follows hypotheses; only the paper's method takes decisions",
            ));
        };
        let seen = self.seen(paths)?;
        let start = self.course(&seen).start();
        Ok(self.decided(&seen, literal, start)?.0)
    }

    /// The decisions, and the postures that they append to `start`.
    pub(super) fn decided(
        &self,
        seen: &Seen,
        literal: &Literal,
        start: Vec<f64>,
    ) -> Result<(Vec<Decided>, Vec<Vec<f64>>)> {
        let s = &self.settings;
        let chains = Chains::of(self.vocabulary.body(), &s.effectors)?;
        let factor = self.usual_row_m() / self.usual_unit_m(seen);
        let mut poses = vec![start];
        let mut all = Vec::new();
        for (first, span) in decisions(seen.instants.len()) {
            let last = (first + s.horizon().max(span)).min(seen.instants.len() - 1);
            let ahead = seen.instants[first..=last].iter();
            let ahead: Vec<Points> = ahead
                .map(|points| points.iter().map(|p| p.map(|p| factor * p)).collect())
                .collect();
            let Some(decision) = literal.decide(&chains, &poses[first], &ahead, span, s)? else {
                break;
            };
            let start_secs = first as f64 * s.sample_secs();
            all.push(Decided {
                start_secs,
                end_secs: start_secs + span as f64 * s.sample_secs(),
                step_secs: s.sample_secs(),
                winner: decision.winner,
                similarities: decision.costs.iter().map(|c| (-c / UNLIKE).exp()).collect(),
                seen: ahead,
                predicted: decision.predicted,
            });
            poses.extend(decision.poses);
        }
        Ok((all, poses))
    }
}
