//! Recordings: placements worked out by hand, axes and units, what is refused; motions as recordings.

use std::f64::consts::FRAC_PI_2;

use kineme::math::rotation::Axis;
use kineme::{Format, Observed, RecordedJoint, Recording, Source, ares};
use kineme::{Motion, Root, adonis};
use nalgebra::{UnitQuaternion, Vector3};

fn source(up: Axis, unit_metres: f64) -> Source {
    Source {
        format: Format::Synthetic,
        up,
        unit_metres,
        warnings: vec![],
    }
}

fn joint(name: &str, parent: Option<usize>, offset: [f64; 3]) -> RecordedJoint {
    RecordedJoint {
        name: name.into(),
        parent,
        offset: offset.into(),
        tip: None,
        order: None,
        dof: 3,
    }
}

fn chain() -> Vec<RecordedJoint> {
    vec![
        joint("root", None, [0.0; 3]),
        joint("mid", Some(0), [1.0, 0.0, 0.0]),
        joint("end", Some(1), [1.0, 0.0, 0.0]),
    ]
}

fn rotations(turns: [UnitQuaternion<f64>; 3], root: Vector3<f64>) -> Observed {
    Observed::Rotations {
        rotations: turns.to_vec(),
        translations: vec![Some(vec![root]), None, None],
    }
}

#[test]
fn placements_compose_from_the_root_outward() {
    let left = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2);
    let observed = rotations([left, left, UnitQuaternion::identity()], Vector3::z());
    let r = Recording::new("chain", source(Axis::Z, 1.0), chain(), 30.0, observed).expect("valid");
    let placed = r.placements(0);
    for (i, wanted) in [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 1.0, 1.0]]
        .iter()
        .enumerate()
    {
        let found = placed[i].position.expect("a position");
        assert!(
            (found - Vector3::from(*wanted)).norm() < 1e-12,
            "{i}: {found:?}"
        );
    }
    let end = placed[2].rotation.expect("a rotation");
    assert!((end * Vector3::x() + Vector3::x()).norm() < 1e-12);
    let mut again = placed.clone();
    r.place(0, &mut again);
    assert_eq!(again, placed);
    assert_eq!((r.frames(), r.dof()), (1, 9));
}

#[test]
fn points_and_rotations_survive_the_way_into_our_axes_and_back() {
    let v = Vector3::new(1.0, -2.0, 3.0);
    for (up, wanted) in [
        (Axis::Y, [0.03, 0.01, -0.02]),
        (Axis::Z, [0.01, -0.02, 0.03]),
    ] {
        let s = source(up, 0.01);
        assert!((s.to_inner(v) - Vector3::from(wanted)).norm() < 1e-15);
        assert!((s.to_native(s.to_inner(v)) - v).norm() < 1e-12);
        let q = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, 0.8, -0.4));
        assert!(s.rotation_to_native(s.rotation_to_inner(q)).angle_to(&q) < 1e-12);
        let turned = s.rotation_to_inner(q) * s.to_inner(v);
        assert!(
            (turned - s.to_inner(q * v)).norm() < 1e-12,
            "a change of axes keeps turning"
        );
    }
}

#[test]
fn what_breaks_the_contract_is_refused() {
    let positions = |n: usize| Observed::Positions(vec![Some(Vector3::zeros()); n]);
    let same = |joints: Vec<RecordedJoint>, rate: f64, observed: Observed| {
        Recording::new("bad", source(Axis::Z, 1.0), joints, rate, observed)
    };
    let mut orphan = chain();
    orphan[1].parent = Some(2);
    let mut endless = chain();
    endless[2].offset.x = f64::INFINITY;
    let identity = UnitQuaternion::identity();
    let nan = rotations([identity; 3], Vector3::new(f64::NAN, 0.0, 0.0));
    let short = Observed::Rotations {
        rotations: vec![identity; 6],
        translations: vec![Some(vec![Vector3::zeros()]), None, None],
    };
    for (what, found) in [
        ("no joints", same(vec![], 30.0, positions(3))),
        ("no frames", same(chain(), 30.0, positions(0))),
        ("a broken frame", same(chain(), 30.0, positions(4))),
        ("no rate", same(chain(), 0.0, positions(3))),
        ("a child first", same(orphan, 30.0, positions(3))),
        ("an endless bone", same(endless, 30.0, positions(3))),
        ("no number", same(chain(), 30.0, nan)),
        ("translations too short", same(chain(), 30.0, short)),
    ] {
        assert!(found.is_err_and(|e| e.is_invalid()), "{what}");
    }
}

#[test]
fn a_motion_as_a_recording_stands_where_the_motion_stands() {
    for body in [ares(), adonis()] {
        let body = std::sync::Arc::new(body.expect("a body"));
        let mut pose = body.neutral();
        pose.iter_mut()
            .enumerate()
            .for_each(|(i, v)| *v += 0.1 * (i as f64).sin());
        let root = Root {
            position: Vector3::new(1.0, 2.0, 0.9),
            yaw: 4.0,
        };
        let motion = Motion::new("m", body.clone(), 60.0, pose, vec![root]).expect("a motion");
        let recording = Recording::from_motion(&motion);
        assert_eq!((recording.frames(), recording.rate_hz()), (1, 60.0));
        for (a, b) in recording.placements(0).iter().zip(motion.frames_at(0)) {
            assert!((a.position.expect("seen") - b.position).norm() < 1e-12);
            assert!(a.rotation.expect("seen").angle_to(&b.rotation) < 1e-12);
        }
        for (j, joint) in recording.joints().iter().enumerate() {
            let carries = recording.joints().iter().any(|k| k.parent == Some(j));
            assert_eq!(
                joint.tip.is_none(),
                carries,
                "{}: leaves have tips",
                joint.name
            );
        }
    }
}

/// A joint that turns about z and walks along x, evenly: the frame's number times a tenth.
fn even(frames: usize, rate_hz: f64) -> Recording {
    let turn = |f: usize| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.1 * f as f64);
    let observed = Observed::Rotations {
        rotations: (0..frames).map(turn).collect(),
        translations: vec![Some(
            (0..frames).map(|f| Vector3::x() * 0.1 * f as f64).collect(),
        )],
    };
    let joints = vec![joint("root", None, [0.0; 3])];
    Recording::new("even", source(Axis::Y, 0.01), joints, rate_hz, observed).expect("valid")
}

#[test]
fn duration_runs_from_the_first_frame_to_the_last() {
    for (frames, rate, secs) in [(1, 30.0, 0.0), (2, 4.0, 0.25), (344, 120.0, 343.0 / 120.0)] {
        assert_eq!(even(frames, rate).duration_secs(), secs, "{frames} frames");
    }
}

#[test]
fn resampling_keeps_even_turns_and_paths_even() {
    let recording = even(31, 30.0);
    assert_eq!(recording.resampled(30.0).expect("the same"), recording);
    for rate in [10.0, 45.0, 120.0, 7.0] {
        let other = recording.resampled(rate).expect("a recording");
        assert!(
            (other.duration_secs() - 1.0).abs() < 1.0 / rate,
            "{rate} Hz"
        );
        assert_eq!(other.source(), recording.source());
        for f in 0..other.frames() {
            let placed = other.placements(f)[0];
            let expected = 3.0 * f as f64 / rate;
            let (place, turn) = (
                placed.position.expect("seen"),
                placed.rotation.expect("turned"),
            );
            assert!((place.x - expected).abs() < 1e-12, "{rate} Hz, frame {f}");
            assert!(
                (turn.angle() - expected).abs() < 1e-9,
                "{rate} Hz, frame {f}"
            );
        }
    }
    for rate in [0.0, f64::NAN, -1.0, 1e9] {
        assert!(recording.resampled(rate).is_err(), "{rate} Hz");
    }
}

#[test]
fn a_missing_point_is_missing_on_both_sides_of_it_only() {
    let seen = |x: f64| Some(Vector3::x() * x);
    let observed = Observed::Positions(vec![seen(0.0), seen(1.0), None, seen(3.0), seen(4.0)]);
    let joints = vec![joint("a", None, [0.0; 3])];
    let recording =
        Recording::new("gap", source(Axis::Z, 1.0), joints, 1.0, observed).expect("valid");
    let Observed::Positions(found) = recording.resampled(2.0).expect("valid").observed().clone()
    else {
        panic!("positions stay positions");
    };
    let x: Vec<Option<f64>> = found.iter().map(|p| p.map(|p| p.x)).collect();
    let wanted = [0.0, 0.5, 1.0, -1.0, -1.0, -1.0, 3.0, 3.5, 4.0];
    assert_eq!(x, wanted.map(|v| (v >= 0.0).then_some(v)));
}

#[test]
fn what_a_file_means_in_other_axes_and_units_is_the_same_file() {
    let recording = even(3, 30.0);
    let other = recording.reread(Axis::Z, 1.0).expect("valid");
    for f in 0..3 {
        let native = |r: &Recording| {
            let placed = r.placements(f)[0];
            (
                r.source().to_native(placed.position.expect("seen")),
                r.source()
                    .rotation_to_native(placed.rotation.expect("turned")),
            )
        };
        let ((p, q), (a, b)) = (native(&recording), native(&other));
        assert!(
            (p - a).norm() < 1e-12 && q.angle_to(&b) < 1e-12,
            "frame {f}"
        );
    }
    assert_eq!(
        other.reread(Axis::Y, 0.01).expect("valid").source(),
        recording.source()
    );
    assert!(recording.reread(Axis::Y, 0.0).is_err());

    let told = Source {
        up: Axis::Z,
        ..recording.source().clone()
    };
    let moved = recording.clone().with_source(told.clone()).expect("valid");
    assert_eq!(
        (moved.placements(2), moved.source()),
        (recording.placements(2), &told)
    );
    let broken = Source {
        unit_metres: -1.0,
        ..told
    };
    assert!(recording.with_source(broken).is_err());
}
