//! `kineme classify`: movements recognised by joint angles.

mod common;

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use common::{done, kineme, scripts, vocabulary, with_input};
use kineme::Vocabulary;
use serde_json::Value;

const METHODS: [&str; 2] = ["filter", "frame"];

/// A folder with a vocabulary of punches, its motions, and one that is none of them; `out.csv` holds the joint angles of
/// a punch out.
fn punches() -> tempfile::TempDir {
    let folder = scripts();
    let at = folder.path();
    let swim = "\n[[animation]]\nname = \"swim\"\nkeys = [{ time = 0 }, { time = 1, left_upper_arm = [150, 0, 0] }]\n";
    let script = fs::read_to_string(at.join("punching.toml")).expect("a script") + swim;
    fs::write(at.join("punching.toml"), script).expect("a script");
    done(at, "choreograph punching.toml -o p.kineme --motions m");
    done(at, "convert m/punch-out-02.bvh out.csv --body ares");
    folder
}

/// The lines of JSON that a run prints.
fn lines(text: &str) -> Vec<Value> {
    let line = |line| serde_json::from_str(line).expect("JSON");
    text.lines().map(line).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// Probabilities, which are ones.
fn probabilities(value: &Value) -> Vec<f64> {
    let object = value.as_object().unwrap_or_else(|| panic!("{value}"));
    let all: Vec<f64> = object.values().map(number).collect();
    assert!(all.iter().all(|p| (0.0..=1.0).contains(p)), "{value}");
    all
}

/// The sum of a posterior, which has rest and none.
fn sum(posterior: &Value) -> f64 {
    assert!(posterior["rest"].is_f64() && posterior["none"].is_f64());
    probabilities(posterior).iter().sum()
}

/// Some columns of a table, by their names.
fn keep_columns(table: &str, keep: impl Fn(&str) -> bool) -> String {
    let header: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let row = |line: &str| {
        let cells = line.split(',').zip(&header).filter(|(_, name)| keep(name));
        cells.map(|(cell, _)| cell).collect::<Vec<_>>().join(",") + "\n"
    };
    table.lines().map(row).collect()
}

#[test]
fn clips_have_a_label_a_posterior_that_sums_to_one_and_spans_without_gaps() {
    let folder = punches();
    let at = folder.path();
    for method in METHODS {
        let line = format!("classify p.kineme m --json --method {method}");
        let run = done(at, &format!("{line} --threads 1"));
        let again = done(at, &format!("{line} --threads 3"));
        assert_eq!(run.out, again.out, "threads change nothing");
        let told = lines(&run.out);
        assert_eq!(told.len(), 19);
        for clip in &told {
            let motion = clip["motion"].as_str().expect("a name");
            let wanted = ["punch-out", "punch-return"]
                .into_iter()
                .find(|name| motion.contains(*name));
            assert_eq!(clip["label"].as_str(), wanted, "{method}: {clip}");
            assert!((sum(&clip["posterior"]) - 1.0).abs() < 1e-9, "{clip}");
            let parameters = clip["parameters"].as_array().map(Vec::len);
            assert_eq!(parameters, wanted.map(|_| 2), "{clip}");
            let spans = clip["spans"].as_array().expect("spans");
            assert_eq!(spans[0]["start"], 0.0);
            for pair in spans.windows(2) {
                assert_eq!(pair[0]["end"], pair[1]["start"], "{clip}");
            }
            let known = spans.iter().any(|span| span["label"].as_str() == wanted);
            assert!(known, "{method}: {clip}");
        }
    }
    let own_units = done(at, "classify p.kineme m/punch-out-09.bvh --json").out;
    for parameter in lines(&own_units)[0]["parameters"].as_array().expect("two") {
        assert!(number(parameter) > 0.9, "{own_units}");
    }
}

#[test]
fn people_read_a_table_with_spans_and_what_to_do_next() {
    let folder = punches();
    let at = folder.path();
    let table = |name: &str| fs::read_to_string(at.join(name)).expect("a table");
    done(at, "convert m/punch-return-02.bvh back.csv --body ares");
    // Out and back in one recording.
    let (out, back) = (table("out.csv"), table("back.csv"));
    let rows = out.lines().skip(1).chain(back.lines().skip(1));
    let mut both = out.lines().next().expect("a header").to_owned() + "\n";
    for (f, row) in rows.enumerate() {
        let cells = row.split_once(',').expect("cells").1;
        both += &format!("{},{cells}\n", f as f64 / 120.0);
    }
    fs::write(at.join("both.csv"), both).expect("a table");
    let run = done(at, "classify p.kineme both.csv m/swim.bvh");
    let words: Vec<&str> = run.out.split_whitespace().collect();
    assert!(run.out.starts_with("motion"), "{}", run.out);
    let place = |word: &str| words.iter().rposition(|w| *w == word);
    assert!(place("punch-out") < place("punch-return"), "{}", run.out);
    assert!(run.out.contains("\n  0.00 to "), "{}", run.out);
    assert!(run.out.contains("none") || run.out.contains("rest"));
    for words in [
        "1 of 2 motions are at rest or none",
        "edit p.kineme",
        "--frames",
    ] {
        assert!(run.err.contains(words), "{words}: {}", run.err);
    }
    let run = done(at, "classify p.kineme out.csv --frames");
    assert_eq!(run.out.lines().count(), 2 + 68 + 1, "{}", run.out);
    for words in ["out.csv\n", "phase", "punch-out", "height 0", "rest"] {
        assert!(run.out.contains(words), "{words}: {}", run.out);
    }
}

#[test]
fn every_frame_tells_phase_and_parameters_of_its_label() {
    let folder = punches();
    let at = folder.path();
    for method in METHODS {
        let line = format!("classify p.kineme out.csv --frames --json --method {method}");
        let told = lines(&done(at, &line).out);
        assert_eq!(told.len(), 68);
        for (f, frame) in told.iter().enumerate() {
            assert!((number(&frame["time"]) - f as f64 / 120.0).abs() < 1e-9);
            assert!((sum(&frame["posterior"]) - 1.0).abs() < 1e-9, "{frame}");
            assert_eq!(
                frame["label"].is_null(),
                frame["phase"].is_null(),
                "{frame}"
            );
            assert_eq!(frame["label"].is_null(), frame["parameters"].is_null());
            assert!(frame.get("about").is_none());
        }
        let phase = |f: usize| number(&told[f]["phase"]);
        assert!(phase(20) + 0.1 < phase(40) && phase(40) < 0.8, "{method}");
        let side = number(&told[40]["parameters"][1]);
        assert!((side - 0.5).abs() < 0.1, "{method}: {side}");
    }
    let lagging = done(at, "classify p.kineme out.csv --frames --json --lag 0.1").out;
    let lagging = lines(&lagging);
    assert!((number(&lagging[40]["about"]) - (40.0 / 120.0 - 0.1)).abs() < 1e-9);
    assert_eq!(lagging[5]["about"], 0.0);
    let coarse = |f: usize| number(&lagging[f]["phase"]);
    let line = "classify p.kineme out.csv --frames --json";
    let prompt = lines(&done(at, line).out);
    assert!((coarse(52) - number(&prompt[40]["phase"])).abs() < 0.03);
}

#[test]
fn every_row_of_a_stream_is_answered_before_the_next_one_is_written() {
    let folder = punches();
    let at = folder.path();
    let table = fs::read_to_string(at.join("out.csv")).expect("a table");
    for method in METHODS {
        let mut child = Command::new(env!("CARGO_BIN_EXE_kineme"))
            .args(["classify", "p.kineme", "-", "--json", "--method", method])
            .current_dir(at)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the binary");
        let mut stdin = child.stdin.take().expect("stdin");
        let stdout = BufReader::new(child.stdout.take().expect("stdout"));
        let (tell, told) = mpsc::channel();
        std::thread::spawn(move || {
            for line in stdout.lines().map_while(Result::ok) {
                if tell.send(line).is_err() {
                    break;
                }
            }
        });
        let mut answers = String::new();
        let mut rows = table.lines();
        let header = rows.next().expect("a header");
        writeln!(stdin, "{header}").expect("a header written");
        for row in rows {
            writeln!(stdin, "{row}").expect("a row written");
            stdin.flush().expect("a row on its way");
            match told.recv_timeout(Duration::from_secs(60)) {
                Ok(answer) => answers += &(answer + "\n"),
                Err(late) => {
                    child.kill().expect("an end");
                    panic!("{method}: no answer to {row}: {late}");
                }
            }
        }
        drop(stdin);
        assert!(child.wait().expect("an end").success());
        let frames = format!("classify p.kineme out.csv --frames --json --method {method}");
        let frames = lines(&done(at, &frames).out);
        for (answer, frame) in lines(&answers).iter().zip(&frames) {
            assert_eq!(answer["motion"], "-");
            assert!((number(&answer["time"]) - number(&frame["time"])).abs() < 1e-9);
            assert_eq!(answer["label"], frame["label"], "{method}");
            let pairs = probabilities(&answer["posterior"])
                .into_iter()
                .zip(probabilities(&frame["posterior"]));
            for (a, b) in pairs {
                assert!((a - b).abs() < 1e-6, "{method}: {answer} {frame}");
            }
        }
        assert_eq!(lines(&answers).len(), frames.len());
    }
}

#[test]
fn what_is_missing_is_left_out_and_not_made_up() {
    let folder = punches();
    let at = folder.path();
    let table = fs::read_to_string(at.join("out.csv")).expect("a table");
    // The left arm hangs in the neutral posture, in which no punch holds it.
    let armless = keep_columns(&table, |c| {
        !(c.starts_with("left_shoulder") || c.starts_with("left_elbow"))
    });
    fs::write(at.join("armless.csv"), &armless).expect("a table");
    // The same columns, but for one row empty.
    let header: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let hollow: String = table
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let cells = line.split(',').zip(&header);
            let blank = |name: &str| i > 1 && name.starts_with("left_") && !name.contains("hip");
            let cells = cells.map(|(cell, name)| if blank(name) { "" } else { cell });
            cells.collect::<Vec<_>>().join(",") + "\n"
        })
        .collect();
    fs::write(at.join("hollow.csv"), &hollow).expect("a table");
    for method in METHODS {
        for name in ["armless.csv", "hollow.csv"] {
            let line = format!("classify p.kineme {name} --json --method {method}");
            let run = done(at, &line);
            assert_eq!(
                lines(&run.out)[0]["label"],
                "punch-out",
                "{name} {}",
                run.out
            );
            assert!(run.err.contains("joints not seen"), "{}", run.err);
        }
        let arguments = ["classify", "p.kineme", "-", "--json", "--method", method];
        let run = with_input(at, &arguments, armless.as_bytes());
        assert_eq!(run.code, 0, "{}", run.err);
        let words =
            "never seen, for the table has not all their columns: left_shoulder, left_elbow";
        assert!(run.err.contains(words), "{}", run.err);
        assert_eq!(lines(&run.out)[40]["label"], "punch-out");
    }
    // Nothing at all is seen: nothing is claimed.
    let empty: String = table
        .lines()
        .enumerate()
        .map(|(i, line)| match i {
            0 => line.to_owned() + "\n",
            _ => {
                line.split(',').next().unwrap_or_default().to_owned()
                    + &",".repeat(header.len() - 1)
                    + "\n"
            }
        })
        .collect();
    for method in METHODS {
        let arguments = ["classify", "p.kineme", "-", "--json", "--method", method];
        let run = with_input(at, &arguments, empty.as_bytes());
        assert_eq!((run.code, run.out.lines().count()), (0, 68), "{}", run.err);
        assert!(
            lines(&run.out)
                .iter()
                .all(|frame| (sum(&frame["posterior"]) - 1.0).abs() < 1e-9)
        );
    }
}

#[test]
fn the_published_method_answers_each_primitive_by_itself() {
    let folder = punches();
    let at = folder.path();
    let told = lines(&done(at, "classify p.kineme out.csv --json --method paper --n 1").out);
    let clip = &told[0];
    assert!(clip.get("posterior").is_none(), "{clip}");
    assert_eq!(probabilities(&clip["binary"]).len(), 2, "no rest, no none");
    assert_eq!(clip["label"], "punch-out");
    let frames = done(
        at,
        "classify p.kineme out.csv --json --frames --method paper",
    )
    .out;
    let frames = lines(&frames);
    assert!(
        frames
            .iter()
            .all(|f| f.get("posterior").is_none() && f["binary"].is_object())
    );
    // Postures far apart in time are judged together otherwise than neighbours.
    let wide = done(
        at,
        "classify p.kineme out.csv --json --method paper --n 3 --stride 8",
    )
    .out;
    assert_ne!(lines(&wide)[0]["binary"], clip["binary"]);
}

/// Runs that end badly: arguments, stdin, exit code, words of the message.
fn check(at: &Path, cases: &[(&str, &[u8], i32, &str)]) {
    for (line, input, code, words) in cases {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let run = with_input(at, &arguments, input);
        assert_eq!(run.code, *code, "{line}: {}", run.err);
        assert!(run.err.contains(words), "{line}: {words}: {}", run.err);
    }
}

#[test]
fn what_cannot_be_read_or_asked_for_has_its_exit_code() {
    let folder = punches();
    let at = folder.path();
    let whole = fs::read(at.join("p.kineme")).expect("a vocabulary");
    fs::write(at.join("cut.kineme"), &whole[..whole.len() / 2]).expect("a file");
    fs::write(at.join("junk.bvh"), "HIERARCHY\nROOT").expect("a file");
    fs::write(at.join("only.bvh"), "HIERARCHY\nROOT").expect("a file");
    done(at, "convert m/punch-out-02.bvh adonis.csv --body adonis");
    let table = fs::read_to_string(at.join("out.csv")).expect("a table");
    let adonis = fs::read(at.join("adonis.csv")).expect("a table");
    let fixed = "time,root_x,root_y,root_z,root_yaw";
    let row = |text: &str| format!("{}\n{text}\n", table.lines().next().expect("a header"));
    let first = table.lines().nth(1).expect("a row");
    check(
        at,
        &[
            ("classify p.kineme gone.bvh", b"", 3, "gone.bvh"),
            ("classify p.kineme out.csv junk.bvh", b"", 3, "junk.bvh"),
            (
                "classify p.kineme out.csv junk.bvh --keep-going",
                b"",
                3,
                "skipped 1 of 2",
            ),
            ("classify cut.kineme out.csv", b"", 3, "cut.kineme"),
            ("classify p.kineme out.csv --method magic", b"", 2, "filter"),
            (
                "classify p.kineme out.csv --n 3",
                b"",
                2,
                "--method frame or",
            ),
            (
                "classify p.kineme out.csv --method frame --lag 1",
                b"",
                2,
                "filter's alone",
            ),
            (
                "classify p.kineme out.csv --method frame --n 0",
                b"",
                2,
                "1..=64",
            ),
            ("classify p.kineme out.csv --lag -1", b"", 2, "0 or more"),
            ("classify p.kineme", b"", 2, "INPUT"),
            ("classify - -", b"", 2, "both the vocabulary and the stream"),
            ("classify p.kineme - out.csv", b"", 2, "alone"),
            ("classify p.kineme -", b"", 3, "nothing in the file"),
            ("classify p.kineme -", &whole, 3, "-:1"),
            ("classify p.kineme -", &adonis, 3, "coordinates of `ares`"),
            (
                "classify p.kineme -",
                format!("{fixed}\n").as_bytes(),
                3,
                "no joint",
            ),
            (
                "classify p.kineme -",
                b"frame,head_x,head_y,head_z\n",
                3,
                "in place of `time`",
            ),
            (
                "classify p.kineme -",
                row("0,1").as_bytes(),
                3,
                "-:2: found 2 cells",
            ),
            (
                "classify p.kineme -",
                row(&format!("{first}\n{first}")).as_bytes(),
                3,
                "times that rise",
            ),
        ],
    );
    // What could be read is answered all the same; a table of another body is brought to this one.
    let run = kineme(
        at,
        &[
            "classify",
            "p.kineme",
            "out.csv",
            "junk.bvh",
            "--keep-going",
        ],
    );
    assert!(run.out.contains("out.csv  punch-out"), "{}", run.out);
    done(at, "classify p.kineme adonis.csv");
    // A name that answers bear is given to no primitive, and refused where somebody gave it all the same.
    let run = kineme(
        at,
        &[
            "edit",
            "p.kineme",
            "-o",
            "r.kineme",
            "--rename",
            "punch-out=rest",
        ],
    );
    assert!(
        run.code == 1 && run.err.contains("`rest` bears the name of an answer"),
        "{}",
        run.err
    );
    assert!(!at.join("r.kineme").exists());
    let known = vocabulary(at, "p.kineme");
    let named = known.primitives().iter().map(|p| match p.name() {
        "punch-out" => p.clone().renamed("rest"),
        _ => p.clone(),
    });
    let named = Vocabulary::new(
        Arc::clone(known.body()),
        named.collect(),
        Vec::new(),
        known.transitions().clone(),
    );
    let bytes = kineme_formats::vocabulary::write(&named.expect("a vocabulary"), "r.kineme");
    fs::write(at.join("r.kineme"), bytes.expect("bytes")).expect("a file");
    let run = kineme(at, &["classify", "r.kineme", "out.csv"]);
    assert!(
        run.code == 1 && run.err.contains("--rename rest="),
        "{}",
        run.err
    );
}

#[test]
fn a_part_of_the_body_is_read_whatever_the_rest_does() {
    let folder = punches();
    let at = folder.path();
    let table = fs::read_to_string(at.join("out.csv")).expect("a table");
    // The left arm and the trunk do something else at every moment.
    let header: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let other = |name: &str| name.starts_with("left_") || name.starts_with("pelvis");
    let wild: String = table
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let cells = line.split(',').zip(&header).map(|(cell, name)| match i {
                0 => cell.to_owned(),
                _ if other(name) => format!("{}", (0.7 * i as f64).sin()),
                _ => cell.to_owned(),
            });
            cells.collect::<Vec<_>>().join(",") + "\n"
        })
        .collect();
    fs::write(at.join("wild.csv"), &wild).expect("a table");
    let arm = keep_columns(&table, |c| {
        ["time", "root"].iter().any(|name| c.starts_with(name)) || c.starts_with("right_")
    });
    let label = |line: &str| lines(&done(at, line).out)[0]["label"].clone();
    assert!(label("classify p.kineme wild.csv --json").is_null());
    for method in METHODS {
        let line = format!("--joints right_arm --json --method {method}");
        let told = done(at, &format!("classify p.kineme wild.csv {line}")).out;
        assert_eq!(lines(&told)[0]["label"], "punch-out", "{told}");
        let frames = done(at, &format!("classify p.kineme wild.csv {line} --frames")).out;
        let frames = lines(&frames);
        assert_eq!(frames[40]["label"], "punch-out", "{}", frames[40]);
        assert!((0.2..0.9).contains(&number(&frames[40]["phase"])));
        // A stream of nothing but the arm says the same.
        let arguments = format!("classify p.kineme - {line}");
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        let run = with_input(at, &arguments, arm.as_bytes());
        assert_eq!(run.code, 0, "{}", run.err);
        for (own, whole) in lines(&run.out).iter().zip(&frames) {
            assert_eq!(own["label"], whole["label"], "{method}");
        }
    }
    check(
        at,
        &[
            (
                "classify p.kineme out.csv --joints right_arm,wing",
                b"",
                2,
                "unknown part or joint `wing`",
            ),
            (
                "classify p.kineme out.csv --joints left_leg",
                b"",
                2,
                "no primitive moves left_leg",
            ),
        ],
    );
}

#[test]
fn a_parquet_table_is_answered_as_its_csv_is() {
    let folder = punches();
    let at = folder.path();
    done(at, "convert m/punch-out-02.bvh out.parquet --body ares");
    let same = |csv: &str| {
        let parquet = csv.replace("out.csv", "out.parquet");
        let (csv, parquet) = (done(at, csv), done(at, &parquet));
        assert!(!csv.out.is_empty());
        assert_eq!(parquet.out.replace("out.parquet", "out.csv"), csv.out);
        assert_eq!(parquet.err, csv.err);
    };
    same("info out.csv --json");
    same("classify p.kineme out.csv --json");
    same("convert out.csv - --to bvh");
    same("convert out.csv - --to csv --positions");
    let read = |name: &str| fs::read(at.join(name)).expect("a table");
    let line = ["classify", "p.kineme", "-", "--json", "--frames"];
    let streamed = |name: &str| with_input(at, &line, &read(name));
    let (csv, parquet) = (streamed("out.csv"), streamed("out.parquet"));
    assert_eq!(
        (parquet.code, &parquet.out, &parquet.err),
        (0, &csv.out, &csv.err)
    );
    assert!(csv.out.lines().count() > 10);
    // A table of positions as Parquet is one of positions, and the bytes do not depend on who asks.
    done(at, "convert out.parquet points.parquet --positions");
    done(at, "convert out.csv points2.parquet --positions");
    assert!(read("points.parquet") == read("points2.parquet"));
    let told = done(at, "info points.parquet --json --input-rate positions=60").out;
    assert!(told.contains("\"format\":\"positions\""), "{told}");
}
