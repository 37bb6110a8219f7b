//! What `kineme reproduce` takes.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// What of the paper is made again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Reproduced {
    /// Table I, and what its accuracies hide
    Table1,
    /// The trajectory encoding test
    Encoding,
    /// Figures 1 to 7
    Figures,
    /// Everything
    All,
}

/// Make the paper's table and figures again, on motion that comes with it and on a corpus
///
/// Drumwright, Jenkins and Mataric (ICRA 2004). figures: figure1 to figure7, each as SVG and as PNG, computed by the code
/// that derives, moves and recognises; figures 4 to 6 show the exact answer beside the published one. table1: the
/// accuracy of five behaviors on what simulated Ares does, on animations and on motion capture, beside the baselines.
/// encoding: which of four sets of primitives captured motions are encoded by, the hands alone being seen.
/// docs/paper.md says what was chosen where the paper leaves it open.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme reproduce figures -o figures             then look at figures/figure1.svg and those after it
  kineme reproduce figures -o figures --force     over those that are there
  kineme reproduce table1 -o table --corpus mocap then read table/table1.md
  kineme reproduce encoding -o table --corpus mocap
  kineme reproduce figures -o figures --json | jq -r '.files[]'")]
pub struct ReproduceArgs {
    /// What is made
    #[arg(value_enum, value_name = "WHAT", default_value = "all")]
    pub what: Reproduced,
    /// The folder to write
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Motion capture: a folder with an index.csv and the archives that it lists [default: KINEME_DATA/mocap, else
    /// ../shared/data/mocap]
    #[arg(long, value_name = "INPUT")]
    pub corpus: Option<PathBuf>,
    /// Tell how long a decision takes, in a file of its own
    #[arg(long)]
    pub timings: bool,
}
