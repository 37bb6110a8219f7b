//! The command line, as clap reads it and as `--help` teaches it.

mod classify;
mod control;
mod encode;
mod evaluate;
mod model;
mod reproduce;
mod view;

pub use classify::{ClassifierArgs, ClassifierName, ClassifyArgs};
pub use control::ControlArgs;
#[cfg(feature = "sim")]
pub use control::ServoName;
pub use encode::{EncodeArgs, EncodeMethod};
pub use evaluate::{EvaluateArgs, MethodName};
pub use model::{
    ChoreographArgs, EditArgs, InterpolationName, LearnArgs, Merging, ModelArgs, Parameters,
    Renaming, ShowArgs, SynthesizeArgs, Target,
};
pub use reproduce::{ReproduceArgs, Reproduced};
pub use view::ViewArgs;

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};
use kineme_formats::input::InputRates;

const EXAMPLES: &str = "\
Examples:
  kineme demo                                     see what it does, on motion that comes with it
  kineme info captures/                           what is in a folder, file by file
  kineme derive captures/ -o walk.kineme --report walk
                                                  find the movements in it, and look at them
  kineme learn labels.csv -o moves.kineme         or say which movement is which
  kineme show moves.kineme                        what the primitives are, and how good
  kineme synthesize moves.kineme jab -o jab.bvh --reach right_hand=0.5,-0.35,0.1
                                                  a motion of one, aimed
  kineme control moves.kineme plan.toml --body adonis
                                                  a body that really moves, by a plan of them
  kineme evaluate moves.kineme tests.csv          how well its movements are recognised
  kineme classify moves.kineme take.bvh           which of them a motion is, and when
  kineme encode moves.kineme take.bvh             which of them a motion is, by its hands
  kineme view take.bvh                            a motion, or a vocabulary, in the browser
  kineme convert take.amc take.bvh                another format, nothing lost

Exit codes: 0 done, 1 the work failed, 2 usage, 3 an input cannot be read.";

/// Motor primitives from motion capture.
///
/// Motion capture in, a vocabulary of motor primitives out: recordings are cut into movements, movements that are
/// alike are found, or labelled by hand, and each kind becomes a primitive: a movement that can be shown, varied by its
/// parameters, aimed at a point, and synthesized.
#[derive(Debug, Parser)]
#[command(name = "kineme", version, after_help = EXAMPLES, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub global: Global,
}

/// What every verb takes.
#[derive(Debug, Args)]
#[command(next_help_heading = "Everywhere")]
pub struct Global {
    /// Machine-readable output on stdout; messages stay on stderr
    #[arg(long, global = true)]
    pub json: bool,
    /// Threads to use [default: all cores]; results do not depend on it
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true, value_parser = threads)]
    pub threads: Option<usize>,
    /// Seed of every random choice
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Overwrite files that exist
    #[arg(long, global = true)]
    pub force: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Info(InfoArgs),
    Convert(ConvertArgs),
    Derive(Box<DeriveArgs>),
    Learn(Box<LearnArgs>),
    Choreograph(Box<ChoreographArgs>),
    Show(ShowArgs),
    Edit(Box<EditArgs>),
    Synthesize(Box<SynthesizeArgs>),
    Evaluate(Box<EvaluateArgs>),
    Classify(Box<ClassifyArgs>),
    Encode(Box<EncodeArgs>),
    Control(Box<ControlArgs>),
    View(Box<ViewArgs>),
    Demo(DemoArgs),
    Reproduce(ReproduceArgs),
}

/// How files are read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading")]
pub struct ReadArgs {
    /// Skip inputs that cannot be read, list them at the end, and exit with 3
    #[arg(long)]
    pub keep_going: bool,
    /// Skeleton of AMC files that find no ASF beside them
    #[arg(long, value_name = "FILE")]
    pub asf: Option<PathBuf>,
    /// Frame rate of files that do not say it: HZ, or amc=HZ,positions=HZ,msr=HZ
    #[arg(long, value_name = "HZ|FORMAT=HZ,...", allow_negative_numbers = true, value_parser = InputRates::from_str)]
    pub input_rate: Option<InputRates>,
    /// Which joint is which, where the names are not recognised: a built-in profile, or a TOML file; of markers (C3D) a
    /// file's role lists those that surround its joint
    #[arg(long, value_name = "NAME|FILE")]
    pub profile: Option<String>,
}

/// Show what motion files hold
///
/// For each motion: format, joints, degrees of freedom, frames, rate, duration, the upward axis and unit as detected,
/// and the profile that names its joints.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme info walk.bvh
  kineme info captures/ set.zip                   folders and archives, all that is in them
  kineme info set.zip/inner/walk.bvh              one motion in an archive
  kineme info --json captures/ | jq .duration     a line of JSON a motion")]
pub struct InfoArgs {
    /// Motion files, folders, or .zip archives, which act as folders; - is stdin
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,
    #[command(flatten)]
    pub read: ReadArgs,
}

/// A format of motion that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Written {
    /// Biovision hierarchy: a skeleton and its rotations
    Bvh,
    /// A table: joint angles of a body, or positions
    Csv,
    /// The same table as Parquet, for pandas, Polars and DuckDB
    Parquet,
    /// Arrays for NumPy: rotations or joint angles, and positions
    Npz,
}

/// Write motions as BVH, CSV, Parquet or NPZ, as they are or on another body
///
/// Without --body the recording itself is written, in its own axes and units. With it, its movement is expressed in the
/// joints of that body first.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme convert take.amc take.bvh                the same skeleton and movement as BVH
  kineme convert take.bvh take.csv --positions    where every joint is, metres, z up
  kineme convert take.bvh angles.csv --body ares  joint angles of Ares, radians
  kineme convert take.bvh a.parquet --body ares   the same table as Parquet
  kineme convert take.bvh take.npz --body ares    joint angles and positions as arrays for NumPy
  kineme convert kinect.csv out.bvh --body ares --rate 60
  kineme convert set.zip out/ --to bvh            a folder of outputs, named as the inputs")]
pub struct ConvertArgs {
    /// A motion file, a folder, or a .zip archive; - is stdin
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,
    /// The file to write, .bvh, .csv, .parquet or .npz; for a folder or an archive a folder; - is stdout
    #[arg(value_name = "OUT")]
    pub out: PathBuf,
    /// Express the movement in the joints of this body: ares, adonis, or a robot of an MJCF or URDF file
    #[arg(long, value_name = "NAME|FILE")]
    pub body: Option<String>,
    /// Resample to this rate
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = rate)]
    pub rate: Option<f64>,
    /// World positions of the joints in place of rotations: frame,<joint>_x,... in metres, z up
    #[arg(long)]
    pub positions: bool,
    /// Positions in the file's own axes and unit
    #[arg(long, requires = "positions")]
    pub native: bool,
    /// The format, where OUT's name does not say it
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub to: Option<Written>,
    #[command(flatten)]
    pub read: ReadArgs,
}

/// How recordings are cut into movements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SegmenterName {
    /// At the ends of limb swings, and at rests
    Pendulum,
    /// At pauses in the activity of the joints
    Zfunction,
    /// Where the course of the features changes
    Changepoint,
    /// Not at all: every file is one movement
    Clips,
}

/// How segments are grouped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ClusteringName {
    /// By density on the geodesics
    Hdbscan,
    /// By overlapping intervals of the embedding, as the paper's authors did
    SweepAndPrune,
}

/// How groups are joined to behaviors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SecondLevelName {
    /// Groups that alternate, such as out and back
    Alternation,
    /// A second spatio-temporal Isomap
    Isomap,
    /// Not at all
    None,
}

/// Find the movements that recur, and make a vocabulary of them
///
/// Every recording is expressed in the joints of one body and cut into segments; segments are compared by time warping
/// and embedded by spatio-temporal Isomap; groups of like segments become the primitives of the vocabulary.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme derive captures/ -o moves.kineme                    continuous recordings
  kineme derive captures/ -o moves.kineme --report moves     and look at what was found: moves/report.html
  kineme derive clips.zip -o moves.kineme --segmenter clips  files that hold one movement each
  kineme derive takes/ -o moves.kineme --marks spans.csv     cut by hand: file,start,end in seconds
  kineme derive takes/ -o moves.kineme --duration 1.5        movements of about this length
  kineme derive takes/ -o moves.kineme --shape 0.7           many people or styles: compare shapes, not postures")]
pub struct DeriveArgs {
    /// Motion files, folders, or .zip archives, which act as folders; - is stdin
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,
    /// The vocabulary file to write; - is stdout
    #[arg(short, long, value_name = "VOCAB")]
    pub out: PathBuf,
    /// The body that the vocabulary is of: ares (whole body) or adonis (upper body)
    #[arg(long, value_name = "NAME", default_value = "ares")]
    pub body: String,
    /// How recordings are cut
    #[arg(long, value_enum, default_value = "pendulum", value_name = "METHOD")]
    pub segmenter: SegmenterName,
    /// Cut by hand: a CSV of file,start,end and optionally recording
    #[arg(long, value_name = "FILE.csv", conflicts_with = "segmenter")]
    pub marks: Option<PathBuf>,
    /// Aim at movements whose median length is this
    #[arg(long, value_name = "SECS", allow_negative_numbers = true, value_parser = positive, conflicts_with = "marks")]
    pub duration: Option<f64>,
    /// Share of each segment's mean posture to disregard, 0 to 1
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = share)]
    pub shape: Option<f64>,
    /// Neighbours of a segment in the graph [default: 3 for cut recordings and more where they are many, 8 for clips and marks]
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = count)]
    pub neighbours: Option<usize>,
    /// The smallest group, 2 or more [default: 3 for cut recordings and more where they are many, 5 for clips and marks]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = group)]
    pub min_size: Option<usize>,
    /// How segments are grouped
    #[arg(long, value_enum, default_value = "hdbscan", value_name = "METHOD")]
    pub clustering: ClusteringName,
    /// How groups are joined to behaviors
    #[arg(long, value_enum, default_value = "alternation", value_name = "METHOD")]
    pub second_level: SecondLevelName,
    /// Write a page with figures into this folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Tell how long each step took
    #[arg(long)]
    pub timings: bool,
    #[command(flatten)]
    pub read: ReadArgs,
}

/// See it work, on motion that comes with it
///
/// Primitives of written exemplars move two bodies through a routine and a bout of sparring; what the bodies do is
/// recognised by the same primitives; a session of eight movements is cut and grouped by itself, and compared with what
/// was choreographed. Writes a page on which all of it moves, and the vocabularies and plans to go on with.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme demo                     then open kineme-demo/report.html
  kineme demo -o /tmp/demo --force")]
pub struct DemoArgs {
    /// The folder to write
    #[arg(short, long, value_name = "DIR", default_value = "kineme-demo")]
    pub out: PathBuf,
}

fn number(text: &str, fits: impl Fn(f64) -> bool, wanted: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|v| v.is_finite() && fits(*v))
        .ok_or_else(|| format!("expected {wanted}"))
}

fn positive(text: &str) -> Result<f64, String> {
    number(text, |v| v > 0.0, "a number above 0")
}

fn rate(text: &str) -> Result<f64, String> {
    number(
        text,
        |v| v > 0.0 && v <= 1e4,
        "hertz above 0, at most 10000",
    )
}

fn share(text: &str) -> Result<f64, String> {
    number(text, |v| (0.0..=1.0).contains(&v), "a number from 0 to 1")
}

fn count(text: &str) -> Result<usize, String> {
    let value: Option<usize> = text.parse().ok();
    value
        .filter(|n| *n > 0)
        .ok_or_else(|| "expected a whole number above 0".into())
}

/// The size of a group: who is alone is in none.
fn group(text: &str) -> Result<usize, String> {
    let size = text.parse().ok().filter(|n| *n >= 2);
    size.ok_or_else(|| "expected a whole number of at least 2".into())
}

fn threads(text: &str) -> Result<usize, String> {
    const MOST: usize = 1024;
    count(text).and_then(|n| {
        if n <= MOST {
            Ok(n)
        } else {
            Err(format!("expected at most {MOST}"))
        }
    })
}
