//! `kineme view`: what to look at, and where.

use std::path::PathBuf;

use clap::Args;

use super::ReadArgs;

/// Look at motions, a vocabulary or a result in the browser
///
/// Makes one page of it and serves that page on this machine alone, until the program is ended; or writes it. Motions
/// are shown in their own skeletons, and with --body beside what the body makes of them; a vocabulary as its
/// primitives, with their parameters on sliders.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  kineme view take.bvh                            a motion, moving
  kineme view take.bvh --body ares                beside it the same movement on Ares
  kineme view captures/ -o captures.html          several in one page, written rather than served
  kineme view moves.kineme                        the primitives of a vocabulary
  kineme view kineme-demo                         what demo, or derive --report, wrote")]
pub struct ViewArgs {
    /// Motion files, folders, or .zip archives; or one vocabulary; or the folder of a result
    #[arg(required = true, value_name = "INPUT|VOCAB|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Show each motion on this body, too: ares or adonis
    #[arg(long, value_name = "NAME")]
    pub body: Option<String>,
    /// Write the page into this file instead of serving it; - is stdout
    #[arg(short, long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
    /// The port to serve it on [default: any that is free]
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true,
        conflicts_with = "out"
    )]
    pub port: u16,
    /// Do not open a browser: only tell the address
    #[arg(long, conflicts_with = "out")]
    pub no_open: bool,
    #[command(flatten)]
    pub read: ReadArgs,
}
