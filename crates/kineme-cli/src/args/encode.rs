//! The verb that encodes paths of effectors.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{ReadArgs, positive};

/// How movements are encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EncodeMethod {
    /// Exemplars followed at every phase and pace, and what is none of them rejected
    Default,
    /// As published: one posture carried on by flowfields, the best match takes all
    Paper,
}

/// Recognise movements from hands alone, and say them in the vocabulary's joints
///
/// Every motion is compared with what the primitives predict, by the paths of its hands (or other effectors) as seen from
/// between the shoulders; elbows and legs need not be there, and the body may be of any size. Told are the primitive that
/// the whole is, how sure that is, and what was done when; with -o the same movement as the vocabulary's body does it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme encode moves.kineme take.bvh                what a motion is, and when
  kineme encode moves.kineme kinect.csv -o seen.bvh  and the body doing it
  kineme encode moves.kineme set.zip -o encoded/     a folder of them, named as the inputs
  kineme encode moves.kineme take.bvh --effectors left_hand,right_hand,left_foot,right_foot
                                                 feet, too, where they matter
  kineme encode moves.kineme captures/ --json | jq '[.motion, .label]'
  kineme encode moves.kineme take.bvh --method paper  the method as published, which rejects nothing")]
pub struct EncodeArgs {
    /// The vocabulary; - is stdin
    #[arg(value_name = "VOCAB")]
    pub vocabulary: PathBuf,
    /// Motion files, folders, or .zip archives, which act as folders
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,
    /// What is looked at: left_hand, right_hand, left_foot, right_foot, head
    #[arg(
        long,
        value_name = "NAME,...",
        value_delimiter = ',',
        default_value = "left_hand,right_hand"
    )]
    pub effectors: Vec<String>,
    /// Seconds that a decision stands for
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = positive, default_value_t = 0.2)]
    pub interval: f64,
    /// Seconds over which predictions are compared [default: two intervals]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = positive)]
    pub horizon: Option<f64>,
    /// How movements are encoded
    #[arg(long, value_enum, value_name = "METHOD", default_value = "default")]
    pub method: EncodeMethod,
    /// Write what the vocabulary's body does: a .bvh, .csv or .parquet (joint angles) or .npz file, for several motions a folder
    #[arg(short, long, value_name = "ENCODED")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub read: ReadArgs,
}
