//! Prints the tables of `docs/derivation.md`: `derivation_table CORPUS`.

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(corpus) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: derivation_table CORPUS (a folder with index.csv and its archives)");
        return ExitCode::from(2);
    };
    let table = kineme_paper::table::derivation_table(&corpus, &mut |set| eprintln!("{set} ..."));
    match table {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("derivation_table: {error}");
            ExitCode::from(3)
        }
    }
}
