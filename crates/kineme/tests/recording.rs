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
