//! The published files, where they are at hand.

use std::path::{Path, PathBuf};

use kineme::Recording;
use kineme_formats::tables::{msr, positions};

use crate::{point, warns};

/// The folder of the developers' data: `KINEME_DATA`, else beside the workspace.
fn data() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("KINEME_DATA").map_or(root.join("../shared/data"), PathBuf::from);
    let found = folder.join("mocap/index.csv").is_file();
    if !found {
        eprintln!("skipped: no motion data, see KINEME_DATA");
    }
    found.then_some(folder)
}

/// The recordings of an archive whose names begin so.
fn recordings(folder: &Path, archive: &str, prefix: &str) -> Vec<(String, Recording)> {
    let file = std::fs::File::open(folder.join("mocap").join(archive)).unwrap();
    let mut zip = zip::ZipArchive::new(file).unwrap();
    (0..zip.len())
        .filter_map(|i| {
            let mut entry = zip.by_index(i).unwrap();
            let name = entry.name().to_string();
            let stem = name.rsplit('/').next()?;
            if entry.is_dir() || !stem.starts_with(prefix) {
                return None;
            }
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
            let recording = match stem.rsplit('.').next()? {
                "csv" => {
                    assert!(positions::sniff(&bytes[..bytes.len().min(4096)]), "{name}");
                    positions::parse(&name, &bytes, None)
                }
                "txt" => {
                    assert!(msr::sniff(&bytes[..bytes.len().min(4096)]), "{name}");
                    msr::parse(&name, &bytes, None)
                }
                _ => return None,
            };
            Some((stem.to_string(), recording.unwrap()))
        })
        .collect()
}

#[test]
fn joints_and_frames_are_those_that_other_readers_found() {
    let Some(folder) = data() else { return };
    let facts = folder.join("../oracles/motion_facts.csv");
    let mut reader = csv::Reader::from_path(facts).unwrap();
    let mut expected = std::collections::BTreeMap::new();
    for row in reader.records() {
        let row = row.unwrap();
        if ["joints-csv", "msr-txt"].contains(&&row[1]) {
            let stem = row[0].rsplit('/').next().unwrap().to_string();
            let counts: (usize, usize) = (row[2].parse().unwrap(), row[5].parse().unwrap());
            expected.insert(stem, counts);
        }
    }
    let mut found = recordings(&folder, "utd-mhad.zip", "");
    found.extend(recordings(&folder, "msr-action3d.zip", ""));
    assert_eq!(found.len(), expected.len());
    for (stem, recording) in &found {
        let counts = (recording.joints().len(), recording.frames());
        assert_eq!(counts, expected[stem], "{stem}");
        assert!(
            recording.source().up == kineme::math::rotation::Axis::Y,
            "{stem}"
        );
    }
}

/// Metres between two joints at a frame, where both were seen.
fn distance(r: &Recording, frame: usize, a: &str, b: &str) -> Option<f64> {
    Some((point(r, frame, a)? - point(r, frame, b)?).norm())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn bones_have_human_lengths_and_the_right_hand_waves() {
    let Some(folder) = data() else { return };
    // Action 1 of MSR-Action3D is the high arm wave; of UTD-MHAD, the right arm's swipe to the left.
    for archive in ["msr-action3d.zip", "utd-mhad.zip"] {
        let found = recordings(&folder, archive, "a01_");
        assert!(found.len() >= 10, "{archive}");
        let bones = [
            ("shoulder_center", "head", 0.12..0.35),
            ("left_shoulder", "left_elbow", 0.2..0.35),
            ("left_elbow", "left_wrist", 0.18..0.35),
            ("left_hip", "left_knee", 0.35..0.65),
            ("left_knee", "left_ankle", 0.3..0.5),
        ];
        for (a, b, metres) in bones {
            for side in ["left", "right"] {
                let (a, b) = (a.replace("left", side), b.replace("left", side));
                let lengths: Vec<f64> = found
                    .iter()
                    .flat_map(|(_, r)| (0..r.frames()).filter_map(|f| distance(r, f, &a, &b)))
                    .collect();
                let length = median(lengths);
                assert!(metres.contains(&length), "{archive} {a} to {b}: {length} m");
            }
        }
        let mut facing = 0;
        for (stem, r) in &found {
            let range = |hand: &str| {
                let z = |f| point(r, f, hand).map(|p| p.z);
                let heights: Vec<f64> = (0..r.frames()).filter_map(z).collect();
                let top = heights.iter().copied().fold(f64::MIN, f64::max);
                top - heights.iter().copied().fold(f64::MAX, f64::min)
            };
            assert!(range("right_hand") > range("left_hand"), "{stem}");
            // Forward is where the toes point; left is then to the left of it, seen from above.
            let p = |joint: &str| point(r, 0, joint).unwrap();
            let toes = p("left_foot") + p("right_foot") - p("left_ankle") - p("right_ankle");
            let to_left = p("left_shoulder") - p("right_shoulder");
            facing += usize::from(toes.cross(&to_left).z > 0.0);
        }
        // The camera sees toes badly: most recordings, not all.
        assert!(
            5 * facing >= 4 * found.len(),
            "{archive}: {facing} of {}",
            found.len()
        );
    }
}

#[test]
fn a_file_of_zeros_is_a_recording_in_which_nothing_was_seen() {
    let Some(folder) = data() else { return };
    let found = recordings(&folder, "msr-action3d.zip", "a13_s09_e02");
    let (_, r) = &found[0];
    assert_eq!(r.frames(), 38);
    assert!((0..38).all(|f| r.placements(f).iter().all(|p| p.position.is_none())));
    assert!(warns(r, "nothing was seen"));
}
