//! Motions of primitives; and what all verbs of the model refuse.

mod common;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use common::{done, json, kineme, numbers, vocabularies, vocabulary, with_input};
use kineme::control::{State, Synthesis};
use serde_json::Value;

/// Largest distance (metres) between the joints of a motion and the positions in a table of them.
fn farthest(folder: &Path, table: &str, motion: &kineme::Motion) -> f64 {
    let header = fs::read_to_string(folder.join(table)).expect("a table");
    let header: Vec<&str> = header
        .lines()
        .next()
        .expect("a header")
        .split(',')
        .collect();
    let rows = numbers(folder, table);
    assert_eq!(rows.len(), motion.frames());
    let track = motion.joints();
    let mut worst = 0.0_f64;
    for (f, row) in rows.iter().enumerate() {
        for (name, point) in motion
            .skeleton()
            .joints()
            .iter()
            .map(|j| &j.name)
            .zip(track.at(f))
        {
            let column = header
                .iter()
                .position(|h| *h == format!("{name}_x"))
                .expect("a column");
            for d in 0..3 {
                worst = worst.max((row[column + d] - point[d]).abs());
            }
        }
    }
    worst
}

#[test]
fn synthesized_bvh_holds_the_motion_of_the_library() {
    let folder = vocabularies();
    let at = folder.path();
    let punching = vocabulary(at, "punching.kineme");
    let punch = punching.primitive("punch-out").expect("a primitive");
    let cases = [("--at 0.3,0.8", vec![0.3, 0.8]), ("", punch.middle())];
    for (i, (option, parameters)) in cases.into_iter().enumerate() {
        let course = Arc::new(punch.at(&parameters).expect("a course"));
        let synthesis = Synthesis {
            rate_hz: 60.0,
            ..Synthesis::default()
        };
        let motion = synthesis
            .motion("punch-out", &course)
            .expect("a motion")
            .motion;
        done(
            at,
            &format!("synthesize punching.kineme punch-out -o {i}.bvh --rate 60 {option}"),
        );
        done(at, &format!("convert {i}.bvh {i}.csv --positions"));
        let worst = farthest(at, &format!("{i}.csv"), &motion);
        assert!(worst < 1e-4, "{option}: {worst} m");
        // The table of joint angles is exact.
        done(
            at,
            &format!("synthesize punching.kineme punch-out -o {i}.angles.csv --rate 60 {option}"),
        );
        for (f, row) in numbers(at, &format!("{i}.angles.csv")).iter().enumerate() {
            assert_eq!(&row[5..], motion.pose(f), "frame {f}");
        }
    }
    done(
        at,
        "synthesize punching.kineme punch-out -o a.npz --rate 60",
    );
    let piped = done(
        at,
        "synthesize punching.kineme punch-out -o - --to csv --rate 60",
    )
    .out;
    assert_eq!(
        piped,
        fs::read_to_string(at.join("1.angles.csv")).expect("a table")
    );
    let told = json(
        at,
        "synthesize punching.kineme punch-out -o t.bvh --at 0.3,0.8 --duration 2 --rate 50 --json",
    );
    assert_eq!(
        (&told["frames"], &told["duration"]),
        (&Value::from(101), &Value::from(2.0))
    );
    assert_eq!(
        (&told["phase"], &told["reach"]),
        (&Value::Null, &Value::Null)
    );
    assert!((told["parameters"][1].as_f64().expect("a number") - 0.8).abs() < 1e-12);
}

#[test]
fn a_hand_is_sent_to_a_point_and_a_miss_is_told() {
    let folder = vocabularies();
    let at = folder.path();
    let punching = vocabulary(at, "punching.kineme");
    let punch = punching.primitive("punch-out").expect("a primitive");
    let aim = punch.aim("right_hand").expect("an effector");
    let p = [0.35, 0.6];
    let place = aim
        .position(&p, aim.extreme(&p).expect("a phase"))
        .expect("a place");
    let line = |x: f64, out: &str| {
        format!(
            "synthesize punching.kineme punch-out -o {out} --json --reach right_hand={x},{},{}",
            place.y, place.z
        )
    };
    let run = done(at, &line(place.x, "near.bvh"));
    let told: Value = serde_json::from_str(&run.out).expect("JSON");
    let miss = told["reach"]["miss"].as_f64().expect("a number");
    assert!(miss < 1e-3, "{miss} m");
    assert!(
        run.err.contains("0.0 cm from") && !run.err.contains("warning"),
        "{}",
        run.err
    );
    assert!(told["phase"].as_f64() > Some(0.3));
    let run = done(at, &line(place.x + 1.0, "far.bvh"));
    assert!(
        run.err.contains("warning: right_hand comes to"),
        "{}",
        run.err
    );
    let told: Value = serde_json::from_str(&run.out).expect("JSON");
    assert!(told["reach"]["miss"].as_f64() > Some(0.8));
    assert!(at.join("far.bvh").exists(), "written all the same");
    let run = done(
        at,
        "synthesize punching.kineme punch-out -o over.bvh --at 7,0.5",
    );
    assert!(
        run.err
            .contains("warning: the exemplars do not reach that far"),
        "{}",
        run.err
    );
}

#[test]
fn a_motion_begins_in_the_posture_that_it_is_given() {
    let folder = vocabularies();
    let at = folder.path();
    done(
        at,
        "synthesize horizontal-waving.kineme wave-across -o wave.csv --rate 100",
    );
    done(
        at,
        "synthesize punching.kineme punch-out -o a.csv --from-pose wave.csv@0.2",
    );
    done(
        at,
        "synthesize punching.kineme punch-out -o b.csv --from-pose wave.csv",
    );
    let wave = numbers(at, "wave.csv");
    for (name, frame) in [("a.csv", 20), ("b.csv", 0)] {
        let first = &numbers(at, name)[0];
        let worst = first[1..]
            .iter()
            .zip(&wave[frame][1..])
            .map(|(x, y)| (x - y).abs())
            .fold(0.0, f64::max);
        assert!(worst < 1e-6, "{name}: {worst}");
    }
    // The library's own start is on the movement.
    let v = vocabulary(at, "punching.kineme");
    let course = v.primitives()[0]
        .at(&v.primitives()[0].middle())
        .expect("a course");
    let start = State::on_course(&course, 0.0, 1.0);
    done(at, "synthesize punching.kineme punch-out -o c.csv");
    let worst = numbers(at, "c.csv")[0][5..]
        .iter()
        .zip(&start.pose)
        .map(|(x, y)| (x - y).abs())
        .fold(0.0, f64::max);
    assert!(worst < 0.02, "limits bend it by {worst} rad at most");
}

#[test]
fn what_cannot_be_is_refused_with_the_right_code_and_a_word_on_it() {
    let folder = vocabularies();
    let at = folder.path();
    fs::write(at.join("junk.kineme"), b"junk").expect("a file");
    let whole = fs::read(at.join("punching.kineme")).expect("a file");
    fs::write(at.join("cut.kineme"), &whole[..whole.len() / 2]).expect("a file");
    fs::write(at.join("none.csv"), "file,label\na.bvh,\n").expect("a file");
    fs::write(at.join("one.csv"), "file,label\na.bvh,a\n").expect("a file");
    fs::write(at.join("odd.csv"), "file,label,colour\na.bvh,a,red\n").expect("a file");
    fs::write(
        at.join("bad.toml"),
        "body = \"ares\"\n[[exemplar]]\nprimitive = \"a\"\nkeys = [{ time = 0 }]\n",
    )
    .expect("a file");
    fs::write(
        at.join("swim.toml"),
        "body = \"ares\"\n[[animation]]\nname = \"a\"\nkeys = [{ time = 0 }, { time = 1 }]\n",
    )
    .expect("a file");
    let before = fs::read_dir(at).expect("a folder").count();
    let cases: &[(&str, i32, &str)] = &[
        ("show no.kineme", 3, "no.kineme: found"),
        ("show junk.kineme", 3, "junk.kineme"),
        ("show cut.kineme", 3, "cut.kineme"),
        (
            "show punching.kineme jab",
            2,
            "known: punch-out, punch-return",
        ),
        ("learn no.csv -o x", 3, "no.csv: found"),
        ("learn none.csv -o x", 3, "without a label"),
        ("learn odd.csv -o x", 3, "odd.csv:1: found column `colour`"),
        ("learn one.csv -o x", 3, "one.csv:2: a.bvh: found"),
        ("learn one.csv -o x --body zeus", 2, "nearest: `ares`"),
        ("learn one.csv -o x --parameters nose", 2, "known: head"),
        ("learn one.csv -o x --cyclic walk", 2, "--cyclic: unknown"),
        (
            "learn one.csv -o x --interpolation best",
            2,
            "verbs-and-adverbs",
        ),
        ("learn one.csv", 2, "--out"),
        ("learn one.csv -o - --json", 2, "stdout"),
        ("choreograph no.toml -o x", 3, "no.toml"),
        ("choreograph bad.toml -o x", 3, "bad.toml:2: found"),
        ("choreograph swim.toml -o x", 2, "no exemplar"),
        ("choreograph punching.toml", 2, "--out"),
        ("choreograph punching.toml -o x --rate 0", 2, "hertz"),
        ("edit punching.kineme -o x", 2, "nothing to change"),
        ("edit punching.kineme -o x --rename a", 2, "OLD=NEW"),
        (
            "edit punching.kineme -o x --rename jab=b",
            2,
            "unknown primitive `jab`",
        ),
        (
            "edit punching.kineme -o x --rename punch-out=punch-return",
            2,
            "hint: --merge",
        ),
        (
            "edit punching.kineme -o x --merge punch-out=b",
            2,
            "A,B=NEW",
        ),
        (
            "edit punching.kineme -o x --merge punch-out,punch-out=b",
            2,
            "itself",
        ),
        (
            "edit punching.kineme -o x --remove punch-out,punch-return",
            2,
            "no primitive",
        ),
        ("edit punching.kineme -o x --root .", 2, "--add"),
        (
            "edit punching.kineme -o punching.kineme --remove punch-out",
            2,
            "--force",
        ),
        (
            "synthesize punching.kineme punch-out -o x",
            2,
            "hint: write .bvh",
        ),
        ("synthesize punching.kineme punch-out -o -", 2, "--to bvh"),
        (
            "synthesize punching.kineme punch-out -o - --to csv --json",
            2,
            "stdout",
        ),
        (
            "synthesize punching.kineme jab -o x.bvh",
            2,
            "unknown primitive",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --at 1",
            2,
            "`punch-out`: 2 parameters (height, side), found 1",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --at 1,high",
            2,
            "numbers",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --at 1,NaN",
            2,
            "numbers",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --reach nose=1,2,3",
            2,
            "unknown effector",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --reach head=1,2",
            2,
            "EFFECTOR=X,Y,Z",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --reach head=1e300,0,0",
            2,
            "EFFECTOR=X,Y,Z",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --at 0,0 --reach head=1,2,3",
            2,
            "--at",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --cycles 2",
            2,
            "stroke",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --duration 0",
            2,
            "above 0",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --duration 1e9",
            2,
            "--duration: a movement of",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --from-pose no.bvh",
            3,
            "no.bvh",
        ),
        (
            "synthesize punching.kineme punch-out -o x.bvh --from-pose no.bvh@x",
            2,
            "seconds",
        ),
    ];
    for (line, code, word) in cases {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let run = kineme(at, &arguments);
        assert_eq!(run.code, *code, "kineme {line}: {}", run.err);
        assert!(run.err.contains(word), "kineme {line}: {}", run.err);
    }
    let after = fs::read_dir(at).expect("a folder").count();
    assert_eq!(before, after, "failures leave nothing behind");
    assert_eq!(fs::read(at.join("punching.kineme")).expect("a file"), whole);
    let run = with_input(at, &["show", "-"], &whole);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("punch-return"), "{}", run.out);
}
