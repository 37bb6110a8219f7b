//! What is broken is an error that says where, what and what instead; nothing panics or swallows memory.

use kineme_formats::detect::{Kind, detect, parse};
use kineme_formats::{FormatError, Place, asf};
use proptest::prelude::*;

const BVH: &str = "HIERARCHY
ROOT Hips
{
\tOFFSET 0 0 0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT Leg
\t{
\t\tOFFSET 0 -40 0
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 -45 0
\t\t}
\t}
}
MOTION
Frames: 2
Frame Time: 0.01
0 90 0 0 0 0 10 0 0
0 91 0 0 0 0 20 0 1e1
";

const ASF: &str = ":version 1.10
:units
 length 0.45
 angle deg
:root
 order TX TY TZ RX RY RZ
 axis XYZ
 position 0 0 0
 orientation 0 0 0
:bonedata
 begin
  id 1
  name thigh
  direction 0 -1 0
  length 7
  axis 0 0 20 XYZ
  dof rx ry rz
  limits (-160 20)
         (-70 70)
         (-60 70)
 end
 begin
  name shank
  direction 0 -1 0
  length 7
  axis 0 0 20 XYZ
  dof rx
 end
:hierarchy
 begin
  root thigh
  thigh shank
 end
";

const AMC: &str = ":FULLY-SPECIFIED
:DEGREES
1
root 0 17 0 0 0 0
thigh 1 2 3
shank 4
2
root 0 17 0 0 0 0
thigh 1 2 3
shank 4
";

fn deepmimic() -> String {
    let ball = "1, 0, 0, 0";
    let limb = format!("{ball}, 0.1, {ball}");
    let row = format!(
        "0.02, 0, 0.9, 0, {ball}, {ball}, {ball}, {limb}, {ball}, 0.1, {limb}, {ball}, 0.1"
    );
    format!("{{\"Loop\": \"none\",\n\"Frames\": [\n[{row}],\n[{row}]\n]}}\n")
}

fn read(kind: Kind, bytes: &[u8]) -> Result<kineme::Recording, FormatError> {
    if kind == Kind::Asf {
        let skeleton = asf::parse("a.asf", bytes)?;
        return parse(Kind::Amc, "a.amc", AMC.as_bytes(), None, Some(&skeleton));
    }
    let skeleton = asf::parse("a.asf", ASF.as_bytes())?;
    parse(kind, "file", bytes, None, Some(&skeleton))
}

/// Reads the text with `from` replaced by `to`, and looks for the line and for what the message must say.
fn check(kind: Kind, text: &str, from: &str, to: &str, place: Place, says: &[&str]) {
    assert!(
        from.is_empty() || text.contains(from),
        "no {from:?} to damage"
    );
    let damaged = if from.is_empty() {
        to.to_owned()
    } else {
        text.replacen(from, to, 1)
    };
    let error = read(kind, damaged.as_bytes()).expect_err(&format!("{kind:?}: {from:?} -> {to:?}"));
    let message = error.to_string();
    assert_eq!(error.place, place, "{message}");
    for part in says {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
    assert!(
        message.contains(": found ") && message.contains(", expected "),
        "{message}"
    );
}

#[test]
fn sound_samples_are_read() {
    for (kind, text, joints) in [
        (Kind::Bvh, BVH.to_owned(), 2),
        (Kind::Asf, ASF.to_owned(), 3),
        (Kind::Amc, AMC.to_owned(), 3),
        (Kind::DeepMimic, deepmimic(), 13),
    ] {
        let recording = read(kind, text.as_bytes()).expect("a sound sample");
        assert_eq!(
            (recording.joints().len(), recording.frames()),
            (joints, 2),
            "{kind:?}"
        );
        // Windows line ends, a byte order mark and doubled blank lines change nothing.
        let other = format!("\u{feff}{}", text.replace('\n', "\r\n\r\n"));
        if kind != Kind::DeepMimic {
            let same = read(kind, other.as_bytes()).expect("other line ends");
            assert_eq!(same.observed(), recording.observed(), "{kind:?}");
        }
    }
}

#[test]
fn damaged_bvh_names_line_and_cause() {
    use Place::{File, Line};
    let cases: &[(&str, &str, Place, &[&str])] = &[
        ("", "", File, &["an empty file", "`HIERARCHY`"]),
        ("", "\n \n", File, &["an empty file"]),
        (
            "",
            "{\"a\": 1}",
            Line(1),
            &["`{\\\"a\\\": 1}`", "`HIERARCHY`"],
        ),
        (
            "",
            "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n",
            Line(4),
            &["the end of the file"],
        ),
        ("ROOT Hips", "ROOT", Line(2), &["the joint's name"]),
        (
            "\tOFFSET 0 0 0",
            "\tOFFSET 0 0",
            Line(4),
            &["`0 0`", "three numbers"],
        ),
        (
            "OFFSET 0 -40 0",
            "OFFSET 0 nan 0",
            Line(8),
            &["three numbers"],
        ),
        (
            "CHANNELS 3 Z",
            "CHANNELS 4 Z",
            Line(9),
            &["as many channels"],
        ),
        (
            "CHANNELS 3 Zrotation",
            "CHANNELS 3 Wrotation",
            Line(9),
            &["Xposition"],
        ),
        (
            "3 Zrotation X",
            "3 Xrotation X",
            Line(9),
            &["different axes"],
        ),
        (
            "\t}\n}\nMOTION",
            "\t}\nMOTION",
            Line(15),
            &["`MOTION`", "`}`"],
        ),
        (
            "\t}\n}\nMOTION",
            "\t}\n}\n}\nMOTION",
            Line(16),
            &["`ROOT` or `MOTION`"],
        ),
        (
            "\t\t\tOFFSET 0 -45 0\n",
            "",
            Line(12),
            &["`OFFSET` before it"],
        ),
        ("JOINT", "BONE", Line(6), &["`BONE Leg`", "`JOINT`"]),
        (
            "Frames: 2",
            "Frames: two",
            Line(17),
            &["`two`", "count of frames"],
        ),
        ("Frames: 2", "Frames: 0", Line(17), &["`0`", "above zero"]),
        (
            "Frames: 2\n",
            "",
            Line(17),
            &["`Frame Time: 0.01`", "`Frames: <count>`"],
        ),
        ("Time: 0.01", "Time: 0", Line(18), &["`0`", "above zero"]),
        (
            "Time: 0.01",
            "Time: fast",
            Line(18),
            &["`fast`", "seconds a frame"],
        ),
        (
            "Frames: 2",
            "Frames: 3",
            Line(20),
            &["after 2 rows", "3 rows that line 17"],
        ),
        (
            "Frames: 2",
            "Frames: 9999999999999",
            Line(20),
            &["after 2 rows"],
        ),
        (
            "0 91 0 0 0 0 20 0 1e1\n",
            "0 91 0 0",
            Line(20),
            &["4 numbers", "9, one a channel"],
        ),
        (
            "20 0 1e1",
            "20 0 1e1 7",
            Line(20),
            &["10 numbers", "9, one a channel"],
        ),
        (
            "0 91 0",
            "0 NaN 0",
            Line(20),
            &["`NaN` in column 2", "a number"],
        ),
        ("0 91 0", "0 9,1 0", Line(20), &["`9,1` in column 2"]),
    ];
    for (from, to, place, says) in cases {
        check(Kind::Bvh, BVH, from, to, *place, says);
    }
    let short = BVH.replace("Frames: 2", "Frames: 1");
    let recording = read(Kind::Bvh, short.as_bytes()).expect("fewer declared than there");
    assert_eq!(recording.frames(), 1);
    assert!(
        recording
            .source()
            .warnings
            .iter()
            .any(|w| w.contains("left out"))
    );
}

#[test]
fn damaged_acclaim_names_line_and_cause() {
    use Place::{File, Line};
    let asf: &[(&str, &str, Place, &[&str])] = &[
        ("", "", File, &["no section", "`:bonedata`"]),
        ("", "once upon\n", Line(1), &["`once upon`", "section"]),
        ("length 0.45", "length 0", Line(3), &["above zero"]),
        (
            "angle deg",
            "angle gon",
            Line(4),
            &["`gon`", "`deg` or `rad`"],
        ),
        ("order TX TY", "order TX TX", Line(6), &["at most once"]),
        (
            "direction 0 -1 0",
            "direction 0 -1",
            Line(14),
            &["nothing", "3 numbers"],
        ),
        (
            "axis 0 0 20 XYZ",
            "axis 0 0 20 XYQ",
            Line(16),
            &["`XYQ`", "`XYZ`"],
        ),
        ("dof rx ry rz", "dof rx l", Line(17), &["`l`"]),
        (
            "dof rx ry rz",
            "dof tx",
            Line(17),
            &["`tx`", "only the root translates"],
        ),
        (" end\n begin", " begin", Line(21), &["`begin`", "`end`"]),
        (
            "name shank",
            "name thigh",
            Line(22),
            &["`thigh`", "not taken"],
        ),
        (
            "  name shank\n",
            "",
            Line(27),
            &["without `name`", "line 22"],
        ),
        (
            "thigh shank",
            "thigh foot",
            Line(32),
            &["`foot`", "`:bonedata`"],
        ),
        (
            "  thigh shank\n",
            "",
            Line(22),
            &["`shank`", "`:hierarchy`"],
        ),
        (
            "thigh shank",
            "thigh thigh",
            Line(32),
            &["`thigh`", "hung once"],
        ),
    ];
    for (from, to, place, says) in asf {
        check(Kind::Asf, ASF, from, to, *place, says);
    }
    let amc: &[(&str, &str, Place, &[&str])] = &[
        ("", "", Line(1), &["no frame"]),
        (
            "",
            ":DEGREES\nroot 1 2 3\n",
            Line(2),
            &["`root 1 2 3`", "first frame"],
        ),
        ("thigh 1 2 3\n", "", Line(6), &["without bone `thigh`"]),
        (
            "thigh 1 2 3",
            "thigh 1 2",
            Line(5),
            &["`thigh 1 2`", "3 numbers"],
        ),
        (
            "shank 4\n2\n",
            "shank 4\n",
            Line(7),
            &["`root` twice", "next frame"],
        ),
        ("shank 4", "shank x", Line(6), &["`shank x`", "1 numbers"]),
        (
            "shank 4",
            "hand 4",
            Line(6),
            &["`hand`", "a bone of the ASF"],
        ),
        ("3\nshank 4\n2", "3\n2", Line(6), &["without bone `shank`"]),
    ];
    for (from, to, place, says) in amc {
        check(Kind::Amc, AMC, from, to, *place, says);
    }
    let cut = AMC.strip_suffix("shank 4\n").expect("the last line");
    check(
        Kind::Amc,
        AMC,
        "",
        cut,
        Line(9),
        &["frame `2` without bone `shank`"],
    );
}

#[test]
fn damaged_deepmimic_names_line_and_cause() {
    use Place::{File, Line};
    let clip = deepmimic();
    let cases: &[(&str, &str, Place, &[&str])] = &[
        ("", "", Line(1), &["EOF", "a DeepMimic clip"]),
        ("", "{\"Frames\": [", Line(1), &["EOF"]),
        (
            "",
            "{\"Loop\": \"wrap\"}",
            Line(1),
            &["missing field `Frames`"],
        ),
        ("", "{\"Frames\": []}", File, &["no frame"]),
        (
            "[0.02, 0,",
            "[0.02,",
            Line(3),
            &["invalid length 43", "44 numbers"],
        ),
        ("[0.02, 0,", "[0.02, 0, 0,", Line(3), &["invalid length 45"]),
        ("[0.02, 0,", "[0, 0,", File, &["a duration of 0"]),
        ("[0.02, 0,", "[0.02, \"x\",", Line(3), &["string \"x\""]),
        (
            "[0.02, 0, 0.9, 0, 1,",
            "[0.02, 0, 0.9, 0, 0,",
            File,
            &["`root` in frame 0", "quaternion"],
        ),
    ];
    for (from, to, place, says) in cases {
        check(Kind::DeepMimic, &clip, from, to, *place, says);
    }
}

/// Numbers that many joints share a few bytes for do not multiply into memory.
#[test]
fn frames_of_joints_without_channels_are_refused() {
    let joints = "JOINT j\n{\nOFFSET 0 1 0\n".repeat(3000);
    let text = format!(
        "HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n{joints}{}}}\nMOTION\nFrames: 3000\nFrame Time: 1\n{}",
        "}\n".repeat(3000),
        "0\n".repeat(3000)
    );
    let error = read(Kind::Bvh, text.as_bytes()).expect_err("out of proportion");
    assert!(
        error.found.contains("3001 joints in 3000 frames"),
        "{error}"
    );
}

fn kinds() -> [(Kind, Vec<u8>); 4] {
    [
        (Kind::Bvh, BVH.into()),
        (Kind::Asf, ASF.into()),
        (Kind::Amc, AMC.into()),
        (Kind::DeepMimic, deepmimic().into_bytes()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        for (kind, _) in kinds() {
            let _ = read(kind, &bytes);
        }
        let _ = detect("a.txt", &bytes);
    }

    /// Cuts, overwrites, removals and repetitions of sound files; every one that is read is a valid recording.
    #[test]
    fn mutations_of_sound_files_never_panic(
        which in 0usize..4,
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0u8..5, any::<u8>(), 1usize..40), 1..6),
    ) {
        const BITS: &[u8] = b"0 1 9 -.e{}\n\t:,\"[]#XYZrt\xff\x00";
        let (kind, mut bytes) = kinds()[which].clone();
        for (at, edit, value, length) in edits {
            if bytes.is_empty() { break; }
            let at = at.index(bytes.len());
            let end = (at + length).min(bytes.len());
            match edit {
                0 => bytes[at] = BITS[usize::from(value) % BITS.len()],
                1 => { bytes.drain(at..end); }
                2 => { let part = bytes[at..end].to_vec(); bytes.splice(at..at, part); }
                3 => bytes.truncate(at),
                _ => bytes.insert(at, BITS[usize::from(value) % BITS.len()]),
            }
        }
        if let Ok(recording) = read(kind, &bytes) {
            prop_assert!(recording.frames() * recording.joints().len() <= bytes.len() * 4 + (1 << 16));
            let _ = recording.placements(recording.frames() - 1);
            let mut out = Vec::new();
            if kineme_formats::bvh::write(&recording, &mut out).is_ok() {
                let again = kineme_formats::bvh::parse("again", &out);
                prop_assert!(again.is_ok_and(|a| a.frames() == recording.frames()));
            }
        }
    }
}
