//! [`Rejection`]: what is too unlike everything known. Fitted to the vocabulary's own exemplars, each of which stands in
//! for the unknown while its primitive is left out.

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

use super::chains::{Ends, FAR, chain, class_costs, shares};
use super::confidence::Confidence;
use super::cost::{blocks, instants};
use super::extrapolation::background;
use super::outline::{Outlines, sums};
use super::paths::EffectorPaths;
use super::rows::Row;
use super::settings::{EncodingSettings, REACH_UNITS};
use crate::error::{Error, Result};
use crate::math::statistics::{median, quantile};
use crate::primitive::Vocabulary;

/// Scores that are weighed.
pub const SCORES: usize = 5;
/// Exemplars that are encoded to fit it, at most.
const MOST_CASES: usize = 120;
/// Cases on either side without which nothing is fitted.
const LEAST_CASES: usize = 8;
/// The share of the known that limits admit.
const ADMITTED: f64 = 0.95;
/// The share of the known that is kept, should even odds keep less: people differ more than exemplars tell.
const KEPT: f64 = 0.97;
/// The weight of a limit alone, where nothing can be fitted: probability 0.9 at a cost of 0.7 of the limit.
const LIMIT_WEIGHT: f64 = 6.0;
/// The cost that bounds a primitive where no exemplar can be held against another, in units.
const PLAIN_LIMIT: f64 = 0.5;
/// Ridge of the weights of standardised scores.
const RIDGE: f64 = 1.0;
/// Temperatures that are tried where the nearer half of a primitive is not known.
const TEMPERATURES: [f64; 12] = [
    0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06, 0.08, 0.12, 0.18, 0.25,
];

/// When a movement is none of the primitives, and how sure the choice among them is: plain numbers, valid for the
/// vocabulary and the settings to which they were fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Rejection {
    /// The cost that 95 % of a primitive's own exemplars stay below when the nearer half of the others is not known.
    pub limits: Vec<f64>,
    /// The same of all primitives together: what a decision of an unknown movement costs.
    pub limit: f64,
    /// Temperature of the posterior over the primitives where the nearer half of the true one is not known: of streams,
    /// and of what refusing may cost.
    pub temperature: f64,
    /// Temperature of the posterior of a clip.
    pub confidence: Confidence,
    /// Log odds of being known: `bias` plus these times cost, margin to the second primitive, logarithm of the median
    /// primitive over the best, of extrapolation over the best, and of the best one's limit over its cost.
    pub weights: [f64; SCORES],
    /// Log odds at scores of 0.
    pub bias: f64,
}

/// What is known of a motion before it is judged.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Evidence {
    /// Cost of each primitive; [`FAR`] where it is not in play.
    pub costs: Vec<f64>,
    /// Cost of the best extrapolation.
    pub background: f64,
}

impl Evidence {
    /// The best primitive.
    pub fn best(&self) -> Option<usize> {
        let costs = self.costs.iter().enumerate();
        let alive = costs.filter(|(_, c)| **c < FAR);
        alive.min_by(|a, b| a.1.total_cmp(b.1)).map(|(k, _)| k)
    }

    fn scores(&self, limits: &[f64]) -> Option<[f64; SCORES]> {
        const LEAST: f64 = 1e-3;
        let best = self.best()?;
        let cost = self.costs[best];
        let others = self.costs.iter().enumerate();
        let others: Vec<f64> = others
            .filter(|(k, c)| *k != best && **c < FAR)
            .map(|(_, c)| *c)
            .collect();
        let second = others.iter().copied().fold(FAR, f64::min);
        let over = |value: f64| (value.max(LEAST) / cost.max(LEAST)).ln();
        Some([
            cost,
            if second < FAR { second - cost } else { 0.0 },
            median(&others).map_or(0.0, over),
            over(self.background),
            over(limits[best]),
        ])
    }
}

fn product(weights: &[f64; SCORES], scores: &[f64; SCORES]) -> f64 {
    weights.iter().zip(scores).map(|(w, s)| w * s).sum()
}

/// A score that speaks for the known has weight of this sign.
const SIGNS: [f64; SCORES] = [-1.0, 1.0, 1.0, 1.0, 1.0];

impl Rejection {
    /// The probability that a movement is none of the primitives.
    pub(super) fn none(&self, evidence: &Evidence) -> f64 {
        let Some(scores) = evidence.scores(&self.limits) else {
            return 1.0;
        };
        let odds = self.bias + product(&self.weights, &scores);
        1.0 / (1.0 + odds.exp())
    }

    /// The same numbers for a vocabulary, or that they are not of it.
    pub(super) fn checked(self, vocabulary: &Vocabulary) -> Result<Self> {
        let numbers = self.limits.iter().chain(&self.weights);
        let Confidence {
            temperature,
            spread,
        } = &self.confidence;
        let finite = numbers
            .chain([&self.limit, &self.temperature, &self.bias])
            .chain([temperature, spread])
            .all(|v| v.is_finite());
        let shared = [&self.limit, &self.temperature, temperature];
        let positive = self.limits.iter().chain(shared);
        if self.limits.len() != vocabulary.primitives().len()
            || !finite
            || *spread < 0.0
            || positive.into_iter().any(|v| *v <= 0.0)
        {
            return Err(Error::invalid(format!(
                "a rejection of {} limits, finite and above 0, was fitted to another vocabulary than one of {} primitives",
                self.limits.len(),
                vocabulary.primitives().len()
            )));
        }
        Ok(self)
    }

    /// Fits to the exemplars of a vocabulary, at most 120 of them, evenly chosen. Who performed an exemplar is not known;
    /// the nearer half of its primitive's others stands for the same person and is left out. A
    /// primitive's limit that is given stays as it is.
    pub(super) fn fit(
        vocabulary: &Vocabulary,
        (rows, outlines): (&[Row], Option<&Outlines>),
        s: &EncodingSettings,
        given: &[Option<f64>],
    ) -> Result<Self> {
        let primitives = vocabulary.primitives().len();
        let kept = rows.len().min(MOST_CASES);
        let cases: Vec<Case> = (0..kept)
            .into_par_iter()
            .map(|k| Case::of(vocabulary, (rows, outlines), k * rows.len() / kept, s))
            .collect::<Result<_>>()?;
        let own: Vec<Vec<f64>> = (0..primitives)
            .map(|p| {
                let of = cases.iter().filter(|c| c.primitive == p);
                of.filter_map(|c| Some(c.known.as_ref()?.costs[p]))
                    .collect()
            })
            .collect();
        let limits: Vec<Option<f64>> = own.iter().map(|costs| quantile(costs, ADMITTED)).collect();
        let seen: Vec<f64> = limits.iter().flatten().copied().collect();
        let usual = median(&seen).unwrap_or(PLAIN_LIMIT).max(1e-3);
        // Few exemplars tell a quantile badly: half-way to the usual one.
        let limits: Vec<f64> = limits
            .iter()
            .enumerate()
            .map(|(p, l)| {
                let fitted = l.map_or(usual, |l| (l.max(1e-3) * usual).sqrt());
                given.get(p).copied().flatten().unwrap_or(fitted)
            })
            .collect();
        let limit = quantile(&own.concat(), ADMITTED).unwrap_or(usual).max(1e-3);
        let scores = |evidence: Option<&Evidence>| evidence.and_then(|e| e.scores(&limits));
        let known: Vec<_> = cases
            .iter()
            .filter_map(|c| scores(c.known.as_ref()))
            .collect();
        let unknown: Vec<_> = cases
            .iter()
            .filter_map(|c| scores(c.unknown.as_ref()))
            .collect();
        let temperature = temperature(&cases);
        let alone = cases
            .iter()
            .filter_map(|c| Some((c.alone.as_deref()?, c.primitive)));
        let confidence = Confidence::learned(&alone.collect::<Vec<_>>());
        let (weights, bias) = match known.len().min(unknown.len()) >= LEAST_CASES {
            true => {
                let (weights, bias) = logistic(&known, &unknown);
                // The best primitive must be likelier than none, however it shares with others.
                let odds = cases.iter().filter_map(|c| {
                    let evidence = c.known.as_ref()?;
                    let all = shares(&evidence.costs, temperature);
                    let best = all[evidence.best()?].max(1e-12);
                    Some(bias + product(&weights, &evidence.scores(&limits)?) + best.ln())
                });
                let least = quantile(&odds.collect::<Vec<_>>(), 1.0 - KEPT).unwrap_or(0.0);
                (weights, bias - least.min(0.0))
            }
            false => ([0.0, 0.0, 0.0, 0.0, LIMIT_WEIGHT], 0.0),
        };
        Ok(Self {
            confidence: confidence.unwrap_or(Confidence {
                temperature,
                spread: 0.0,
            }),
            temperature,
            limits,
            limit,
            weights,
            bias,
        })
    }
}

/// An exemplar encoded by the others.
struct Case {
    primitive: usize,
    /// The costs without itself, of chains and outlines; `None` for a primitive of one exemplar, and where there is no
    /// other primitive.
    alone: Option<Vec<f64>>,
    /// Without itself and the nearer half of its primitive; `None` for a primitive of one exemplar.
    known: Option<Evidence>,
    /// Without its primitive; `None` where there is no other.
    unknown: Option<Evidence>,
}

impl Case {
    fn of(
        vocabulary: &Vocabulary,
        (rows, outlines): (&[Row], Option<&Outlines>),
        row: usize,
        s: &EncodingSettings,
    ) -> Result<Self> {
        let primitives = vocabulary.primitives();
        let own = rows[row].primitive;
        let motion = &primitives[own].exemplars()[rows[row].exemplar].motion;
        let paths = EffectorPaths::of_motion(motion, &s.effectors, s.heading_secs)?;
        let instants = instants(&paths, 1.0, s);
        let blocks = blocks(&instants, s);
        let unit_m = paths.reach_m().unwrap_or(1.0) / REACH_UNITS;
        let costs: Vec<f64> = rows
            .iter()
            .map(|r| chain(r, (&blocks, unit_m), Ends::Whole, s))
            .collect();
        let mut near: Vec<usize> = (0..rows.len())
            .filter(|&r| rows[r].primitive == own && r != row)
            .collect();
        near.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
        let others = near.len();
        near.truncate(others / 2);
        let background = background(&instants, &blocks, unit_m, s);
        let of = |costs: &[f64], counts: &dyn Fn(usize) -> bool| {
            class_costs(rows, costs, primitives.len(), s.temperature, counts)
        };
        let evidence = |counts: &dyn Fn(usize) -> bool| Evidence {
            costs: of(&costs, counts),
            background,
        };
        let with_outlines = outlines.and_then(|o| Some(sums(&costs, &o.costs(&paths, unit_m)?)));
        let whole = with_outlines.as_deref().unwrap_or(&costs);
        let seen = !blocks.is_empty();
        Ok(Self {
            primitive: own,
            alone: (seen && others > 0 && primitives.len() > 1).then(|| of(whole, &|r| r != row)),
            known: (seen && others > 0).then(|| evidence(&|r| r != row && !near.contains(&r))),
            unknown: (seen && primitives.len() > 1)
                .then(|| evidence(&|r| rows[r].primitive != own)),
        })
    }
}

/// The temperature under which the known cases are likeliest.
fn temperature(cases: &[Case]) -> f64 {
    let surprise = |t: f64| -> f64 {
        let known = cases
            .iter()
            .filter_map(|c| Some((c.primitive, c.known.as_ref()?)));
        known
            .map(|(p, e)| -shares(&e.costs, t)[p].max(1e-12).ln())
            .sum()
    };
    let tried = TEMPERATURES.iter().map(|&t| (t, surprise(t)));
    tried
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(TEMPERATURES[5], |(t, _)| t)
}

/// Logistic regression with a ridge, both sides weighing the same; scores that would speak the wrong way are dropped.
fn logistic(known: &[[f64; SCORES]], unknown: &[[f64; SCORES]]) -> ([f64; SCORES], f64) {
    let all = || known.iter().chain(unknown);
    let count = all().count() as f64;
    let means: [f64; SCORES] = std::array::from_fn(|i| all().map(|s| s[i]).sum::<f64>() / count);
    let deviations: [f64; SCORES] = std::array::from_fn(|i| {
        let squares = all().map(|s| (s[i] - means[i]).powi(2)).sum::<f64>();
        (squares / count).sqrt().max(1e-9)
    });
    let mut used = [true; SCORES];
    let weights = loop {
        let cases: Vec<(SVector<f64, 6>, f64, f64)> = [(known, 1.0), (unknown, 0.0)]
            .iter()
            .flat_map(|&(side, truth)| {
                side.iter()
                    .map(move |s| (s, truth, 0.5 / side.len() as f64))
            })
            .map(|(s, truth, weight)| {
                let x = SVector::<f64, 6>::from_fn(|i, _| match i {
                    0 => 1.0,
                    i if used[i - 1] => (s[i - 1] - means[i - 1]) / deviations[i - 1],
                    _ => 0.0,
                });
                (x, truth, weight * count)
            })
            .collect();
        let weights = newton(&cases);
        let wrong = (0..SCORES).find(|&i| used[i] && weights[i + 1] * SIGNS[i] < 0.0);
        match wrong {
            Some(i) => used[i] = false,
            None => break weights,
        }
    };
    let own: [f64; SCORES] = std::array::from_fn(|i| match used[i] {
        true => weights[i + 1] / deviations[i],
        false => 0.0,
    });
    let shift: f64 = own.iter().zip(means).map(|(w, m)| w * m).sum();
    (own, weights[0] - shift)
}

/// Newton's method on the penalised likelihood: it is concave, so that it converges.
fn newton(cases: &[(SVector<f64, 6>, f64, f64)]) -> SVector<f64, 6> {
    const ROUNDS: usize = 40;
    let mut weights = SVector::<f64, 6>::zeros();
    for _ in 0..ROUNDS {
        let mut slope = SVector::<f64, 6>::zeros();
        let mut bend = SMatrix::<f64, 6, 6>::identity() * 1e-9;
        for i in 1..6 {
            slope[i] -= RIDGE * weights[i];
            bend[(i, i)] += RIDGE;
        }
        for (x, truth, weight) in cases {
            let p = 1.0 / (1.0 + (-weights.dot(x)).exp());
            slope += x * (weight * (truth - p));
            bend += x * x.transpose() * (weight * (p * (1.0 - p)).max(1e-9));
        }
        let Some(step) = bend.cholesky().map(|c| c.solve(&slope)) else {
            break;
        };
        weights += step * (2.0 / step.norm().max(2.0));
        if step.norm() < 1e-9 {
            break;
        }
    }
    weights
}
