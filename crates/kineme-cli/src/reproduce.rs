//! `kineme reproduce`: what the paper shows, made again.

use std::path::PathBuf;

use kineme_paper::paper_figures;
use serde::Serialize;

use crate::args::{Global, Reproduced, ReproduceArgs};
use crate::failure::{Failure, print};
use crate::json;
use crate::outputs::{existing, refuse_existing};
use crate::progress;

/// What was written.
#[derive(Serialize)]
struct Written {
    files: Vec<String>,
}

pub fn run(args: &ReproduceArgs, global: &Global) -> Result<u8, Failure> {
    // The figures are all there is so far.
    let (Reproduced::Figures | Reproduced::All) = args.what;
    let files: Vec<PathBuf> = paper_figures::files()
        .iter()
        .map(|name| args.out.join(name))
        .collect();
    refuse_existing(files.iter().map(PathBuf::as_path), global)?;
    let spinner = progress::spinner();
    let drawn = paper_figures::draw(global.seed, &mut |name| spinner.set_message(name));
    spinner.finish_and_clear();
    let failed = |e: Box<dyn std::error::Error + Send + Sync>| Failure::failed(e.to_string());
    let figures = drawn.map_err(failed)?;
    paper_figures::write(&figures, &args.out, existing(global)).map_err(failed)?;
    let shown: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    let text = match global.json {
        true => json::line(&Written { files: shown })?,
        false => format!(
            "Figures 1 to 7 of the paper, on the choreographed movements that come with kineme:\n\n  {}\n",
            shown.join("\n  ")
        ),
    };
    print(text.as_bytes())?;
    Ok(0)
}
