//! The binary `kineme`: verbs over the library, with messages, progress and exit codes.

mod args;
mod bodies;
mod choreograph;
mod classify;
mod control;
mod convert;
mod demo;
mod derive;
mod describe;
mod draft;
mod edit;
mod encode;
mod evaluate;
mod failure;
mod findings;
mod info;
mod json;
mod labelled;
mod learn;
mod observed;
mod outputs;
mod progress;
mod recognisers;
mod reproduce;
mod show;
mod source;
mod synthesize;
mod table;
mod view;
mod vocabularies;
mod warnings;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use failure::{Failure, complain};

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(told) if !told.use_stderr() => {
            // Help and version; a reader that has gone away needs neither.
            let _ = told.print();
            return ExitCode::SUCCESS;
        }
        Err(told) => {
            let text = told.render().to_string();
            complain(text.strip_prefix("error: ").unwrap_or(&text).trim_end());
            return ExitCode::from(failure::USAGE);
        }
    };
    match run(&cli) {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            failure.print();
            ExitCode::from(failure.code)
        }
    }
}

/// Runs the verb; the code is 0, or 3 where inputs were skipped.
fn run(cli: &Cli) -> Result<u8, Failure> {
    if let Some(threads) = cli.global.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .map_err(|e| Failure::failed(format!("no {threads} threads: {e}")))?;
    }
    match &cli.command {
        Command::Info(args) => info::run(args, &cli.global),
        Command::Convert(args) => convert::run(args, &cli.global),
        Command::Derive(args) => derive::run(args, &cli.global),
        Command::Learn(args) => learn::run(args, &cli.global),
        Command::Choreograph(args) => choreograph::run(args, &cli.global),
        Command::Show(args) => show::run(args, &cli.global),
        Command::Edit(args) => edit::run(args, &cli.global),
        Command::Synthesize(args) => synthesize::run(args, &cli.global),
        Command::Evaluate(args) => evaluate::run(args, &cli.global),
        Command::Classify(args) => classify::run(args, &cli.global),
        Command::Control(args) => control::run(args, &cli.global),
        Command::Encode(args) => encode::run(args, &cli.global),
        Command::View(args) => view::run(args, &cli.global),
        Command::Demo(args) => demo::run(args, &cli.global),
        Command::Reproduce(args) => reproduce::run(args, &cli.global),
    }
}
