//! The forward pass over everything at once: rows of all primitives, rest, and movement of no known kind.

use super::chain::Kernel;
use super::rows::Row;
use crate::primitive::Vocabulary;

/// Chances a second: to break a movement off, to begin one from rest, to begin one from unknown movement, and to go
/// between rest and unknown movement.
const LEAVE: f64 = 0.3;
/// People hardly break off what has an end; what goes round and round ends no other way. A body that carries primitives out
/// is told to.
const LEAVE_PEOPLE: f64 = 0.05;
const LEAVE_EXACT: f64 = 1.0;
const BEGIN: f64 = 2.0;
/// The same of a movement that has ended, where the body need not stand still afterwards.
const ENDED: f64 = 20.0;
const CHANGE: f64 = 0.5;
/// What follows a movement that has ended: rest, something unknown, or another primitive.
const AFTER: [f64; 3] = [0.3, 0.2, 0.5];
/// A movement is entered at its beginning, within so much of it ...
const ENTRY: f64 = 0.06;
const ENTRY_EXACT: f64 = 0.03;
/// ... but for one time in so many, when it is entered anywhere.
const ANYWHERE: f64 = 0.15;
/// Before anything was seen: rest, unknown, and all primitives alike.
const PRIOR: [f64; 3] = [0.3, 0.2, 0.5];
/// The logarithm of likelihoods, against the greatest, below which they are nothing.
const LEAST_LOG: f64 = -230.0;

/// How mass goes from row to row.
#[derive(Debug, Clone)]
pub(super) struct Network {
    /// First state of each row, and the number of states.
    pub starts: Vec<usize>,
    /// How the mass that enters a primitive is spread over its rows' states.
    entry: Vec<f64>,
    /// Rates at which states are left before their row ends, a second.
    leave: Vec<f64>,
    /// `n x n`: which primitive follows which.
    follow: Vec<f64>,
    primitives: usize,
}

/// How mass goes on in a certain time.
#[derive(Debug, Clone)]
pub(super) struct Step {
    /// How each row advances.
    kernels: Vec<Kernel>,
    /// Chances that states are left before their row ends.
    leaving: Vec<f64>,
    /// Chances to begin from rest or unknown movement, and to go between these.
    begin: f64,
    change: f64,
}

/// Probabilities of all states.
#[derive(Debug, Clone)]
pub(super) struct Mass {
    pub states: Vec<f64>,
    pub rest: f64,
    pub none: f64,
}

impl Network {
    /// `exact`: movements follow one another without standing still between them, unless the body rests. `people`: of
    /// what is seen nobody follows the primitives themselves.
    pub fn new(vocabulary: &Vocabulary, rows: &[Row], exact: bool, people: bool) -> Self {
        let n = vocabulary.primitives().len();
        let mut starts = vec![0];
        let mut entry = Vec::new();
        let mut leave = Vec::new();
        for row in rows {
            let count = rows.iter().filter(|r| r.primitive == row.primitive).count() as f64;
            let still = |k: usize| exact && row.stands(k);
            let entry_within = if exact { ENTRY_EXACT } else { ENTRY };
            let near = |k: usize| match row.cyclic {
                true => 1.0,
                false if still(k) => 0.0,
                false => (-row.progress[k] / entry_within).exp(),
            };
            let moments = 0..row.progress.len();
            let sum: f64 = moments.clone().map(near).sum();
            let even = 1.0 / row.progress.len() as f64;
            let share = |k: usize| ((1.0 - ANYWHERE) * near(k) / sum + ANYWHERE * even) / count;
            entry.extend(moments.clone().map(share));
            let broken_off = match (exact, people && !row.cyclic) {
                (true, _) => LEAVE_EXACT,
                (false, true) => LEAVE_PEOPLE,
                (false, false) => LEAVE,
            };
            leave.extend(moments.map(|k| if still(k) { ENDED } else { broken_off }));
            starts.push(entry.len());
        }
        let transitions = vocabulary.transitions();
        let pairs = (0..n).flat_map(|a| (0..n).map(move |b| (a, b)));
        Self {
            starts,
            entry,
            leave,
            follow: pairs.map(|(a, b)| transitions.probability(a, b)).collect(),
            primitives: n,
        }
    }

    /// How mass goes on in so many seconds, at paces between the slowest and the fastest.
    pub fn step(&self, rows: &[Row], secs: f64, paces: [f64; 2]) -> Step {
        let chance = |rate: f64| 1.0 - (-rate * secs).exp();
        Step {
            kernels: rows.iter().map(|r| Kernel::of(r, secs, paces)).collect(),
            leaving: self.leave.iter().map(|rate| chance(*rate)).collect(),
            begin: chance(BEGIN),
            change: chance(CHANGE),
        }
    }

    /// What is believed before anything was seen.
    pub fn prior(&self, rows: &[Row]) -> Mass {
        let mut states = self.entry.clone();
        for (r, row) in rows.iter().enumerate() {
            let own = &mut states[self.starts[r]..self.starts[r + 1]];
            // A stream may begin in the midst of a movement as well as before it.
            let even = 0.5 * own.iter().sum::<f64>() / row.progress.len() as f64;
            for m in own {
                *m = (0.5 * *m + even) * PRIOR[2] / self.primitives as f64;
            }
        }
        Mass {
            states,
            rest: PRIOR[0],
            none: PRIOR[1],
        }
    }

    /// Mass after a step, before anything is seen.
    pub fn forward(&self, rows: &[Row], step: &Step, mass: &Mass) -> Mass {
        let (begin, change) = (step.begin, step.change);
        let n = self.primitives;
        let mut states = vec![0.0; mass.states.len()];
        let mut ended = vec![0.0; n];
        for (r, row) in rows.iter().enumerate() {
            let own = self.starts[r]..self.starts[r + 1];
            let next = &mut states[own.clone()];
            let mut out = step.kernels[r].advance(row.cyclic, &mass.states[own.clone()], next);
            for (m, leave) in next.iter_mut().zip(&step.leaving[own]) {
                out += leave * *m;
                *m *= 1.0 - leave;
            }
            ended[row.primitive] += out;
        }
        let all: f64 = ended.iter().sum();
        let mut into = vec![begin * (mass.rest + mass.none) / n as f64; n];
        for (from, out) in ended.iter().enumerate() {
            for (to, sum) in into.iter_mut().enumerate() {
                *sum += AFTER[2] * out * self.follow[from * n + to];
            }
        }
        for (r, row) in rows.iter().enumerate() {
            let own = self.starts[r]..self.starts[r + 1];
            for (m, e) in states[own.clone()].iter_mut().zip(&self.entry[own]) {
                *m += into[row.primitive] * e;
            }
        }
        let keep = 1.0 - begin;
        Mass {
            states,
            rest: AFTER[0] * all + keep * ((1.0 - change) * mass.rest + change * mass.none),
            none: AFTER[1] * all + keep * ((1.0 - change) * mass.none + change * mass.rest),
        }
    }

    /// The step backward: what each state was worth when those after it are worth so much (their likelihood included).
    pub fn backward(&self, rows: &[Row], step: &Step, worth: &Mass) -> Mass {
        let (begin, change) = (step.begin, step.change);
        let n = self.primitives;
        let mut entered = vec![0.0; n];
        for (r, row) in rows.iter().enumerate() {
            let own = self.starts[r]..self.starts[r + 1];
            let pairs = worth.states[own.clone()].iter().zip(&self.entry[own]);
            entered[row.primitive] += pairs.map(|(w, e)| w * e).sum::<f64>();
        }
        let ended: Vec<f64> = (0..n)
            .map(|from| {
                let follow = &self.follow[from * n..(from + 1) * n];
                let next: f64 = follow.iter().zip(&entered).map(|(f, e)| f * e).sum();
                AFTER[0] * worth.rest + AFTER[1] * worth.none + AFTER[2] * next
            })
            .collect();
        let mut states = vec![0.0; worth.states.len()];
        for (r, row) in rows.iter().enumerate() {
            let own = self.starts[r]..self.starts[r + 1];
            let end = ended[row.primitive];
            let before = &mut states[own.clone()];
            let pairs = worth.states[own.clone()].iter().zip(&step.leaving[own]);
            let kept: Vec<f64> = pairs
                .map(|(w, leave)| (1.0 - leave) * w + leave * end)
                .collect();
            step.kernels[r].retreat(row.cyclic, &kept, end, before);
        }
        let begun = entered.iter().sum::<f64>() / n as f64;
        let from = |same: f64, other: f64| {
            begin * begun + (1.0 - begin) * ((1.0 - change) * same + change * other)
        };
        Mass {
            states,
            rest: from(worth.rest, worth.none),
            none: from(worth.none, worth.rest),
        }
    }
}

impl Mass {
    /// Likelihoods from their logarithms, up to the factor `exp(-most)`: those of the states times `factor`.
    pub fn likelihood(logs: &[f64], factor: f64, rest: f64, none: f64, most: f64) -> Self {
        // Most states are far off: what is less than that is nothing, and need not be computed.
        let exp = |log: f64| if log > LEAST_LOG { log.exp() } else { 0.0 };
        Self {
            states: logs.iter().map(|l| exp(factor * l - most)).collect(),
            rest: exp(rest - most),
            none: exp(none - most),
        }
    }

    /// Each times the same.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            states: self.states.iter().map(|m| factor * m).collect(),
            rest: factor * self.rest,
            none: factor * self.none,
        }
    }

    /// Gives a share of each to the other, and takes as much of the other.
    pub fn exchange(&mut self, other: &mut Self, share: f64) {
        let mix = |a: &mut f64, b: &mut f64| {
            (*a, *b) = (
                (1.0 - share) * *a + share * *b,
                (1.0 - share) * *b + share * *a,
            );
        };
        for (a, b) in self.states.iter_mut().zip(&mut other.states) {
            mix(a, b);
        }
        mix(&mut self.rest, &mut other.rest);
        mix(&mut self.none, &mut other.none);
    }

    /// The sum of two.
    pub fn plus(mut self, other: &Self) -> Self {
        for (m, o) in self.states.iter_mut().zip(&other.states) {
            *m += o;
        }
        self.rest += other.rest;
        self.none += other.none;
        self
    }

    /// The sum of products with another.
    pub fn dot(&self, by: &Self) -> f64 {
        let pairs = self.states.iter().zip(&by.states);
        pairs.map(|(m, w)| m * w).sum::<f64>() + self.rest * by.rest + self.none * by.none
    }

    /// Multiplies each by another and divides it by `sum`.
    pub fn weigh(&mut self, by: &Self, sum: f64) {
        for (m, w) in self.states.iter_mut().zip(&by.states) {
            *m *= w / sum;
        }
        self.rest *= by.rest / sum;
        self.none *= by.none / sum;
    }
}
