//! What the verbs print and write: shapes of JSON, round trips, bytes that do not depend on threads.

mod common;

use std::fs;
use std::path::Path;

use common::{done, folder, kineme, numbers};
use serde_json::Value;

/// The keys of an object in the order in which they are written.
fn keys(text: &str) -> Vec<String> {
    let object: Value = serde_json::from_str(text).expect("JSON");
    let mut keys: Vec<String> = object
        .as_object()
        .expect("an object")
        .keys()
        .cloned()
        .collect();
    let place = |key: &String| text.find(&format!("\"{key}\":")).unwrap_or(usize::MAX);
    keys.sort_by_key(place);
    keys
}

#[test]
fn info_prints_a_line_a_motion() {
    let folder = folder();
    let run = done(
        folder.path(),
        "info --json arms.bvh points.csv --input-rate 15",
    );
    let lines: Vec<&str> = run.out.lines().collect();
    assert_eq!(lines.len(), 2);
    let fields = [
        "motion", "format", "joints", "dof", "frames", "rate", "duration", "warnings",
    ];
    assert_eq!(keys(lines[0]), fields);
    let start = r#"{"motion":"arms.bvh","format":"bvh","joints":16,"dof":51,"frames":390,"rate":30.0,"duration":12.967,"warnings":["#;
    assert!(lines[0].starts_with(start), "{}", lines[0]);
    let start = r#"{"motion":"points.csv","format":"positions","joints":20,"dof":60,"frames":8,"rate":15.0,"duration":0.467,"#;
    assert!(lines[1].starts_with(start), "{}", lines[1]);
    assert!(
        run.err.is_empty(),
        "a given rate is not warned of: {}",
        run.err
    );

    let table = done(folder.path(), "info .").out;
    for words in ["motion", "cmu-bvh", "kinect", "2 motions, 398 frames"] {
        assert!(table.contains(words), "{table}");
    }
}

#[test]
fn derive_prints_one_document_that_agrees_with_itself() {
    let folder = folder();
    let run = done(folder.path(), "derive arms.bvh -o v.kineme --json");
    assert_eq!(
        keys(&run.out),
        ["segments", "groups", "behaviors", "embedding"]
    );
    let found: Value = serde_json::from_str(&run.out).expect("JSON");
    let list = |name: &str| found[name].as_array().expect("a list").clone();
    let segments = list("segments");
    assert!(segments.len() >= 16, "{} segments", segments.len());
    assert!(list("groups").len() >= 2, "{}", run.out);
    for group in list("groups") {
        let name = &group["name"];
        let members = segments.iter().filter(|s| s["group"] == *name).count();
        assert_eq!(group["segments"], members, "{name}");
        assert!(group["coherence"].is_number(), "{name}");
        let behaviors = list("behaviors");
        let of = |b: &&Value| b["groups"].as_array().is_some_and(|g| g.contains(name));
        assert_eq!(behaviors.iter().filter(of).count(), 1, "{name}");
    }
    for s in &segments {
        assert_eq!(s["motion"], "arms.bvh");
        assert!(s["start"].as_f64() < s["end"].as_f64() && s["end"].as_f64() <= Some(13.0));
        assert_eq!(s["group"].is_null(), s["behavior"].is_null());
    }
    let dimension = found["embedding"]["dimension"].as_u64().expect("a number") as usize;
    let residual = found["embedding"]["residual_variance"]
        .as_array()
        .expect("a list");
    assert!(dimension >= 1 && dimension <= residual.len());
    assert!(residual.iter().all(Value::is_f64));

    let timed = done(
        folder.path(),
        "derive arms.bvh -o t.kineme --json --timings",
    )
    .out;
    assert_eq!(keys(&timed).last().map(String::as_str), Some("seconds"));
}

#[test]
fn results_do_not_depend_on_threads() {
    let folder = folder();
    for threads in ["1", "2", "3"] {
        let line = format!(
            "derive . -o moves.kineme --json --report report-{threads} --threads {threads} --seed 5"
        );
        let out = done(folder.path(), &line).out;
        // The page names its vocabulary: all of them have the same name.
        let named = folder.path().join(format!("{threads}.kineme"));
        fs::rename(folder.path().join("moves.kineme"), named).expect("a vocabulary");
        fs::write(folder.path().join(format!("{threads}.json")), out).expect("a file");
    }
    let bytes = |name: String| fs::read(folder.path().join(name)).expect("a file");
    for threads in ["2", "3"] {
        for what in ["kineme", "json"] {
            assert_eq!(
                bytes(format!("1.{what}")),
                bytes(format!("{threads}.{what}")),
                "{what}"
            );
        }
        let mut files = 0;
        for entry in fs::read_dir(folder.path().join("report-1")).expect("a report") {
            let name = entry
                .expect("a file")
                .file_name()
                .to_string_lossy()
                .into_owned();
            let same =
                bytes(format!("report-1/{name}")) == bytes(format!("report-{threads}/{name}"));
            assert!(same, "{name}");
            files += 1;
        }
        assert_eq!(files, 6, "a page and five figures");
    }
}

#[test]
fn a_vocabulary_names_its_sources_by_their_hashes() {
    let folder = folder();
    done(folder.path(), "derive arms.bvh -o v.kineme");
    let bytes = fs::read(folder.path().join("v.kineme")).expect("a vocabulary");
    let vocabulary = kineme_formats::vocabulary::read("v.kineme", &bytes).expect("a vocabulary");
    let source = fs::read(folder.path().join("arms.bvh")).expect("a fixture");
    let hash = blake3::hash(&source).to_hex().to_string();
    for exemplar in vocabulary.primitives().iter().flat_map(|p| p.exemplars()) {
        assert_eq!(exemplar.provenance.blake3.as_ref(), Some(&hash));
        assert_eq!(exemplar.provenance.motion, "arms.bvh");
    }
}

#[test]
fn marks_cut_where_they_say() {
    let folder = folder();
    let marks =
        "file,start,end\narms.bvh,0,0.9\narms.bvh,1.2,2.2\narms.bvh,2.5,3.4\narms.bvh,3.8,4.6\n";
    fs::write(folder.path().join("m.csv"), marks).expect("a file");
    let line = "derive . -o v.kineme --marks m.csv --min-size 2 --neighbours 2 --json";
    let run = kineme(folder.path(), &line.split(' ').collect::<Vec<_>>());
    let found: Value = serde_json::from_str(&run.out).expect("JSON");
    let starts: Vec<f64> = found["segments"]
        .as_array()
        .expect("segments")
        .iter()
        .map(|s| s["start"].as_f64().expect("a number"))
        .collect();
    for (found, wanted) in starts.iter().zip([0.0, 1.2, 2.5, 3.8]) {
        assert!((found - wanted).abs() < 0.02, "{starts:?}");
    }
    assert_eq!(starts.len(), 4);
    for (row, place, word) in [
        ("legs.bvh,0,1", "m.csv:2", "hint: `kineme info`"),
        ("arms.bvh,5,99", "m.csv:2", "lasts 13"),
        ("arms.bvh,2,1", "m.csv:2", "end 1 not after start 2"),
    ] {
        fs::write(
            folder.path().join("m.csv"),
            format!("file,start,end\n{row}\n"),
        )
        .expect("a file");
        let run = kineme(
            folder.path(),
            &["derive", ".", "-o", "w", "--marks", "m.csv"],
        );
        assert_eq!(run.code, 3, "{row}: {}", run.err);
        assert!(
            run.err.contains(place) && run.err.contains(word),
            "{row}: {}",
            run.err
        );
    }
}

fn check_near(folder: &Path, a: &str, b: &str, tolerance: f64) {
    let (left, right) = (numbers(folder, a), numbers(folder, b));
    assert_eq!(left.len(), right.len(), "{a} and {b}");
    for (i, (l, r)) in left.iter().zip(&right).enumerate() {
        assert_eq!(l.len(), r.len());
        let worst = l
            .iter()
            .zip(r)
            .map(|(x, y)| (x - y).abs())
            .fold(0.0, f64::max);
        assert!(worst <= tolerance, "{a} and {b}, row {i}: {worst}");
    }
}

#[test]
fn converting_loses_nothing() {
    let folder = folder();
    let at = folder.path();
    done(at, "convert arms.bvh again.bvh");
    for native in ["", " --native"] {
        done(
            at,
            &format!("convert arms.bvh a.csv --positions --force{native}"),
        );
        done(
            at,
            &format!("convert again.bvh b.csv --positions --force{native}"),
        );
        check_near(
            at,
            "a.csv",
            "b.csv",
            1e-9 * if native.is_empty() { 1.0 } else { 100.0 },
        );
    }
    for body in ["ares", "adonis"] {
        done(at, &format!("convert arms.bvh {body}.csv --body {body}"));
        done(
            at,
            &format!("convert {body}.csv {body}-again.csv --body {body}"),
        );
        check_near(
            at,
            &format!("{body}.csv"),
            &format!("{body}-again.csv"),
            1e-9,
        );
        done(at, &format!("convert arms.bvh {body}.bvh --body {body}"));
        done(
            at,
            &format!("convert {body}.bvh {body}-bvh.csv --body {body}"),
        );
        check_near(at, &format!("{body}.csv"), &format!("{body}-bvh.csv"), 1e-6);
    }
    // Where a body's joints are does not depend on the file that it went through.
    done(at, "convert arms.bvh direct.csv --body ares --positions");
    done(at, "convert ares.bvh through.csv --body ares --positions");
    check_near(at, "direct.csv", "through.csv", 1e-6);
}

/// The f64 numbers of an array in an NPZ archive.
fn array(folder: &Path, archive: &str, name: &str) -> Vec<f64> {
    let file = fs::File::open(folder.join(archive)).expect("an archive");
    let mut zip = zip::ZipArchive::new(file).expect("an archive");
    let mut bytes = Vec::new();
    let mut array = zip.by_name(&format!("{name}.npy")).expect("an array");
    std::io::Read::read_to_end(&mut array, &mut bytes).expect("an array");
    let data = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let (numbers, _) = bytes[data..].as_chunks::<8>();
    numbers.iter().map(|b| f64::from_le_bytes(*b)).collect()
}

#[test]
fn arrays_hold_the_numbers_of_the_tables() {
    let folder = folder();
    let at = folder.path();
    // A conversion to NPZ, the array to look at, and the same as a table after so many columns.
    let cases = [
        ("arms.bvh {} --positions", "positions", 1),
        ("arms.bvh {} --positions --native", "positions", 1),
        ("points.csv {} --positions --rate 10", "positions", 1),
        ("arms.bvh {} --body ares --positions", "positions", 1),
        ("arms.bvh {} --body adonis", "poses", 5),
        ("points.csv {} --body ares", "poses", 5),
    ];
    for (i, (line, name, skipped)) in cases.into_iter().enumerate() {
        let (npz, csv) = (format!("{i}.npz"), format!("{i}.csv"));
        done(at, &format!("convert {}", line.replace("{}", &npz)));
        done(at, &format!("convert {}", line.replace("{}", &csv)));
        let rows = numbers(at, &csv);
        let table: Vec<f64> = rows
            .iter()
            .flat_map(|row| &row[skipped..])
            .copied()
            .collect();
        assert_eq!(array(at, &npz, name), table, "{line}");
        let time = array(at, &npz, "time");
        assert_eq!(time.len(), rows.len(), "{line}");
        assert!(
            (time[1] * array(at, &npz, "rate")[0] - 1.0).abs() < 1e-12,
            "{line}"
        );
    }
    // As it is: the file's own rotations; a point cloud has none. Folders are written too.
    done(at, "convert . arrays --to npz");
    assert!(array(at, "arrays/arms.npz", "rotations").len() > 4);
}

#[test]
fn another_rate_is_the_same_movement() {
    let folder = folder();
    let at = folder.path();
    done(at, "convert arms.bvh double.bvh --rate 60");
    done(at, "convert arms.bvh a.csv --positions");
    done(at, "convert double.bvh b.csv --positions");
    let (single, double) = (numbers(at, "a.csv"), numbers(at, "b.csv"));
    assert_eq!(double.len(), 2 * single.len() - 1);
    for (f, row) in single.iter().enumerate() {
        let same = row[1..].iter().zip(&double[2 * f][1..]);
        let worst = same.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-4, "frame {f}: {worst}");
    }
    done(at, "convert points.csv slow.csv --positions --rate 10");
    assert_eq!(numbers(at, "slow.csv").len(), 3);
}

#[test]
fn a_profile_says_which_joint_is_which_and_which_way_is_up() {
    let folder = folder();
    let at = folder.path();
    let bvh = fs::read_to_string(at.join("arms.bvh")).expect("a fixture");
    let mut strange = bvh;
    let mut roles = String::new();
    for (i, (joint, role)) in [
        ("LeftForeArm", "left_lower_arm"),
        ("LeftArm", "left_upper_arm"),
        ("RightForeArm", "right_lower_arm"),
        ("RightArm", "right_upper_arm"),
        ("LeftUpLeg", "left_upper_leg"),
        ("RightUpLeg", "right_upper_leg"),
    ]
    .into_iter()
    .enumerate()
    {
        strange = strange.replace(&format!("JOINT {joint}\n"), &format!("JOINT j{i}\n"));
        roles.push_str(&format!("{role} = \"j{i}\"\n"));
    }
    fs::write(at.join("strange.bvh"), strange).expect("a file");
    let run = kineme(at, &["convert", "strange.bvh", "s.csv", "--body", "ares"]);
    assert_eq!(run.code, 3, "{}", run.err);
    assert!(run.err.contains("--profile FILE"), "{}", run.err);

    let profile = format!("name = \"mine\"\nunit_metres = 0.02\n[roles]\nhips = \"Hips\"\n{roles}");
    fs::write(at.join("mine.toml"), profile).expect("a file");
    done(
        at,
        "convert strange.bvh s.csv --body ares --profile mine.toml",
    );
    let table = done(at, "info strange.bvh --profile mine.toml").out;
    assert!(
        table.contains("mine") && table.contains("0.0200 m"),
        "{table}"
    );
}
