use std::io::{Cursor, Read};
use std::sync::Arc;

use kineme::math::rotation::Axis;
use kineme::{Format, Motion, Observed, RecordedJoint, Recording, Root, Source, body};
use kineme_formats::npz;
use kineme_formats::positions::Frame;
use nalgebra::{UnitQuaternion, Vector3};
use zip::ZipArchive;

/// An array as it stands in an archive.
struct Array {
    kind: String,
    shape: String,
    data: Vec<u8>,
}

impl Array {
    fn numbers(&self) -> Vec<f64> {
        assert_eq!(self.kind, "<f8");
        let (chunks, rest) = self.data.as_chunks::<8>();
        assert!(rest.is_empty());
        chunks.iter().map(|b| f64::from_le_bytes(*b)).collect()
    }

    fn names(&self) -> Vec<String> {
        let width: usize = self.kind.strip_prefix("<U").unwrap().parse().unwrap();
        let (chunks, rest) = self.data.as_chunks::<4>();
        assert!(rest.is_empty());
        let letters: Vec<char> = chunks
            .iter()
            .map(|b| char::from_u32(u32::from_le_bytes(*b)).unwrap())
            .collect();
        let padded = letters
            .chunks(width)
            .map(|name| name.iter().collect::<String>());
        padded
            .map(|name| name.trim_end_matches('\0').to_string())
            .collect()
    }
}

/// Reads an array by the letter of NPY 1.0.
fn array(archive: &[u8], name: &str) -> Array {
    let mut zip = ZipArchive::new(Cursor::new(archive)).unwrap();
    let mut bytes = Vec::new();
    let mut file = zip.by_name(&format!("{name}.npy")).unwrap();
    file.read_to_end(&mut bytes).unwrap();
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00", "{name}");
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert!(
        start.is_multiple_of(64) && bytes[start - 1] == b'\n',
        "{name}"
    );
    let text = std::str::from_utf8(&bytes[10..start]).unwrap().trim_end();
    let text = text.strip_prefix("{'descr': '").unwrap();
    let (kind, text) = text
        .split_once("', 'fortran_order': False, 'shape': (")
        .unwrap();
    Array {
        kind: kind.to_string(),
        shape: text.strip_suffix("), }").unwrap().to_string(),
        data: bytes[start..].to_vec(),
    }
}

/// Which arrays an archive holds, of which type and shape, in order.
fn check(archive: &[u8], expected: &[(&str, &str, &str)]) {
    let zip = ZipArchive::new(Cursor::new(archive)).unwrap();
    let names: Vec<&str> = zip.file_names().collect();
    let wanted: Vec<String> = expected.iter().map(|(n, ..)| format!("{n}.npy")).collect();
    assert_eq!(names, wanted);
    for (name, kind, shape) in expected {
        let found = array(archive, name);
        assert_eq!(
            (found.kind.as_str(), found.shape.as_str()),
            (*kind, *shape),
            "{name}"
        );
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn motion() -> Motion {
    let body = Arc::new(body("adonis").unwrap());
    let poses = (0..60).map(|i| (i as f64).sin() / 3.0).collect();
    let roots = (0..3).map(|f| Root {
        position: [f as f64 / 3.0, -0.0, 0.95].into(),
        yaw: 1e-300,
    });
    Motion::new("wave", body, 1.0 / 0.033, poses, roots.collect()).unwrap()
}

#[test]
fn a_motion_is_arrays_with_all_its_numbers() {
    let motion = motion();
    let archive = npz::write(&motion).unwrap();
    let joints = motion.skeleton().joints();
    let longest = |names: &[String]| names.iter().map(String::len).max().unwrap();
    let names: Vec<String> = joints.iter().map(|j| j.name.clone()).collect();
    let coordinates = motion.skeleton().coordinate_names();
    let n = joints.len();
    check(
        &archive,
        &[
            ("body", "<U6", ""),
            ("rate", "<f8", ""),
            ("time", "<f8", "3,"),
            (
                "coordinates",
                &format!("<U{}", longest(&coordinates)),
                "20,",
            ),
            ("poses", "<f8", "3, 20"),
            ("root", "<f8", "3, 4"),
            (
                "joints",
                &format!("<U{}", longest(&names)),
                &format!("{n},"),
            ),
            ("positions", "<f8", &format!("3, {n}, 3")),
        ],
    );
    assert_eq!(array(&archive, "body").names(), ["adonis"]);
    assert_eq!(array(&archive, "rate").numbers(), [motion.rate_hz()]);
    assert_eq!(array(&archive, "time").numbers()[2], 2.0 / motion.rate_hz());
    assert_eq!(array(&archive, "coordinates").names(), coordinates);
    assert_eq!(array(&archive, "joints").names(), names);
    assert_eq!(
        bits(&array(&archive, "poses").numbers()),
        bits(motion.poses())
    );
    let root = [1.0 / 3.0, -0.0, 0.95, 1e-300];
    assert_eq!(bits(&array(&archive, "root").numbers()[4..8]), bits(&root));
    let positions = array(&archive, "positions").numbers();
    for frame in 0..3 {
        for (joint, placed) in motion.frames_at(frame).iter().enumerate() {
            let at = 3 * (frame * n + joint);
            assert_eq!(positions[at..at + 3], *placed.position.as_slice());
        }
    }
    assert_eq!(npz::write(&motion).unwrap(), archive, "the same bytes");
}

fn joint(name: &str, parent: Option<usize>) -> RecordedJoint {
    RecordedJoint {
        name: name.to_string(),
        parent,
        offset: Vector3::new(0.0, 0.0, 0.5),
        tip: parent.map(|_| Vector3::new(0.0, 0.25, 0.0)),
        order: None,
        dof: 3,
    }
}

fn recording(observed: Observed) -> Recording {
    let source = Source {
        format: Format::Synthetic,
        up: Axis::Y,
        unit_metres: 0.01,
        warnings: Vec::new(),
    };
    let joints = vec![joint("a", None), joint("ßeta", Some(0))];
    Recording::new("r", source, joints, 50.0, observed).unwrap()
}

#[test]
fn a_recording_keeps_its_rotations() {
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    let recording = recording(Observed::Rotations {
        rotations: vec![quarter, UnitQuaternion::identity()],
        translations: vec![None, None],
    });
    let archive = npz::write_recording(&recording).unwrap();
    check(
        &archive,
        &[
            ("rate", "<f8", ""),
            ("time", "<f8", "1,"),
            ("joints", "<U4", "2,"),
            ("parents", "<i8", "2,"),
            ("positions", "<f8", "1, 2, 3"),
            ("rotations", "<f8", "1, 2, 4"),
        ],
    );
    assert_eq!(array(&archive, "joints").names(), ["a", "ßeta"]);
    let parents = array(&archive, "parents").data;
    assert_eq!(parents, [[0xff; 8], [0; 8]].concat(), "-1 and 0");
    let half = 0.5_f64.sqrt();
    let expected = [half, half, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    for (found, expected) in array(&archive, "rotations").numbers().iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    }
    let positions = array(&archive, "positions").numbers();
    for (found, expected) in positions.iter().zip([0.0, 0.0, 0.5, 0.0, -0.5, 0.5]) {
        assert!((found - expected).abs() < 1e-15, "{positions:?}");
    }
    // The points of the table: the joint's tip among them, here in centimetres with y up.
    let archive = npz::write_positions(&recording, Frame::Native).unwrap();
    check(
        &archive,
        &[
            ("rate", "<f8", ""),
            ("time", "<f8", "1,"),
            ("joints", "<U8", "3,"),
            ("positions", "<f8", "1, 3, 3"),
        ],
    );
    assert_eq!(array(&archive, "joints").names(), ["a", "ßeta", "ßeta_End"]);
    let tip = &array(&archive, "positions").numbers()[6..];
    for (found, expected) in tip.iter().zip([-50.0, 75.0, 0.0]) {
        assert!((found - expected).abs() < 1e-12, "{tip:?}");
    }
}

#[test]
fn points_that_were_not_seen_are_not_numbers() {
    let seen = Vector3::new(1.0, 2.0, 3.0);
    let recording = recording(Observed::Positions(vec![
        Some(seen),
        None,
        None,
        Some(seen),
    ]));
    let archive = npz::write_recording(&recording).unwrap();
    let zip = ZipArchive::new(Cursor::new(&archive)).unwrap();
    assert!(zip.file_names().all(|name| name != "rotations.npy"));
    let nan = f64::NAN;
    let expected = [1.0, 2.0, 3.0, nan, nan, nan, nan, nan, nan, 1.0, 2.0, 3.0];
    let positions = array(&archive, "positions").numbers();
    assert_eq!(format!("{positions:?}"), format!("{expected:?}"));
}
