//! What `kineme reproduce` takes.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// What of the paper is made again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Reproduced {
    /// Figures 1 to 7
    Figures,
    /// Everything
    All,
}

/// Make the paper's figures again, on motion that comes with it
///
/// Drumwright, Jenkins and Mataric (ICRA 2004): figure1 to figure7, each as SVG and as PNG, computed by the code that
/// derives, moves and recognises. Figures 4 to 6 show the exact answer beside the published one. docs/paper.md says what
/// was chosen where the paper leaves it open.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme reproduce figures -o figures             then look at figures/figure1.svg and those after it
  kineme reproduce figures -o figures --force     over those that are there
  kineme reproduce figures -o figures --json | jq -r '.files[]'")]
pub struct ReproduceArgs {
    /// What is made
    #[arg(value_enum, value_name = "WHAT", default_value = "all")]
    pub what: Reproduced,
    /// The folder to write
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
}
