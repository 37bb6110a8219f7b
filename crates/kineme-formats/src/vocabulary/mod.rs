//! The vocabulary file `*.kineme`: a safetensors container.
//!
//! Its metadata holds one JSON document under the key `kineme`: version, units, checksum of the tensors, and
//! the vocabulary as [`VocabularyMeta`]. Everything long stands in tensors of little-endian f64, those of exemplar `i`
//! and of primitive `j`, both counted from 0 through the whole vocabulary in order, under six digits:
//!
//! | tensor | shape | holds |
//! | --- | --- | --- |
//! | `exemplar-<i>/poses` | frames x coordinates | joint coordinates, radians |
//! | `exemplar-<i>/root` | frames x 4 | x, y, z in metres, z up, and yaw in radians |
//! | `exemplar-<i>/warp` | knots | places in the part used, 0 to 1, at evenly spaced phases |
//! | `primitive-<j>/points` | exemplars x parameters | the exemplars' parameters, in the unit cube |
//! | `primitive-<j>/reference` | knots x landmarks | registered mean landmarks, metres |
//! | `primitive-<j>/mean`, `primitive-<j>/directions` | length; parameters x length | where parameters are principal coordinates: the mean shape and one direction a parameter |
//!
//! With the exemplars these numbers are the primitive: nothing is fitted when a file is read, and what is read and
//! written again has the same bytes. A Python program has them by
//! `safetensors.numpy.load_file("moves.kineme")`, the document by
//! `json.loads(safetensors.safe_open("moves.kineme", "numpy").metadata()["kineme"])`.

mod bind;
mod check;
mod container;
mod fit;

pub use bind::{read, write};
pub use fit::{
    ErrorMeta, FitMeta, KernelMeta, MethodMeta, ParameterMeta, SourceMeta, TailMeta, TrialMeta,
};

use serde::{Deserialize, Serialize};

/// The version of the document that this program writes.
pub const VERSION: u64 = 3;

/// The oldest version that it reads: as [`VERSION`], without calibrations.
pub const OLDEST_VERSION: u64 = 2;

/// The most exemplars a file may hold: the six digits of a tensor's name.
pub const MAX_EXEMPLARS: usize = 1_000_000;

/// What a vocabulary file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct VocabularyFile {
    /// Everything but long rows of numbers.
    pub meta: VocabularyMeta,
    /// The movements, in the order of the exemplars in [`VocabularyMeta::primitives`].
    pub exemplars: Vec<ExemplarTensors>,
    /// What was fitted, in the order of [`VocabularyMeta::primitives`].
    pub fits: Vec<FitTensors>,
}

/// The movement of one exemplar.
#[derive(Debug, Clone, PartialEq)]
pub struct ExemplarTensors {
    /// Joint coordinates, radians, frame-major: `poses[frame * coordinates + coordinate]`.
    pub poses: Vec<f64>,
    /// The root's path, one a frame: x, y, z in metres (z up) and yaw in radians.
    pub root: Vec<[f64; 4]>,
    /// Places in the part used, from 0 to 1, at evenly spaced phases.
    pub warp: Vec<f64>,
}

/// The long rows of numbers of one primitive's fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitTensors {
    /// The exemplars' parameters in the unit cube: `points[exemplar * parameters + parameter]`.
    pub points: Vec<f64>,
    /// Registered mean landmarks, metres: `reference[knot * landmarks + landmark]`.
    pub reference: Vec<f64>,
    /// The transform to principal coordinates, where they are the parameters.
    pub principal: Option<PrincipalTensors>,
}

/// The transform from shape to principal coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct PrincipalTensors {
    /// The mean shape, metres.
    pub mean: Vec<f64>,
    /// A direction a parameter: `directions[parameter * mean.len() + i]`.
    pub directions: Vec<f64>,
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
    /// How many numbers the body's landmarks are.
    pub landmarks: u64,
    /// The primitives, at least one, each name once.
    pub primitives: Vec<PrimitiveMeta>,
    /// The second level: primitives that belong together.
    pub behaviors: Vec<BehaviorMeta>,
    /// Which primitives were seen to follow which; pairs that never did are left out.
    pub transitions: Vec<TransitionMeta>,
    /// What recognisers learned of the vocabulary, each recogniser once; none in version 2.
    #[serde(default)]
    pub calibrations: Vec<CalibrationMeta>,
}

/// A primitive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrimitiveMeta {
    /// Its name.
    pub name: String,
    /// What the derivation knew of its group; `None` where a person determined it.
    pub group: Option<GroupMeta>,
    /// What was fitted.
    pub fit: FitMeta,
    /// Its exemplars, at least one.
    pub exemplars: Vec<ExemplarMeta>,
}

/// The group that a primitive was derived from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupMeta {
    /// How many segments it had, of which the exemplars are some.
    pub members: u64,
    /// How well they cohere; `None` where it was not measured.
    pub coherence: Option<f64>,
}

/// Where an exemplar comes from, and what of it is used.
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
    /// What a person said of it, in the adverbs' own units.
    pub adverbs: Option<Vec<f64>>,
    /// The first frame and the last that are used, not always whole.
    pub used: [f64; 2],
    /// Where in that part phase 0 is, as a share of it, in [0, 1): 0 but for cycles read round their end.
    pub shift: f64,
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

/// What a recogniser learned of the vocabulary by leaving exemplars out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationMeta {
    /// Its name, such as `filter`; what the numbers mean is for it to know.
    pub recogniser: String,
    /// Every primitive of the vocabulary, in the same order, with equally many numbers each.
    pub primitives: Vec<CalibratedMeta>,
    /// Numbers of the whole, such as a temperature.
    pub shared: Vec<f64>,
}

/// What a recogniser learned of one primitive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibratedMeta {
    /// The primitive's name.
    pub name: String,
    /// Finite numbers.
    pub numbers: Vec<f64>,
}

impl VocabularyMeta {
    /// The number of exemplars of all primitives.
    pub fn exemplar_count(&self) -> usize {
        self.primitives.iter().map(|p| p.exemplars.len()).sum()
    }
}
