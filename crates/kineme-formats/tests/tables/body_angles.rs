use std::sync::Arc;

use kineme::retargeting::retarget;
use kineme::{Format, Motion, Root, body};
use kineme_formats::Place;
use kineme_formats::detect::{Kind, detect, parse};
use kineme_formats::tables::body_angles::table;

use crate::{refuses, warns};

/// A smooth motion of a body that also turns and walks.
pub fn motion(name: &str, frames: usize) -> Motion {
    let body = Arc::new(body(name).unwrap());
    let neutral = body.neutral();
    let poses = (0..frames).flat_map(|f| {
        let at = move |i: usize| 0.1 * (0.07 * f as f64 + i as f64).sin();
        let neutral = neutral.clone();
        // The pelvis of Ares has no yaw: that is the root's.
        (0..neutral.len()).map(move |i| neutral[i] + if i < 3 { 0.0 } else { at(i) })
    });
    let roots = (0..frames).map(|f| Root {
        position: [0.01 * f as f64, 0.3, 0.95].into(),
        yaw: 0.05 * f as f64 - 3.0,
    });
    let (poses, roots) = (poses.collect(), roots.collect());
    Motion::new("m.csv", Arc::clone(&body), 120.0, poses, roots).unwrap()
}

#[test]
fn a_motion_comes_back_from_its_table() {
    for name in ["ares", "adonis"] {
        let original = motion(name, 90);
        let bytes = table(&original).write("m.csv").unwrap();
        assert_eq!(detect("m.csv", &bytes), Some(Kind::Angles));
        let recording = parse(Kind::Angles, "m.csv", &bytes, None, None).unwrap();
        assert_eq!(recording.source().format, Format::AngleTable);
        assert!(recording.source().warnings.is_empty(), "{name}");
        let back = retarget(&recording, original.skeleton(), None)
            .unwrap()
            .motion;
        assert!((back.rate_hz() - 120.0).abs() < 1e-9, "{name}");
        let coordinates = back.poses().iter().zip(original.poses());
        let worst = coordinates.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{name}: {worst}");
        for (a, b) in back.roots().iter().zip(original.roots()) {
            assert!((a.position - b.position).norm() < 1e-9, "{name}");
            assert!((a.yaw - b.yaw).abs() < 1e-9, "{name}: {} {}", a.yaw, b.yaw);
        }
    }
}

#[test]
fn gaps_are_filled_in_time_and_told() {
    // 0.02 s is not in the table, 0.03 s lacks the elbow, the left knee is not a column.
    let text = "time,root_x,root_y,root_z,root_yaw,left_elbow,neck_x\n\
                0,0,0,0.95,0,,0.1\n0.01,0,0,0.95,0,1.0,0.1\n0.03,0,0,0.95,,,0.1\n0.04,0,0,0.95,0.5,0.4,0.1\n";
    let recording = parse(Kind::Angles, "gaps.csv", text.as_bytes(), None, None).unwrap();
    for words in [
        "9 cells missing",
        "of `adonis` never observed",
        "1 frames are not",
    ] {
        assert!(
            warns(&recording, words),
            "{words}: {:?}",
            recording.source().warnings
        );
    }
    let adonis = Arc::new(body("adonis").unwrap());
    let motion = retarget(&recording, &adonis, None).unwrap().motion;
    let elbow = adonis
        .coordinate_names()
        .iter()
        .position(|c| c == "left_elbow")
        .unwrap();
    for (f, wanted) in [1.0, 1.0, 0.8, 0.6, 0.4].into_iter().enumerate() {
        assert!((motion.pose(f)[elbow] - wanted).abs() < 1e-9, "frame {f}");
    }
    assert!((motion.root(2).yaw - motion.root(1).yaw - 0.5 / 3.0).abs() < 1e-9);
}

#[test]
fn tables_of_no_body_are_refused() {
    let head = "time,root_x,root_y,root_z,root_yaw";
    let typing_error = format!("{head},neck_x,skul_x\n0,0,0,0,0,0,0\n");
    let two_bodies = format!("{head},left_elbow,left_elbow_x\n0,0,0,0,0,0,0\n");
    let many_rows: String = (0..9000)
        .map(|i| format!("{},,,,,\n", i / 2 * 7 + i % 2))
        .collect();
    let hollow = format!("{head},lumbar_5_x\n{many_rows}");
    refuses(
        &[
            ("typing error", &typing_error, Place::Line(1), "`skul_x`"),
            ("two bodies", &two_bodies, Place::Line(1), "`left_elbow"),
            (
                "no rows",
                &format!("{head},neck_x\n"),
                Place::File,
                "no row",
            ),
            (
                "nothing in it",
                &hollow,
                Place::File,
                "44 joints in 31495 frames",
            ),
        ],
        |bytes| parse(Kind::Angles, "a.csv", bytes, None, None),
    );
}
