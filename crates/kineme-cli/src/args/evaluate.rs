//! The verb that judges recognition.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::ReadArgs;

/// A way to recognise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// The default of `classify`
    Filter,
    /// A few postures judged together, exactly
    Frame,
    /// As published, every primitive by itself
    Paper,
    /// The hands alone, as `encode` hears them
    Encode,
    /// The nearest exemplar by time warping, a baseline
    #[value(name = "1nn-dtw")]
    NearestDtw,
    /// The nearest posture of any exemplar, a baseline
    NearestPosture,
    /// Always the primitive of most exemplars, a baseline
    Constant,
}

/// Judge how well a vocabulary recognises labelled motion
///
/// Every motion of the manifest, or span of one, is recognised as a whole by each method, and the answers are compared
/// with the labels. An empty label says that the motion is none of the primitives, a negative: a good method names none,
/// and finds it novel. Test on other people, or other takes, than the exemplars; what is an exemplar itself is told.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme evaluate moves.kineme tests.csv
  kineme evaluate moves.kineme tests.csv --root captures/     files are named as from there
  kineme evaluate moves.kineme tests.csv --methods filter,paper
  kineme evaluate moves.kineme all.csv --unknown-as-negative  labels that were not learned are strange movements
  kineme evaluate moves.kineme tests.csv --json | jq '.methods.filter.accuracy'
A manifest:
  file,label,start,end
  takes/anna.bvh,jab,0.5,1.2
  takes/anna.bvh,,3.0,5.5
  set.zip/inner/wave.amc,wave,,
Times are those of an answer to one more frame of a stream, on one thread.")]
pub struct EvaluateArgs {
    /// The vocabulary; - is stdin
    #[arg(value_name = "VOCAB")]
    pub vocabulary: PathBuf,
    /// The labelled motions; - is stdin
    #[arg(value_name = "MANIFEST.csv")]
    pub manifest: PathBuf,
    /// The folder or archive that the manifest's files lie in [default: the manifest's folder]
    #[arg(long, value_name = "DIR")]
    pub root: Option<PathBuf>,
    /// What recognises; the first is compared with the others, and its mistakes are listed
    #[arg(
        long,
        value_enum,
        value_name = "METHOD,...",
        value_delimiter = ',',
        default_value = "filter,frame,1nn-dtw,nearest-posture,constant"
    )]
    pub methods: Vec<MethodName>,
    /// Take labels that are no primitive of the vocabulary as negatives
    #[arg(long)]
    pub unknown_as_negative: bool,
    /// Tell how long answers take
    #[arg(long)]
    pub timings: bool,
    #[command(flatten)]
    pub read: ReadArgs,
}
