//! Stroke by stroke inside its own set: is each decision given to a primitive that goes the same way?

use kineme::Vocabulary;
use kineme::evaluation::{Bootstrap, Estimate};
use kineme::perception::encoding::{EffectorPaths, Encoder};

use super::{Question, SETS};
use crate::sets::Result;

/// Of each set, the primitives in which the coordinate of [`coordinate`] rises.
pub const RISING: [&[&str]; SETS.len()] = [
    &["wave-up"],
    &["punch-out"],
    &["twist-left"],
    &["wave-across", "greet-in"],
];
/// A turn of direction counts when the coordinate went back by so much, in reaches (of the twist: radians).
const TURN: f64 = 0.15;
/// Slower than this along its coordinate, reaches a second, a hand makes no stroke.
const SLOW: f64 = 0.2;

/// A decision: when, and the primitive, an index into the vocabulary.
pub type Taken = (f64, f64, Option<usize>);

/// The decisions of one recording that lie wholly inside a stroke: strokes and answers, `[rises, falls]` each.
#[derive(Debug, Clone, PartialEq)]
pub struct Told {
    /// Whose.
    pub question: Question,
    /// Decisions, `[stroke][answer]`.
    pub counts: [[usize; 2]; 2],
}

impl Told {
    /// Right decisions and all of them.
    pub fn right(&self) -> (usize, usize) {
        let [[a, b], [c, d]] = self.counts;
        (a + d, a + b + c + d)
    }
}

/// The main direction of a set's strokes as a coordinate of the right hand, a frame each: vertical waving its height;
/// punching its horizontal distance from between the shoulders; the twist its bearing around them, radians; horizontal
/// waving how far left it is. Lengths in reaches. Empty where nothing was seen of the hand.
pub fn coordinate(paths: &EffectorPaths, set: usize) -> Vec<f64> {
    let reach = paths.reach_m().unwrap_or(1.0);
    let path = paths.smoothed(0);
    let mut before = 0.0;
    path.iter()
        .map(|p| match set {
            0 => p.z / reach,
            1 => p.xy().norm() / reach,
            2 => {
                let turns = std::f64::consts::TAU;
                let bearing = p.y.atan2(p.x);
                before = bearing + turns * ((before - bearing) / turns).round();
                before
            }
            _ => p.y / reach,
        })
        .collect()
}

/// The strokes of a coordinate: from turning point to turning point, first and last index and whether it rises. A
/// turning point is where the coordinate goes back by `TURN` at least.
pub fn strokes(values: &[f64]) -> Vec<(usize, usize, bool)> {
    let Some(&first) = values.first() else {
        return Vec::new();
    };
    let mut turns = Vec::new();
    // Until the first stroke has a direction, both extremes are candidates for its beginning.
    let (mut low, mut high) = ((0, first), (0, first));
    let mut rises = None;
    for (k, &v) in values.iter().enumerate() {
        if v > high.1 {
            high = (k, v);
        }
        if v < low.1 {
            low = (k, v);
        }
        if rises != Some(true) && v - low.1 >= TURN {
            turns.push((low.0, true));
            rises = Some(true);
            high = (k, v);
        } else if rises != Some(false) && high.1 - v >= TURN {
            turns.push((high.0, false));
            rises = Some(false);
            low = (k, v);
        }
    }
    let last = match rises {
        Some(true) => high.0,
        _ => low.0,
    };
    let ends: Vec<usize> = turns
        .iter()
        .skip(1)
        .map(|(k, _)| *k)
        .chain([last])
        .collect();
    let pairs = turns.iter().zip(ends);
    pairs.map(|(&(a, rises), b)| (a, b, rises)).collect()
}

/// Counts the decisions that lie wholly inside one stroke of a hand in which it does not rest: `[stroke][answer]`.
pub fn tally(
    paths: &EffectorPaths,
    set: usize,
    rising: &[usize],
    taken: &[Taken],
) -> [[usize; 2]; 2] {
    let values = coordinate(paths, set);
    let rate = paths.rate_hz();
    let mut counts = [[0; 2]; 2];
    for (first, last, rises) in strokes(&values) {
        let (from, to) = (first as f64 / rate - 1e-9, last as f64 / rate + 1e-9);
        for &(start, end, primitive) in taken {
            let Some(primitive) = primitive.filter(|_| start >= from && end <= to) else {
                continue;
            };
            let gone = at(&values, end * rate) - at(&values, start * rate);
            let along = if rises { gone } else { -gone };
            if along >= SLOW * (end - start) {
                counts[usize::from(!rises)][usize::from(!rising.contains(&primitive))] += 1;
            }
        }
    }
    counts
}

fn at(values: &[f64], place: f64) -> f64 {
    let below = (place.max(0.0) as usize).min(values.len() - 1);
    let above = (below + 1).min(values.len() - 1);
    values[below] + (place - below as f64).clamp(0.0, 1.0) * (values[above] - values[below])
}

/// The decisions by hypotheses inside a set.
///
/// # Errors
/// When the encoder looks at something else than the right hand.
pub fn by_hypotheses(
    encoder: &Encoder<'_>,
    paths: &EffectorPaths,
    own: &[usize],
) -> Result<Vec<Taken>> {
    let secs = encoder.settings().decision_secs;
    let all = paths.duration_secs();
    let decisions = encoder.explained(paths, own)?.decisions;
    Ok(decisions
        .into_iter()
        .enumerate()
        .map(|(k, p)| (k as f64 * secs, ((k + 1) as f64 * secs).min(all), p))
        .collect())
}

/// The decisions of the published method, whose encoder knows one set alone; `own` are the set's primitives among all.
///
/// # Errors
/// When the encoder looks at something else than the right hand.
pub fn by_the_paper(
    encoder: &Encoder<'_>,
    paths: &EffectorPaths,
    own: &[usize],
) -> Result<Vec<Taken>> {
    let decisions = encoder.decisions(paths)?.into_iter();
    Ok(decisions
        .map(|d| (d.start_secs, d.end_secs, Some(own[d.winner])))
        .collect())
}

/// The set's primitives in `all`, and those in which the coordinate rises.
pub fn own(all: &Vocabulary, sets: &[usize], set: usize) -> (Vec<usize>, Vec<usize>) {
    let own: Vec<usize> = (0..sets.len()).filter(|p| sets[*p] == set).collect();
    let rises = |p: &usize| RISING[set].contains(&all.primitives()[*p].name());
    let rising = own.iter().copied().filter(rises).collect();
    (own, rising)
}

/// The share of right decisions, with its interval by resampling recordings; `None` without a decision.
///
/// # Errors
/// Never with the default bootstrap.
pub fn share(told: &[&Told]) -> Result<Option<Estimate>> {
    if told.is_empty() {
        return Ok(None);
    }
    let [estimate] = Bootstrap::default().estimates(told.len(), |counts| {
        let (mut right, mut all) = (0.0, 0.0);
        for (t, &n) in told.iter().zip(counts) {
            let (r, a) = t.right();
            right += f64::from(n) * r as f64;
            all += f64::from(n) * a as f64;
        }
        [(all > 0.0).then(|| right / all)]
    })?;
    Ok(estimate)
}
