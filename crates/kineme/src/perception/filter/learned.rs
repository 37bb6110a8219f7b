//! What the filter has learned of a vocabulary: how sure to be, and what is unknown.

use super::evidence::{Evidence, Trusts};
use super::recogniser::Filter;
use crate::math::statistics::median;
use crate::primitive::Calibration;

/// The name under which a vocabulary keeps it.
pub(super) const NAME: &str = "filter";
/// The first number kept: what the others mean has changed since they were first kept.
const EDITION: f64 = 4.0;
/// Scores by which the unknown is told.
pub(super) const SCORES: usize = 5;
/// The temperature of real vocabularies.
pub(super) const USUAL_TEMPERATURE: f64 = 1.0;
/// What a clip costs a second at the least, however exactly it was met.
const LEAST_COST: f64 = 5.0;

/// Plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Learned {
    /// Log-likelihoods a second of clips are divided by it and by the root of what they cost at the least
    /// ([`Self::heat`]): how somebody differs lasts through a clip, so that a longer one tells hardly more.
    pub temperature: f64,
    /// How much routes and shapes count.
    pub trusts: Trusts,
    /// Mean and deviation of each score, and its weight in the logarithm of the odds of being unknown.
    pub scores: [[f64; 3]; SCORES],
    /// The constant of those odds.
    pub bias: f64,
    /// Added to the logarithm a second of unknown movement.
    pub unknown_per_sec: f64,
    /// For each primitive, what a clip of it costs a second at most, as a rule.
    pub limits: Vec<f64>,
}

impl Learned {
    /// What holds as long as nothing was learned: means of real vocabularies.
    pub fn usual(primitives: usize) -> Self {
        Self {
            temperature: USUAL_TEMPERATURE,
            trusts: Trusts {
                route: 1.0,
                shape: 0.3,
            },
            scores: [[0.0, 1.0, 0.0]; SCORES],
            bias: -2.0,
            unknown_per_sec: 0.0,
            limits: vec![300.0; primitives],
        }
    }

    /// As a vocabulary keeps it.
    pub fn calibration(&self) -> Calibration {
        let mut shared = vec![
            EDITION,
            self.temperature,
            self.trusts.route,
            self.trusts.shape,
            self.bias,
            self.unknown_per_sec,
        ];
        shared.extend(self.scores.iter().flatten());
        Calibration {
            recogniser: NAME.into(),
            primitives: self.limits.iter().map(|l| vec![*l]).collect(),
            shared,
        }
    }

    /// From what a vocabulary keeps; `None` where that is no such thing.
    pub fn of(calibration: &Calibration) -> Option<Self> {
        let [
            EDITION,
            temperature,
            route,
            shape,
            bias,
            unknown_per_sec,
            scores @ ..,
        ] = calibration.shared.as_slice()
        else {
            return None;
        };
        let scores = <[[f64; 3]; SCORES]>::try_from(scores.as_chunks::<3>().0).ok()?;
        let limit = |numbers: &Vec<f64>| numbers.first().copied().filter(|l| *l > 0.0);
        let valid = *temperature > 0.0 && *route >= 0.0 && *shape >= 0.0;
        let valid = valid && scores.iter().all(|[_, d, _]| *d > 0.0);
        Some(Self {
            temperature: Some(*temperature).filter(|_| valid)?,
            trusts: Trusts {
                route: *route,
                shape: *shape,
            },
            scores,
            bias: *bias,
            unknown_per_sec: *unknown_per_sec,
            limits: calibration
                .primitives
                .iter()
                .map(limit)
                .collect::<Option<_>>()?,
        })
    }

    /// What log-likelihoods of a clip are divided by before they become probabilities.
    pub fn heat(&self, classes: &[f64], evidence: &Evidence) -> f64 {
        self.temperature * unit(classes, evidence.lasts())
    }

    /// The logarithm of the odds that a clip is none of the primitives.
    pub fn unknown(&self, scores: &[f64; SCORES]) -> f64 {
        let terms = scores.iter().zip(&self.scores);
        self.bias
            + terms
                .map(|(s, [mean, deviation, weight])| weight * (s - mean) / deviation)
                .sum::<f64>()
    }
}

/// Log-likelihoods of the primitives: the mean over those of their rows that are not left out. Infinitely unlikely
/// without any.
pub(super) fn classes(filter: &Filter<'_>, of_rows: &[f64], left_out: &[bool]) -> Vec<f64> {
    let rows = &filter.clips.rows;
    let of = |primitive: usize| {
        let own = rows.iter().zip(of_rows).enumerate();
        let own: Vec<f64> = own
            .filter(|(r, (row, _))| row.primitive == primitive && !left_out[*r])
            .map(|(_, (_, e))| *e)
            .collect();
        let most = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if most == f64::NEG_INFINITY {
            return most;
        }
        most + (own.iter().map(|e| (e - most).exp()).sum::<f64>() / own.len() as f64).ln()
    };
    (0..filter.vocabulary.primitives().len()).map(of).collect()
}

/// The unit of temperature: seconds, times the root of what the leading primitive costs a second. A clip that comes near
/// nothing tells less than the same difference of two primitives does where one is met; by the cost itself it would tell
/// too little, as much of that is the same for all.
pub(super) fn unit(classes: &[f64], secs: f64) -> f64 {
    let most = classes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let cost = Some(-most / secs).filter(|c| c.is_finite());
    secs * cost.unwrap_or(LEAST_COST).max(LEAST_COST).sqrt()
}

/// The scores by which the unknown is told: gain over movement of any kind, lead over the second, lead over the median
/// primitive, cost, and cost as a share of what the leading primitive usually costs; all but the last a second.
pub(super) fn scores(classes: &[f64], evidence: &Evidence, limits: &[f64]) -> [f64; SCORES] {
    let secs = evidence.lasts();
    let known: Vec<f64> = classes.iter().copied().filter(|c| c.is_finite()).collect();
    let mut best = 0;
    for (k, c) in classes.iter().enumerate() {
        if *c > classes[best] {
            best = k;
        }
    }
    let first = classes[best];
    let second = classes
        .iter()
        .enumerate()
        .filter(|(k, c)| *k != best && c.is_finite());
    let second = second.map(|(_, c)| *c).fold(f64::NEG_INFINITY, f64::max);
    // With two primitives the second is the only other one: its distance tells nothing of the unknown.
    let lead = |other: f64| {
        if other.is_finite() && classes.len() > 2 {
            (first - other) / secs
        } else {
            0.0
        }
    };
    let cost = -first / secs;
    [
        (first - evidence.broad) / secs,
        lead(second),
        lead(median(&known).unwrap_or(first)),
        cost,
        cost / limits[best],
    ]
}
