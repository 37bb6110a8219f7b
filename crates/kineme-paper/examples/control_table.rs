//! Prints the tables of `docs/control.md`: `control_table CORPUS [G1.xml]`; with `--speed`, those of
//! `docs/benchmarks.md`, which are of this machine.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use kineme_paper::control::tables::{control_tables, speed_table};
use kineme_paper::sets::Result;

/// Where `cargo xtask setup --robots` puts the robot.
const G1: &str = ".mujoco/robots/unitree_g1/g1.xml";

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let done = match arguments.as_slice() {
        [only] if only.as_os_str() == "--speed" => speed_table(),
        [corpus] => tables(corpus, Path::new(G1)),
        [corpus, g1] => tables(corpus, g1),
        _ => {
            eprintln!("usage: control_table CORPUS [G1.xml] | --speed");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("control_table: {error}");
            ExitCode::from(3)
        }
    }
}

fn tables(corpus: &Path, g1: &Path) -> Result<String> {
    let begun = Instant::now();
    let mut watch = |stage: &str| eprintln!("{:6.1} s {stage} ...", begun.elapsed().as_secs_f64());
    control_tables(corpus, Some(g1), &mut watch)
}
