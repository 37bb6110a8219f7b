//! Movements that no warp can bring together: the mirror image, the other foot first, another movement altogether.

use rayon::prelude::*;

use super::registration::{Registered, Registration};
use super::warp::{resample, uniform};
use crate::error::{Error, Result};
use crate::math::statistics::median;

/// The other form must come to less than this share of the exemplar's own distance from the mean.
const MUCH_BETTER: f64 = 0.75;
/// An outlier is this many times as far from the mean as the median member, and farther than all others.
const OUTLYING: f64 = 3.0;
/// Rounds in which the mean is made of those that belong together.
const ROUNDS: usize = 4;

/// How an exemplar differs in structure from the others of its group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mismatch {
    /// Its mirror image fits much better than it does: the other hand, the other foot first.
    Mirrored,
    /// The cycle fits much better half a turn later: it begins with the other foot.
    OutOfStep,
    /// It lies much farther from the mean than all others. This is to be told, not to be acted on.
    Outlier,
}

/// An exemplar's distances from the mean of its group, each after registration ([`Aligned::cost`](super::Aligned)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Structure {
    /// As it is.
    pub cost: f64,
    /// Mirrored.
    pub mirrored: f64,
    /// Half a cycle later; `None` for sequences that are no cycles.
    pub half_turn: Option<f64>,
}

impl Structure {
    /// What is wrong with an exemplar of these distances, where the others' own are `others`.
    pub fn mismatch(&self, others: &[f64]) -> Option<Mismatch> {
        let bound = MUCH_BETTER * self.cost;
        match self.half_turn {
            Some(half) if half < bound && half <= self.mirrored => {
                return Some(Mismatch::OutOfStep);
            }
            _ if self.mirrored < bound => return Some(Mismatch::Mirrored),
            _ => {}
        }
        let typical = median(others)?;
        let beyond = others.iter().all(|c| self.cost > *c) && self.cost > OUTLYING * typical;
        // Two others cannot say what is usual.
        (beyond && others.len() >= 3 && typical > 0.0).then_some(Mismatch::Outlier)
    }
}

impl Registration {
    /// How well an exemplar fits the mean of a group, as it is and in its other forms. The caller mirrors: plain
    /// vectors do not know left from right.
    ///
    /// # Errors
    /// As for [`Self::register_to`].
    pub fn structure(
        &self,
        reference: &[f64],
        exemplar: &[f64],
        mirrored: &[f64],
        dims: usize,
    ) -> Result<Structure> {
        let cost = |sequence: &[f64]| Ok(self.register_to(reference, sequence, dims)?.cost);
        Ok(Structure {
            cost: cost(exemplar)?,
            mirrored: cost(mirrored)?,
            half_turn: match self.cyclic {
                true => Some(cost(&half_turned(exemplar, dims, self.knots))?),
                false => None,
            },
        })
    }

    /// The structure of each exemplar of a group, against the mean of those that are alike in structure.
    ///
    /// A group may be mixed, its plain mean neither one thing nor the other. So the medoid comes first, and then, for
    /// up to four rounds, the mean of the exemplars without a mismatch to the last one. `all` is the registration of
    /// the sequences, `mirrored` holds the mirror image of each. Of two equal parts either may be taken for the right one.
    ///
    /// # Errors
    /// As for [`Self::register`]; when there is not one mirror image for each sequence.
    pub fn structures(
        &self,
        sequences: &[&[f64]],
        mirrored: &[&[f64]],
        all: &Registered,
        dims: usize,
    ) -> Result<Vec<(Structure, Option<Mismatch>)>> {
        if sequences.len() != mirrored.len() {
            return Err(Error::invalid(format!(
                "{} sequences need as many mirror images, found {}",
                sequences.len(),
                mirrored.len()
            )));
        }
        let mut reference = resample(sequences[all.medoid], dims, &uniform(self.knots));
        let mut kept: Vec<bool> = Vec::new();
        let mut found = Vec::new();
        for _ in 0..ROUNDS {
            let structures: Vec<Structure> = sequences
                .par_iter()
                .zip(mirrored)
                .map(|(s, m)| self.structure(&reference, s, m, dims))
                .collect::<Result<_>>()?;
            found = told(&structures);
            let alike: Vec<bool> = found
                .iter()
                .map(|(_, m)| !matches!(m, Some(Mismatch::Mirrored | Mismatch::OutOfStep)))
                .collect();
            if alike == kept || !alike.contains(&true) {
                break;
            }
            kept = alike;
            if !kept.contains(&false) {
                reference = all.mean.clone();
                continue;
            }
            let members: Vec<&[f64]> = sequences
                .iter()
                .zip(&kept)
                .filter_map(|(s, keep)| keep.then_some(*s))
                .collect();
            reference = self.register(&members, dims)?.mean;
        }
        Ok(found)
    }
}

/// Each with its mismatch, judged by the distances of all others.
fn told(structures: &[Structure]) -> Vec<(Structure, Option<Mismatch>)> {
    let alone: Vec<Option<Mismatch>> = structures.iter().map(|s| s.mismatch(&[])).collect();
    structures
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let others: Vec<f64> = structures
                .iter()
                .zip(&alone)
                .enumerate()
                .filter_map(|(j, (o, m))| (i != j && m.is_none()).then_some(o.cost))
                .collect();
            (*s, s.mismatch(&others))
        })
        .collect()
}

/// A cycle read from its middle onward.
fn half_turned(cycle: &[f64], dims: usize, knots: usize) -> Vec<f64> {
    let places: Vec<f64> = uniform(knots)
        .into_iter()
        .map(|p| if p < 0.5 { p + 0.5 } else { p - 0.5 })
        .collect();
    resample(cycle, dims, &places)
}
