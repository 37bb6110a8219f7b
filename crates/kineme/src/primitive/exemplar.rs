//! [`Exemplar`]: one recorded or authored trajectory of a primitive.

use crate::motion::Motion;

/// Where an exemplar comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// The recording's name: `set.zip/inner/walk.bvh`.
    pub motion: String,
    /// Start in the recording, seconds.
    pub start_secs: f64,
    /// End in the recording, seconds.
    pub end_secs: f64,
    /// BLAKE3 of the source's bytes, hexadecimal, where it was a file.
    pub blake3: Option<String>,
}

/// One trajectory that defines a movement: joint coordinates over time, with where they come from.
#[derive(Debug, Clone, PartialEq)]
pub struct Exemplar {
    /// The movement, from its first to its last frame.
    pub motion: Motion,
    /// Its source.
    pub provenance: Provenance,
    /// Where it lies among the primitive's variations, in the adverbs' own units; `None` where nobody said.
    pub adverbs: Option<Vec<f64>>,
}

impl Exemplar {
    /// A motion from its first to its last frame, named as it is; `adverbs` as in [`Exemplar::adverbs`].
    pub fn whole(motion: Motion, adverbs: Option<Vec<f64>>) -> Self {
        let provenance = Provenance {
            motion: motion.name().into(),
            start_secs: 0.0,
            end_secs: motion.duration_secs(),
            blake3: None,
        };
        Self {
            motion,
            provenance,
            adverbs,
        }
    }

    /// How messages name it: the recording and, of a part of one, its seconds.
    pub fn label(&self) -> String {
        let from = &self.provenance;
        format!(
            "`{}` from {:.2} to {:.2} s",
            from.motion, from.start_secs, from.end_secs
        )
    }
}
