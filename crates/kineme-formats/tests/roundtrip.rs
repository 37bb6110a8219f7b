//! What is written reads back alike.

mod common;

use common::{bytes, data, points};
use kineme::math::rotation::{Axis, EulerOrder};
use kineme::{Format, Observed, RecordedJoint, Recording, Source};
use kineme_formats::{amc, asf, bvh, deepmimic, positions};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

fn written(recording: &Recording) -> Vec<u8> {
    let mut out = Vec::new();
    bvh::write(recording, &mut out).expect("rotations");
    out
}

/// Writes, reads, and compares unit, axes, rate and every point of some frames.
fn check(recording: &Recording) {
    let text = written(recording);
    let again = bvh::parse(recording.name(), &text).expect("our own file");
    let name = recording.name();
    assert_eq!(again.frames(), recording.frames(), "{name}");
    assert_eq!(again.rate_hz(), recording.rate_hz(), "{name}");
    assert_eq!(again.source().up, recording.source().up, "{name}");
    let (unit, other) = (recording.source().unit_metres, again.source().unit_metres);
    assert!(
        (unit / other - 1.0).abs() < 1e-12,
        "{name}: unit {unit} became {other}"
    );
    for frame in (0..recording.frames()).step_by(1 + recording.frames() / 5) {
        let (before, after) = (points(recording, frame), points(&again, frame));
        let largest = before.values().map(|p| p.amax()).fold(0.0, f64::max);
        for (point, place) in &after {
            let far = (place - before[point]).amax();
            assert!(
                far <= 1e-9 * largest,
                "{name} {point} frame {frame}: {far:e} of {largest}"
            );
        }
        for joint in recording.joints() {
            assert!(
                after.contains_key(&joint.name),
                "{name}: {} is lost",
                joint.name
            );
        }
    }
    // Once in our own form a file stays as it is.
    assert_eq!(
        String::from_utf8(written(&again)),
        String::from_utf8(text),
        "{name}"
    );
}

#[test]
fn real_motion_survives_bvh() {
    let Some(data) = data() else { return };
    for file in [
        "bandai-namco-1/dataset-1_dash_active_001.bvh",
        "cmu-daz/martial/07.bvh",
        "cmu-lifeforms/006/006_01.bvh",
        "cmu-mb/16/16_22.bvh",
    ] {
        let recording = bvh::parse(file, &bytes(&data, file)).expect("a motion");
        check(&recording);
        let again = bvh::parse(file, &written(&recording)).expect("our own file");
        assert_eq!(again.joints(), recording.joints(), "{file}");
    }
    let skeleton = asf::parse("02.asf", &bytes(&data, "cmu-asfamc/02/02.asf")).expect("an ASF");
    let file = "cmu-asfamc/02/02_01.amc";
    check(&amc::parse(file, &bytes(&data, file), &skeleton, None).expect("a motion"));
    let file = "deepmimic/humanoid3d_spinkick.txt";
    check(&deepmimic::parse(file, &bytes(&data, file)).expect("a clip"));
}

const ORDERS: [&str; 12] = [
    "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ",
];

/// A trunk and a leg of an adult, all joints in one order, with these angles (degrees).
fn figure(order: &str, up: Axis, angles: &[[f64; 3]]) -> Recording {
    let order = EulerOrder::parse(order).expect("an order");
    let joint = |name: &str, parent, z: f64, tip: Option<f64>, dof| RecordedJoint {
        name: name.into(),
        parent,
        offset: Vector3::new(0.0, 0.0, z),
        tip: tip.map(|z| Vector3::new(0.0, 0.0, z)),
        order: Some(order),
        dof,
    };
    let joints = vec![
        joint("hips", None, 0.0, None, 6),
        joint("leg", Some(0), -0.1, Some(-1.0), 3),
        joint("trunk", Some(0), 0.1, Some(0.7), 3),
    ];
    let source = Source {
        format: Format::Bvh,
        up,
        unit_metres: 0.01,
        warnings: Vec::new(),
    };
    let mut rotations = Vec::new();
    for triple in angles {
        // The hips stand, so that the up axis can be told; the others turn as they like.
        rotations.push(UnitQuaternion::identity());
        for scale in [0.1, 1.0] {
            let turn = order.rotation(triple.map(|a| (a * scale).to_radians()));
            rotations.push(source.rotation_to_inner(turn));
        }
    }
    let places = (0..angles.len()).map(|f| Vector3::new(0.01 * f as f64, 0.0, 1.1));
    let observed = Observed::Rotations {
        rotations,
        translations: vec![Some(places.collect()), None, None],
    };
    Recording::new("figure", source, joints, 30.0, observed).expect("a figure")
}

/// The turns of a file are compared as matrices, in every order, at and near gimbal lock too.
#[test]
fn every_order_survives_gimbal_lock() {
    for order in ORDERS {
        for middle in [
            0.0,
            90.0,
            -90.0,
            180.0,
            90.0 - 1e-7,
            89.9999,
            -90.0 + 1e-6,
            1e-7,
            180.0 - 1e-6,
        ] {
            let angles = [
                [10.0, middle, 30.0],
                [-170.0, middle, 175.0],
                [0.0, middle, 0.0],
            ];
            let recording = figure(order, Axis::Y, &angles);
            let again = bvh::parse("figure", &written(&recording)).expect("our own file");
            let (
                Observed::Rotations { rotations: a, .. },
                Observed::Rotations { rotations: b, .. },
            ) = (recording.observed(), again.observed())
            else {
                panic!("rotations");
            };
            for (a, b) in a.iter().zip(b) {
                let far =
                    (a.to_rotation_matrix().matrix() - b.to_rotation_matrix().matrix()).amax();
                assert!(far < 1e-11, "{order} {middle}: {far:e}");
            }
        }
    }
}

/// Channels of a joint that turns steadily do not jump by whole turns or between equivalent triples.
#[test]
fn written_angles_do_not_jump() {
    // The middle angle goes through both gimbal locks, the others through half turns.
    let turning: Vec<[f64; 3]> = (0..200)
        .map(f64::from)
        .map(|f| [f, 1.8 * f, 0.5 * f])
        .collect();
    let text = String::from_utf8(written(&figure("ZXY", Axis::Y, &turning))).expect("text");
    let (_, rows) = text.split_once("Frame Time: ").expect("rows");
    let rows: Vec<Vec<f64>> = rows
        .lines()
        .skip(1)
        .map(|l| l.split(' ').map(|w| w.parse().expect("a number")).collect())
        .collect();
    for pair in rows.windows(2) {
        for (a, b) in pair[0].iter().zip(&pair[1]) {
            assert!((a - b).abs() < 10.0, "{a} to {b}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn any_turns_in_any_order_survive(
        order in 0usize..12,
        z_up in any::<bool>(),
        angles in proptest::collection::vec(prop::array::uniform3(-180.0f64..180.0), 1..6),
    ) {
        // A leg that turns anywhere may lie: then nothing tells the up axis, so only y up is asked for there.
        let up = if z_up && angles.iter().flatten().all(|a| a.abs() < 30.0) { Axis::Z } else { Axis::Y };
        let standing: Vec<[f64; 3]> = angles.iter().map(|t| t.map(|a| a * if up == Axis::Z { 1.0 } else { 0.2 })).collect();
        check(&figure(ORDERS[order], up, &standing));
    }
}

#[test]
fn a_file_with_z_up_stays_z_up() {
    check(&figure(
        "ZXY",
        Axis::Z,
        &[[0.0, 5.0, 0.0], [3.0, 10.0, -8.0]],
    ));
}

#[test]
fn positions_are_written_native_and_in_metres() {
    let recording = figure("ZXY", Axis::Y, &[[0.0; 3]]);
    let table = |frame| {
        let mut out = Vec::new();
        positions::write(&recording, frame, &mut out).expect("a table");
        String::from_utf8(out).expect("text")
    };
    let header = "frame,hips_x,hips_y,hips_z,leg_x,leg_y,leg_z,leg_End_x,leg_End_y,leg_End_z,trunk_x,trunk_y,trunk_z,trunk_End_x,trunk_End_y,trunk_End_z\n";
    let near = |text: &str, expected: &[f64]| {
        let (head, row) = text.split_at(header.len());
        assert_eq!(head, header);
        let found: Vec<f64> = row
            .trim()
            .split(',')
            .map(|c| c.parse().expect("a number"))
            .collect();
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{found:?} {expected:?}");
        }
    };
    let metres = [
        0.0, 0.0, 0.0, 1.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.2, 0.0, 0.0, 1.9,
    ];
    let native = [
        0.0, 0.0, 110.0, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 120.0, 0.0, 0.0, 190.0, 0.0,
    ];
    near(&table(positions::Frame::Metres), &metres);
    near(&table(positions::Frame::Native), &native);
}
