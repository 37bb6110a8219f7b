//! Prints the tables of `docs/perception.md`: `recognition_table CORPUS`.
//!
//! `recognition_table CORPUS --export FOLDER` writes clips and splits for `peers/minirocket.py` instead;
//! `recognition_table CORPUS --latency` tells how long a frame takes on this machine; `recognition_table CORPUS --only
//! WORD` makes the stages with that word in their name alone, such as `HDM05` or `streams`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use kineme_paper::recognition::corpora::{Part, UTD, corpora};
use kineme_paper::recognition::export::export;
use kineme_paper::recognition::known::Method;
use kineme_paper::recognition::latency::{Fast, RATE_HZ};
use kineme_paper::recognition::tables::perception_tables;
use kineme_paper::sets::Result;

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let Some(corpus) = arguments.next().map(PathBuf::from) else {
        return usage();
    };
    let rest: Vec<_> = arguments.collect();
    let words: Vec<&str> = rest.iter().filter_map(|a| a.to_str()).collect();
    let done = match words.as_slice() {
        [] => tables(&corpus, None),
        ["--only", word] => tables(&corpus, Some(word)),
        ["--export", folder] => export(&corpus, Path::new(folder)),
        ["--latency"] => latency(&corpus),
        _ => return usage(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("recognition_table: {error}");
            ExitCode::from(3)
        }
    }
}

fn usage() -> ExitCode {
    eprintln!(
        "usage: recognition_table CORPUS [--only WORD | --export FOLDER | --latency] (a folder with index.csv and its archives)"
    );
    ExitCode::from(2)
}

fn tables(corpus: &Path, only: Option<&str>) -> Result<()> {
    let begun = Instant::now();
    let mut watch = |stage: &str| eprintln!("{:6.1} s {stage} ...", begun.elapsed().as_secs_f64());
    print!("{}", perception_tables(corpus, only, &mut watch)?);
    watch("done");
    Ok(())
}

/// Machine-dependent, and therefore in no document.
fn latency(corpus: &Path) -> Result<()> {
    let body = Arc::new(kineme::ares()?);
    let set = corpora(corpus, &body, &[UTD], Part::WHOLE)?.remove(0);
    let fast = Fast::of(&set)?;
    println!(
        "{} primitives, {RATE_HZ} Hz, one core of this machine",
        fast.primitives()
    );
    let begun = Instant::now();
    let mut clock = || begun.elapsed().as_secs_f64();
    for method in [Method::Filter, Method::Frame, Method::Encode, Method::Dtw] {
        let l = fast.latency(method, &mut clock)?;
        println!(
            "{}: median {:.3} ms, p99 {:.3} ms of {} frames",
            method.name(),
            1e3 * l.median_secs,
            1e3 * l.p99_secs,
            l.frames
        );
    }
    Ok(())
}
