//! The verb that recognises movement from joint angles.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{ReadArgs, number};

/// A classifier of joint angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ClassifierName {
    /// Follows the movement over primitive, parameters and phase
    Filter,
    /// Judges a few postures together, exactly; primitives, rest and none compete
    Frame,
    /// As published: every primitive by itself, yes or no
    Paper,
}

/// How a classifier sees, where the command line says so.
#[derive(Debug, Default, Args)]
pub struct ClassifierArgs {
    /// frame, paper: postures that are judged together [default: 2]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub n: Option<u16>,
    /// frame, paper: frames from one of them to the next [default: frame 4, paper 1]
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub stride: Option<u16>,
    /// filter: answers to frames are about the moment so many seconds before, so that what followed speaks for it, too;
    /// `about` is its time [default: 0]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = lag)]
    pub lag: Option<f64>,
}

fn lag(text: &str) -> Result<f64, String> {
    number(
        text,
        |v| (0.0..=10.0).contains(&v),
        "seconds, 0 or more, at most 10",
    )
}

/// Recognise movements by joint angles: which primitive, how far into it, in which manner
///
/// Every motion is compared with the vocabulary's primitives. Told are the primitive that the whole is, or that it is at
/// rest or none of them, how probable that is, and what was done when. --frames tells the same of every moment, from what
/// was seen up to it, with phase (from 0 to 1) and parameters (in their own units). On stdin, -, it reads a table of joint
/// angles, as `convert` writes it, and answers every row as it comes; an empty cell is a joint that was not seen.
///
/// --joints looks at a part of the body alone: an arm that waves is seen to wave whatever the legs do meanwhile, and of two
/// movements at a time each is found by its part.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme classify moves.kineme take.bvh              what a motion is, and when
  kineme classify moves.kineme captures/ --json | jq -r '[.motion, .label] | @tsv'
  kineme classify moves.kineme take.bvh --frames     moment by moment: answer, phase, parameters
  kineme classify moves.kineme take.bvh --joints right_arm
                                                     what the right arm does, whatever the rest of the body does
  kineme classify moves.kineme take.bvh --joints trunk,head --frames
                                                     what trunk and head do, moment by moment
  producer | kineme classify moves.kineme - --frames --json
                                                     a stream: a line of JSON a row, at once
  kineme classify moves.kineme take.bvh --method frame --n 3 --stride 6
                                                     three postures judged together, six frames apart
  kineme classify moves.kineme take.bvh --method paper
                                                     the method as published, each primitive by itself
A stream, of the vocabulary's body (`kineme convert take.bvh - --body ares --to csv` writes one):
  time,root_x,root_y,root_z,root_yaw,pelvis_x,pelvis_y,...
  0.00,0,0,0.95,0,0.1,0.02,...
  0.01,,,,,,,...
How well it does on your motions: `kineme evaluate`.")]
pub struct ClassifyArgs {
    /// The vocabulary; - is stdin
    #[arg(value_name = "VOCAB")]
    pub vocabulary: PathBuf,
    /// Motion files, folders, or .zip archives, which act as folders; - is stdin: rows of joint angles, answered one by one
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,
    /// What recognises
    #[arg(long, value_enum, value_name = "METHOD", default_value = "filter")]
    pub method: ClassifierName,
    #[command(flatten)]
    pub classifier: ClassifierArgs,
    /// Look at these parts alone, and at the primitives that move them: left_arm, right_arm, trunk, head, left_leg,
    /// right_leg, or joints [default: the whole body]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub joints: Vec<String>,
    /// Answer every frame; of a stream that is so in any case
    #[arg(long)]
    pub frames: bool,
    #[command(flatten)]
    pub read: ReadArgs,
}
