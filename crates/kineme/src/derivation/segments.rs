//! Cutting motions into the segments that are compared, and which segment truly follows which.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::motion::{Motion, STACKED_DIMS};
use crate::segmentation::pendulum::Limb;
use crate::segmentation::{Segmenter, Signal, Views, movements};

use super::features::{Features, dims};

/// A span marked by hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Index of the motion.
    pub motion: usize,
    /// Start, seconds.
    pub start_secs: f64,
    /// End, seconds.
    pub end_secs: f64,
    /// The performance that it belongs to, if the marks say: its spans follow one another in the order of the marks.
    pub recording: Option<String>,
}

/// Where segments come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Cut {
    /// Found by a segmenter in each motion.
    Segmenter {
        /// The method.
        segmenter: Segmenter,
        /// Median length of the movements to aim at, seconds, in place of the method's thresholds.
        target_secs: Option<f64>,
    },
    /// Each motion is one segment.
    Clips,
    /// Marked by hand.
    Marks(Vec<Mark>),
}

/// A part of a motion in which no relevant event occurs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segment {
    /// Index of the motion.
    pub motion: usize,
    /// Its frames.
    pub frames: Range<usize>,
    /// The segment that follows it in the same true recording.
    pub successor: Option<usize>,
}

/// The segments of all motions, in the order of the motions (of the marks, where given).
///
/// # Errors
/// When a mark lies outside its motion or a segmenter refuses its settings.
pub fn cut(motions: &[Motion], cut: &Cut) -> Result<Vec<Segment>> {
    match cut {
        Cut::Clips => Ok(motions
            .iter()
            .enumerate()
            .map(|(motion, m)| Segment {
                motion,
                frames: 0..m.frames(),
                successor: None,
            })
            .collect()),
        Cut::Segmenter {
            segmenter,
            target_secs,
        } => {
            let found: Vec<Vec<Range<usize>>> = motions
                .par_iter()
                .map(|m| movements_of(m, segmenter, *target_secs))
                .collect::<Result<_>>()?;
            let mut segments = Vec::new();
            for (motion, ranges) in found.into_iter().enumerate() {
                let first = segments.len();
                let end = first + ranges.len();
                segments.extend(ranges.into_iter().enumerate().map(|(i, frames)| Segment {
                    motion,
                    frames,
                    successor: Some(first + i + 1).filter(|&next| next < end),
                }));
            }
            Ok(segments)
        }
        Cut::Marks(marks) => from_marks(motions, marks),
    }
}

/// The movements that a segmenter finds in one motion.
fn movements_of(
    motion: &Motion,
    segmenter: &Segmenter,
    target_secs: Option<f64>,
) -> Result<Vec<Range<usize>>> {
    let rate = motion.rate_hz();
    let centroids = motion.limb_centroids();
    let features = match segmenter {
        Segmenter::ChangePoint(_) => Features::default().of(motion),
        _ => Vec::new(),
    };
    let weights = motion.activity_weights();
    let limbs = [Limb {
        bob: Signal::new(&centroids, STACKED_DIMS, rate)?,
        length: motion.limb_length(),
    }];
    let views = Views {
        limbs: &limbs,
        angles: Some(Signal::new(motion.poses(), motion.skeleton().dof(), rate)?),
        weights: &weights,
        features: match features.as_slice() {
            [] => None,
            all => Some(Signal::new(all, dims(motion.skeleton()), rate)?),
        },
        ..Views::new(motion.frames(), rate)
    };
    let found = segmenter.segment(&views, target_secs)?;
    Ok(movements(&found.spans).map(|s| s.start..s.end).collect())
}

fn from_marks(motions: &[Motion], marks: &[Mark]) -> Result<Vec<Segment>> {
    let mut segments = Vec::with_capacity(marks.len());
    for mark in marks {
        let motion = motions.get(mark.motion).ok_or_else(|| {
            Error::invalid(format!(
                "a mark names motion {} of {}",
                mark.motion,
                motions.len()
            ))
        })?;
        let frame = |secs: f64| (secs * motion.rate_hz()).round().max(0.0) as usize;
        let (start, end) = (
            frame(mark.start_secs),
            frame(mark.end_secs).min(motion.frames()),
        );
        if !(mark.start_secs >= 0.0 && mark.end_secs > mark.start_secs) || start >= end {
            return Err(Error::invalid(format!(
                "a mark from {} s to {} s does not lie in `{}`, which lasts {:.3} s",
                mark.start_secs,
                mark.end_secs,
                motion.name(),
                motion.duration_secs()
            )));
        }
        segments.push(Segment {
            motion: mark.motion,
            frames: start..end,
            successor: None,
        });
    }
    // Spans of one named recording follow in the order of the marks, others in the order of time within their motion.
    let mut chains: BTreeMap<(Option<&str>, usize), Vec<usize>> = BTreeMap::new();
    for (i, mark) in marks.iter().enumerate() {
        let key = match &mark.recording {
            Some(name) => (Some(name.as_str()), 0),
            None => (None, mark.motion),
        };
        chains.entry(key).or_default().push(i);
    }
    for ((name, _), mut chain) in chains {
        if name.is_none() {
            chain.sort_by_key(|&i| (segments[i].frames.start, i));
        }
        for pair in chain.windows(2) {
            segments[pair[0]].successor = Some(pair[1]);
        }
    }
    Ok(segments)
}
