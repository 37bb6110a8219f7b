//! `kineme reproduce`: what the paper shows, made again.

use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use kineme_formats::output::{Existing, write_bytes};
use kineme_paper::demo::find;
use kineme_paper::encoding_test::encoding_test;
use kineme_paper::paper_figures;
use kineme_paper::table1::{MovementSettings, TableSettings, table1};
use serde::Serialize;

use crate::args::{Global, ReproduceArgs, Reproduced};
use crate::failure::{Failure, print};
use crate::json;
use crate::outputs::{existing, refuse_existing, unwritten};
use crate::progress;

/// Where a corpus is looked for when nobody says where it is.
const CORPUS: &str = "../shared/data/mocap";

/// What was written.
#[derive(Serialize)]
struct Written {
    files: Vec<String>,
}

pub fn run(args: &ReproduceArgs, global: &Global) -> Result<u8, Failure> {
    let wants = |what| args.what == what || args.what == Reproduced::All;
    let mut names: Vec<String> = Vec::new();
    if wants(Reproduced::Table1) {
        names.extend(["table1.md".into(), "table1.csv".into()]);
        names.extend(args.timings.then(|| "table1-times.md".into()));
    }
    if wants(Reproduced::Encoding) {
        names.extend(["encoding.md".into(), "encoding.csv".into()]);
    }
    if wants(Reproduced::Figures) {
        names.extend(paper_figures::files().iter().map(|f| f.to_string()));
    }
    let files: Vec<PathBuf> = names.iter().map(|name| args.out.join(name)).collect();
    refuse_existing(files.iter().map(PathBuf::as_path), global)?;
    let corpus = match wants(Reproduced::Table1) || wants(Reproduced::Encoding) {
        true => corpus(args)?,
        false => PathBuf::new(),
    };
    let spinner = progress::spinner();
    let done = make(args, global, &corpus, &spinner);
    spinner.finish_and_clear();
    done?;
    let shown: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    let text = match global.json {
        true => json::line(&Written { files: shown })?,
        false => {
            let made = match args.what {
                Reproduced::Table1 => "Table I of the paper",
                Reproduced::Encoding => "The trajectory encoding test of the paper",
                Reproduced::Figures => {
                    "Figures 1 to 7 of the paper, on the choreographed movements that come with kineme"
                }
                Reproduced::All => {
                    "Table I, the trajectory encoding test and the figures of the paper"
                }
            };
            format!("{made}:\n\n  {}\n", shown.join("\n  "))
        }
    };
    print(text.as_bytes())?;
    Ok(0)
}

/// The corpus that was named, or where one is usually.
fn corpus(args: &ReproduceArgs) -> Result<PathBuf, Failure> {
    let usual = || match std::env::var_os("KINEME_DATA") {
        Some(data) => Path::new(&data).join("mocap"),
        None => PathBuf::from(CORPUS),
    };
    let corpus = args.corpus.clone().unwrap_or_else(usual);
    if corpus.join("index.csv").is_file() {
        return Ok(corpus);
    }
    let message = format!(
        "{}: no motion capture: no index.csv there",
        corpus.display()
    );
    Err(Failure::usage(message).hint("--corpus names the folder that holds it"))
}

fn make(
    args: &ReproduceArgs,
    global: &Global,
    corpus: &Path,
    spinner: &ProgressBar,
) -> Result<(), Failure> {
    let wants = |what| args.what == what || args.what == Reproduced::All;
    let failed = |e: Box<dyn std::error::Error + Send + Sync>| Failure::failed(e.to_string());
    let put = |name: &str, text: &str| put(&args.out.join(name), text, existing(global));
    let watch = &mut |stage: &str| spinner.set_message(stage.to_string());
    if wants(Reproduced::Table1) {
        let usual = TableSettings::default();
        let settings = TableSettings {
            corpus: Some(corpus.to_path_buf()),
            movements: MovementSettings {
                seed: global.seed,
                ..usual.movements
            },
            timings: args.timings,
            ..usual
        };
        let table = table1(&settings, watch).map_err(failed)?;
        put("table1.md", &table.markdown().map_err(failed)?)?;
        put("table1.csv", &table.csv().map_err(failed)?)?;
        if args.timings {
            put(
                "table1-times.md",
                &table.timings_markdown().map_err(failed)?,
            )?;
        }
    }
    if wants(Reproduced::Encoding) {
        let test = encoding_test(corpus, 1, watch).map_err(failed)?;
        put("encoding.md", &test.markdown().map_err(failed)?)?;
        put("encoding.csv", &test.csv().map_err(failed)?)?;
    }
    if wants(Reproduced::Figures) {
        let mut watch = |name: &str| spinner.set_message(name.to_string());
        let found = find(global.seed, &mut |_| {}).map_err(failed)?;
        let figures = paper_figures::draw(&found, &mut watch).map_err(failed)?;
        paper_figures::write(&figures, &args.out, existing(global)).map_err(failed)?;
    }
    Ok(())
}

fn put(path: &Path, text: &str, existing: Existing) -> Result<(), Failure> {
    write_bytes(path, existing, text.as_bytes()).map_err(unwritten)
}
