//! The verb that moves a body.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::ReadArgs;

/// How motors follow what they are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ServoName {
    /// Proportional-derivative, as Adonis
    Pd,
    /// Inverse dynamics of what is to come, and PD, as Ares
    Feedforward,
    /// Computed torque
    ComputedTorque,
}

/// Move a body by a plan of behaviors
///
/// A plan says which primitive when, in which manner and on which joints; its rules answer what the body watches. The
/// arbiter decides among behaviors that want the same joints: by priority, the winner takes all, or weighted together.
/// The body is simulated (Adonis, Ares, or a robot from an MJCF or URDF file), its pelvis held; what it really did is written
/// and measured against what it was told.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme control boxing.kineme plan.toml --body adonis         on a body of 20 joint angles
  kineme control boxing.kineme plan.toml --body ares -o ring.bvh
  kineme control boxing.kineme plan.toml --body adonis --report ring    and look at it: ring/report.html
  kineme control boxing.kineme plan.toml --body g1.xml         on your robot (.urdf serves too)
  kineme control boxing.kineme spar.toml --watch attacker.bvh  answer what another one does
  producer | kineme control boxing.kineme spar.toml --watch -  answer a live stream of joint angles
A plan:
  rate_hz = 120
  seconds = 6.0
  arbiter = \"superposition\"             # or priority, winner
  [observe]
  motion = \"attacker.bvh\"
  [[behavior]]
  primitive = \"wave-across\"
  start = 0.5
  repeat = 3
  joints = [\"left_arm\"]                 # left_arm right_arm trunk head left_leg right_leg, or joints
  parameters = [0.2, 0.5]               # or: reach = { effector = \"left_hand\", at = [0.5, 0.1, 0.2] }
  weight = 1.0
  priority = 1
  [[rule]]
  when = \"jab\"
  then = { primitive = \"shield\", priority = 5 }")]
pub struct ControlArgs {
    /// The vocabulary; - is stdin
    #[arg(value_name = "VOCAB")]
    pub vocabulary: PathBuf,
    /// The plan
    #[arg(value_name = "PLAN.toml")]
    pub plan: PathBuf,
    /// The body that moves: ares, adonis or an MJCF or URDF file, with the profile of its joints beside it (same stem,
    /// .toml) unless their names tell [default: the vocabulary's]
    #[arg(long, value_name = "NAME|FILE")]
    pub body: Option<String>,
    /// The motion to write, .bvh, .csv, .parquet or .npz: what the body did
    #[arg(short, long, value_name = "OUT")]
    pub out: Option<PathBuf>,
    /// Write a page that shows what the body did into this folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// What it watches in place of the plan's [observe] motion; - is stdin: rows of joint angles
    #[arg(long, value_name = "MOTION")]
    pub watch: Option<PathBuf>,
    /// How motors follow [default: pd for Adonis and robots, feedforward for Ares]
    #[arg(long, value_enum, value_name = "LAW")]
    pub servo: Option<ServoName>,
    /// Without physics: the body is where it is told to be
    #[arg(long, conflicts_with = "servo")]
    pub kinematic: bool,
    /// Tell how fast it ran
    #[arg(long)]
    pub timings: bool,
    #[command(flatten)]
    pub read: ReadArgs,
}
