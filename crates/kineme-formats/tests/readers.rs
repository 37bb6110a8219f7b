//! Readers against the positions and counts of other people's libraries.

mod common;

use std::collections::BTreeMap;

use common::{bytes, data, number, oracle, points};
use kineme::math::rotation::Axis;
use kineme_formats::input::{Inputs, ReadOptions};
use kineme_formats::{amc, asf, bvh, deepmimic};
use rayon::prelude::*;

#[test]
fn bvh_positions_are_those_of_other_libraries() {
    let Some(data) = data() else { return };
    let plausible: BTreeMap<String, String> = oracle(&data, "fk_bvh_files.csv")
        .into_iter()
        .filter(|row| row["plausible"] == "yes")
        .map(|row| (row["file"].clone(), row["conventions"].clone()))
        .collect();
    let mut by_file: BTreeMap<String, Vec<_>> = BTreeMap::new();
    for row in oracle(&data, "fk_bvh.csv") {
        if plausible.get(&row["file"]) == Some(&row["conventions"]) {
            by_file.entry(row["file"].clone()).or_default().push(row);
        }
    }
    assert_eq!(by_file.len(), plausible.len());
    for (file, rows) in by_file {
        let recording = bvh::parse(&file, &bytes(&data, &file)).expect("a motion");
        let (mut far, mut largest) = (0.0f64, 0.0f64);
        let mut frames = BTreeMap::new();
        for row in rows {
            let frame = number(&row, "frame") as usize;
            let points = frames
                .entry(frame)
                .or_insert_with(|| points(&recording, frame));
            let found = points[&row["name"]];
            for (axis, column) in ["x", "y", "z"].iter().enumerate() {
                let value = number(&row, column);
                largest = largest.max(value.abs());
                far = far.max((found[axis] - value).abs());
            }
        }
        assert!(far <= 1e-7 * largest, "{file}: {far:e} of {largest}");
    }
}

#[test]
fn acclaim_positions_are_those_of_other_libraries() {
    let Some(data) = data() else { return };
    let mut by_file: BTreeMap<String, Vec<_>> = BTreeMap::new();
    for row in oracle(&data, "fk_asfamc.csv") {
        by_file.entry(row["file"].clone()).or_default().push(row);
    }
    assert!(!by_file.is_empty());
    for (file, rows) in by_file {
        let skeleton = asf::parse(&rows[0]["asf"], &bytes(&data, &rows[0]["asf"])).expect("an ASF");
        let recording = amc::parse(&file, &bytes(&data, &file), &skeleton, None).expect("a motion");
        let mut frames = BTreeMap::new();
        for row in rows {
            let frame = number(&row, "frame") as usize;
            let points = frames
                .entry(frame)
                .or_insert_with(|| points(&recording, frame));
            let name = &row["bone"];
            let tip = points.get(&format!("{name}_End"));
            let found = tip.unwrap_or(&points[name]);
            for (axis, column) in ["x", "y", "z"].iter().enumerate() {
                let far = (found[axis] - number(&row, column)).abs();
                assert!(far <= 1e-6, "{file} {name} frame {frame}: {far:e}");
            }
        }
    }
}

/// The published BVH conversion of a trial and its AMC place legs and back alike.
#[test]
fn bvh_and_amc_of_one_trial_agree() {
    let Some(data) = data() else { return };
    let text = std::fs::read(data.join("../oracles/cross_conversion.json")).expect("the oracle");
    let oracle: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    let note = oracle["note"].as_str().expect("a note");
    let (_, joints) = note.split_once("legs_and_back: ").expect("the joints");
    let joints: Vec<&str> = joints.split_whitespace().collect();
    assert_eq!(joints.len(), 11);
    let skeleton = asf::parse("02.asf", &bytes(&data, "cmu-asfamc/02/02.asf")).expect("an ASF");
    for pair in oracle["pairs"].as_array().expect("pairs") {
        let file = |key: &str| pair[key].as_str().expect("a name").to_owned();
        let (amc_file, bvh_file) = (file("amc"), file("bvh"));
        let acclaim =
            amc::parse(&amc_file, &bytes(&data, &amc_file), &skeleton, None).expect("AMC");
        let bvh = bvh::parse(&bvh_file, &bytes(&data, &bvh_file)).expect("BVH");
        assert_eq!(
            acclaim.frames() as u64,
            pair["amc_frames"].as_u64().expect("frames")
        );
        let shift = pair["bvh_frame_minus_amc_index"].as_u64().expect("a shift") as usize;
        for frame in (0..acclaim.frames()).step_by(97) {
            let a = points(&acclaim, frame);
            let b = points(&bvh, frame + shift);
            for &joint in &joints {
                let bone = oracle["joint_to_bone_tip"][joint].as_str().expect("a bone");
                let tip = a.get(&format!("{bone}_End")).unwrap_or(&a[bone]);
                let far = (tip - b[joint]).norm();
                assert!(far < 1e-4, "{amc_file} {joint} frame {frame}: {far:e}");
            }
        }
    }
}

/// Formats whose rows of the table are about rotations.
#[test]
fn every_file_has_the_joints_frames_and_rate_of_the_table() {
    let Some(data) = data() else { return };
    let facts: BTreeMap<String, BTreeMap<String, String>> = oracle(&data, "motion_facts.csv")
        .into_iter()
        .map(|row| (row["file"].clone(), row))
        .collect();
    let archives = [
        ("bandai-namco-1", 116, 0.01),
        ("bandai-namco-2", 210, 0.01),
        ("cmu-asfamc", 13, 0.0254 / 0.45),
        ("cmu-daz", 13, 0.01),
        ("cmu-lifeforms", 9, 0.01),
        ("cmu-mb", 83, 0.0254 / 0.45),
        ("deepmimic", 15, 1.0),
        ("hdm05", 189, 0.0254 / 0.45),
    ];
    let mocap = data.join("mocap");
    let options = ReadOptions {
        asf: Some(mocap.join("cmu-asfamc.zip/cmu-asfamc/02/02.asf")),
        ..ReadOptions::default()
    };
    for (archive, count, unit) in archives {
        let packed = mocap.join(format!("{archive}.zip"));
        let inputs = Inputs::resolve(&[&packed], &options).expect("inputs");
        assert_eq!(inputs.entries.len(), count, "{archive}");
        assert_eq!(inputs.ignored, 0, "{archive}");
        // A debug build reads one file in seven, a release build all.
        let step = if cfg!(debug_assertions) { 7 } else { 1 };
        let entries: Vec<_> = inputs.entries.iter().step_by(step).collect();
        entries.par_iter().for_each(|entry| {
            let recording = entry.read().expect("a motion");
            let inner = entry.name().split_once(".zip/").expect("an archive").1;
            let fact = facts
                .get(inner)
                .or_else(|| facts.get(&format!("{archive}/{inner}")))
                .unwrap_or_else(|| panic!("no facts of {inner}"));
            assert_eq!(recording.frames() as f64, number(fact, "frames"), "{inner}");
            let secs = recording.rate_hz().recip();
            match fact["format"].as_str() {
                "amc" => {
                    assert_eq!(recording.dof() as f64, number(fact, "channels"), "{inner}");
                    assert_eq!(recording.rate_hz(), 120.0, "{inner}");
                }
                format => {
                    assert_eq!(
                        recording.joints().len() as f64,
                        number(fact, "joints"),
                        "{inner}"
                    );
                    let told = number(fact, "frame_time");
                    assert!((secs - told).abs() <= 1e-15, "{inner}: {secs} {told}");
                    if format == "bvh" {
                        assert_eq!(recording.dof() as f64, number(fact, "channels"), "{inner}");
                    }
                }
            }
            assert_eq!(recording.source().unit_metres, unit, "{inner}");
            assert_eq!(recording.source().up, Axis::Y, "{inner}");
        });
    }
}

/// A forward step of the DeepMimic walk goes the way the character faces, the feet stay near the floor.
#[test]
fn deepmimic_stands_on_its_feet() {
    let Some(data) = data() else { return };
    let file = "deepmimic/humanoid3d_walk.txt";
    let walk = deepmimic::parse(file, &bytes(&data, file)).expect("a clip");
    let at = |frame: usize, name: &str| points(&walk, frame)[name];
    let lowest = (0..walk.frames())
        .map(|f| at(f, "left_ankle_End").y.min(at(f, "right_ankle_End").y))
        .fold(f64::INFINITY, f64::min);
    assert!(lowest.abs() < 0.05, "the lower sole is at {lowest} m");
    assert!(at(0, "right_hip").z > at(0, "left_hip").z);
    let way = at(walk.frames() - 1, "root") - at(0, "root");
    assert!(way.x > 0.5 && way.z.abs() < 0.3, "it walked {way:?}");
    for frame in 0..walk.frames() {
        // A knee bends back: the shank never points ahead of the thigh.
        let (hip, knee, ankle) = (
            at(frame, "left_hip"),
            at(frame, "left_knee"),
            at(frame, "left_ankle"),
        );
        assert!((knee - hip).cross(&(ankle - knee)).z < 1e-2);
    }
}
