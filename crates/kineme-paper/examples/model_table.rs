//! Prints the tables of `docs/model.md`: `model_table CORPUS`.

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(corpus) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: model_table CORPUS (a folder with index.csv and its archives)");
        return ExitCode::from(2);
    };
    let begun = std::time::Instant::now();
    let mut watch = |stage: &str| eprintln!("{:6.1} s {stage} ...", begun.elapsed().as_secs_f64());
    match kineme_paper::model_table::model_tables(&corpus, &mut watch) {
        Ok(text) => {
            print!("{text}");
            watch("done");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("model_table: {error}");
            ExitCode::from(3)
        }
    }
}
