//! From groups of segments to a vocabulary.

use std::sync::Arc;

use rayon::prelude::*;

use super::procedure::Derived;
use crate::error::Result;
use crate::motion::Motion;
use crate::primitive::{self, Exemplar, Mismatched, Modelling, Primitive, Provenance, Vocabulary};

/// Exemplars that a primitive keeps at most: those nearest the middle of its group.
pub const MAX_EXEMPLARS: usize = 50;

impl Derived {
    /// The vocabulary of the groups found in `motions` (those that the derivation was given): each group becomes a
    /// primitive of its most central segments. `source` tells the BLAKE3 of the file behind a motion, where there is one.
    ///
    /// # Errors
    /// When `motions` are not those that the segments were cut from.
    pub fn vocabulary(
        &self,
        motions: &[Motion],
        modelling: &Modelling,
        source: &(dyn Fn(usize) -> Option<String> + Sync),
    ) -> Result<Vocabulary> {
        // Nobody chose these exemplars: one that does not fit leaves, and the primitive says so.
        let modelling = Modelling {
            mismatched: Mismatched::LeaveOut,
            ..modelling.clone()
        };
        let primitives = self
            .groups
            .par_iter()
            .map(|group| {
                let exemplars = group
                    .segments
                    .iter()
                    .take(MAX_EXEMPLARS)
                    .map(|&s| self.exemplar(s, motions, source))
                    .collect::<Result<_>>()?;
                let primitive = Primitive::learn(&group.name, exemplars, &modelling)?;
                Ok(primitive.of_group(primitive::Group {
                    members: group.segments.len(),
                    coherence: group.coherence,
                }))
            })
            .collect::<Result<_>>()?;
        Vocabulary::new(
            Arc::clone(motions[0].skeleton()),
            primitives,
            self.behaviors.items.clone(),
            self.transitions.clone(),
        )
    }

    fn exemplar(
        &self,
        segment: usize,
        motions: &[Motion],
        source: &(dyn Fn(usize) -> Option<String> + Sync),
    ) -> Result<Exemplar> {
        let segment = &self.segments[segment];
        let motion = &motions[segment.motion];
        let rate = motion.rate_hz();
        Ok(Exemplar {
            motion: motion.slice(segment.frames.clone())?,
            provenance: Provenance {
                motion: motion.name().into(),
                start_secs: segment.frames.start as f64 / rate,
                end_secs: segment.frames.end as f64 / rate,
                blake3: source(segment.motion),
            },
            adverbs: None,
        })
    }
}
