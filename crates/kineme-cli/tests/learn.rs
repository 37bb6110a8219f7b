//! Vocabularies made by hand: scripts and manifests.

mod common;

use std::fs;

use common::{archive, data, done, json, kineme, names, scripts, vocabulary};
use serde_json::Value;

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
    // `b` begins where the first `a` ends, the second `a` where `b` does; the third comes later.
    assert_eq!(shown.transitions().counts, [0, 1, 1, 0]);
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
fn rates_and_cycles_are_what_a_person_says() {
    let folder = common::folder();
    let at = folder.path();
    let rows = "file,label,rate\npoints.csv,a,15\narms.bvh,b,\n";
    fs::write(at.join("rates.csv"), rows).expect("a manifest");
    let run = done(at, "learn rates.csv -o rates.kineme");
    assert!(!run.err.contains("assumed"), "{}", run.err);
    let learned = vocabulary(at, "rates.kineme");
    let rate = |i: usize| learned.primitives()[i].exemplars()[0].motion.rate_hz();
    assert_eq!(rate(0), 15.0);
    assert!((rate(1) - 30.0).abs() < 1e-3);

    let rows = "file,label,start,end\narms.bvh,raise,0,3\narms.bvh,other,0,3\n";
    fs::write(at.join("cycles.csv"), rows).expect("a manifest");
    done(at, "learn cycles.csv -o cycles.kineme --cyclic raise");
    let learned = vocabulary(at, "cycles.kineme");
    let cyclic: Vec<bool> = learned.primitives().iter().map(|p| p.is_cyclic()).collect();
    assert_eq!(cyclic, [true, false]);
    let seconds = |line: &str| {
        let told = json(
            at,
            &format!("synthesize cycles.kineme raise --json -o {line}"),
        );
        told["duration"].as_f64().expect("a number")
    };
    let (one, three) = (seconds("1.csv"), seconds("3.csv --cycles 3"));
    assert!((three - 3.0 * one).abs() < 0.03, "{one} s and {three} s");
}
