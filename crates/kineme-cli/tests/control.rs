//! `kineme control`: plans that move a body.

mod common;

use std::fs;
use std::path::Path;

use common::{done, json, kineme, vocabularies, with_input};

const WAVE: &str = "\
seconds = 2.0
arbiter = \"superposition\"
[[behavior]]
primitive = \"wave-across\"
start = 0.2
[[behavior]]
primitive = \"wave-return\"
start = 1.0
";

const SPAR: &str = "\
seconds = 1.5
[observe]
motion = \"out.csv\"
[[rule]]
when = \"punch-out\"
then = { primitive = \"punch-return\", priority = 5 }
";

#[test]
fn a_plan_is_carried_out_and_what_was_done_is_told_and_written() {
    let folder = vocabularies();
    let at = folder.path();
    fs::write(at.join("wave.toml"), WAVE).expect("a plan");
    for body in ["ares", "adonis"] {
        let line = format!(
            "control horizontal-waving.kineme wave.toml --body {body} --json -o {body}.bvh --threads 1"
        );
        let told = json(at, &line);
        assert_eq!(told["body"], body);
        assert_eq!(told["dof"], if body == "ares" { 132 } else { 20 });
        assert_eq!(told["physics"], cfg!(feature = "sim"));
        assert_eq!(told["seconds"], 2.0);
        assert!(told["real_time_factor"].is_null(), "no measured times");
        let rms = told["tracking_rms_rad"].as_f64().expect("a number");
        assert!((0.0..0.05).contains(&rms), "{rms}");
        let behaviors = told["behaviors"].as_array().expect("a list");
        let names: Vec<_> = behaviors.iter().map(|b| b["primitive"].clone()).collect();
        assert_eq!(names, ["wave-across", "wave-return"]);
        let info = json(at, &format!("info {body}.bvh --json"));
        assert_eq!(info["frames"], 240);
        let again = json(at, &line.replace(".bvh", ".2.bvh").replace("1", "2"));
        assert_eq!(told["tracking_rms_rad"], again["tracking_rms_rad"]);
    }
    let refused = kineme(
        at,
        &[
            "control",
            "horizontal-waving.kineme",
            "wave.toml",
            "-o",
            "ares.bvh",
        ],
    );
    assert_eq!(refused.code, 2, "an existing file is kept: {}", refused.err);
}

#[test]
fn what_is_watched_is_answered_from_a_file_and_from_a_stream() {
    let folder = vocabularies();
    let at = folder.path();
    done(at, "synthesize punching.kineme punch-out -o out.csv");
    fs::write(at.join("spar.toml"), SPAR).expect("a plan");
    let line = "control punching.kineme spar.toml --kinematic --json";
    let watched = json(at, line);
    let answers = watched["behaviors"].as_array().expect("a list");
    assert_eq!(answers.len(), 1, "{watched}");
    assert_eq!(answers[0]["primitive"], "punch-return");
    assert_eq!(answers[0]["rule"], true);
    assert_eq!(watched["noticed"][0]["primitive"], "punch-out");
    let rows = fs::read(at.join("out.csv")).expect("a table");
    let words = line.split_whitespace().chain(["--watch", "-"]);
    let streamed = with_input(at, &words.collect::<Vec<_>>(), &rows);
    assert_eq!(streamed.code, 0, "{}", streamed.err);
    let streamed: serde_json::Value = serde_json::from_str(&streamed.out).expect("JSON");
    assert_eq!(streamed["behaviors"], watched["behaviors"]);
}

#[test]
fn what_was_done_until_a_stream_broke_off_is_written() {
    let folder = vocabularies();
    let at = folder.path();
    done(at, "synthesize punching.kineme punch-out -o out.csv");
    fs::write(at.join("spar.toml"), SPAR).expect("a plan");
    let rows = fs::read_to_string(at.join("out.csv")).expect("a table");
    let mut rows: Vec<&str> = rows.lines().take(61).collect();
    rows.push("0.6,1,2\n");
    let line = "control punching.kineme spar.toml --kinematic --watch - -o part.bvh";
    let words: Vec<&str> = line.split_whitespace().collect();
    let run = with_input(at, &words, rows.join("\n").as_bytes());
    assert!(run.code == 3 && run.err.contains("-:62:"), "{}", run.err);
    let part = json(at, "info part.bvh --json");
    let secs = part[0]["duration"].as_f64().or(part["duration"].as_f64());
    assert!(secs.is_some_and(|s| (0.3..0.7).contains(&s)), "{part}");
}

#[test]
fn what_a_plan_may_not_ask_for_is_refused_with_its_line_before_anything_moves() {
    let folder = vocabularies();
    let at = folder.path();
    let cases: [(&str, &str, &str, &str); 6] = [
        ("wave-across\"", "wave-acros\"", ":3", "wave-across"),
        ("start = 0.2", "start = -1", ":3", "negative"),
        (
            "start = 0.2",
            "joints = [\"left_leg\"]",
            ":3",
            "moves none of",
        ),
        ("start = 0.2", "joints = [\"tail\"]", ":3", "tail"),
        ("start = 1.0", "weight = 0", ":6", "weight"),
        ("seconds = 2.0", "seconds = 0", "", "seconds"),
    ];
    for (old, new, line, says) in cases {
        assert!(WAVE.contains(old), "{old}");
        fs::write(at.join("bad.toml"), WAVE.replacen(old, new, 1)).expect("a plan");
        let words = [
            "control",
            "horizontal-waving.kineme",
            "bad.toml",
            "-o",
            "x.bvh",
        ];
        let run = kineme(at, &words);
        assert_eq!(run.code, 3, "{new}: {}", run.err);
        assert!(
            run.err.contains(&format!("bad.toml{line}")),
            "{new}: {}",
            run.err
        );
        assert!(run.err.contains(says), "{new}: {}", run.err);
        assert!(!at.join("x.bvh").exists());
    }
}

#[test]
fn a_robot_of_a_urdf_file_does_what_it_is_told() {
    let folder = vocabularies();
    let at = folder.path();
    let urdf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../kineme-formats/tests/common/small.urdf");
    fs::copy(&urdf, at.join("small.urdf")).expect("a robot");
    // What a file is its content says.
    fs::copy(&urdf, at.join("small.xml")).expect("a robot");
    fs::write(at.join("wave.toml"), WAVE).expect("a plan");
    let line = "control horizontal-waving.kineme wave.toml --body small.urdf --json";
    let told = json(at, line);
    assert_eq!((&told["body"], &told["dof"]), (&"small".into(), &11.into()));
    assert_eq!(told["physics"], cfg!(feature = "sim"));
    let rms = told["tracking_rms_rad"].as_f64().expect("a number");
    assert!((0.0..0.05).contains(&rms), "{rms}");
    assert_eq!(json(at, &line.replace(".urdf", ".xml")), told);
    let run = done(
        at,
        "control horizontal-waving.kineme wave.toml --body small.urdf",
    );
    for note in ["parts guessed from names", "next to none"] {
        assert!(run.err.contains(note), "{}", run.err);
    }
    // Elsewhere a robot is a body like any other, and a file that is none is told by its line.
    done(
        at,
        "synthesize horizontal-waving.kineme wave-across -o wave.bvh",
    );
    done(at, "convert wave.bvh angles.csv --body small.urdf");
    let rows = fs::read_to_string(at.join("angles.csv")).expect("a table");
    assert!(
        rows.lines()
            .next()
            .is_some_and(|l| l.contains("left_elbow")),
        "{rows}"
    );
    let macros = "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:include filename='a'/></robot>";
    for name in ["robot.xacro", "robot.urdf.xacro", "robot.urdf"] {
        fs::write(at.join(name), macros).expect("a file");
        let line = format!("convert wave.bvh other.csv --body {name}");
        let run = kineme(at, &line.split(' ').collect::<Vec<_>>());
        assert_eq!(run.code, 3, "{}", run.err);
        assert!(
            run.err.contains(&format!("{name}:2")) && run.err.contains("run xacro"),
            "{}",
            run.err
        );
    }
}
