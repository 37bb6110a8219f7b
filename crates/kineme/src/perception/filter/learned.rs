//! What the filter learns of a vocabulary by leaving exemplars out: how sure to be, and what is unknown.

use rayon::prelude::*;

use super::evidence::Evidence;
use super::logistic::logistic;
use super::recogniser::Filter;
use crate::error::Result;
use crate::math::statistics::{median, quantile};
use crate::primitive::{Calibration, Observations, ParameterSource, Vocabulary};

/// The name under which a vocabulary keeps it.
pub(super) const NAME: &str = "filter";
/// The first number kept: what the others mean has changed since they were first kept.
const EDITION: f64 = 3.0;
/// Scores by which the unknown is told.
pub(super) const SCORES: usize = 5;
/// At most so many exemplars are left out, and at most so many moments of rows are compared for it.
const MOST_FOLDS: usize = 160;
const MOST_COMPARED: f64 = 1.5e8;
const LEAST_FOLDS: usize = 24;
/// How much a squared distance of routes may count a second; at most as much as one of the body's directions.
const ROUTE_TRUSTS: [f64; 4] = [0.0, 0.3, 1.0, 3.0];
/// The temperature of real vocabularies, and what it costs, in logarithms of probability, to be fitted e times off: where
/// one person gave all exemplars, nothing that is left out is hard, and nothing is learned of others.
const USUAL_TEMPERATURE: f64 = 1.0;
const TEMPERATURE_PRIOR: f64 = 10.0;
/// What a clip costs a second at the least, however exactly it was met.
const LEAST_COST: f64 = 5.0;
/// What this share of clips costs at most is usual.
const KEPT: f64 = 0.95;
/// This share of the exemplars that are left out is to be called by its name, with so much to spare in logarithms of
/// odds.
const CALLED: f64 = 0.98;
const MARGIN: f64 = 2.0;

/// Plain numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Learned {
    /// Log-likelihoods a second of clips are divided by it and by the root of what they cost at the least
    /// ([`Self::heat`]): how somebody differs lasts through a clip, so that a longer one tells hardly more.
    pub temperature: f64,
    /// How much a squared distance of routes counts a second: where people went their own ways, hardly at all.
    pub route_trust: f64,
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
            route_trust: 1.0,
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
            self.route_trust,
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
            route_trust,
            bias,
            unknown_per_sec,
            scores @ ..,
        ] = calibration.shared.as_slice()
        else {
            return None;
        };
        let scores = <[[f64; 3]; SCORES]>::try_from(scores.as_chunks::<3>().0).ok()?;
        let limit = |numbers: &Vec<f64>| numbers.first().copied().filter(|l| *l > 0.0);
        let positive = *temperature > 0.0 && scores.iter().all(|[_, d, _]| *d > 0.0);
        Some(Self {
            temperature: Some(*temperature).filter(|_| positive)?,
            route_trust: Some(*route_trust).filter(|t| *t >= 0.0)?,
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
fn unit(classes: &[f64], secs: f64) -> f64 {
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

/// A clip of which something is left out: the primitives' log-likelihoods, the unit of their temperature, the clip, and
/// its true primitive if that is among them.
struct Trial {
    classes: Vec<f64>,
    unit: f64,
    fold: usize,
    truth: Option<usize>,
}

/// Learns from a vocabulary's own exemplars.
///
/// Each is left out three times: alone, and it stands for a known movement of somebody known; with the half of every
/// primitive's exemplars that is nearest to it, which are by the same person if persons there are, and it stands for a
/// known movement of somebody new; and with its whole primitive, and it stands for something unknown. `kept` has limits
/// that are not to change.
pub(super) fn learn(filter: &Filter<'_>, kept: &[Option<f64>]) -> Result<Learned> {
    let vocabulary = filter.vocabulary;
    let folds = folds(filter);
    let evidences: Vec<Evidence> = folds
        .par_iter()
        .map(|&(k, i)| {
            let motion = vocabulary.primitives()[k].exemplars()[i].motion.clone();
            filter.evidence(&Observations::complete(motion))
        })
        .collect::<Result<_>>()?;
    let usual = Learned::usual(vocabulary.primitives().len());
    let trusted = |trust: f64| {
        let trials = trials(filter, &folds, &evidences, trust);
        (trust, temperature(&trials), trials)
    };
    let candidates = ROUTE_TRUSTS.map(trusted);
    let told = |c: &(f64, Option<(f64, f64)>, Vec<Trial>)| c.1.map_or(0.0, |(_, loss)| loss);
    let routed = evidences.iter().any(|e| e.routes.is_some());
    let best = match candidates.iter().all(|c| c.1.is_some()) && routed {
        true => candidates
            .into_iter()
            .min_by(|a, b| told(a).total_cmp(&told(b))),
        false => None,
    };
    let (route_trust, fitted, trials) = best.unwrap_or_else(|| trusted(usual.route_trust));
    let limits = limits(vocabulary, &trials, &evidences, kept, &usual);
    let temperature = fitted
        .map(|(temperature, _)| temperature)
        .or_else(|| Some(chance_lead(&trials)?.max(usual.temperature)))
        .unwrap_or(usual.temperature);
    let mut learned = Learned {
        temperature,
        route_trust,
        limits,
        ..usual
    };
    let possible = |t: &&Trial| t.classes.iter().any(|c| c.is_finite());
    let told: Vec<([f64; SCORES], bool)> = trials
        .iter()
        .filter(possible)
        .map(|t| {
            (
                scores(&t.classes, &evidences[t.fold], &learned.limits),
                t.truth.is_none(),
            )
        })
        .collect();
    if told.iter().any(|t| t.1) && told.iter().any(|t| !t.1) {
        (learned.scores, learned.bias) = logistic(&told);
        // Whatever that costs of the unknown, the known are to be called by their name: the odds of being unknown stay
        // below the probability of the leading primitive, with a margin as people come who differ more than those seen.
        let bare = Learned {
            bias: 0.0,
            ..learned.clone()
        };
        let room: Vec<f64> = trials
            .iter()
            .filter(possible)
            .zip(&told)
            .filter(|(t, _)| t.truth.is_some())
            .map(|(t, (scores, _))| {
                -loss(&t.classes, None, temperature * t.unit) - bare.unknown(scores)
            })
            .collect();
        let keeping = quantile(&room, 1.0 - CALLED).unwrap_or(learned.bias);
        learned.bias = learned.bias.min(keeping - MARGIN);
    }
    // Streams know no route.
    let by_postures = self::trials(filter, &folds, &evidences, 0.0);
    let gains = |unknown: bool| -> Vec<f64> {
        let of = by_postures.iter().filter(possible);
        of.filter(|t| t.truth.is_none() == unknown)
            .map(|t| scores(&t.classes, &evidences[t.fold], &learned.limits)[0])
            .collect()
    };
    let (known, unknown) = (gains(false), gains(true));
    learned.unknown_per_sec = match (quantile(&known, 1.0 - KEPT), median(&unknown)) {
        // Between what the least of the known gains over movement of any kind, and what the unknown gains.
        (Some(low), Some(high)) => 0.5 * (low + low.min(high)),
        // Of single exemplars nobody knows what the known gain, but they gain more than the unknown.
        (None, Some(high)) => high.min(usual.unknown_per_sec),
        _ => usual.unknown_per_sec,
    };
    Ok(learned)
}

/// The exemplars that are left out, evenly taken: primitive and exemplar.
fn folds(filter: &Filter<'_>) -> Vec<(usize, usize)> {
    let primitives = filter.vocabulary.primitives().iter().enumerate();
    let all: Vec<(usize, usize)> = primitives
        .flat_map(|(k, p)| (0..p.exemplars().len()).map(move |i| (k, i)))
        .collect();
    let secs = |&(k, i): &(usize, usize)| {
        filter.vocabulary.primitives()[k].exemplars()[i]
            .motion
            .duration_secs()
    };
    let frames = all.iter().map(secs).sum::<f64>() * filter.settings.clock_hz / all.len() as f64;
    let states: usize = filter.clips.rows.iter().map(|r| r.phases.len()).sum();
    let affordable = (MOST_COMPARED / (frames * states as f64).max(1.0)) as usize;
    let count = all.len().min(affordable.clamp(LEAST_FOLDS, MOST_FOLDS));
    (0..count).map(|f| all[f * all.len() / count]).collect()
}

/// Whether the parameters of a primitive were found in what people did, not chosen.
fn principal(vocabulary: &Vocabulary, primitive: usize) -> bool {
    let source = vocabulary.primitives()[primitive].parameters().source();
    matches!(source, ParameterSource::Principal { .. })
}

fn trials(
    filter: &Filter<'_>,
    folds: &[(usize, usize)],
    evidences: &[Evidence],
    route_trust: f64,
) -> Vec<Trial> {
    let rows = &filter.clips.rows;
    let mut trials = Vec::new();
    for (fold, (&(k, i), evidence)) in folds.iter().zip(evidences).enumerate() {
        let alone: Vec<bool> = rows
            .iter()
            .map(|r| r.primitive == k && r.exemplar == Some(i))
            .collect();
        let weighed = evidence.weighed(route_trust);
        let mut trial = |left_out: &[bool], truth: Option<usize>| {
            let classes = classes(filter, &weighed, left_out);
            trials.push(Trial {
                unit: unit(&classes, evidence.lasts()),
                classes,
                fold,
                truth,
            });
        };
        let others = (0..rows.len()).filter(|&r| rows[r].primitive == k && !alone[r]);
        if others.count() > 0 {
            trial(&alone, Some(k));
            // A grid of parameters is nobody's: its exemplars are by one hand.
            if principal(filter.vocabulary, k) {
                trial(&nearest_half(filter, &weighed, &alone), Some(k));
            }
        }
        let whole: Vec<bool> = rows.iter().map(|r| r.primitive == k).collect();
        trial(&whole, None);
    }
    trials
}

/// Leaves out the half of each primitive's rows that is likeliest beside those that are left out already. Rivals lose
/// theirs as well: whoever is new is so in all movements.
fn nearest_half(filter: &Filter<'_>, of_rows: &[f64], left_out: &[bool]) -> Vec<bool> {
    let rows = &filter.clips.rows;
    let mut all = left_out.to_vec();
    for k in 0..filter.vocabulary.primitives().len() {
        if !principal(filter.vocabulary, k) {
            continue;
        }
        let mut own: Vec<usize> = (0..rows.len())
            .filter(|&r| rows[r].primitive == k && !left_out[r])
            .collect();
        own.sort_by(|&a, &b| of_rows[b].total_cmp(&of_rows[a]));
        for &r in &own[..own.len() / 2] {
            all[r] = true;
        }
    }
    all
}

/// What clips of each primitive cost at most, as a rule; of primitives that say nothing the median of the others.
fn limits(
    vocabulary: &Vocabulary,
    trials: &[Trial],
    evidences: &[Evidence],
    kept: &[Option<f64>],
    usual: &Learned,
) -> Vec<f64> {
    let costs = |k: usize| -> Vec<f64> {
        let own = trials.iter().filter(|t| t.truth == Some(k));
        own.map(|t| -t.classes[k] / evidences[t.fold].lasts())
            .collect()
    };
    let of = |k: usize| quantile(&costs(k), KEPT).filter(|l| *l > 0.0);
    let found: Vec<Option<f64>> = (0..vocabulary.primitives().len())
        .map(|k| kept.get(k).copied().flatten().or_else(|| of(k)))
        .collect();
    let known: Vec<f64> = found.iter().copied().flatten().collect();
    let middle = median(&known).unwrap_or(usual.limits[0]);
    found.into_iter().map(|l| l.unwrap_or(middle)).collect()
}

/// The temperature at which the truth is most probable, and what it then costs; `None` without known trials or rivals.
fn temperature(trials: &[Trial]) -> Option<(f64, f64)> {
    let known: Vec<(&Trial, usize)> = trials
        .iter()
        .filter_map(|t| Some((t, t.truth?)))
        .filter(|(t, _)| t.classes.len() > 1)
        .collect();
    if known.is_empty() {
        return None;
    }
    let all = |t: f64| -> f64 {
        let of =
            |(trial, truth): &(&Trial, usize)| loss(&trial.classes, Some(*truth), t * trial.unit);
        let off = (t / USUAL_TEMPERATURE).ln();
        known.iter().map(of).sum::<f64>() + TEMPERATURE_PRIOR * off * off
    };
    let candidates = (0..=60).map(|k| 10f64.powf(-1.5 + 3.0 * f64::from(k) / 60.0));
    let with_loss = candidates.map(|t| (t, all(t)));
    with_loss.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// How far the likeliest of wrong answers leads the second, as a rule, in units of temperature: less than that tells nothing.
/// It stands for the temperature where every primitive has one exemplar, and nothing known can be left out. `None` where
/// less than three primitives are.
fn chance_lead(trials: &[Trial]) -> Option<f64> {
    let lead = |trial: &Trial| {
        let mut classes = trial.classes.clone();
        classes.sort_by(|a, b| b.total_cmp(a));
        let [first, second] = *classes.first_chunk()?;
        Some((first - second) / trial.unit).filter(|lead| lead.is_finite())
    };
    let unknown = trials.iter().filter(|t| t.truth.is_none());
    median(&unknown.filter_map(lead).collect::<Vec<f64>>())
}

/// Less the logarithm of a primitive's probability among all, of the most probable one if none is named.
fn loss(classes: &[f64], of: Option<usize>, temperature: f64) -> f64 {
    let most = classes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = classes
        .iter()
        .map(|c| ((c - most) / temperature).exp())
        .sum();
    sum.ln() - of.map_or(0.0, |k| (classes[k] - most) / temperature)
}
