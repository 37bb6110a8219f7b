//! The verbs that make, show, change and use primitives.

mod common;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use common::{Run, archive, data, kineme, with_input};
use kineme::control::{State, Synthesis};
use kineme::{Primitive, Vocabulary};
use serde_json::Value;

fn done(folder: &Path, line: &str) -> Run {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let run = kineme(folder, &arguments);
    assert_eq!(run.code, 0, "kineme {line}: {}", run.err);
    run
}

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&done(folder, line).out).expect("JSON")
}

/// A folder with the written vocabularies of punching and waving.
fn scripts() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let written = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../choreography");
    for name in ["punching.toml", "horizontal-waving.toml"] {
        fs::copy(written.join(name), folder.path().join(name)).expect("a script");
    }
    folder
}

/// The same, as vocabularies.
fn vocabularies() -> tempfile::TempDir {
    let folder = scripts();
    for name in ["punching", "horizontal-waving"] {
        let line = format!("choreograph {name}.toml -o {name}.kineme");
        done(folder.path(), &line);
    }
    folder
}

fn vocabulary(folder: &Path, name: &str) -> Vocabulary {
    let bytes = fs::read(folder.join(name)).expect("a vocabulary");
    kineme_formats::vocabulary::read(name, &bytes).expect("a vocabulary")
}

fn names(vocabulary: &Vocabulary) -> Vec<&str> {
    vocabulary
        .primitives()
        .iter()
        .map(Primitive::name)
        .collect()
}

/// The rows of a table of numbers below its header.
fn numbers(folder: &Path, name: &str) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(folder.join(name)).expect("a table");
    let row = |line: &str| {
        line.split(',')
            .map(|c| c.parse().expect("a number"))
            .collect()
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn a_script_becomes_the_vocabulary_that_it_describes() {
    let folder = scripts();
    let at = folder.path();
    for threads in [1, 2] {
        let line = format!("choreograph punching.toml -o {threads}.kineme --threads {threads}");
        let table = done(at, &line).out;
        for words in [
            "punch-return",
            "height 0 to 1, side 0 to 1",
            "verbs-and-adverbs",
        ] {
            assert!(table.contains(words), "{table}");
        }
    }
    let bytes = |name: &str| fs::read(at.join(name)).expect("a file");
    assert_eq!(
        bytes("1.kineme"),
        bytes("2.kineme"),
        "threads change nothing"
    );
    let shown = json(at, "show 1.kineme --json");
    assert_eq!(shown["body"], "ares");
    let primitives = shown["primitives"].as_array().expect("primitives");
    let hash = blake3::hash(&bytes("punching.toml")).to_hex().to_string();
    assert_eq!(primitives.len(), 2);
    for p in primitives {
        let parameters = p["parameters"].as_array().expect("parameters");
        let names: Vec<&Value> = parameters.iter().map(|a| &a["name"]).collect();
        assert_eq!(names, ["height", "side"]);
        assert_eq!(
            (&p["cyclic"], &p["parameters_from"]),
            (&Value::from(false), &Value::from("adverbs"))
        );
        let exemplars = p["exemplars"].as_array().expect("exemplars");
        assert_eq!(exemplars.len(), 9);
        for (i, e) in exemplars.iter().enumerate() {
            let name = format!(
                "punching.toml/{}-{:02}",
                p["name"].as_str().expect("a name"),
                i + 1
            );
            assert_eq!(e["motion"], Value::from(name));
            assert_eq!(e["blake3"], Value::from(hash.as_str()));
            let values = |key: &str| -> Vec<f64> {
                let list = e[key].as_array().expect("a list").iter();
                list.map(|v| v.as_f64().expect("a number")).collect()
            };
            assert_eq!(
                values("adverbs"),
                values("parameters"),
                "a range from 0 to 1 changes nothing"
            );
        }
        let error = &p["leave_one_out"];
        assert!(
            error["error_m"].as_f64() < error["nearest_m"].as_f64(),
            "{error}"
        );
    }
    let details = done(at, "show 1.kineme punch-out").out;
    for words in [
        "<- chosen",
        "the nearest exemplar",
        &hash[..8],
        "punching.toml/punch-out-09",
    ] {
        assert!(details.contains(words), "{details}");
    }
    let alone = json(at, "show 1.kineme punch-out --json");
    assert_eq!(alone["primitives"].as_array().map(Vec::len), Some(1));
}

#[test]
fn motions_of_a_script_are_learned_back() {
    let folder = scripts();
    let at = folder.path();
    let swim = "\n[[animation]]\nname = \"swim\"\nkeys = [{ time = 0 }, { time = 1, left_upper_arm = [90, 0, 0] }]\n";
    let script = fs::read_to_string(at.join("punching.toml")).expect("a script") + swim;
    fs::write(at.join("more.toml"), script).expect("a script");
    done(
        at,
        "choreograph more.toml -o written.kineme --motions motions",
    );
    let manifest = fs::read_to_string(at.join("motions/manifest.csv")).expect("a manifest");
    let mut lines = manifest.lines();
    assert_eq!(lines.next(), Some("file,label,p1,p2"));
    assert_eq!(lines.next(), Some("punch-out-01.bvh,punch-out,0,0"));
    assert_eq!(lines.last(), Some("swim.bvh,,,"));
    let run = done(at, "learn motions/manifest.csv -o learned.kineme");
    assert!(run.err.contains("1 row has no label"), "{}", run.err);
    let (written, learned) = (
        vocabulary(at, "written.kineme"),
        vocabulary(at, "learned.kineme"),
    );
    assert_eq!(names(&written), names(&learned));
    for (w, l) in written.primitives().iter().zip(learned.primitives()) {
        assert_eq!(w.exemplars().len(), l.exemplars().len());
        assert_eq!(w.fitted().points, l.fitted().points);
        assert_eq!(l.parameters().axes()[1].name, "p2");
        for phase in [0.0, 0.4, 1.0] {
            let (a, b) = (w.pose(&[0.3, 0.6], phase), l.pose(&[0.3, 0.6], phase));
            let pairs = a.expect("a pose").into_iter().zip(b.expect("a pose"));
            let worst = pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-3, "{} at phase {phase}: {worst} rad", w.name());
        }
    }
    // A script of animations makes motions and no vocabulary.
    fs::write(at.join("swim.toml"), format!("body = \"adonis\"\n{swim}")).expect("a script");
    let told = json(at, "choreograph swim.toml --motions swimming --json");
    assert_eq!(told["animations"], 1);
    assert!(at.join("swimming/swim.bvh").exists());
}

#[test]
fn manifests_take_spans_of_files_and_archives_wherever_they_lie() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let bvh = fs::read(data("arms.bvh")).expect("a fixture");
    fs::create_dir(at.join("takes")).expect("a folder");
    fs::write(at.join("takes/arms.bvh"), &bvh).expect("a file");
    archive(&at.join("takes/set.zip"), &[("in/arms.bvh", &bvh)]);
    let spans = [
        ("a", 0.0, 1.5),
        ("b", 1.5, 3.0),
        ("a", 3.0, 4.5),
        ("a", 6.0, 7.5),
    ];
    let manifest = |prefix: &str| {
        let row = |(label, start, end): &(&str, f64, f64)| {
            format!("{prefix}arms.bvh,{label},{start},{end}\n")
        };
        spans
            .iter()
            .map(row)
            .fold("file,label,start,end\n".to_owned(), |text, row| text + &row)
    };
    fs::write(at.join("takes/beside.csv"), manifest("")).expect("a manifest");
    fs::write(at.join("rooted.csv"), manifest("")).expect("a manifest");
    fs::write(at.join("packed.csv"), manifest("takes/set.zip/in/")).expect("a manifest");
    done(at, "learn takes/beside.csv -o beside.kineme");
    done(at, "learn rooted.csv -o rooted.kineme --root takes");
    done(
        at,
        "learn rooted.csv -o archive.kineme --root takes/set.zip/in",
    );
    done(at, "learn packed.csv -o packed.kineme --threads 1");
    let bytes = |name: &str| fs::read(at.join(name)).expect("a file");
    assert_eq!(bytes("beside.kineme"), bytes("rooted.kineme"));
    assert_eq!(bytes("beside.kineme"), bytes("archive.kineme"));
    let shown = vocabulary(at, "packed.kineme");
    assert_eq!(names(&shown), ["a", "b"], "in the order of the labels");
    let a = &shown.primitives()[0];
    assert_eq!(a.exemplars().len(), 3);
    for (e, start) in a.exemplars().iter().zip([0.0, 3.0, 6.0]) {
        let from = &e.provenance;
        // The file's frame time is rounded.
        assert!(
            (from.start_secs - start).abs() < 1e-4 && (from.end_secs - start - 1.5).abs() < 1e-4
        );
        assert_eq!(e.provenance.motion, "takes/set.zip/in/arms.bvh");
        assert_eq!(
            e.provenance.blake3.as_deref(),
            Some(blake3::hash(&bvh).to_hex().as_str())
        );
        assert_eq!(e.motion.frames(), 45);
    }
    // What cannot be used is told with its line, and left out on request.
    let rows = "takes/arms.bvh,a,0,1\ntakes/none.bvh,a,,\ntakes,a,,\ntakes/arms.bvh,b,12,99\ntakes/arms.bvh,b,1,1.03\ntakes/arms.bvh,a,2,3\n";
    fs::write(at.join("bad.csv"), format!("file,label,start,end\n{rows}")).expect("a manifest");
    let run = kineme(at, &["learn", "bad.csv", "-o", "bad.kineme"]);
    assert_eq!(
        (run.code, at.join("bad.kineme").exists()),
        (3, false),
        "{}",
        run.err
    );
    assert!(run.err.contains("bad.csv:"), "{}", run.err);
    let run = kineme(
        at,
        &["learn", "bad.csv", "-o", "good.kineme", "--keep-going"],
    );
    assert_eq!(run.code, 3, "{}", run.err);
    for words in [
        "bad.csv:3: takes/none.bvh",
        "bad.csv:4: takes: found a folder",
        "bad.csv:5: found 12 s to 99 s",
        "bad.csv:6: found 1 frame",
        "skipped 4 of 6",
    ] {
        assert!(run.err.contains(words), "{words}: {}", run.err);
    }
    let good = vocabulary(at, "good.kineme");
    assert_eq!(
        (names(&good), good.primitives()[0].exemplars().len()),
        (vec!["a"], 2)
    );
}

#[test]
fn an_exemplar_of_another_structure_is_refused_by_file_and_line() {
    let folder = scripts();
    let at = folder.path();
    done(at, "choreograph punching.toml -o p.kineme --motions m");
    // The mirror image of an exemplar, as a table of angles.
    let punching = vocabulary(at, "p.kineme");
    let mirrored = punching.primitives()[0].exemplars()[4]
        .motion
        .mirrored()
        .expect("a mirror");
    let table = kineme_formats::tables::body_angles::table(&mirrored)
        .write("left.csv")
        .expect("a table");
    fs::write(at.join("m/left.csv"), table).expect("a file");
    let manifest = fs::read_to_string(at.join("m/manifest.csv")).expect("a manifest");
    fs::write(
        at.join("m/more.csv"),
        manifest + "left.csv,punch-out,0.5,0.5\n",
    )
    .expect("a manifest");
    let run = kineme(at, &["learn", "m/more.csv", "-o", "no.kineme"]);
    assert_eq!(
        (run.code, at.join("no.kineme").exists()),
        (1, false),
        "{}",
        run.err
    );
    for words in [
        "m/more.csv:20: `left.csv`",
        "mirror image",
        "`punch-out`",
        "hint: ",
    ] {
        assert!(run.err.contains(words), "{words}: {}", run.err);
    }
    let run = kineme(
        at,
        &["learn", "m/more.csv", "-o", "yes.kineme", "--keep-going"],
    );
    assert_eq!(run.code, 3, "{}", run.err);
    assert!(run.err.contains("skipped 1 of 19"), "{}", run.err);
    let learned = vocabulary(at, "yes.kineme");
    assert_eq!(learned.primitives()[0].exemplars().len(), 9);
}

#[test]
fn editing_changes_what_was_named_and_nothing_else() {
    let folder = vocabularies();
    let at = folder.path();
    let before = vocabulary(at, "punching.kineme");
    let edited = |line: &str, out: &str| {
        done(at, &format!("edit punching.kineme -o {out} {line}"));
        vocabulary(at, out)
    };
    // Names change places; everything else stays.
    let renamed = edited(
        "--rename punch-out=punch-return --rename punch-return=punch-out",
        "1.kineme",
    );
    assert_eq!(names(&renamed), ["punch-return", "punch-out"]);
    for (a, b) in before.primitives().iter().zip(renamed.primitives()) {
        assert_eq!(a.fitted(), b.fitted());
        assert_eq!(a.exemplars(), b.exemplars());
    }
    let behaviors: Vec<&str> = renamed
        .behaviors()
        .iter()
        .map(|b| b.name.as_str())
        .collect();
    assert_eq!(behaviors, ["punch-return", "punch-out"]);
    let removed = edited("--remove punch-out", "2.kineme");
    assert_eq!(removed.primitives(), &before.primitives()[1..]);
    assert_eq!(removed.behaviors(), &before.behaviors()[1..]);
    // The order is rename, merge, remove, whatever the line says.
    let merged = edited(
        "--merge out,punch-return=punch --rename punch-out=out",
        "3.kineme",
    );
    assert_eq!(names(&merged), ["punch"]);
    let punch = &merged.primitives()[0];
    assert_eq!(punch.exemplars().len(), 18);
    let axes: Vec<&str> = punch
        .parameters()
        .axes()
        .iter()
        .map(|a| a.name.as_str())
        .collect();
    assert_eq!(axes, ["height", "side"], "adverbs keep their names");

    // Exemplars are added to one primitive, and to a new one, once.
    done(at, "choreograph punching.toml --motions m");
    let rows = "file,label,p1,p2\npunch-out-01.bvh,punch-out,0.1,0.1\npunch-out-02.bvh,jab,0,0.5\npunch-out-09.bvh,jab,1,1\n";
    fs::write(at.join("m/add.csv"), rows).expect("a manifest");
    let added = edited("--add m/add.csv", "4.kineme");
    assert_eq!(names(&added), ["punch-out", "punch-return", "jab"]);
    assert_eq!(added.primitives()[0].exemplars().len(), 10);
    assert_eq!(
        added.primitives()[0].exemplars()[..9],
        *before.primitives()[0].exemplars()
    );
    assert_eq!(added.primitives()[1], before.primitives()[1], "bit for bit");
    assert_eq!(added.transitions().n, 3);
    let run = done(at, "edit 4.kineme -o 5.kineme --add m/add.csv");
    assert!(
        run.err
            .contains("3 of the motions to add are exemplars already"),
        "{}",
        run.err
    );
    let bytes = |name: &str| fs::read(at.join(name)).expect("a file");
    assert_eq!(bytes("4.kineme"), bytes("5.kineme"));
    fs::write(
        at.join("m/few.csv"),
        "file,label,p1\npunch-out-01.bvh,punch-out,0.1\n",
    )
    .expect("a manifest");
    let run = kineme(
        at,
        &[
            "edit",
            "punching.kineme",
            "-o",
            "6.kineme",
            "--add",
            "m/few.csv",
        ],
    );
    assert_eq!(run.code, 3);
    assert!(
        run.err
            .contains("m/few.csv:2: found 1 parameters of `punch-out`, expected 2 (height, side)"),
        "{}",
        run.err
    );
}

#[test]
fn behaviors_and_transitions_follow_an_edit() {
    let folder = common::folder();
    let at = folder.path();
    done(at, "derive arms.bvh -o v.kineme");
    let before = vocabulary(at, "v.kineme");
    let all = names(&before);
    assert!(all.len() >= 3, "{all:?}");
    let counts = |v: &Vocabulary| v.transitions().counts.iter().sum::<u32>();
    let (a, b, c) = (all[0], all[1], all[2]);
    done(
        at,
        &format!("edit v.kineme -o merged.kineme --merge {a},{b}=both"),
    );
    let merged = vocabulary(at, "merged.kineme");
    assert_eq!(merged.primitives().len(), all.len() - 1);
    assert_eq!(counts(&merged), counts(&before), "no succession is lost");
    let within: u32 = [(0, 0), (0, 1), (1, 0), (1, 1)]
        .iter()
        .map(|&(f, t)| before.transitions().count(f, t))
        .sum();
    assert_eq!(merged.transitions().count(0, 0), within);
    let members = |p: &Primitive| p.group().map_or(0, |g| g.members);
    let both = merged.primitive("both").expect("merged");
    assert_eq!(
        members(both),
        members(&before.primitives()[0]) + members(&before.primitives()[1])
    );
    for v in [&before, &merged] {
        for name in names(v) {
            let of = v
                .behaviors()
                .iter()
                .filter(|b| b.primitives.iter().any(|p| p == name));
            assert_eq!(of.count(), 1, "{name}");
        }
    }
    done(at, &format!("edit v.kineme -o removed.kineme --remove {c}"));
    let removed = vocabulary(at, "removed.kineme");
    assert_eq!(
        removed.transitions().count(0, 1),
        before.transitions().count(0, 1)
    );
    let gone = |name: &String| name == c;
    assert!(
        !removed
            .behaviors()
            .iter()
            .flat_map(|b| &b.primitives)
            .any(gone)
    );
}

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
            "2 parameters (height, side), found 1",
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
            1,
            "pace",
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
