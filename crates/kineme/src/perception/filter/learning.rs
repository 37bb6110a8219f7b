//! Learning of a vocabulary by leaving its exemplars out.

use rayon::prelude::*;

use super::evidence::{Evidence, Trusts};
use super::learned::{Learned, SCORES, classes, scores, unit};
use super::logistic::logistic;
use super::recogniser::Filter;
use super::temperature::{belief, chance_lead, temperature};
use crate::error::Result;
use crate::math::statistics::{median, quantile};
use crate::perception::rows::manifold;
use crate::perception::temperature::LogNormal;
use crate::primitive::{Observations, Vocabulary};

/// At most so many exemplars are left out, and at most so many moments of rows are compared for it.
const MOST_FOLDS: usize = 160;
const MOST_COMPARED: f64 = 1.5e8;
const LEAST_FOLDS: usize = 24;
/// How much routes and shapes may count: a route a second, at most as much as one of the body's directions; a shape
/// beside the moments, which are trusted alike. Exemplars that are left out go at a pace that somebody was seen to go at,
/// and never tell what shapes are worth to others: they count in any case.
const ROUTES: [f64; 4] = [0.0, 0.3, 1.0, 3.0];
const SHAPES: [f64; 3] = [0.3, 1.0, 3.0];
/// Exemplars of a few people stand and fall together: of what they say about the next one, so much counts.
pub(super) const INDEPENDENT: f64 = 0.1;
/// What this share of clips costs at most is usual.
const KEPT: f64 = 0.95;
/// This share of the exemplars that are left out is to be called by its name, with so much to spare in logarithms of
/// odds.
const CALLED: f64 = 0.98;
const MARGIN: f64 = 2.0;

/// A clip of which something is left out: the primitives' log-likelihoods, the unit of their temperature, the clip, and
/// its true primitive if that is among them; whether nothing but the clip itself is left out.
pub(super) struct Trial {
    pub classes: Vec<f64>,
    pub unit: f64,
    pub fold: usize,
    pub truth: Option<usize>,
    pub alone: bool,
}

impl Trial {
    /// Whether anything is left that it could be.
    fn is_possible(&self) -> bool {
        self.classes.iter().any(|c| c.is_finite())
    }
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
    let (trusts, fitted) = trusts(filter, &folds, &evidences, usual.trusts);
    let trials = trials(filter, &folds, &evidences, trusts);
    let temperature = fitted
        .or_else(|| Some(chance_lead(&trials)?.max(usual.temperature)))
        .unwrap_or(usual.temperature);
    // Whoever gave a grid of parameters is the one who moves: there is no next person to be unsure of.
    let people = vocabulary.primitives().iter().any(|p| !manifold(p));
    let belief = belief(&trials).filter(|_| people);
    let believed = belief.unwrap_or(LogNormal {
        mean: temperature,
        spread: 0.0,
    });
    let mut learned = Learned {
        temperature: believed.mean,
        spread: believed.spread,
        trusts,
        limits: limits(vocabulary, &trials, &evidences, kept, &usual),
        ..usual
    };
    refuse(&mut learned, &trials, &evidences, people);
    let of_moments: Vec<Evidence> = evidences.iter().map(Evidence::of_moments).collect();
    let by_moments = self::trials(filter, &folds, &of_moments, Trusts::default());
    learned.unknown_per_sec = gain(&by_moments, &of_moments, &learned);
    Ok(learned)
}

/// The trusts under which the exemplars left out are told best, and the temperature; the usual ones without known
/// trials or rivals.
fn trusts(
    filter: &Filter<'_>,
    folds: &[(usize, usize)],
    evidences: &[Evidence],
    usual: Trusts,
) -> (Trusts, Option<f64>) {
    let candidates = |known: bool, all: &[f64], usual: f64| match known {
        true => all.to_vec(),
        // What nobody is told of counts nothing, however it is trusted.
        false => vec![usual],
    };
    let routes = candidates(
        evidences.iter().any(|e| e.routes.is_some()),
        &ROUTES,
        usual.route,
    );
    let shapes = candidates(
        evidences.iter().any(|e| e.shapes.is_some()),
        &SHAPES,
        usual.shape,
    );
    let pairs = routes
        .iter()
        .flat_map(|&route| shapes.iter().map(move |&shape| Trusts { route, shape }));
    let pairs: Vec<Trusts> = pairs.collect();
    let told = |&trusts: &Trusts| {
        let (temperature, loss) = temperature(&trials(filter, folds, evidences, trusts))?;
        Some((trusts, temperature, loss))
    };
    let told: Vec<_> = pairs.par_iter().filter_map(told).collect();
    let best = told.iter().min_by(|a, b| a.2.total_cmp(&b.2));
    best.map_or((usual, None), |&(trusts, temperature, _)| {
        (trusts, Some(temperature))
    })
}

/// Learns the odds of being unknown, of `people` with how sure they are.
fn refuse(learned: &mut Learned, trials: &[Trial], evidences: &[Evidence], people: bool) {
    let possible = trials.iter().filter(|t| t.is_possible());
    let told: Vec<(&Trial, [f64; SCORES])> = possible
        .map(|t| (t, scores(&t.classes, &evidences[t.fold], &learned.limits)))
        .collect();
    let known = told.iter().filter(|(t, _)| t.truth.is_some());
    if known.clone().count() == 0 || known.clone().count() == told.len() {
        return;
    }
    let examples: Vec<([f64; SCORES], bool)> = told
        .iter()
        .map(|(t, scores)| (*scores, t.truth.is_none()))
        .collect();
    let found = logistic(&examples, INDEPENDENT);
    (learned.scores, learned.bias) = (found.scores, found.bias);
    if people {
        learned.covariance = found.covariance;
    }
    // Whatever that costs of the unknown, the known are to be called by their name: the odds of being unknown stay
    // below the probability of the leading primitive, with a margin as people come who differ more than those seen.
    let bare = Learned {
        bias: 0.0,
        ..learned.clone()
    };
    let room: Vec<f64> = known
        .map(|(t, scores)| {
            let shares = bare.shares(&t.classes, t.unit).into_iter();
            shares.fold(0.0, f64::max).ln() - bare.unknown(scores)
        })
        .collect();
    let keeping = quantile(&room, 1.0 - CALLED).unwrap_or(learned.bias);
    learned.bias = learned.bias.min(keeping - MARGIN);
}

/// What unknown movement is given a second, by trials that know postures alone.
fn gain(trials: &[Trial], evidences: &[Evidence], learned: &Learned) -> f64 {
    let gains = |unknown: bool| -> Vec<f64> {
        let of = trials.iter().filter(|t| t.is_possible());
        of.filter(|t| t.truth.is_none() == unknown)
            .map(|t| scores(&t.classes, &evidences[t.fold], &learned.limits)[0])
            .collect()
    };
    let (known, unknown) = (gains(false), gains(true));
    match (quantile(&known, 1.0 - KEPT), median(&unknown)) {
        // Between what the least of the known gains over movement of any kind, and what the unknown gains.
        (Some(low), Some(high)) => 0.5 * (low + low.min(high)),
        // Of single exemplars nobody knows what the known gain, but they gain more than the unknown.
        (None, Some(high)) => high.min(learned.unknown_per_sec),
        _ => learned.unknown_per_sec,
    }
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

fn trials(
    filter: &Filter<'_>,
    folds: &[(usize, usize)],
    evidences: &[Evidence],
    trusts: Trusts,
) -> Vec<Trial> {
    let rows = &filter.clips.rows;
    let mut trials = Vec::new();
    for (fold, (&(k, i), evidence)) in folds.iter().zip(evidences).enumerate() {
        let alone: Vec<bool> = rows
            .iter()
            .map(|r| r.primitive == k && r.exemplar == Some(i))
            .collect();
        let weighed = evidence.weighed(trusts);
        let mut trial = |left_out: &[bool], truth: Option<usize>, alone: bool| {
            let classes = classes(filter, &weighed, left_out);
            trials.push(Trial {
                unit: unit(&classes, evidence.lasts()),
                classes,
                fold,
                truth,
                alone,
            });
        };
        let others = (0..rows.len()).filter(|&r| rows[r].primitive == k && !alone[r]);
        if others.count() > 0 {
            trial(&alone, Some(k), true);
            // A grid of parameters is nobody's: its exemplars are by one hand.
            if !manifold(&filter.vocabulary.primitives()[k]) {
                let new = nearest_half(filter, &weighed, &alone);
                trial(&new, Some(k), false);
            }
        }
        let whole: Vec<bool> = rows.iter().map(|r| r.primitive == k).collect();
        trial(&whole, None, false);
    }
    trials
}

/// Leaves out the half of each primitive's rows that is likeliest beside those that are left out already. Rivals lose
/// theirs as well: whoever is new is so in all movements.
fn nearest_half(filter: &Filter<'_>, of_rows: &[f64], left_out: &[bool]) -> Vec<bool> {
    let rows = &filter.clips.rows;
    let mut all = left_out.to_vec();
    for (k, primitive) in filter.vocabulary.primitives().iter().enumerate() {
        if manifold(primitive) {
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
