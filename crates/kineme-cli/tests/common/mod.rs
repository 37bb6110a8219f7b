//! Running the binary.
#![allow(dead_code, reason = "every test file uses its part")]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use kineme::{Primitive, Vocabulary};
use serde_json::Value;

/// What a run left behind.
pub struct Run {
    pub code: i32,
    pub out: String,
    pub err: String,
}

/// A fixture of `tests/data`.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

/// Runs `kineme` in `folder`.
pub fn kineme<S: AsRef<std::ffi::OsStr>>(folder: &Path, arguments: &[S]) -> Run {
    with_input(folder, arguments, b"")
}

/// Runs `kineme` in `folder` with these bytes on standard input.
pub fn with_input<S: AsRef<std::ffi::OsStr>>(folder: &Path, arguments: &[S], input: &[u8]) -> Run {
    let mut child = Command::new(env!("CARGO_BIN_EXE_kineme"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary");
    let mut stdin = child.stdin.take().expect("stdin");
    let input = input.to_vec();
    let writing = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().expect("a run");
    writing.join().expect("input written");
    Run {
        code: output.status.code().expect("no signal"),
        out: String::from_utf8(output.stdout).expect("text"),
        err: String::from_utf8(output.stderr).expect("text"),
    }
}

/// A folder with both fixtures.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["arms.bvh", "points.csv"] {
        std::fs::copy(data(name), folder.path().join(name)).expect("a fixture");
    }
    folder
}

/// A zip archive of files.
pub fn archive(path: &Path, files: &[(&str, &[u8])]) {
    let mut zip = zip::ZipWriter::new(std::fs::File::create(path).expect("an archive"));
    for (name, content) in files {
        zip.start_file(*name, zip::write::SimpleFileOptions::default())
            .expect("an entry");
        zip.write_all(content).expect("content");
    }
    zip.finish().expect("an archive");
}

/// A run that succeeds.
pub fn done(folder: &Path, line: &str) -> Run {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let run = kineme(folder, &arguments);
    assert_eq!(run.code, 0, "kineme {line}: {}", run.err);
    run
}

/// The document that a run prints.
pub fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&done(folder, line).out).expect("JSON")
}

/// A folder with the written vocabularies of punching and waving.
pub fn scripts() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let written = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../choreography");
    for name in ["punching.toml", "horizontal-waving.toml"] {
        std::fs::copy(written.join(name), folder.path().join(name)).expect("a script");
    }
    folder
}

/// The same, as vocabularies.
pub fn vocabularies() -> tempfile::TempDir {
    let folder = scripts();
    for name in ["punching", "horizontal-waving"] {
        let line = format!("choreograph {name}.toml -o {name}.kineme");
        done(folder.path(), &line);
    }
    folder
}

/// The vocabulary in a file.
pub fn vocabulary(folder: &Path, name: &str) -> Vocabulary {
    let bytes = std::fs::read(folder.join(name)).expect("a vocabulary");
    kineme_formats::vocabulary::read(name, &bytes).expect("a vocabulary")
}

/// The primitives of a vocabulary.
pub fn names(vocabulary: &Vocabulary) -> Vec<&str> {
    vocabulary
        .primitives()
        .iter()
        .map(Primitive::name)
        .collect()
}

/// The rows of a table of numbers below its header.
pub fn numbers(folder: &Path, name: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(folder.join(name)).expect("a table");
    let row = |line: &str| {
        line.split(',')
            .map(|c| c.parse().expect("a number"))
            .collect()
    };
    text.lines().skip(1).map(row).collect()
}
