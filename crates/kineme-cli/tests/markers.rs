//! Marker files: looked at, put on a body through a profile, and refused with a word on what is missing.

mod common;
#[path = "../../kineme-formats/tests/c3d/written.rs"]
#[allow(dead_code, reason = "a part of it serves here")]
mod written;

use std::fs;

use common::kineme;
use written::Written;

const PROFILE: &str = r#"
name = "suit"
up = "z"
[roles]
left_upper_arm = "Lsh"
right_upper_arm = "Rsh"
left_lower_arm = ["Lel_in", "Lel_out"]
right_lower_arm = ["Rel_in", "Rel_out"]
left_upper_leg = "Lhip"
right_upper_leg = "Rhip"
"#;

/// Somebody who raises both elbows, as the markers of a suit see it, in millimetres.
fn suit() -> Written {
    let place = |name: &str, up: f32| -> [f32; 3] {
        let side = if name.starts_with('L') { 1.0 } else { -1.0 };
        let [aside, height] = match &name[1..] {
            "hip" => [90.0, 900.0],
            "sh" => [180.0, 1400.0],
            "el_in" => [170.0 + 300.0 * up, 1100.0 + 300.0 * up],
            _ => [250.0 + 300.0 * up, 1100.0 + 300.0 * up],
        };
        [0.0, side * aside, height]
    };
    let names = ["hip", "sh", "el_in", "el_out"];
    let labels: Vec<String> = ["L", "R"]
        .iter()
        .flat_map(|side| names.map(|name| format!("{side}{name}")))
        .collect();
    let frame = |up: f32| labels.iter().map(|n| Some(place(n, up))).collect();
    Written {
        points: (0..60).map(|f| frame(f as f32 / 59.0)).collect(),
        labels,
        unit: "mm".into(),
        screen: String::new(),
        ..Written::small()
    }
}

#[test]
fn markers_are_told_and_move_a_body_through_a_profile() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("take.c3d"), suit().bytes()).expect("a file");
    fs::write(folder.path().join("suit.toml"), PROFILE).expect("a file");
    let lost = PROFILE.replace("Lel_in", "Lelbow");
    fs::write(folder.path().join("lost.toml"), lost).expect("a file");
    // The line; its exit code; what it must and must not say.
    let cases: [(&str, i32, &[&str], &str); 6] = [
        (
            "info take.c3d",
            0,
            &["c3d", "8", "60", "mm", "up axis: z assumed"],
            "suit",
        ),
        ("info take.c3d --profile suit.toml", 0, &["suit"], "up axis"),
        (
            "convert take.c3d out.bvh --body ares --profile suit.toml",
            0,
            &["60 frames at 50 Hz"],
            "up axis",
        ),
        (
            "convert take.c3d points.csv --positions",
            0,
            &["60 frames"],
            "suit",
        ),
        (
            "convert take.c3d other.bvh --body ares",
            3,
            &["no joint found for", "--profile FILE"],
            "suit",
        ),
        (
            "convert take.c3d other.bvh --body ares --profile lost.toml",
            3,
            &[
                "the profile `suit` wants the marker `Lelbow` for left_lower_arm",
                "Lel_out",
            ],
            "hint",
        ),
    ];
    for (line, code, words, never) in cases {
        let run = kineme(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
        let said = format!("{}{}", run.out, run.err);
        assert_eq!(run.code, code, "{line}: {said}");
        for word in words {
            assert!(said.contains(word), "{line}: no {word:?} in {said}");
        }
        assert!(!said.contains(never), "{line}: {never:?} in {said}");
    }
    let table = fs::read_to_string(folder.path().join("points.csv")).expect("a table");
    let mut lines = table.lines();
    let header = lines.next().expect("a header");
    assert!(
        header.starts_with("frame,Lhip_x,Lhip_y,Lhip_z,Lsh_x"),
        "{header}"
    );
    let first = lines.next().expect("a row");
    assert!(first.starts_with("0,0,0.09,0.9,0,0.18,1.4"), "{first}");
}
