//! Marker files: what is read of them, and the joints that markers surround.

#[path = "../common/mod.rs"]
mod common;
mod joints;
mod written;

use std::collections::BTreeMap;

use common::{bytes, data, number, oracle};
use kineme::math::rotation::Axis;
use kineme::{Observed, Recording};
use kineme_formats::Place;
use kineme_formats::c3d::{parse, sniff};
use nalgebra::Vector3;
use proptest::prelude::*;
use written::{Numbers, Written};

fn read(written: &Written) -> Recording {
    parse("a.c3d", &written.bytes()).unwrap_or_else(|e| panic!("{e}"))
}

fn seen(recording: &Recording) -> &[Option<Vector3<f64>>] {
    match recording.observed() {
        Observed::Positions(seen) => seen,
        Observed::Rotations { .. } => panic!("markers do not turn"),
    }
}

fn names(recording: &Recording) -> Vec<&str> {
    recording.joints().iter().map(|j| j.name.as_str()).collect()
}

#[test]
fn markers_are_those_of_other_libraries() {
    let Some(data) = data() else { return };
    let mut points: BTreeMap<String, Vec<_>> = BTreeMap::new();
    for row in oracle(&data, "c3d_points.csv") {
        points.entry(row["file"].clone()).or_default().push(row);
    }
    let files = oracle(&data, "c3d_files.csv");
    assert_eq!((files.len(), points.len()), (10, 10));
    for file in files {
        let name = &file["file"];
        let bytes = bytes(&data, name);
        assert!(sniff(&bytes), "{name}");
        let recording = parse(name, &bytes).unwrap_or_else(|e| panic!("{e}"));
        let places = seen(&recording);
        let missing = places.iter().filter(|p| p.is_none()).count();
        let found = [recording.joints().len(), recording.frames(), missing].map(|n| n as f64);
        let wanted = ["markers", "frames", "invalid_points"].map(|c| number(&file, c));
        assert_eq!(found, wanted, "{name}");
        let rate = number(&file, "rate_hz");
        assert!((recording.rate_hz() - rate).abs() < 1e-6 * rate, "{name}");
        let unit = if file["units"] == "mm" { 1e-3 } else { 1.0 };
        assert_eq!(recording.source().unit_metres, unit, "{name}");
        let near = if file["processor"] == "DEC" {
            1e-4
        } else {
            1e-6
        };
        for row in &points[name] {
            let marker = number(row, "marker") as usize;
            assert_eq!(names(&recording)[marker], row["name"], "{name}");
            let place = places[number(row, "frame") as usize * recording.joints().len() + marker];
            assert_eq!(place.is_some(), row["valid"] == "1", "{name}: {row:?}");
            let Some(place) = place else { continue };
            let place = recording.source().to_native(place);
            for (axis, column) in ["x", "y", "z"].iter().enumerate() {
                let far = (place[axis] - number(row, column)).abs();
                assert!(far <= near, "{name} {row:?}: {far:e}");
            }
        }
    }
}

#[test]
fn every_processor_and_number_says_the_same() {
    let sound = read(&Written::small());
    let first = [[0.25, -1.5, 0.75], [0.0, 0.5, 1.0]].map(|p| Some(Vector3::from(p)));
    assert_eq!(seen(&sound)[..3], [first[0], first[1], None]);
    for processor in [84, 85, 86] {
        for numbers in [Numbers::Whole, Numbers::Real] {
            for analog in [0, 3] {
                let written = Written {
                    processor,
                    numbers,
                    analog,
                    ..Written::small()
                };
                let recording = read(&written);
                let what = format!("{processor} {numbers:?} {analog}");
                assert_eq!(recording.observed(), sound.observed(), "{what}");
                assert_eq!(recording.joints(), sound.joints(), "{what}");
                assert_eq!(recording.rate_hz(), 50.0, "{what}");
            }
        }
    }
}

#[test]
fn units_and_axes_are_told_or_assumed() {
    // Unit, vertical of the screen; metres in the unit, up, words of the warnings.
    let cases = [
        ("m", "+Z", 1.0, Axis::Z, ""),
        ("mm", "+Y", 0.001, Axis::Y, ""),
        (" CM ", "+Z", 0.01, Axis::Z, ""),
        (
            "",
            "+Z",
            0.001,
            Axis::Z,
            "no unit of length: millimetres assumed",
        ),
        ("ell", "+Z", 0.001, Axis::Z, "`ell`: millimetres assumed"),
        ("m", "", 1.0, Axis::Z, "up axis: z assumed"),
        ("m", "-X", 1.0, Axis::Z, "up axis: z assumed"),
    ];
    for (unit, screen, metres, up, word) in cases {
        let recording = read(&Written {
            unit: unit.into(),
            screen: screen.into(),
            ..Written::small()
        });
        let source = recording.source();
        assert_eq!(
            (source.unit_metres, source.up),
            (metres, up),
            "{unit} {screen}"
        );
        let warnings: Vec<&String> = source
            .warnings
            .iter()
            .filter(|w| !w.contains('%'))
            .collect();
        assert_eq!(warnings.is_empty(), word.is_empty(), "{warnings:?}");
        assert!(warnings.iter().all(|w| w.contains(word)), "{warnings:?}");
    }
}

#[test]
fn names_are_whole_and_each_ones_own() {
    let cases: [(&[&str], [&str; 3]); 4] = [
        (&["A", "Anna:B 1", "C"], ["A", "Anna:B 1", "C"]),
        (&["A", "A", "A"], ["A", "A_2", "A_3"]),
        (&["A"], ["A", "marker_2", "marker_3"]),
        (&["A", "", "C", "D"], ["A", "marker_2", "C"]),
    ];
    for (labels, wanted) in cases {
        for split in [false, true] {
            let written = Written {
                labels: labels.iter().map(ToString::to_string).collect(),
                split,
                ..Written::small()
            };
            assert_eq!(names(&read(&written)), wanted, "{labels:?} {split}");
        }
    }
}

#[test]
fn frames_beyond_the_headers_counters_are_read() {
    let mut written = Written::small();
    let frame = written.points[0].clone();
    written.points = vec![frame; 70_000];
    for fields in [true, false] {
        written.actual_field = fields;
        assert_eq!(read(&written).frames(), 70_000);
    }
}

#[test]
fn what_is_damaged_is_told_with_its_byte() {
    type Damage = fn(&mut Vec<u8>);
    // The damage, the byte that is told, words of what was found.
    let cases: [(Damage, usize, &str); 12] = [
        (|b| b.truncate(0), 0, "an empty file"),
        (|b| b.truncate(700), 0, "700 bytes that begin 0x02 0x50"),
        (|b| b[1] = 0, 0, "begin 0x02 0x00"),
        (|b| b[0] = 200, 0, "block 200, beyond the end"),
        (|b| b[515] = 1, 515, "processor 1"),
        (|b| b[2..4].fill(0), 2, "no marker"),
        (|b| b[8..10].fill(0), 6, "no frame"),
        (|b| b[12..16].fill(0), 12, "scale 0"),
        (
            |b| b[16..18].copy_from_slice(&[1, 0]),
            16,
            "data in block 1",
        ),
        (
            |b| b[16..18].copy_from_slice(&[99, 0]),
            16,
            "data in block 99",
        ),
        (
            |b| b.truncate(b.len() - 8),
            1600,
            "the end of the file after 1 of 2 frames",
        ),
        // A parameter of 255 times 255 numbers.
        (
            |b| {
                let rate = b.windows(4).position(|w| w == b"RATE").unwrap_or(0);
                b[rate + 6..rate + 10].copy_from_slice(&[4, 2, 255, 255]);
            },
            1,
            "cut short",
        ),
    ];
    let sound = Written::small().bytes();
    for (damage, at, word) in cases {
        let mut bytes = sound.clone();
        damage(&mut bytes);
        let error = parse("a.c3d", &bytes).expect_err(word);
        let rate = || bytes.windows(4).position(|w| w == b"RATE").unwrap_or(0);
        let at = match at {
            1 => rate() - 2,
            1600 => bytes.len(),
            at => at,
        };
        assert_eq!(error.place, Place::Byte(at), "{error}");
        assert!(error.found.contains(word), "{error}");
    }
    let mut rateless = Written::small();
    rateless.rate_hz = 0.0;
    let error = parse("a.c3d", &rateless.bytes()).expect_err("no rate");
    assert!(error.to_string().contains("a rate of 0 Hz"), "{error}");
    let mut wild = Written::small();
    wild.points[1][0] = Some([f32::INFINITY, 0.0, 0.0]);
    let error = parse("a.c3d", &wild.bytes()).expect_err("infinite");
    assert!(error.to_string().contains("found inf"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Cuts and overwritten bytes of a sound file; whatever is read is in proportion to the file.
    #[test]
    fn no_bytes_make_the_reader_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        cut in any::<prop::sample::Index>(),
        cuts in any::<bool>(),
        header in any::<bool>(),
    ) {
        let mut bytes = Written::small().bytes();
        for (at, value) in edits {
            let within = if header { 600 } else { bytes.len() };
            bytes[at.index(within)] = value;
        }
        if cuts {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok(recording) = parse("a.c3d", &bytes) {
            prop_assert!(recording.frames() * recording.joints().len() <= bytes.len());
            let _ = kineme_formats::c3d::joint_centres(&recording, None);
        }
    }

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let mut bytes = bytes;
        let _ = parse("a.c3d", &bytes);
        if bytes.len() > 516 {
            bytes[..2].copy_from_slice(&[2, 0x50]);
            bytes[515] = 84;
            let _ = parse("a.c3d", &bytes);
        }
    }
}
