//! Movements recognised from hands alone.

mod common;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use common::{done, json, kineme, vocabularies};
use serde_json::Value;

/// A folder with the vocabulary of punching and a motion of each of its primitives.
fn punches() -> tempfile::TempDir {
    let folder = vocabularies();
    fs::create_dir(folder.path().join("in")).expect("a folder");
    for name in ["punch-out", "punch-return"] {
        done(
            folder.path(),
            &format!("synthesize punching.kineme {name} -o in/{name}.bvh --at 0.4,0.6 --rate 60"),
        );
    }
    folder
}

fn lines(text: &str) -> Vec<Value> {
    let parse = |line: &str| serde_json::from_str(line).expect("JSON");
    text.lines().map(parse).collect()
}

#[test]
fn a_motion_of_a_primitive_is_told_by_its_hands_and_made_again() {
    let folder = punches();
    let at = folder.path();
    for name in ["punch-out", "punch-return"] {
        let line = format!("encode punching.kineme in/{name}.bvh --json -o {name}.bvh");
        let told = json(at, &line);
        assert_eq!(told["label"], name);
        assert_eq!(told["motion"], format!("in/{name}.bvh"));
        let sum: f64 = told["posterior"]
            .as_object()
            .expect("a posterior")
            .values()
            .filter_map(Value::as_f64)
            .sum();
        assert!((sum - 1.0).abs() < 1e-9);
        assert!(told["scores"][name].as_f64() > Some(0.8), "{told}");
        assert!(told["rmse"].as_f64() < Some(0.1), "{told}");
        let spans = told["spans"].as_array().expect("spans");
        assert_eq!(spans[0]["start"], 0.0);
        assert!(spans.iter().any(|s| s["primitive"] == name), "{told}");
        // What was written is a motion of the body that makes the same movement.
        let again = json(at, &format!("encode punching.kineme {name}.bvh --json"));
        assert_eq!(again["label"], name);
        // Bare points do as well, elbows or not.
        done(at, &format!("convert in/{name}.bvh {name}.csv --positions"));
        let table = fs::read_to_string(at.join(format!("{name}.csv"))).expect("a table");
        fs::write(at.join("bare.csv"), torso_and_wrists(&table)).expect("a table");
        let bare = json(at, "encode punching.kineme bare.csv --json --input-rate 60");
        assert_eq!(bare["label"], name, "{bare}");
    }
    let told = done(at, "encode punching.kineme in/punch-out.bvh").out;
    assert!(told.starts_with("in/punch-out.bvh: punch-out "), "{told}");
    let paper = json(
        at,
        "encode punching.kineme in/punch-out.bvh --method paper --json",
    );
    assert_eq!(paper["posterior"]["none"], 0.0);
}

/// The columns of shoulders, wrists and pelvis.
fn torso_and_wrists(table: &str) -> String {
    let header: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let wanted = [
        "frame",
        "time",
        "pelvis",
        "left_shoulder",
        "right_shoulder",
        "left_wrist",
        "right_wrist",
    ];
    let kept: Vec<usize> = (0..header.len())
        .filter(|&c| {
            wanted.contains(
                &header[c]
                    .trim_end_matches(['x', 'y', 'z'])
                    .trim_end_matches('_'),
            )
        })
        .collect();
    table
        .lines()
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let kept: Vec<&str> = kept.iter().map(|&c| cells[c]).collect();
            kept.join(",") + "\n"
        })
        .collect()
}

#[test]
fn a_folder_becomes_a_folder_the_same_on_one_thread_or_many() {
    let folder = punches();
    let at = folder.path();
    let one = done(at, "encode punching.kineme in --json -o one --threads 1");
    let many = done(at, "encode punching.kineme in --json -o many --threads 3");
    assert_eq!(one.out, many.out);
    let told = lines(&one.out);
    let labels: Vec<&Value> = told.iter().map(|t| &t["label"]).collect();
    assert_eq!(labels, ["punch-out", "punch-return"]);
    for name in ["punch-out.bvh", "punch-return.bvh"] {
        let read = |folder: &str| fs::read(at.join(folder).join(name)).expect("a motion");
        assert_eq!(read("one"), read("many"));
    }
}

#[test]
fn what_cannot_be_is_told_with_its_code() {
    let folder = punches();
    let at = folder.path();
    fs::write(at.join("there.bvh"), "").expect("a file");
    fs::write(at.join("dots.csv"), "frame,a_x,a_y,a_z\n0,1,2,3\n1,1,2,3\n").expect("a table");
    let cases = [
        ("in/punch-out.bvh --effectors nose", 2, "unknown effector"),
        ("in/punch-out.bvh --interval 0", 2, "above 0"),
        ("in/punch-out.bvh --interval 1e9", 2, "decisions of"),
        ("in/punch-out.bvh --horizon 100", 2, "horizon"),
        ("in/punch-out.bvh -o there.bvh", 2, "exists already"),
        ("in/punch-out.bvh -o -", 2, "stdout"),
        ("in -o one.bvh", 2, "give a folder"),
        ("no.bvh", 3, "no.bvh"),
        ("dots.csv", 3, "shoulders"),
    ];
    for (line, code, word) in cases {
        let line = format!("encode punching.kineme {line}");
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let run = kineme(at, &arguments);
        assert_eq!(run.code, code, "kineme {line}: {}", run.err);
        assert!(run.err.contains(word), "kineme {line}: {}", run.err);
    }
}

/// The folder of the motion data, where it is.
fn corpus() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("KINEME_DATA").map_or(beside, PathBuf::from);
    let found = data.join("mocap/utd-mhad.zip");
    found.exists().then_some(found)
}

#[test]
fn real_people_are_known_by_their_hands() {
    let Some(archive) = corpus() else {
        println!("skipped: no motion data");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    // Swipe left, wave, throw, boxing and tennis serve: two people to learn from, a third to recognise.
    let actions = [1, 3, 5, 8, 17];
    let mut manifest = String::from("file,label\n");
    let inside = "utd-mhad.zip/utd-mhad";
    for a in actions {
        for (subject, take) in [(1, 1), (1, 2), (3, 1), (3, 2)] {
            writeln!(manifest, "{inside}/a{a:02}_s{subject}_t{take}.csv,a{a:02}").expect("a row");
        }
    }
    fs::write(at.join("labels.csv"), manifest).expect("a manifest");
    let root = archive.parent().expect("a folder").display().to_string();
    done(
        at,
        &format!("learn labels.csv -o people.kineme --root {root} --keep-going"),
    );
    let tests = actions.map(|a| format!("{root}/{inside}/a{a:02}_s5_t1.csv"));
    let told = done(
        at,
        &format!("encode people.kineme {} --json", tests.join(" ")),
    );
    let best = |told: &Value| {
        let scores = told["scores"].as_object().expect("scores");
        let scores: BTreeMap<&String, f64> = scores
            .iter()
            .map(|(k, v)| (k, v.as_f64().expect("a number")))
            .collect();
        let best = scores.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        best.expect("a primitive").0.clone()
    };
    let told = lines(&told.out);
    let right = told
        .iter()
        .zip(actions)
        .filter(|(t, a)| best(t) == format!("a{a:02}"));
    assert!(right.count() >= 4, "{told:?}");
}
