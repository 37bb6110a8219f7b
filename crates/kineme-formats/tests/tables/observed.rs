use std::sync::Arc;

use kineme::{Skeleton, body};
use kineme_formats::Place;
use kineme_formats::tables::observed::{ObservedRows, parse};

use crate::refuses;

const HEAD: &str = "time,root_x,root_y,root_z,root_yaw";

fn adonis() -> Arc<Skeleton> {
    Arc::new(body("adonis").unwrap())
}

/// The joints that are missing, by name.
fn gone<'b>(body: &'b Skeleton, missing: &[bool]) -> Vec<&'b str> {
    let joints = body.joints().iter().zip(missing);
    let gone = joints.filter(|(joint, gone)| **gone && joint.kind.dof() > 0);
    gone.map(|(joint, _)| joint.name.as_str()).collect()
}

#[test]
fn what_is_not_in_a_table_is_missing_in_the_file_and_in_the_stream() {
    let body = adonis();
    // The elbow is empty once, a coordinate of the neck once; 0.02 s is left out; the left shoulder lacks a column.
    let columns: Vec<String> = body.coordinate_names();
    let kept: Vec<&String> = columns.iter().filter(|c| *c != "left_shoulder_y").collect();
    let mut text = format!(
        "{HEAD},{}\n",
        kept.iter()
            .map(|c| c.as_str())
            .collect::<Vec<_>>()
            .join(",")
    );
    for (secs, empty, root) in [
        ("0", "", "0,0,0.95,0.5"),
        ("0.01", "left_elbow", "0,0,0.95,0.5"),
        ("0.03", "neck_y", "0,,0.95,0.5"),
        ("0.04", "", "0,0,0.95,0.5"),
    ] {
        let cells = kept.iter().map(|c| if *c == empty { "" } else { "0.1" });
        text += &format!("{secs},{root},{}\n", cells.collect::<Vec<_>>().join(","));
    }
    let wanted = [
        vec!["left_shoulder"],
        vec!["left_elbow", "left_shoulder"],
        vec!["left_shoulder", "neck"],
        vec!["left_shoulder"],
    ];
    let observed = parse("o.csv", text.as_bytes(), &body).unwrap().unwrap();
    let share = "of the joints not seen";
    assert!(
        observed.warnings.iter().any(|w| w.contains(share)),
        "{:?}",
        observed.warnings
    );
    assert_eq!(observed.seen.motion().frames(), 5);
    let mut rows = ObservedRows::open("-", text.as_bytes(), &body).unwrap();
    assert_eq!(rows.unseen(), ["left_shoulder"]);
    let known = |f: usize| {
        let mut names = gone(&body, observed.seen.at(f).missing);
        names.sort_unstable();
        names
    };
    for (frame, wanted) in [0, 1, 3, 4].into_iter().zip(wanted) {
        let row = rows.next_row().unwrap().unwrap();
        let mut streamed = gone(&body, row.missing);
        streamed.sort_unstable();
        assert_eq!(streamed, wanted, "frame {frame}");
        assert_eq!(known(frame), wanted, "frame {frame}");
        assert!((row.secs - 0.01 * frame as f64).abs() < 1e-12);
        assert_eq!(row.root.is_some(), frame != 3, "a root without y is none");
        for (joint, missing) in row.missing.iter().enumerate() {
            let there = &row.pose[body.coordinates(joint)];
            assert!(*missing || there.iter().all(|x| *x == 0.1), "frame {frame}");
        }
    }
    assert!(rows.next_row().unwrap().is_none());
    let moving = body.joints().iter().filter(|j| j.kind.dof() > 0);
    assert_eq!(
        known(2).len(),
        moving.count(),
        "of a frame left out nothing is known"
    );
}

#[test]
fn a_whole_table_has_nothing_missing_and_other_bodies_are_not_taken() {
    let body = adonis();
    let names = body.coordinate_names();
    let ones = vec!["0.1"; names.len()].join(",");
    let columns = names.join(",");
    let text = format!("{HEAD},{columns}\n0,0,0,0,0,{ones}\n0.1,0,0,0,0,{ones}\n");
    let observed = parse("o.csv", text.as_bytes(), &body).unwrap().unwrap();
    assert!(observed.seen.at(0).missing.is_empty() && observed.warnings.is_empty());
    assert!(observed.seen.motion().pose(0).iter().all(|x| *x == 0.1));
    let ares = Arc::new(kineme::body("ares").unwrap());
    assert!(parse("o.csv", text.as_bytes(), &ares).unwrap().is_none());
}

#[test]
fn streams_of_no_such_body_are_refused() {
    let strange = format!("{HEAD},neck_x,skul_x\n");
    let bare = format!("{HEAD}\n");
    refuses(
        &[
            ("a strange column", &strange, Place::Line(1), "`skul_x`"),
            ("no joint", &bare, Place::Line(1), "no joint"),
            ("positions", "time,head_x\n", Place::Line(1), "`head_x`"),
            ("nothing", "", Place::File, "nothing"),
        ],
        |bytes| ObservedRows::open("-", bytes, &adonis()).map(|rows| rows.unseen().len()),
    );
}
