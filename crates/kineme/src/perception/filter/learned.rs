//! What the filter has learned of a vocabulary: how sure to be, and what is unknown.

use std::f64::consts::PI;

use super::evidence::{Evidence, Trusts};
use super::recogniser::Filter;
use crate::math::statistics::median;
use crate::perception::temperature::LogNormal;
use crate::primitive::Calibration;

/// The name under which a vocabulary keeps it.
pub(super) const NAME: &str = "filter";
/// The first number kept: what the others mean has changed since they were first kept.
const EDITION: f64 = 6.0;
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
    /// The deviation of its natural logarithm: how much less or more alike the next person may be. 0: it is known.
    pub spread: f64,
    /// How much routes and shapes count.
    pub trusts: Trusts,
    /// Mean and deviation of each score, and its weight in the logarithm of the odds of being unknown.
    pub scores: [[f64; 3]; SCORES],
    /// The constant of those odds.
    pub bias: f64,
    /// The covariance of those weights and, last, the constant: how sure the odds are. 0: they are known.
    pub covariance: [[f64; SCORES + 1]; SCORES + 1],
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
            spread: 0.0,
            trusts: Trusts {
                route: 1.0,
                shape: 0.3,
            },
            scores: [[0.0, 1.0, 0.0]; SCORES],
            bias: -2.0,
            covariance: [[0.0; SCORES + 1]; SCORES + 1],
            unknown_per_sec: 0.0,
            limits: vec![300.0; primitives],
        }
    }

    /// As a vocabulary keeps it.
    pub fn calibration(&self) -> Calibration {
        let mut shared = vec![
            EDITION,
            self.temperature,
            self.spread,
            self.trusts.route,
            self.trusts.shape,
            self.bias,
            self.unknown_per_sec,
        ];
        shared.extend(self.scores.iter().flatten());
        shared.extend(self.covariance.iter().flatten());
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
            spread,
            route,
            shape,
            bias,
            unknown_per_sec,
            rest @ ..,
        ] = calibration.shared.as_slice()
        else {
            return None;
        };
        let (scores, covariance) = rest.split_at_checked(3 * SCORES)?;
        let scores = <[[f64; 3]; SCORES]>::try_from(scores.as_chunks::<3>().0).ok()?;
        let covariance = covariance.as_chunks::<{ SCORES + 1 }>().0;
        let covariance = <[[f64; SCORES + 1]; SCORES + 1]>::try_from(covariance).ok()?;
        let limit = |numbers: &Vec<f64>| numbers.first().copied().filter(|l| *l > 0.0);
        let valid = *temperature > 0.0 && *spread >= 0.0 && *route >= 0.0 && *shape >= 0.0;
        let valid = valid && scores.iter().all(|[_, d, _]| *d > 0.0);
        Some(Self {
            temperature: Some(*temperature).filter(|_| valid)?,
            spread: *spread,
            trusts: Trusts {
                route: *route,
                shape: *shape,
            },
            scores,
            bias: *bias,
            covariance,
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

    /// How probable each primitive is if the clip is one of them: the mean over what the temperature may be.
    pub fn shares(&self, classes: &[f64], unit: f64) -> Vec<f64> {
        let most = classes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let believed = LogNormal {
            mean: self.temperature,
            spread: self.spread,
        };
        believed.mean_of(classes.len(), |temperature| {
            let weight = |c: &f64| ((c - most) / (unit * temperature)).exp();
            let weights: Vec<f64> = classes.iter().map(weight).collect();
            let sum: f64 = weights.iter().sum();
            weights.into_iter().map(|w| w / sum).collect()
        })
    }

    /// The same odds as far as they can be trusted: nearer to even the less the exemplars say of such scores (MacKay 1992,
    /// the evidence framework applied to classification: moderated outputs).
    pub fn moderated(&self, scores: &[f64; SCORES]) -> f64 {
        let mut x = [1.0; SCORES + 1];
        for ((x, s), [mean, deviation, _]) in x.iter_mut().zip(scores).zip(&self.scores) {
            *x = (s - mean) / deviation;
        }
        let rows = self.covariance.iter().zip(&x);
        let variance: f64 = rows
            .map(|(row, a)| a * row.iter().zip(&x).map(|(c, b)| c * b).sum::<f64>())
            .sum();
        self.unknown(scores) / (1.0 + PI / 8.0 * variance).sqrt()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn learned(spread: f64, variance: f64) -> Learned {
        let mut covariance = [[0.0; SCORES + 1]; SCORES + 1];
        for (i, row) in covariance.iter_mut().enumerate() {
            row[i] = variance;
        }
        Learned {
            temperature: 0.8,
            spread,
            scores: [[1.0, 2.0, 0.5]; SCORES],
            covariance,
            ..Learned::usual(3)
        }
    }

    #[test]
    fn what_is_kept_is_what_was_learned_and_older_numbers_are_not() {
        let wanted = learned(0.6, 0.3);
        let kept = wanted.calibration();
        assert_eq!(Learned::of(&kept), Some(wanted));
        for (place, value) in [(0, EDITION - 1.0), (1, 0.0), (2, -0.1)] {
            let mut other = kept.clone();
            other.shared[place] = value;
            assert_eq!(Learned::of(&other), None, "number {place} is {value}");
        }
        let mut short = kept.clone();
        short.shared.pop();
        assert_eq!(Learned::of(&short), None, "a number less");
    }

    #[test]
    fn a_spread_of_temperatures_keeps_the_order_and_gives_the_unlikely_more() {
        let classes = [-3.0, -15.0, -4.0];
        let (sure, unsure) = (
            learned(0.0, 0.0).shares(&classes, 1.5),
            learned(0.7, 0.0).shares(&classes, 1.5),
        );
        let weights = classes.map(|c: f64| (c / 1.2).exp());
        let sum: f64 = weights.iter().sum();
        for k in 0..3 {
            assert!((sure[k] - weights[k] / sum).abs() < 1e-12, "{sure:?}");
        }
        assert!((unsure.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(unsure[0] > unsure[2] && unsure[2] > unsure[1], "{unsure:?}");
        // The far tail is ruled by the highest temperatures.
        assert!(unsure[1] > 5.0 * sure[1], "{unsure:?} and {sure:?}");
    }

    #[test]
    fn moderated_odds_are_the_mean_probability_over_what_the_weights_may_be() {
        for (at, variance) in [(1.0, 0.0), (3.0, 0.2), (-5.0, 0.2), (9.0, 0.5)] {
            let l = learned(0.0, variance);
            let scores = [at; SCORES];
            let (plain, moderated) = (l.unknown(&scores), l.moderated(&scores));
            let x = (at - 1.0) / 2.0;
            let deviation = (variance * (SCORES as f64 * x * x + 1.0)).sqrt();
            let (mut sum, mut all) = (0.0, 0.0);
            for z in (-600..=600).map(|k| 0.01 * f64::from(k)) {
                let density = (-0.5_f64 * z * z).exp();
                sum += density / (1.0 + (-plain - deviation * z).exp());
                all += density;
            }
            let found = 1.0 / (1.0 + (-moderated).exp());
            let mean = sum / all;
            assert!((found - mean).abs() < 0.02, "{at}: {found} for {mean}");
            assert!(plain * moderated >= 0.0 && moderated.abs() <= plain.abs());
        }
    }
}
