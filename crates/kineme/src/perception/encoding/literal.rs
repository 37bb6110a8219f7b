//! Trajectory encoding as section V-B of the paper words it.
//!
//! The current state is one posture, that at the end of what was encoded so far; each primitive's memoryless flowfield
//! predicts from it over the horizon; the prediction that matches the observed effectors best takes the decision, whatever
//! the match, and is appended to the encoded motion.

use nalgebra::Vector3;

use super::paths::Chains;
use super::settings::{EncodingSettings, Matching};
use crate::error::Result;
use crate::primitive::{FlowSettings, Flowfield, Vocabulary};

/// Effectors of one instant, metres on the body.
pub(super) type Points = Vec<Option<Vector3<f64>>>;

/// The primitives' flowfields.
#[derive(Debug, Clone)]
pub(super) struct Literal {
    fields: Vec<Flowfield>,
}

/// What was decided.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Decision {
    /// The unlikeness of each primitive's prediction.
    pub costs: Vec<f64>,
    /// The primitive that took it.
    pub winner: usize,
    /// The winner's postures, one an instant.
    pub poses: Vec<Vec<f64>>,
    /// What each primitive predicts, at all instants looked at.
    pub predicted: Vec<Vec<Points>>,
}

impl Literal {
    pub fn of(vocabulary: &Vocabulary) -> Result<Self> {
        let primitives = vocabulary.primitives().iter();
        let fields = primitives.map(|p| Flowfield::of(p, &FlowSettings::paper()));
        Ok(Self {
            fields: fields.collect::<Result<_>>()?,
        })
    }

    /// Decides on the `span` instants after the first of `seen`, looking at all of them.
    pub fn decide(
        &self,
        chains: &Chains<'_>,
        pose: &[f64],
        seen: &[Points],
        span: usize,
        s: &EncodingSettings,
    ) -> Result<Option<Decision>> {
        let rate = 1.0 / s.sample_secs();
        let mut costs = Vec::with_capacity(self.fields.len());
        let mut all = Vec::with_capacity(self.fields.len());
        let mut best: Option<(f64, usize, Vec<Vec<f64>>)> = None;
        for (k, field) in self.fields.iter().enumerate() {
            let state = field.enter(pose)?;
            let states = field.predict(&state, (seen.len() - 1) as f64 / rate, rate)?;
            let mut predicted = vec![chains.posture(pose).0];
            predicted.extend(states.iter().map(|state| chains.posture(state.pose()).0));
            let cost = unlikeness(&predicted, seen, s.matching, s.sample_secs());
            costs.push(cost);
            all.push(predicted);
            if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                let poses = states[..span].iter().map(|state| state.pose().to_vec());
                best = Some((cost, k, poses.collect()));
            }
        }
        Ok(best.map(|(_, winner, poses)| Decision {
            costs,
            winner,
            poses,
            predicted: all,
        }))
    }
}

/// How unlike a predicted and an observed path are: square metres; for velocities 1 less the mean likeness.
fn unlikeness(predicted: &[Points], seen: &[Points], matching: Matching, secs: f64) -> f64 {
    match matching {
        Matching::Position => mean(predicted, seen, |at, e| {
            Some((predicted[at][e]? - seen[at][e]?).norm_squared())
        }),
        Matching::Displacement => mean(predicted, seen, |at, e| {
            let moved = |path: &[Points]| Some(path[at][e]? - path[0][e]?);
            Some((moved(predicted)? - moved(seen)?).norm_squared())
        }),
        Matching::Velocity => mean(predicted, seen, |at, e| {
            let velocity = |path: &[Points]| Some((path[at][e]? - path[at - 1][e]?) / secs);
            let (a, b) = (velocity(predicted)?, velocity(seen)?);
            let (slow, fast) = (a.norm().min(b.norm()), a.norm().max(b.norm()));
            // At rest together is alike.
            const STILL: f64 = 0.02;
            let alike = match fast < STILL {
                true => 1.0,
                false => a.dot(&b) / (a.norm() * b.norm()).max(1e-12) * slow / fast,
            };
            Some(1.0 - alike)
        }),
        Matching::Warped => warped(predicted, seen),
    }
}

/// The mean over effectors and all instants but the first, of what was seen.
fn mean(predicted: &[Points], seen: &[Points], gap: impl Fn(usize, usize) -> Option<f64>) -> f64 {
    let places = (1..predicted.len()).flat_map(|at| (0..seen[at].len()).map(move |e| (at, e)));
    let (mut sum, mut count) = (0.0, 0.0);
    for gap in places.filter_map(|(at, e)| gap(at, e)) {
        sum += gap;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// The mean squared distance along the best warp of one path's time to the other's (Sakoe and Chiba 1978).
fn warped(predicted: &[Points], seen: &[Points]) -> f64 {
    let local = |i: usize, k: usize| -> f64 {
        let pairs = predicted[i].iter().zip(&seen[k]);
        let gaps = pairs.filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).norm_squared()));
        let gaps: Vec<f64> = gaps.collect();
        gaps.iter().sum::<f64>() / gaps.len().max(1) as f64
    };
    let (n, m) = (predicted.len(), seen.len());
    let mut sums = vec![f64::INFINITY; (n + 1) * (m + 1)];
    sums[0] = 0.0;
    for i in 1..=n {
        for k in 1..=m {
            let before = [(i - 1, k), (i, k - 1), (i - 1, k - 1)];
            let least = before.map(|(a, b)| sums[a * (m + 1) + b]);
            let least = least.into_iter().fold(f64::INFINITY, f64::min);
            sums[i * (m + 1) + k] = least + local(i - 1, k - 1);
        }
    }
    sums[n * (m + 1) + m] / n.max(m) as f64
}
