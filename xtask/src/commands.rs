//! Commands that run other programs.

use std::ffi::OsStr;
use std::io::{ErrorKind, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::{setup, tidy, viewer};

/// Result of a command: the message of a failure is all that a caller prints.
pub type Outcome = Result<(), String>;

/// The whole workspace with physics.
const WITH_ENGINE: &[&str] = &[
    "--workspace",
    "--features",
    "kineme-cli/sim,kineme-paper/sim",
];
/// What can be built where the engine could not be fetched.
const WITHOUT_ENGINE: &[&str] = &["--workspace", "--exclude", "kineme-sim"];

/// Runs everything that CI asks and prints each step with its time; goes on after a failure, so that one run tells all.
pub fn test(root: &Path, quick: bool) -> Outcome {
    let begun = Instant::now();
    let mut failed: Vec<&str> = Vec::new();
    let mut count = 0;
    let mut step = |name: &'static str, work: &dyn Fn() -> Outcome| {
        println!("== {name}");
        let begun = Instant::now();
        let outcome = work();
        if let Err(message) = &outcome {
            eprintln!("{message}");
            failed.push(name);
        }
        let word = if outcome.is_ok() { "ok" } else { "FAILED" };
        println!("== {name}: {word}, {}", seconds(begun.elapsed()));
        count += 1;
        outcome.is_ok()
    };
    let engine = step("setup", &|| {
        setup::engine(root)?;
        // Tests of the robot say that they skip: no fault of the code's.
        if let Err(message) = setup::g1(root) {
            println!("without the robot: {message}");
        }
        Ok(())
    });
    let built = step("viewer", &|| match viewer::build(root) {
        Err(message) if message.starts_with("node ") => {
            println!("SKIPPED: {message}");
            Ok(())
        }
        done => done,
    });
    let scope = if engine { WITH_ENGINE } else { WITHOUT_ENGINE };
    let all = |command: &[&'static str], rest: &[&'static str]| [command, scope, rest].concat();
    step("format", &|| cargo(root, &["fmt", "--all", "--check"], &[]));
    step("tidy", &|| tidy::run(root));
    step("clippy", &|| {
        let rest = ["--all-targets", "--", "-D", "warnings"];
        cargo(root, &all(&["clippy"], &rest), &[])
    });
    if quick {
        step("tests", &|| {
            let rest = ["--lib", "--bins", "--tests"];
            cargo(root, &all(&["test"], &rest), &[])
        });
    } else {
        step("tests", &|| cargo(root, &all(&["test"], &[]), &[]));
        step("documentation", &|| {
            let denied = [("RUSTDOCFLAGS", "-D warnings")];
            cargo(root, &all(&["doc"], &["--no-deps", "--lib"]), &denied)
        });
    }
    if built {
        step("page in a browser", &|| viewer::test(root));
    }
    let took = seconds(begun.elapsed());
    if failed.is_empty() {
        println!("passed: {count} steps in {took}");
        Ok(())
    } else {
        Err(format!(
            "FAILED: {} (of {count} steps, {took})",
            failed.join(", ")
        ))
    }
}

/// `kineme demo` with these arguments, in release; without physics where the engine cannot be had.
pub fn demo(root: &Path, arguments: &[&str]) -> Outcome {
    if let Err(message) = viewer::build(root) {
        eprintln!("{message}");
    }
    let mut line = vec!["run", "--release", "--package", "kineme-cli"];
    match setup::engine(root) {
        Ok(()) => line.extend(["--features", "sim"]),
        Err(message) => eprintln!("without physics: {message}"),
    }
    line.extend(["--", "demo"]);
    line.extend(arguments);
    cargo(root, &line, &[])
}

/// Runs a fuzz target for some seconds, or every target in turn.
pub fn fuzz(root: &Path, arguments: &[&str]) -> Outcome {
    let (target, seconds) = fuzz_arguments(arguments)?;
    let known = fuzz_targets(root);
    if known.is_empty() {
        return Err("there are no fuzz targets: fuzz/fuzz_targets holds no .rs file".into());
    }
    let chosen: Vec<&String> = match target {
        None => known.iter().collect(),
        Some(name) => match known.iter().find(|k| *k == name) {
            Some(found) => vec![found],
            None => {
                let known = known.join(", ");
                return Err(format!("no fuzz target `{name}`; there are: {known}"));
            }
        },
    };
    let probe = Command::new("cargo")
        .args(["fuzz", "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if !probe.is_ok_and(|status| status.success()) {
        return Err("cargo-fuzz is not here: cargo install cargo-fuzz".into());
    }
    for target in chosen {
        let limit = format!("-max_total_time={seconds}");
        // libFuzzer wants unstable compiler flags; this lets the stable compiler take them.
        let unstable = [("RUSTC_BOOTSTRAP", "1")];
        cargo(root, &["fuzz", "run", target, "--", &limit], &unstable)?;
    }
    Ok(())
}

fn fuzz_arguments<'a>(arguments: &[&'a str]) -> Result<(Option<&'a str>, u32), String> {
    let whole = |text: &str| {
        text.parse::<u32>()
            .map_err(|_| format!("`{text}` is not a whole number of seconds"))
    };
    match arguments {
        [] => Ok((None, 60)),
        [one] => Ok(one.parse().map_or((Some(*one), 60), |secs| (None, secs))),
        [target, secs] => Ok((Some(*target), whole(secs)?)),
        more => Err(format!(
            "fuzz takes a target and seconds, not `{}`",
            more.join(" ")
        )),
    }
}

fn fuzz_targets(root: &Path) -> Vec<String> {
    let Ok(folder) = std::fs::read_dir(root.join("fuzz/fuzz_targets")) else {
        return Vec::new();
    };
    let mut names: Vec<String> = folder
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

/// Runs cargo in the workspace with its output on ours.
fn cargo(root: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> Outcome {
    // Ours must stand before what the child prints.
    let _ = std::io::stdout().flush();
    let outcome = Command::new("cargo")
        .args(arguments)
        .envs(variables.iter().copied())
        .current_dir(root)
        .status();
    let line = arguments.join(" ");
    match outcome {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(format!("cargo {line}: failed")),
        Err(error) if error.kind() == ErrorKind::NotFound => Err("cargo is not on PATH".to_owned()),
        Err(error) => Err(format!("cargo {line}: {error}")),
    }
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}

/// The line below which the tables of a document stand that hold on every machine, and of one that are of a machine.
const TABLES: &str = "<!-- tables: cargo xtask repro -->";
const TIMES: &str = "<!-- tables: cargo xtask bench -->";
/// Documents with tables, and the examples of `kineme-paper` that print them.
const REPRODUCED: [(&str, &str); 5] = [
    ("docs/derivation.md", "derivation_table"),
    ("docs/model.md", "model_table"),
    ("docs/perception.md", "recognition_table"),
    ("docs/control.md", "control_table"),
    ("docs/table1.md", "table1_table"),
];

/// Computes the tables of the documents again and puts them below their marks.
pub fn repro(root: &Path, corpus: Option<&Path>) -> Result<(), String> {
    let corpus = match (corpus, std::env::var_os("KINEME_DATA")) {
        (Some(given), _) => given.to_path_buf(),
        (None, Some(data)) => Path::new(&data).join("mocap"),
        (None, None) => root.join("../shared/data/mocap"),
    };
    setup::engine(root)?;
    if let Err(message) = setup::g1(root) {
        println!("without the robot: {message}");
    }
    for (document, example) in REPRODUCED {
        let tables = tables(root, example, corpus.as_os_str())?;
        replace(&root.join(document), TABLES, &tables)?;
    }
    Ok(())
}

/// Times ourselves on this machine and puts the table into its document.
pub fn bench(root: &Path) -> Outcome {
    setup::engine(root)?;
    let tables = tables(root, "control_table", "--speed".as_ref())?;
    replace(
        &root.join("docs/benchmarks.md"),
        TIMES,
        &format!("\n{}\n\n{tables}", machine()),
    )
}

/// The machine that is timed, where it says so.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    let model = model.map_or("", |m| m.trim_start_matches([' ', '\t', ':']));
    let system = std::env::consts::OS;
    format!(
        "{cores} cores {model}, {system}, kineme {}.",
        env!("CARGO_PKG_VERSION")
    )
}

/// Puts tables below the mark of a document.
fn replace(page: &Path, mark: &str, tables: &str) -> Outcome {
    let failed = |e: std::io::Error| format!("{}: {e}", page.display());
    let text = std::fs::read_to_string(page).map_err(failed)?;
    let (above, _) = text
        .split_once(mark)
        .ok_or_else(|| format!("{}: no line `{mark}`", page.display()))?;
    std::fs::write(page, format!("{above}{mark}\n{tables}")).map_err(failed)?;
    println!("{} is up to date", page.display());
    Ok(())
}

/// What an example of `kineme-paper` prints of a corpus.
fn tables(root: &Path, example: &str, argument: &OsStr) -> Result<String, String> {
    let mut command = Command::new("cargo");
    command.current_dir(root).args([
        "run",
        "--release",
        "--quiet",
        "--package",
        "kineme-paper",
        "--features",
        "sim",
        "--example",
        example,
        "--",
    ]);
    let output = command
        .arg(argument)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    if !output.status.success() {
        return Err(format!("no tables of {example}"));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::fuzz_arguments;

    #[test]
    fn fuzz_takes_a_target_seconds_or_both() {
        assert_eq!(fuzz_arguments(&[]), Ok((None, 60)));
        assert_eq!(fuzz_arguments(&["bvh"]), Ok((Some("bvh"), 60)));
        assert_eq!(fuzz_arguments(&["5"]), Ok((None, 5)));
        assert_eq!(fuzz_arguments(&["bvh", "5"]), Ok((Some("bvh"), 5)));
        assert!(fuzz_arguments(&["bvh", "long"]).is_err());
        assert!(fuzz_arguments(&["bvh", "5", "6"]).is_err());
    }
}
