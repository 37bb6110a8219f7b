//! The verbs that make, show, change and use primitives.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};

use super::{ReadArgs, Written, count, positive, rate};

/// How exemplars are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum InterpolationName {
    /// What predicts exemplars best that are left out
    Automatic,
    /// Verbs and Adverbs, through every exemplar
    VerbsAndAdverbs,
    /// Inverse distances, never beyond the exemplars
    Shepard,
}

/// What the parameters of a primitive are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Parameters {
    /// The adverbs that were given, else the principal coordinates.
    Automatic,
    /// The directions in which the exemplars vary most.
    Principal,
    /// The place of this effector at its extreme.
    Effector(String),
}

impl FromStr for Parameters {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "automatic" => Self::Automatic,
            "principal" => Self::Principal,
            effector => Self::Effector(effector.into()),
        })
    }
}

/// How exemplars become a primitive.
#[derive(Debug, Args)]
#[command(next_help_heading = "Modelling")]
pub struct ModelArgs {
    /// How exemplars are weighted
    #[arg(long, value_enum, value_name = "METHOD", default_value = "automatic")]
    pub interpolation: InterpolationName,
    /// What the parameters are: the adverbs given, else principal coordinates (automatic); principal; or an effector's
    /// place at its extreme, such as right_hand
    #[arg(long, value_name = "automatic|principal|EFFECTOR", value_parser = Parameters::from_str)]
    pub parameters: Option<Parameters>,
    /// Primitives that are cycles, such as walking [default: what most exemplars are]
    #[arg(long, value_name = "PRIMITIVE,...", value_delimiter = ',')]
    pub cyclic: Vec<String>,
}

/// Make a vocabulary of labelled motions
///
/// Each label of the manifest becomes a primitive, in the order in which labels first appear, its exemplars the files, or
/// spans of files, that carry it. Columns: file,label and optionally start,end (seconds), rate (hertz, for files that do
/// not say it) and p1,p2,... (adverbs: how the movement is done, in any unit). Rows without a label are ignored. An
/// exemplar of another structure than the others of its label, such as their mirror image, is refused; --keep-going
/// leaves it out and lists it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme learn labels.csv -o moves.kineme
  kineme learn labels.csv -o moves.kineme --root captures/       files are named as from there
  kineme learn labels.csv -o moves.kineme --cyclic walk,run      these come round again
  kineme learn labels.csv -o moves.kineme --parameters right_hand
                                                 where the hand goes to is what varies
A manifest:
  file,label,start,end,p1,p2
  takes/jabs.bvh,jab,0.5,1.2,0.9,-0.2
  takes/jabs.bvh,jab,1.6,2.3,0.4,0.1
  set.zip/inner/wave.amc,wave,,,,")]
pub struct LearnArgs {
    /// The manifest; - is stdin
    #[arg(value_name = "MANIFEST.csv")]
    pub manifest: PathBuf,
    /// The vocabulary file to write; - is stdout
    #[arg(short, long, value_name = "VOCAB")]
    pub out: PathBuf,
    /// The folder or archive that the manifest's files lie in [default: the manifest's folder]
    #[arg(long, value_name = "DIR")]
    pub root: Option<PathBuf>,
    /// The body that the vocabulary is of: ares (whole body) or adonis (upper body)
    #[arg(long, value_name = "NAME", default_value = "ares")]
    pub body: String,
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub read: ReadArgs,
}

/// Make a vocabulary of movements written by hand
///
/// A script is TOML: key postures in degrees by role, and their times. Each [[exemplar]] belongs to a primitive and may
/// have parameters (adverbs) under names of its own; each [[animation]] is a motion that is no primitive.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme choreograph boxing.toml -o boxing.kineme
  kineme choreograph boxing.toml -o boxing.kineme --motions boxing/  and every exemplar as BVH
  kineme choreograph animations.toml --motions negatives/            a script of animations alone
A script:
  body = \"ares\"
  [[exemplar]]
  primitive = \"raise\"
  parameters = { height = 0.5 }
  keys = [
    { time = 0.0 },
    { time = 0.6, right_upper_arm = [90, 0, 0], right_lower_arm = [20] },
  ]")]
pub struct ChoreographArgs {
    /// The script; - is stdin
    #[arg(value_name = "SCRIPT.toml")]
    pub script: PathBuf,
    /// The vocabulary file to write; - is stdout
    #[arg(short, long, value_name = "VOCAB", required_unless_present = "motions")]
    pub out: Option<PathBuf>,
    /// Write every exemplar and animation as BVH into this folder, with a manifest of their labels
    #[arg(long, value_name = "DIR")]
    pub motions: Option<PathBuf>,
    /// The body that moves: ares or adonis [default: the script's]
    #[arg(long, value_name = "NAME")]
    pub body: Option<String>,
    /// Frames a second of exemplars and animations
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = rate, default_value_t = 120.0)]
    pub rate: f64,
    #[command(flatten)]
    pub model: ModelArgs,
}

/// Show the primitives of a vocabulary
///
/// For each: how many exemplars and how long they are, what its parameters are and their range, how exemplars are
/// weighted, and how well each of them is predicted from the others, beside what is simpler: the nearest exemplar, and
/// the mean. With a primitive's name, all that is known of it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme show moves.kineme
  kineme show moves.kineme jab                    its exemplars, their sources, what was tried, notes
  kineme show moves.kineme --json | jq '.primitives[].name'")]
pub struct ShowArgs {
    /// The vocabulary; - is stdin
    #[arg(value_name = "VOCAB")]
    pub vocabulary: PathBuf,
    /// The primitive to show in detail
    #[arg(value_name = "PRIMITIVE")]
    pub primitive: Option<String>,
}

/// `A=B`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Renaming {
    pub from: String,
    pub to: String,
}

/// `A,B,...=C`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Merging {
    pub from: Vec<String>,
    pub to: String,
}

impl FromStr for Renaming {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=').map(|(a, b)| (a.trim(), b.trim())) {
            Some((from, to)) if !from.is_empty() && !to.is_empty() => Ok(Self {
                from: from.into(),
                to: to.into(),
            }),
            _ => Err("expected OLD=NEW".into()),
        }
    }
}

impl FromStr for Merging {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const WANTED: &str = "expected A,B=NEW: two names or more, and the one they get";
        let (from, to) = text.split_once('=').ok_or(WANTED)?;
        let from: Vec<String> = from.split(',').map(|name| name.trim().into()).collect();
        let to = to.trim().to_owned();
        if from.len() < 2 || to.is_empty() || from.iter().any(String::is_empty) {
            return Err(WANTED.into());
        }
        Ok(Self { from, to })
    }
}

/// Change a vocabulary: names, wrong groups, new exemplars
///
/// What is asked for is done in this order, whatever the order on the command line: rename (all at once, so that two
/// names can change places), merge, remove, add. Later steps use the names that earlier ones gave. Behaviors and
/// transitions follow. Primitives that are merged or get exemplars are modelled anew, the others stay as they are, bit
/// for bit.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme edit found.kineme -o named.kineme --rename group-03=wave --rename group-07=jab
  kineme edit found.kineme -o fewer.kineme --merge group-01,group-04=walk --remove group-09
  kineme edit moves.kineme -o more.kineme --add new-takes.csv --root captures/
                                                 exemplars for what is there, or new primitives
  kineme edit moves.kineme -o moves.kineme --force --remove jab")]
pub struct EditArgs {
    /// The vocabulary; - is stdin
    #[arg(value_name = "VOCAB")]
    pub vocabulary: PathBuf,
    /// The vocabulary file to write; - is stdout
    #[arg(short, long, value_name = "OUT")]
    pub out: PathBuf,
    /// Give a primitive another name
    #[arg(long, value_name = "A=B", value_parser = Renaming::from_str)]
    pub rename: Vec<Renaming>,
    /// Make one primitive of several
    #[arg(long, value_name = "A,B=C", value_parser = Merging::from_str)]
    pub merge: Vec<Merging>,
    /// Drop primitives
    #[arg(long, value_name = "A,...", value_delimiter = ',')]
    pub remove: Vec<String>,
    /// Add the labelled motions of a manifest, as learn reads it
    #[arg(long, value_name = "MANIFEST.csv")]
    pub add: Option<PathBuf>,
    /// The folder or archive that the manifest's files lie in [default: the manifest's folder]
    #[arg(long, value_name = "DIR", requires = "add")]
    pub root: Option<PathBuf>,
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub read: ReadArgs,
}

/// `EFFECTOR=X,Y,Z`.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    pub effector: String,
    pub place: [f64; 3],
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const WANTED: &str =
            "expected EFFECTOR=X,Y,Z: metres forward, left and up from between the shoulders";
        /// Beyond any room, metres.
        const FAR: f64 = 1000.0;
        let (effector, place) = text.split_once('=').ok_or(WANTED)?;
        let near = |text| finite(text).filter(|v| v.abs() <= FAR);
        let place: Option<Vec<f64>> = place.split(',').map(near).collect();
        let place = place.and_then(|p| p.try_into().ok()).ok_or(WANTED)?;
        Ok(Self {
            effector: effector.trim().into(),
            place,
        })
    }
}

/// `P1,P2,...`.
#[derive(Debug, Clone, PartialEq)]
pub struct Values(pub Vec<f64>);

impl FromStr for Values {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let values: Option<Vec<f64>> = text.split(',').map(finite).collect();
        let values = values.ok_or("expected numbers with commas between them")?;
        Ok(Self(values))
    }
}

fn finite(text: &str) -> Option<f64> {
    let value: f64 = text.trim().parse().ok()?;
    value.is_finite().then_some(value)
}

/// Write a motion of a primitive
///
/// The movement at the parameters asked for, or at those that bring a hand to a point; from its own beginning, or from any
/// posture, which is left smoothly. When it misses the point it is written all the same, and how far is told.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme synthesize boxing.kineme jab -o jab.bvh               the middle of its exemplars
  kineme synthesize boxing.kineme jab -o jab.bvh --at 0.9,0.2  parameters, as `kineme show` has them
  kineme synthesize boxing.kineme jab -o jab.bvh --reach right_hand=0.5,-0.35,0.1
                                           metres forward, left and up from between the shoulders
  kineme synthesize moves.kineme walk -o walk.csv --cycles 5 --from-pose take.bvh@2.5
  kineme synthesize moves.kineme walk -o - --to csv | head     joint angles on stdout")]
pub struct SynthesizeArgs {
    /// The vocabulary; - is stdin
    #[arg(value_name = "VOCAB")]
    pub vocabulary: PathBuf,
    /// Which of its primitives
    #[arg(value_name = "PRIMITIVE")]
    pub primitive: String,
    /// The file to write, .bvh, .csv or .parquet (joint angles) or .npz; - is stdout
    #[arg(short, long, value_name = "OUT")]
    pub out: PathBuf,
    /// The format, where OUT's name does not say it
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub to: Option<Written>,
    /// The parameters, in their own units [default: the middle of the exemplars]
    #[arg(long, value_name = "P1,P2,...", allow_hyphen_values = true, value_parser = Values::from_str)]
    pub at: Option<Values>,
    /// Find the parameters that bring this effector to a point: metres in the thorax frame (forward, left and up from
    /// between the shoulders)
    #[arg(long, value_name = "EFFECTOR=X,Y,Z", value_parser = Target::from_str, conflicts_with = "at")]
    pub reach: Option<Target>,
    /// How long it takes, all cycles included, and joining it from --from-pose [default: as long as the exemplars]
    #[arg(long, value_name = "SECS", allow_negative_numbers = true, value_parser = positive)]
    pub duration: Option<f64>,
    /// How many cycles of a primitive that is one [default: 1, or as many as fit --duration best]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = count)]
    pub cycles: Option<usize>,
    /// Frames a second
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = rate, default_value_t = 120.0)]
    pub rate: f64,
    /// A motion whose first posture, or that at SECS, is where the body starts
    #[arg(long, value_name = "FILE[@SECS]")]
    pub from_pose: Option<String>,
    #[command(flatten)]
    pub read: ReadArgs,
}
