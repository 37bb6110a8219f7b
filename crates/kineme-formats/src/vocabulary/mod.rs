//! The vocabulary file `*.kineme`: a safetensors container.
//!
//! Its metadata holds one JSON document under the key `kineme`: version, units, checksum of the tensors, and
//! the vocabulary as [`VocabularyMeta`]. Exemplar `i`, counted through the primitives in order, has two f64
//! tensors: `exemplar-<i, six digits>/poses` (frames x coordinates, radians) and `.../root` (frames x 4:
//! x, y, z in metres, z up, and yaw in radians).

mod bind;
mod check;
mod container;

pub use bind::{read, write};

use serde::{Deserialize, Serialize};

/// The version of the document that this program writes, and the only one it reads.
pub const VERSION: u64 = 1;

/// The most exemplars a file may hold: the six digits of a tensor's name.
pub const MAX_EXEMPLARS: usize = 1_000_000;

/// What a vocabulary file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct VocabularyFile {
    /// Everything but the movements.
    pub meta: VocabularyMeta,
    /// The movements, in the order of the exemplars in [`VocabularyMeta::primitives`].
    pub exemplars: Vec<ExemplarFrames>,
}

/// The movement of one exemplar.
#[derive(Debug, Clone, PartialEq)]
pub struct ExemplarFrames {
    /// Joint coordinates, radians, frame-major: `poses[frame * coordinates + coordinate]`.
    pub poses: Vec<f64>,
    /// The root's path, one a frame: x, y, z in metres (z up) and yaw in radians.
    pub root: Vec<[f64; 4]>,
}

/// The body, the primitives and what is known of their origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VocabularyMeta {
    /// The program that wrote it, with its version.
    pub program: String,
    /// The body that all poses belong to.
    pub body: String,
    /// The names of the body's joint coordinates, in the order of a pose.
    pub coordinates: Vec<String>,
    /// The primitives, at least one, each name once.
    pub primitives: Vec<PrimitiveMeta>,
    /// The second level: primitives that belong together.
    pub behaviors: Vec<BehaviorMeta>,
    /// Which primitives were seen to follow which; pairs that never did are left out.
    pub transitions: Vec<TransitionMeta>,
}

/// A primitive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrimitiveMeta {
    /// Its name.
    pub name: String,
    /// How many segments its group had, of which the exemplars are some.
    pub members: u64,
    /// How well its exemplars cohere; `None` where it was not measured.
    pub coherence: Option<f64>,
    /// Its exemplars, at least one.
    pub exemplars: Vec<ExemplarMeta>,
}

/// Where an exemplar comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExemplarMeta {
    /// The source motion, named as `info` names it.
    pub motion: String,
    /// Where it starts in the source, seconds.
    pub start_secs: f64,
    /// Where it ends in the source, seconds.
    pub end_secs: f64,
    /// Frames a second of its poses.
    pub rate_hz: f64,
    /// BLAKE3 of the source file, 64 lower-case hexadecimal digits, where it is known.
    pub blake3: Option<String>,
}

/// Primitives that belong together because they follow one another.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BehaviorMeta {
    /// Its name.
    pub name: String,
    /// The primitives it is made of; a primitive is in one behavior at most.
    pub groups: Vec<String>,
}

/// How often one primitive was followed by another.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransitionMeta {
    /// The primitive before.
    pub from: String,
    /// The primitive after.
    pub to: String,
    /// Times seen, at least one.
    pub count: u32,
}

impl VocabularyMeta {
    /// The number of exemplars of all primitives.
    pub fn exemplar_count(&self) -> usize {
        self.primitives.iter().map(|p| p.exemplars.len()).sum()
    }
}
