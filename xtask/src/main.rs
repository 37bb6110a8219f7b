//! `cargo xtask`: the commands of those who work on the project.

mod commands;
mod setup;
mod tidy;
mod viewer;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HELP: &str = "\
cargo xtask COMMAND: what those who work on kineme run

  test [--quick]             all that CI asks: setup, viewer, formatting, tidy, clippy with warnings denied,
                             tests and doc-tests, documentation with warnings denied, the page in a browser.
                             --quick leaves out doc-tests and documentation
  setup [--robots]           fetch what physics needs, once: the engine into .mujoco/lib, and with --robots the humanoid
                             Unitree G1 into .mujoco/robots; wants python3 with pip. `test` and `demo` do it themselves
  viewer                     build the program of the page, so that the next build of kineme carries it; wants node.
                             `test` and `demo` do it themselves where node is
  screenshot                 the picture in the README, taken of the demo's page; wants node and Chromium
  tidy                       only the rules that rustc and clippy do not know: floors between rooms
                             (the table in ARCHITECTURE.md), length of files, paths named in documents,
                             the code map, the CHANGELOG's heading, paths of somebody's machine
  demo [-- ARGS]             kineme demo ARGS, in release, with physics
  repro [CORPUS]             the tables of docs/derivation.md, model.md, perception.md, control.md and table1.md, computed
                             again from a corpus of labelled motion (default: KINEME_DATA/mocap, else ../shared/data/mocap)
  bench                      time control on this machine, for docs/benchmarks.md
  fuzz [TARGET] [SECONDS]    run one fuzz target, or each in turn, for so long (60 s); wants cargo-fuzz

CI runs `cargo xtask test` and nothing else: what passes here passes there.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match arguments.as_slice() {
        [] | ["help" | "--help" | "-h", ..] => {
            print!("{HELP}");
            Ok(())
        }
        ["test"] => commands::test(&root(), false),
        ["test", "--quick"] => commands::test(&root(), true),
        ["setup"] => setup::run(&root(), false),
        ["setup", "--robots"] => setup::run(&root(), true),
        ["viewer"] => viewer::build(&root()),
        ["screenshot"] => viewer::screenshot(&root()),
        ["tidy"] => tidy::run(&root()),
        ["demo", "--", rest @ ..] | ["demo", rest @ ..] => commands::demo(&root(), rest),
        ["repro"] => commands::repro(&root(), None),
        ["repro", corpus] => commands::repro(&root(), Some(Path::new(corpus))),
        ["bench"] => commands::bench(&root()),
        ["fuzz", rest @ ..] => commands::fuzz(&root(), rest),
        other => {
            eprint!(
                "cargo xtask: cannot make sense of `{}`\n\n{HELP}",
                other.join(" ")
            );
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// The workspace: the folder above this crate.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
