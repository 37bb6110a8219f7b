//! The contract of the command line: exit codes, messages, what is never overwritten.

mod common;

use std::fs;

use common::{archive, data, folder, kineme, with_input};

#[test]
fn exit_codes_say_what_went_wrong_and_hints_what_to_do() {
    let folder = folder();
    let cases: &[(&str, i32, &str)] = &[
        ("", 2, "Usage"),
        ("--help", 0, ""),
        ("--version", 0, ""),
        ("derive --help", 0, ""),
        ("dance", 2, "unrecognized subcommand"),
        ("info", 2, "<INPUT>"),
        ("info nowhere.bvh", 3, "nowhere.bvh: found"),
        ("info arms.bvh --asf no.asf", 3, "no.asf"),
        ("info arms.bvh --threads 0", 2, "above 0"),
        ("info points.csv --input-rate fast", 2, "hertz"),
        ("info points.csv --input-rate bvh=30", 2, "bvh"),
        ("info arms.bvh --profile nobody", 2, "unknown profile"),
        ("derive arms.bvh", 2, "--out"),
        ("reproduce figures", 2, "--out"),
        ("reproduce figure8 -o figures", 2, "figures"),
        (
            "derive arms.bvh -o v --marks m --segmenter clips",
            2,
            "--marks",
        ),
        (
            "derive arms.bvh -o v --segmenter clips --duration 1",
            2,
            "clips",
        ),
        ("derive arms.bvh -o v --segmenter clips", 1, "at least two"),
        (
            "derive arms.bvh -o v --min-size 50",
            1,
            "hint: give more motion",
        ),
        ("derive arms.bvh -o v --min-size 1", 2, "at least 2"),
        ("derive arms.bvh -o v --shape 2", 2, "0 to 1"),
        ("derive arms.bvh -o .", 1, ".: found a folder"),
        (
            "derive arms.bvh -o arms.bvh/v",
            1,
            "arms.bvh/v: found a file where a folder should be",
        ),
        ("derive no.bvh -o v", 3, "no.bvh: found no such file"),
        ("show arms.bvh", 3, "arms.bvh: found another kind of file"),
        ("derive arms.bvh -o v --body zeus", 2, "nearest: `ares`"),
        ("derive arms.bvh -o v --body g1.xml", 2, "hint: --body ares"),
        ("convert arms.bvh a.csv --body no.urdf", 3, "no.urdf"),
        ("convert arms.bvh a.csv --body no.xml", 3, "no.xml"),
        ("derive arms.bvh -o - --json", 2, "stdout"),
        ("derive arms.bvh -o v --marks no.csv", 3, "no.csv"),
        ("convert arms.bvh a.csv", 2, "hint: --body ares"),
        ("convert arms.bvh a.parquet", 2, "hint: --body ares"),
        ("convert arms.bvh a.fbx", 2, "`.fbx`"),
        ("convert arms.bvh a.bvh --positions", 2, "--positions"),
        ("convert arms.bvh a.csv --native", 2, "--positions"),
        ("convert arms.bvh a.bvh --rate -3", 2, "hertz"),
        ("convert points.csv a.bvh", 1, "hint: --body ares"),
        ("convert . a.bvh", 2, "a folder"),
        ("convert . -", 2, "2 motions"),
    ];
    for (line, code, word) in cases {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let run = kineme(folder.path(), &arguments);
        assert_eq!(run.code, *code, "kineme {line}: {}", run.err);
        assert!(run.err.contains(word), "kineme {line}: {}", run.err);
        let ours = |l: &str| l.starts_with("kineme: ") || l.starts_with("hint: ");
        if *code == 1 || *code == 3 {
            assert!(run.err.lines().all(ours), "kineme {line}: {}", run.err);
        }
    }
    let left: Vec<_> = fs::read_dir(folder.path()).expect("a folder").collect();
    assert_eq!(left.len(), 2, "failures leave nothing behind");
}

#[test]
fn help_of_every_verb_has_examples() {
    let folder = folder();
    for arguments in [
        &["--help"][..],
        &["derive", "--help"],
        &["convert", "--help"],
        &["learn", "--help"],
        &["choreograph", "--help"],
        &["show", "--help"],
        &["edit", "--help"],
        &["synthesize", "--help"],
        &["classify", "--help"],
        &["encode", "--help"],
        &["evaluate", "--help"],
        &["control", "--help"],
        &["view", "--help"],
        &["reproduce", "--help"],
    ] {
        let help = kineme(folder.path(), arguments).out;
        assert!(help.contains("Examples:"), "{arguments:?}");
    }
}

#[test]
fn a_movement_is_converted_to_a_robot_of_hinges() {
    let folder = folder();
    let limb = |side: &str, y: f64| {
        format!(
            "<body name='{side}_arm' pos='0 {y} 0.5'><joint name='{side}_shoulder_pitch' axis='0 1 0' range='-180 180'/>\
             <joint name='{side}_shoulder_roll' axis='1 0 0' range='-180 180'/>\
             <joint name='{side}_shoulder_yaw' range='-180 180'/>\
             <body name='{side}_forearm' pos='0 0 -0.3'><joint name='{side}_elbow' axis='0 -1 0' range='0 150'/>\
             <inertial pos='0 0 -0.1' mass='1' diaginertia='1 1 1'/></body></body>"
        )
    };
    let robot = format!(
        "<mujoco model='pair'><worldbody><body name='base'>{}{}</body></worldbody></mujoco>",
        limb("left", 0.2),
        limb("right", -0.2)
    );
    fs::write(folder.path().join("pair.xml"), robot).expect("a file");
    let run = kineme(
        folder.path(),
        &["convert", "arms.bvh", "a.csv", "--body", "pair.xml"],
    );
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.err.contains("parts guessed"), "{}", run.err);
    let table = fs::read_to_string(folder.path().join("a.csv")).expect("a table");
    let header = table.lines().next().unwrap_or_default();
    let wanted =
        "left_shoulder_pitch,left_shoulder_roll,left_shoulder_yaw,left_elbow,right_shoulder_pitch";
    assert!(header.contains(wanted), "{header}");
    let raised = table.lines().skip(1).any(|row| {
        let cells = row.split(',').skip(5).filter_map(|c| c.parse::<f64>().ok());
        cells.fold(0f64, |m, x| m.max(x.abs())) > 0.5
    });
    assert!(raised, "the arms of arms.bvh move");
}

const AMC: &str = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\nb 5\n";
const ASF: &str = ":units\nlength 1\n:bonedata\nbegin\nname b\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\ndof rx\nend\n:hierarchy\nbegin\nroot b\nend\n";

#[test]
fn what_is_damaged_is_told_with_file_place_found_and_expected() {
    let bvh = fs::read_to_string(data("arms.bvh")).expect("a fixture");
    let table = fs::read_to_string(data("points.csv")).expect("a fixture");
    let whole = |text: &str| text.as_bytes().to_vec();
    let cut = |text: &str| text.as_bytes()[..text.len() * 2 / 3].to_vec();
    let angles = "time,root_x,root_y,root_z,root_yaw,neck_x\n0,0,0,0,0,much\n";
    let vague = "time,root_x,root_y,root_z,root_yaw,tail_x\n0,0,0,0,0,1\n";
    let clip = "{\"Loop\": \"wrap\", \"Frames\": [[0.03, 0, 0.8";
    let msr = "1 2 3 1\n".repeat(19) + "1 2 3\n";
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("empty.bvh", Vec::new(), "empty.bvh"),
        ("cut.bvh", cut(&bvh), "cut.bvh:"),
        (
            "noise.bvh",
            whole("HIERARCHY\nROOT a\n{\nOFFSET 0 x 0\n"),
            "noise.bvh:4: found",
        ),
        (
            "nan.bvh",
            whole(&bvh.replacen("\n0 90 0", "\n0 NaN 0", 1)),
            "nan.bvh:",
        ),
        ("cut.csv", cut(&table), "cut.csv:"),
        (
            "word.csv",
            whole(&table.replacen("0.9", "high", 1)),
            "word.csv:2: found",
        ),
        ("angles.csv", whole(angles), "angles.csv:2: found `much`"),
        (
            "vague.csv",
            whole(vague),
            "vague.csv:1: found column `tail_x`",
        ),
        ("clip.json", whole(clip), "clip.json"),
        ("msr.txt", whole(&msr), "msr.txt"),
        ("alone.amc", whole(AMC), "no ASF"),
        (
            "marker.c3d",
            vec![2, 0x50, 0, 0],
            "found 4 bytes that begin",
        ),
        (
            "words.txt",
            whole("nothing of the kind\n"),
            "no motion format",
        ),
        ("empty.csv", Vec::new(), "found an empty file"),
        (
            "table.csv",
            whole("subject,age\n1,30\n"),
            "a table whose header begins `subject`, `age`, expected `frame` or `time`",
        ),
        (
            "moves.kineme",
            [&[2, 0, 0, 0, 0, 0, 0, 0][..], b"{\"a\":1}"].concat(),
            "found a vocabulary",
        ),
        ("half.zip", b"PK\x03\x04 and so on".to_vec(), "half.zip"),
    ];
    for (name, bytes, word) in cases {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join(name), bytes).expect("a file");
        for verb in [
            &["info", name][..],
            &["convert", name, "out.bvh", "--body", "ares"],
        ] {
            let run = kineme(folder.path(), verb);
            assert_eq!(run.code, 3, "{verb:?}: {}", run.err);
            let error = run.err.lines().find(|l| l.contains("found"));
            let error = error.unwrap_or_else(|| panic!("{verb:?}: {}", run.err));
            assert!(error.starts_with("kineme: "), "{error}");
            assert!(
                error.contains(word) && error.contains("expected"),
                "{error}"
            );
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("b.asf"), ASF).expect("a file");
    let broken = AMC.replace("b 5", "b five");
    fs::write(folder.path().join("b.amc"), broken).expect("a file");
    let run = kineme(folder.path(), &["info", "b.amc"]);
    assert_eq!(
        (run.code, run.err.contains("b.amc:5: found")),
        (3, true),
        "{}",
        run.err
    );
}

#[test]
fn keep_going_takes_the_others_and_lists_what_it_skipped() {
    let folder = folder();
    let inside = folder.path().join("in");
    fs::create_dir(&inside).expect("a folder");
    for name in ["arms.bvh", "points.csv"] {
        fs::rename(folder.path().join(name), inside.join(name)).expect("moved");
    }
    for (name, text) in [("b.bvh", "HIERARCHY\n"), ("c.c3d", "no")] {
        fs::write(inside.join(name), text).expect("a file");
    }
    for arguments in [
        &["info", "in"][..],
        &["derive", "in", "-o", "v.kineme"],
        &["convert", "in", "out", "--body", "ares"],
    ] {
        let run = kineme(folder.path(), arguments);
        assert_eq!(run.code, 3, "{arguments:?}: {}", run.err);
        assert!(run.err.contains("hint: --keep-going"), "{}", run.err);
        let written = folder.path().join("v.kineme").exists();
        assert!(!(arguments[0] == "derive" && written));

        let mut arguments = arguments.to_vec();
        arguments.extend(["--keep-going", "--force"]);
        let run = kineme(folder.path(), &arguments);
        assert_eq!(run.code, 3, "{arguments:?}: {}", run.err);
        for words in ["b.bvh", "c.c3d", "skipped 2 of 4"] {
            assert!(run.err.contains(words), "{arguments:?}: {}", run.err);
        }
        assert!(run.out.contains("arms"), "{arguments:?}: {}", run.out);
    }
    assert!(folder.path().join("v.kineme").exists());
    assert!(folder.path().join("out/arms.bvh").exists());
    assert!(folder.path().join("out/points.bvh").exists());
    let run = kineme(
        folder.path(),
        &["info", "in/b.bvh", "in/c.c3d", "--keep-going"],
    );
    assert_eq!(run.code, 3);
    assert!(run.err.contains("no input could be read"), "{}", run.err);
}

#[test]
fn what_exists_is_overwritten_with_force_alone() {
    let folder = folder();
    let lines = [
        "convert arms.bvh out.bvh",
        "convert . many --body adonis",
        "derive arms.bvh -o v.kineme --report report",
    ];
    for line in lines {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let first = kineme(folder.path(), &arguments);
        assert_eq!(first.code, 0, "{line}: {}", first.err);
        let again = kineme(folder.path(), &arguments);
        assert_eq!(again.code, 2, "{line}: {}", again.err);
        assert!(again.err.contains("hint: --force"), "{line}: {}", again.err);
        let forced = [&arguments[..], &["--force"]].concat();
        assert_eq!(kineme(folder.path(), &forced).code, 0, "{line}");
    }
    // What takes long is refused before it begins: one of its files in the way is enough.
    fs::create_dir(folder.path().join("demo")).expect("a folder");
    fs::write(folder.path().join("demo/report.html"), "kept").expect("a file");
    let run = kineme(folder.path(), &["demo", "-o", "demo"]);
    assert_eq!(run.code, 2, "{}", run.err);
    assert!(run.err.contains("hint: --force"), "{}", run.err);
    let run = kineme(folder.path(), &["demo", "-o", "demo", "--force"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let page = fs::read_to_string(folder.path().join("demo/report.html")).expect("a page");
    assert!(run.out.contains("report.html") && page.len() > 10_000);
    // The report alone is in the way, too.
    let run = kineme(
        folder.path(),
        &["derive", "arms.bvh", "-o", "w", "--report", "report"],
    );
    assert_eq!(run.code, 2);
    assert!(!folder.path().join("w").exists());
}

#[test]
fn a_dash_is_stdin_and_stdout() {
    let folder = folder();
    let bytes = fs::read(data("arms.bvh")).expect("a fixture");
    let run = with_input(folder.path(), &["info", "-", "--json"], &bytes);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("\"motion\":\"-\""), "{}", run.out);
    let run = with_input(folder.path(), &["convert", "-", "-"], &bytes);
    assert_eq!(
        (run.code, run.out.starts_with("HIERARCHY")),
        (0, true),
        "{}",
        run.err
    );
    let run = with_input(folder.path(), &["info", "-"], b"");
    assert_eq!(run.code, 3, "{}", run.err);
}

#[test]
fn archives_act_as_folders_and_cannot_write_outside_of_out() {
    let folder = folder();
    let bytes = fs::read(data("arms.bvh")).expect("a fixture");
    archive(
        &folder.path().join("set.zip"),
        &[
            ("in/a.bvh", &bytes),
            ("../../b.bvh", &bytes),
            ("in/notes.txt", b"x"),
        ],
    );
    let run = kineme(folder.path(), &["convert", "set.zip", "deep/out"]);
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.err.contains("1 file is no motion"), "{}", run.err);
    assert!(
        folder.path().join("deep/out/in/a.bvh").exists(),
        "{}",
        run.out
    );
    for outside in ["b.bvh", "deep/b.bvh"] {
        assert!(!folder.path().join(outside).exists(), "{outside}");
    }
    let run = kineme(folder.path(), &["convert", "set.zip/in/a.bvh", "one.bvh"]);
    assert_eq!(run.code, 0, "{}", run.err);
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = folder();
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_kineme"))
        .args(["convert", "arms.bvh", "-"])
        .current_dir(folder.path())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the binary");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("a run");
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{err}");
    assert!(!err.contains("panicked"), "{err}");
}
