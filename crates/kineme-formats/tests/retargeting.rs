//! Retargeting on real recordings: bones keep their directions, conversions of one trial agree, positions suffice.

mod common;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use kineme::math::statistics::quantile;
use kineme::retargeting::{Retargeted, RoleMap, retarget};
use kineme::{Motion, Recording, Role, Skeleton};
use kineme_formats::input::{Inputs, ReadOptions};
use rayon::prelude::*;

/// Bones whose direction must pass: from one role's joint to the next.
const BONES: [(Role, Role); 8] = [
    (Role::LeftUpperArm, Role::LeftLowerArm),
    (Role::LeftLowerArm, Role::LeftHand),
    (Role::RightUpperArm, Role::RightLowerArm),
    (Role::RightLowerArm, Role::RightHand),
    (Role::LeftUpperLeg, Role::LeftLowerLeg),
    (Role::LeftLowerLeg, Role::LeftFoot),
    (Role::RightUpperLeg, Role::RightLowerLeg),
    (Role::RightLowerLeg, Role::RightFoot),
];

fn read(data: &Path, name: &str) -> Recording {
    let options = ReadOptions {
        asf: Some(data.join("mocap/cmu-asfamc.zip/cmu-asfamc/02/02.asf")),
        ..ReadOptions::default()
    };
    let inputs = Inputs::resolve(&[data.join("mocap").join(name)], &options).expect("inputs");
    inputs.entries[0].read().expect("a readable motion")
}

fn map(recording: &Recording) -> RoleMap {
    let names: Vec<&str> = recording.joints().iter().map(|j| j.name.as_str()).collect();
    RoleMap::detect(&names).expect("roles")
}

/// Angles in degrees between the source's and the body's bones, every `step`-th frame.
fn bone_angles(
    recording: &Recording,
    motion: &Motion,
    bones: &[(Role, Role)],
    step: usize,
) -> Vec<f64> {
    let roles = map(recording).joints;
    let body = motion.skeleton();
    let joint = |r: Role| body.joints_of(r)[0];
    let mut angles = Vec::new();
    for f in (0..recording.frames()).step_by(step) {
        let placed = recording.placements(f);
        let frames = motion.frames_at(f);
        for (a, b) in bones {
            let tip = |p: usize| {
                let at = placed[p];
                Some(at.position? + at.rotation? * recording.joints()[p].tip?)
            };
            let from = roles.get(a).and_then(|&j| placed[j].position);
            let to = match roles.get(b) {
                Some(&j) => placed[j].position,
                None => roles.get(a).and_then(|&j| tip(j)),
            };
            if let (Some(from), Some(to)) = (from, to) {
                let source = to - from;
                let bone = frames[joint(*b)].position - frames[joint(*a)].position;
                if source.norm() > 1e-3 {
                    angles.push(source.angle(&bone).to_degrees());
                }
            }
        }
    }
    angles
}

#[test]
fn limbs_keep_their_directions_on_every_whole_body_file() {
    let Some(data) = common::data() else { return };
    let options = ReadOptions {
        asf: Some(data.join("mocap/cmu-asfamc.zip/cmu-asfamc/02/02.asf")),
        ..ReadOptions::default()
    };
    let inputs = Inputs::resolve(&[data.join("mocap")], &options).expect("inputs");
    // Release looks at every file, debug at some of every kind.
    let (files, step) = if cfg!(debug_assertions) {
        (23, 9)
    } else {
        (1, 3)
    };
    for (body, bones) in [("ares", &BONES[..]), ("adonis", &BONES[..4])] {
        let body = Arc::new(kineme::body(body).expect("a body"));
        let all: Vec<Vec<f64>> = inputs
            .entries
            .par_iter()
            .step_by(files)
            .filter_map(|entry| {
                let recording = entry.read().ok()?;
                let motion = retarget(&recording, &body, None).ok()?.motion;
                Some(bone_angles(&recording, &motion, bones, step))
            })
            .collect();
        let angles: Vec<f64> = all.concat();
        let at = |q: f64| quantile(&angles, q).expect("angles");
        println!(
            "{}: {} files, {} angles, median {:.4}, 99th percentile {:.4}, greatest {:.3} degrees",
            body.name(),
            all.len(),
            angles.len(),
            at(0.5),
            at(0.99),
            at(1.0)
        );
        assert!(all.len() * files > 1_200, "{} files", all.len());
        assert!(at(0.5) <= 1.0 && at(0.99) <= 5.0, "{}", body.name());
    }
}

/// Root mean square of coordinate differences, degrees, of these coordinates over paired frames.
fn rms(a: &Motion, b: &Motion, frames: &[(usize, usize)], of: &[usize]) -> f64 {
    let squares: f64 = frames
        .iter()
        .flat_map(|&(i, j)| {
            of.iter()
                .map(move |&c| (a.pose(i)[c] - b.pose(j)[c]).powi(2))
        })
        .sum();
    (squares / (frames.len() * of.len()) as f64)
        .sqrt()
        .to_degrees()
}

/// Coordinates of joints, by joint name.
fn coordinates(body: &Skeleton, joints: impl Fn(&str) -> bool) -> BTreeMap<String, Vec<usize>> {
    (0..body.joints().len())
        .filter(|&j| joints(&body.joints()[j].name))
        .map(|j| (body.joints()[j].name.clone(), body.coordinates(j).collect()))
        .collect()
}

#[test]
fn three_conversions_of_one_trial_agree_in_body_coordinates() {
    let Some(data) = common::data() else { return };
    let body = Arc::new(kineme::ares().expect("a body"));
    for trial in ["02_05", "02_10"] {
        let motion = |name: String| -> Retargeted {
            retarget(&read(&data, &name), &body, None).expect("retargeted")
        };
        let amc = motion(format!("cmu-asfamc.zip/cmu-asfamc/02/{trial}.amc")).motion;
        let mb = motion(format!("cmu-mb.zip/cmu-mb/02/{trial}.bvh")).motion;
        let lifeforms = motion(format!(
            "cmu-lifeforms.zip/cmu-lifeforms/002/002_{}.bvh",
            &trial[3..]
        ))
        .motion;
        // Frame 0 of both BVHs is an added T-pose; the third runs at half the rate.
        let n = amc.frames();
        let whole: Vec<(usize, usize)> = (0..n)
            .map(|i| (i, i + 1))
            .filter(|p| p.1 < mb.frames())
            .collect();
        let half: Vec<(usize, usize)> = (0..n / 2)
            .map(|i| (2 * i, i + 1))
            .filter(|p| p.1 < lifeforms.frames())
            .collect();
        let all: Vec<usize> = (0..body.dof()).collect();
        for (name, other, frames) in [
            ("motionbuilder", &mb, &whole),
            ("lifeforms", &lifeforms, &half),
        ] {
            let total = rms(&amc, other, frames, &all);
            println!(
                "{trial} {name}: {total:.2} degrees over {} frames",
                frames.len()
            );
            for (joint, of) in coordinates(&body, |_| true) {
                let one = rms(&amc, other, frames, &of);
                if one > 3.0 {
                    println!("    {joint} {one:.2}");
                }
            }
            assert!(total <= 5.0, "{trial} {name}: {total} degrees");
        }
    }
}

#[test]
fn positions_alone_give_the_arms_of_the_rotations() {
    let Some(data) = common::data() else { return };
    for body in ["ares", "adonis"] {
        let body = Arc::new(kineme::body(body).expect("a body"));
        for name in [
            "cmu-mb.zip/cmu-mb/02/02_05.bvh",
            "cmu-daz.zip/cmu-daz/martial/07.bvh",
            "bandai-namco-1.zip/bandai-namco-1/dataset-1_bye_active_001.bvh",
            "bandai-namco-2.zip/bandai-namco-2/dataset-2_wave-right-hand_youthful_001.bvh",
            "cmu-lifeforms.zip/cmu-lifeforms/006/006_03.bvh",
        ] {
            let recording = read(&data, name);
            let mut table = Vec::new();
            let frame = kineme_formats::positions::Frame::Metres;
            kineme_formats::positions::write(&recording, frame, &mut table).expect("a table");
            let rate = Some(recording.rate_hz());
            let bare = kineme_formats::tables::positions::parse("table.csv", &table, rate)
                .expect("read back");
            let a = retarget(&recording, &body, None).expect("rotations").motion;
            let b = retarget(&bare, &body, None).expect("positions").motion;
            let elbows: Vec<usize> = coordinates(&body, |j| j.ends_with("elbow"))
                .into_values()
                .flatten()
                .collect();
            let every: Vec<(usize, usize)> = (0..a.frames()).map(|f| (f, f)).collect();
            let bent_elbows = rms(&a, &b, &every, &elbows);
            // The twist of a straight arm is no fact of positions, so shoulders are compared where the elbow is bent.
            let mut shoulders = Vec::new();
            for side in ["left", "right"] {
                let of = |joint: &str| {
                    coordinates(&body, |j| j == format!("{side}_{joint}"))
                        .into_values()
                        .flatten()
                };
                let elbow = body.joint(&format!("{side}_elbow")).expect("an elbow");
                let bent: Vec<(usize, usize)> = every
                    .iter()
                    .copied()
                    .filter(|&(f, _)| {
                        let turn = body.rotation(elbow, &a.pose(f)[body.coordinates(elbow)]);
                        turn.angle() > 25f64.to_radians()
                    })
                    .collect();
                if !bent.is_empty() {
                    shoulders.push(rms(&a, &b, &bent, &of("shoulder").collect::<Vec<_>>()));
                }
            }
            println!(
                "{} {name}: elbows {bent_elbows:.3}, shoulders {shoulders:.3?} degrees",
                body.name()
            );
            assert!(
                bent_elbows <= 2.0 && shoulders.iter().all(|s| *s <= 2.0),
                "{name}"
            );
        }
    }
}
