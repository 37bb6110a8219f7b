//! `kineme evaluate`: recognition judged on labelled motion.

mod common;

use std::fs;
use std::path::Path;

use common::{done, json, kineme, scripts};
use serde_json::Value;

/// A folder with the motions of punching and one that is none of them, a vocabulary of every other exemplar, and a
/// manifest of the others, with the stranger as a negative: `p.kineme`, `m/test.csv`.
fn learned() -> tempfile::TempDir {
    let folder = scripts();
    let at = folder.path();
    let swim = "\n[[animation]]\nname = \"swim\"\nkeys = [{ time = 0 }, { time = 1, left_upper_arm = [150, 0, 0] }]\n";
    let script = fs::read_to_string(at.join("punching.toml")).expect("a script") + swim;
    fs::write(at.join("punching.toml"), script).expect("a script");
    done(at, "choreograph punching.toml --motions m");
    let manifest = fs::read_to_string(at.join("m/manifest.csv")).expect("a manifest");
    let rows: Vec<&str> = manifest.lines().skip(1).collect();
    assert_eq!(rows.len(), 19, "nine punches out, nine back, a swim");
    let every_other =
        |first: usize| -> Vec<&str> { rows.iter().skip(first).step_by(2).copied().collect() };
    let stranger = rows[18];
    let train = every_other(0).into_iter().filter(|row| *row != stranger);
    write(at, "m/train.csv", train);
    write(
        at,
        "m/test.csv",
        every_other(1).into_iter().chain([stranger]),
    );
    done(at, "learn m/train.csv -o p.kineme --interpolation shepard");
    folder
}

fn write<'a>(at: &Path, name: &str, rows: impl Iterator<Item = &'a str>) {
    let text = rows.fold("file,label,p1,p2\n".to_owned(), |text, row| {
        text + row + "\n"
    });
    fs::write(at.join(name), text).expect("a manifest");
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|v| v.as_f64().expect("a number")).collect()
}

#[test]
fn unseen_motions_are_judged_beside_the_baselines() {
    let folder = learned();
    let at = folder.path();
    let line = "evaluate p.kineme m/test.csv --methods 1nn-dtw,nearest-posture,constant";
    let told = json(at, &format!("{line} --json --threads 1"));
    assert_eq!(
        (&told["clips"], &told["negatives"]),
        (&Value::from(10), &Value::from(1))
    );
    assert_eq!(told["on_exemplars"], 0);
    let methods = told["methods"].as_object().expect("methods");
    assert_eq!(methods.len(), 3);
    // Nine punches are told apart; the stranger gets a name, but is found novel.
    let dtw = &methods["1nn-dtw"];
    let accuracy = numbers(&dtw["accuracy"]);
    assert!((accuracy[0] - 0.9).abs() < 1e-12, "{dtw}");
    assert!(accuracy[1] < 0.9 && accuracy[2] == 1.0, "{dtw}");
    assert!(
        (numbers(&dtw["balanced_accuracy"])[0] - 2.0 / 3.0).abs() < 1e-12,
        "{dtw}"
    );
    assert_eq!(
        (&dtw["auroc"], &dtw["unknowns_found"]),
        (&Value::from(1.0), &Value::from(1.0))
    );
    assert!(dtw["ece"].is_f64() && dtw["log_loss"].is_f64() && dtw.get("decision_us").is_none());
    let by_chance = numbers(&dtw["ece_by_chance"]);
    assert!(
        0.0 <= by_chance[0] && by_chance[0] <= by_chance[1] && by_chance[1] <= 1.0,
        "{dtw}"
    );
    let constant = &methods["constant"];
    assert_eq!(constant["auroc"], 0.5);
    assert!(numbers(&constant["accuracy"])[0] < 0.6);
    assert_eq!(
        told["confusion"]["punch-out"],
        serde_json::json!({"punch-out": 4})
    );
    assert_eq!(
        told["confusion"]["punch-return"],
        serde_json::json!({"punch-return": 5})
    );
    let stranger = told["confusion"]["none"].as_object().expect("answers");
    assert!(!stranger.contains_key("none") && stranger.len() == 1);

    let again = json(at, &format!("{line} --json --threads 2"));
    assert_eq!(told, again, "threads change nothing");

    let table = done(at, line);
    for words in [
        "10 clips, 1 of them negatives",
        "0.900 (0.",
        "nearest-posture",
        "1nn-dtw less",
        "Answers of 1nn-dtw",
        "always names a primitive",
    ] {
        assert!(table.out.contains(words), "{words}: {}", table.out);
    }
    assert!(!table.err.contains("exemplars"), "{}", table.err);
    let timed = json(
        at,
        "evaluate p.kineme m/test.csv --json --methods constant,constant --timings",
    );
    assert_eq!(timed["methods"].as_object().map(|m| m.len()), Some(1));
    assert_eq!(
        numbers(&timed["methods"]["constant"]["decision_us"]).len(),
        2
    );
}

#[test]
fn classifiers_are_judged_like_the_baselines_and_reject() {
    let folder = learned();
    let at = folder.path();
    let told = json(at, "evaluate p.kineme m/test.csv --json");
    let methods = told["methods"].as_object().expect("methods");
    let mut names: Vec<&str> = methods.keys().map(String::as_str).collect();
    names.sort_unstable();
    assert_eq!(
        names,
        ["1nn-dtw", "constant", "filter", "frame", "nearest-posture"]
    );
    // Of the first method: unseen punches are told apart, and the stranger is none of them.
    for (truth, answers) in [
        ("punch-out", serde_json::json!({"punch-out": 4})),
        ("punch-return", serde_json::json!({"punch-return": 5})),
        ("none", serde_json::json!({"none": 1})),
    ] {
        assert_eq!(told["confusion"][truth], answers, "{truth}");
    }
    let paper = json(at, "evaluate p.kineme m/test.csv --json --methods paper");
    let paper = &paper["methods"]["paper"];
    assert!(paper["accuracy"].is_array(), "{paper}");
    let binary = "judged each by itself, answers have no calibration";
    assert!(
        paper["ece"].is_null() && paper["ece_by_chance"].is_null() && paper["log_loss"].is_null(),
        "{binary}: {paper}"
    );
    let table = done(at, "evaluate p.kineme m/test.csv --methods frame,encode");
    assert!(!table.out.contains("always names"), "{}", table.out);
    assert!(
        table.out.contains("Answers of frame") && table.out.contains("encode"),
        "{}",
        table.out
    );
}

#[test]
fn exemplars_among_the_clips_are_told() {
    let folder = learned();
    let at = folder.path();
    fs::write(
        at.join("m/mixed.csv"),
        "file,label,start,end\npunch-out-01.bvh,punch-out,0,0.2\npunch-out-02.bvh,punch-out,,\n",
    )
    .expect("a manifest");
    let run = done(at, "evaluate p.kineme m/mixed.csv --methods 1nn-dtw");
    let words = "warning: 1 of 2 clips are exemplars of the vocabulary or overlap them, m/mixed.csv:2 for one";
    assert!(run.err.contains(words), "{}", run.err);
    assert!(run.out.contains("No negatives"), "{}", run.out);
    let told = json(at, "evaluate p.kineme m/mixed.csv --json");
    assert_eq!(
        (&told["on_exemplars"], &told["methods"]["1nn-dtw"]["auroc"]),
        (&Value::from(1), &Value::Null)
    );
}

#[test]
fn labels_must_be_primitives_unless_they_are_to_be_negatives() {
    let folder = learned();
    let at = folder.path();
    let rows =
        "file,label\npunch-out-02.bvh,punch-out\nswim.bvh,swimming\npunch-out-04.bvh,punch-outt\n";
    fs::write(at.join("m/strange.csv"), rows).expect("a manifest");
    let run = kineme(at, &["evaluate", "p.kineme", "m/strange.csv"]);
    assert_eq!(run.code, 1, "{}", run.err);
    for words in [
        "m/strange.csv:3: unknown primitive `swimming`",
        "known: punch-out, punch-return",
        "an empty label means none of these",
        "--unknown-as-negative",
    ] {
        assert!(run.err.contains(words), "{words}: {}", run.err);
    }
    let run = done(
        at,
        "evaluate p.kineme m/strange.csv --unknown-as-negative --json",
    );
    assert!(
        run.err
            .contains("none of the primitives: `swimming`, `punch-outt`"),
        "{}",
        run.err
    );
    let told: Value = serde_json::from_str(&run.out).expect("JSON");
    assert_eq!(
        (&told["clips"], &told["negatives"]),
        (&Value::from(3), &Value::from(2))
    );
}

#[test]
fn what_cannot_be_read_or_asked_for_has_its_exit_code() {
    let folder = learned();
    let at = folder.path();
    let rows = "file,label\npunch-out-02.bvh,punch-out\ngone.bvh,punch-out\n";
    fs::write(at.join("m/gone.csv"), rows).expect("a manifest");
    for (line, code, words) in [
        ("evaluate p.kineme m/gone.csv", 3, "gone.csv:3"),
        (
            "evaluate p.kineme m/gone.csv --keep-going",
            3,
            "skipped 1 of 2",
        ),
        ("evaluate p.kineme none.csv", 3, "none.csv"),
        ("evaluate p.kineme m/test.csv --methods magic", 2, "1nn-dtw"),
        ("evaluate - -", 2, "stdin cannot be both"),
    ] {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let run = kineme(at, &arguments);
        assert_eq!(run.code, code, "{line}: {}", run.err);
        assert!(run.err.contains(words), "{line}: {}", run.err);
        assert_eq!(
            run.out.contains("accuracy"),
            line.contains("keep-going"),
            "{line}"
        );
    }
    let other = "evaluate p.kineme test.csv --root m --methods constant";
    fs::copy(at.join("m/test.csv"), at.join("test.csv")).expect("a copy");
    done(at, other);
}
