//! Prints the tables of `docs/table1.md`: `table1_table CORPUS`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use kineme_paper::encoding_test::encoding_test;
use kineme_paper::sets::Result;
use kineme_paper::table1::{TableSettings, table1};

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(corpus), None) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: table1_table CORPUS");
        return ExitCode::from(2);
    };
    match tables(corpus) {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("table1_table: {error}");
            ExitCode::from(3)
        }
    }
}

fn tables(corpus: PathBuf) -> Result<String> {
    let begun = Instant::now();
    let mut watch = |stage: &str| eprintln!("{:6.1} s {stage} ...", begun.elapsed().as_secs_f64());
    let encoding = encoding_test(&corpus, 1, &mut watch)?.markdown()?;
    let settings = TableSettings {
        corpus: Some(corpus),
        ..TableSettings::default()
    };
    let table = table1(&settings, &mut watch)?.markdown()?;
    Ok(format!("{table}\n{encoding}"))
}
