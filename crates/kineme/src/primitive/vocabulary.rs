//! [`Vocabulary`]: the primitives of one body, and what is known of how they follow one another.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::calibration::Calibration;
use super::exemplar::Provenance;
use super::model::Primitive;
use crate::error::{Error, Result};
use crate::skeleton::Skeleton;

/// An exemplar follows another that ends so near to where it begins, seconds: people mark no finer.
const JOINED_SECS: f64 = 0.1;

/// Primitives that belong to one behaviour: the second level of the derivation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Behavior {
    /// Its name; the primitive's own where it has just one.
    pub name: String,
    /// Names of its primitives.
    pub primitives: Vec<String>,
}

/// How often one primitive followed another inside true recordings.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Transitions {
    /// Row-major `n x n`: `counts[from * n + to]`.
    pub counts: Vec<u32>,
    /// The number of primitives.
    pub n: usize,
}

impl Transitions {
    /// No successions among `n` primitives.
    pub fn none(n: usize) -> Self {
        Self {
            counts: vec![0; n * n],
            n,
        }
    }

    /// Successions among the exemplars themselves: wherever one begins where another of the same recording ends, give or
    /// take a tenth of a second. Repetitions cut out of one recording follow one another; clips from files of their own
    /// tell nothing.
    pub fn observed(primitives: &[Primitive]) -> Self {
        let all: Vec<(usize, &Provenance)> = primitives
            .iter()
            .enumerate()
            .flat_map(|(k, p)| p.exemplars().iter().map(move |e| (k, &e.provenance)))
            .collect();
        let mut observed = Self::none(primitives.len());
        for (i, (from, before)) in all.iter().enumerate() {
            for (j, (to, after)) in all.iter().enumerate() {
                let joined = (after.start_secs - before.end_secs).abs() <= JOINED_SECS;
                let recorded = before.motion == after.motion && before.blake3 == after.blake3;
                if i != j && joined && recorded {
                    observed.counts[from * observed.n + to] += 1;
                }
            }
        }
        observed
    }

    /// How often `to` followed `from`.
    pub fn count(&self, from: usize, to: usize) -> u32 {
        self.counts[from * self.n + to]
    }

    /// The probability that `to` follows `from`, Laplace-smoothed with one count for every successor.
    pub fn probability(&self, from: usize, to: usize) -> f64 {
        let row = &self.counts[from * self.n..(from + 1) * self.n];
        let all: f64 = row.iter().map(|&c| f64::from(c)).sum();
        (f64::from(row[to]) + 1.0) / (all + self.n as f64)
    }
}

/// Primitives of one body: built once, checked once, then only lent.
#[derive(Debug, Clone, PartialEq)]
pub struct Vocabulary {
    body: Arc<Skeleton>,
    primitives: Vec<Primitive>,
    behaviors: Vec<Behavior>,
    transitions: Transitions,
    calibrations: Vec<Calibration>,
}

impl Vocabulary {
    /// A vocabulary of these primitives.
    ///
    /// # Errors
    /// When names repeat, a primitive is of another body, a behaviour names no
    /// primitive of the vocabulary, or the transitions are of another number of primitives.
    pub fn new(
        body: Arc<Skeleton>,
        primitives: Vec<Primitive>,
        behaviors: Vec<Behavior>,
        transitions: Transitions,
    ) -> Result<Self> {
        let mut names = BTreeSet::new();
        for p in &primitives {
            if !names.insert(p.name()) {
                return Err(Error::invalid(format!(
                    "primitives need distinct names, found `{}` twice",
                    p.name()
                )));
            }
            if **p.body() != *body {
                return Err(Error::invalid(format!(
                    "the primitive `{}` is of the body `{}`, not of `{}`",
                    p.name(),
                    p.body().name(),
                    body.name()
                )));
            }
        }
        for name in behaviors.iter().flat_map(|b| &b.primitives) {
            if !names.contains(name.as_str()) {
                return Err(Error::unknown_name(
                    "primitive",
                    name,
                    names.iter().copied(),
                ));
            }
        }
        let n = primitives.len();
        if transitions.n != n || transitions.counts.len() != n * n {
            return Err(Error::invalid(format!(
                "transitions of {} primitives for a vocabulary of {n}",
                transitions.n
            )));
        }
        Ok(Self {
            body,
            primitives,
            behaviors,
            transitions,
            calibrations: Vec::new(),
        })
    }

    /// The same vocabulary with what a recogniser learned of it, in place of what that one had learned before.
    ///
    /// # Errors
    /// When the numbers are not finite, not of as many primitives, or not equally many of each.
    pub fn calibrated(mut self, calibration: Calibration) -> Result<Self> {
        let numbers = &calibration.primitives;
        let equal = numbers.windows(2).all(|w| w[0].len() == w[1].len());
        let mut all = numbers.iter().flatten().chain(&calibration.shared);
        if numbers.len() != self.primitives.len() || !equal || !all.all(|v| v.is_finite()) {
            return Err(Error::invalid(format!(
                "a calibration of `{}` needs equally many finite numbers of each of the {} primitives",
                calibration.recogniser,
                self.primitives.len()
            )));
        }
        self.calibrations
            .retain(|c| c.recogniser != calibration.recogniser);
        self.calibrations.push(calibration);
        self.calibrations
            .sort_by(|a, b| a.recogniser.cmp(&b.recogniser));
        Ok(self)
    }

    /// What recognisers learned of it, in the order of their names.
    pub fn calibrations(&self) -> &[Calibration] {
        &self.calibrations
    }

    /// What the recogniser of this name learned of it.
    pub fn calibration(&self, recogniser: &str) -> Option<&Calibration> {
        self.calibrations
            .iter()
            .find(|c| c.recogniser == recogniser)
    }

    /// The body that all exemplars move.
    pub fn body(&self) -> &Arc<Skeleton> {
        &self.body
    }

    /// All primitives.
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// The primitive of this name.
    ///
    /// # Errors
    /// For an unknown name; the message lists the known ones.
    pub fn primitive(&self, name: &str) -> Result<&Primitive> {
        self.primitives
            .iter()
            .find(|p| p.name() == name)
            .ok_or_else(|| {
                Error::unknown_name(
                    "primitive",
                    name,
                    self.primitives.iter().map(Primitive::name),
                )
            })
    }

    /// The second level: behaviours and their primitives.
    pub fn behaviors(&self) -> &[Behavior] {
        &self.behaviors
    }

    /// How primitives followed one another.
    pub fn transitions(&self) -> &Transitions {
        &self.transitions
    }
}
