//! What kind of movement a group is: a stroke or a cycle, and which exemplars are of another kind.

use super::exemplar::Exemplar;
use super::fitting::Phased;
use super::modelling::Used;
use crate::alignment::{Cycle, Mismatch, cycle, cycles, period};
use crate::error::Result;
use crate::motion::{landmark_dims, mirror_landmarks};

/// One cycle of each exemplar, all beginning at the same event; `None` for a group of strokes. `declared` says
/// which it is, where somebody knows.
pub(super) fn cycles_of(
    exemplars: &[Exemplar],
    landmarks: &[Vec<f64>],
    declared: Option<bool>,
) -> Result<Option<Vec<Used>>> {
    let dims = landmark_dims(exemplars[0].motion.skeleton());
    let borrowed: Vec<&[f64]> = landmarks.iter().map(Vec::as_slice).collect();
    let rates: Vec<f64> = exemplars.iter().map(|e| e.motion.rate_hz()).collect();
    let short = exemplars.iter().any(|e| e.motion.frames() < LEAST_FRAMES);
    if short && declared != Some(true) {
        return Ok(None);
    }
    let found = cycles(&borrowed, dims, &rates, declared)?;
    Ok(found.map(|cycles| cycles.iter().map(used).collect()))
}

/// Frames below which nothing can be said of repetition.
const LEAST_FRAMES: usize = 4;

/// A cycle of a further sequence in step with a reference cycle of so many seconds.
pub(super) fn cycle_of(
    sequence: &[f64],
    dims: usize,
    rate_hz: f64,
    secs: f64,
    reference: &[f64],
) -> Result<Used> {
    let own = period(sequence, dims, rate_hz)?.map_or(secs * rate_hz, |p| {
        p.frames / (p.frames / (secs * rate_hz)).round().max(1.0)
    });
    Ok(used(&cycle(sequence, dims, own.max(2.0), Some(reference))?))
}

fn used(cycle: &Cycle) -> Used {
    Used {
        start: cycle.start,
        end: cycle.start + cycle.frames,
        shift: cycle.shift,
    }
}

/// Exemplars of another structure than the others, and what is wrong with them; beside them what is only to be told.
pub(super) struct Foreign {
    pub refused: Vec<(usize, &'static str)>,
    pub told: Vec<(usize, &'static str)>,
}

pub(super) fn foreign(exemplars: &[Exemplar], phased: &Phased) -> Result<Foreign> {
    let mut foreign = Foreign {
        refused: Vec::new(),
        told: Vec::new(),
    };
    if exemplars.len() < 2 {
        return Ok(foreign);
    }
    let body = exemplars[0].motion.skeleton();
    let mirrored: Vec<Vec<f64>> = phased
        .sequences
        .iter()
        .map(|s| mirror_landmarks(body, s))
        .collect();
    let borrowed: Vec<&[f64]> = phased.sequences.iter().map(Vec::as_slice).collect();
    let images: Vec<&[f64]> = mirrored.iter().map(Vec::as_slice).collect();
    let found = phased.registration.structures(
        &borrowed,
        &images,
        &phased.registered,
        landmark_dims(body),
    )?;
    for (i, (_, mismatch)) in found.into_iter().enumerate() {
        match mismatch {
            Some(Mismatch::Mirrored) => foreign
                .refused
                .push((i, "is the mirror image of the others")),
            Some(Mismatch::OutOfStep) => foreign
                .refused
                .push((i, "begins with the other foot (half a cycle out of step)")),
            Some(Mismatch::Outlier) => foreign.told.push((i, "is far from all others")),
            None => {}
        }
    }
    // Somebody must be of the structure that the others lack.
    foreign
        .refused
        .retain(|(i, _)| *i != phased.registered.medoid);
    Ok(foreign)
}
