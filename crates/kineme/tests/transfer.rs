//! From body to body, and motions that were written as recordings.

mod sources;

use kineme::math::rotation::exp;
use kineme::retargeting::{retarget, transfer};
use kineme::{Recording, Role, Skeleton, adonis};
use nalgebra::Vector3;
use sources::{LIMBS, Style, apart, body, bones, joint, moving, to_ares, written};
use std::f64::consts::PI;
use std::sync::Arc;

#[test]
fn a_motion_written_as_a_recording_comes_back_whole() {
    let ares = moving(
        15,
        Style {
            turning: 4.0 * PI,
            ..Style::default()
        },
    );
    let (on_adonis, _) = transfer(&ares, &Arc::new(adonis().expect("a body"))).expect("a motion");
    for motion in [ares, on_adonis] {
        let back =
            retarget(&Recording::from_motion(&motion), motion.skeleton(), None).expect("a motion");
        assert!(back.unobserved.is_empty());
        for f in 0..motion.frames() {
            for (a, b) in back.motion.pose(f).iter().zip(motion.pose(f)) {
                assert!((a - b).abs() < 1e-9, "frame {f}: {a} not {b}");
            }
            assert!((back.motion.root(f).yaw - motion.root(f).yaw).abs() < 1e-9);
            assert!((back.motion.root(f).position - motion.root(f).position).norm() < 1e-9);
        }
    }
}

#[test]
fn the_recording_of_one_body_on_another_is_the_transfer() {
    let ares = moving(16, Style::default());
    let adonis = Arc::new(adonis().expect("a body"));
    let (wanted, lacking) = transfer(&ares, &adonis).expect("a motion");
    let found = retarget(&Recording::from_motion(&ares), &adonis, None).expect("a motion");
    assert_eq!(found.unobserved, lacking);
    for f in 0..ares.frames() {
        for (a, b) in found.motion.pose(f).iter().zip(wanted.pose(f)) {
            assert!((a - b).abs() < 1e-9, "frame {f}");
        }
    }
}

#[test]
fn a_foreign_skeleton_with_our_names_is_retargeted_by_its_geometry() {
    let wanted = moving(17, Style::default());
    let recording = Recording::from_motion(&wanted);
    // The same rotations on bones that lie elsewhere at rest are another movement: nothing may be read joint by joint.
    let mut joints = recording.joints().to_vec();
    let elbow = joints
        .iter()
        .position(|j| j.name == "left_elbow")
        .expect("a joint");
    joints[elbow].offset = Vector3::new(0.0, 0.28, 0.0);
    let bent = Recording::new(
        "bent",
        recording.source().clone(),
        joints,
        sources::RATE,
        recording.observed().clone(),
    );
    let bent = bent.expect("valid");
    let found = to_ares(&bent);
    let (index, parent) = (elbow, bent.joints()[elbow].parent.expect("a parent"));
    for f in 0..found.frames() {
        let placed = bent.placements(f);
        let at = |j: usize| placed[j].position.expect("seen");
        let ([upper, _], _) = bones(&found, f, &LIMBS[0]);
        assert!(
            apart(&upper, &(at(index) - at(parent)).normalize()) < 1e-6,
            "frame {f}"
        );
    }
}

#[test]
fn transfer_to_adonis_and_back_keeps_arms_and_head() {
    let motion = moving(40, Style::default());
    let adonis = Arc::new(adonis().expect("a body"));
    let (there, _) = transfer(&motion, &adonis).expect("a motion");
    let (back, lacking) = transfer(&there, &body()).expect("a motion");
    assert!(lacking.contains(&Role::LeftFingers));
    for f in 0..motion.frames() {
        let (is, was) = (back.frames_at(f), motion.frames_at(f));
        for role in [
            Role::Chest,
            Role::Head,
            Role::LeftUpperArm,
            Role::LeftLowerArm,
            Role::LeftHand,
            Role::RightUpperArm,
            Role::RightLowerArm,
            Role::RightHand,
        ] {
            let j = joint(&body(), role);
            let off = is[j].rotation.angle_to(&was[j].rotation);
            assert!(off < 1e-6, "frame {f}, {}: {off}", role.name());
        }
    }
}

#[test]
fn transfer_to_the_same_kind_of_body_is_the_identity() {
    let ares = body();
    let twin =
        Skeleton::new("twin", ares.joints().to_vec(), ares.effectors().to_vec()).expect("a body");
    // Spread along the spine as transfer spreads it.
    let motion = written(60, |body, t, pose| {
        let s = (2.0 * t).sin();
        let trunk = exp(&Vector3::new(0.2 * s, 0.4 * t, 0.3));
        let roles: [&[Role]; 2] = [&[Role::Spine, Role::Chest], &[Role::Neck, Role::Head]];
        for roles in roles {
            for j in roles.iter().flat_map(|&r| body.joints_of(r)) {
                let share = exp(&(trunk.scaled_axis() * body.joints()[j].share));
                body.set_rotation(pose, j, &share, None);
            }
        }
        for limb in &LIMBS {
            body.set_clinical(pose, limb[0], &[40.0 * s, 20.0, 10.0])
                .expect("a pose");
            body.set_clinical(pose, limb[1], &[40.0 + 20.0 * s])
                .expect("a pose");
            body.set_clinical(pose, limb[2], &[10.0 * s, 5.0, 5.0])
                .expect("a pose");
        }
        body.set_clinical(pose, Role::LeftShoulder, &[10.0 * s, 5.0])
            .expect("a pose");
        body.set_clinical(pose, Role::RightFingers, &[30.0])
            .expect("a pose");
    });
    for other in [ares.clone(), Arc::new(twin)] {
        let (found, lacking) = transfer(&motion, &other).expect("a motion");
        assert!(lacking.is_empty());
        for f in 0..motion.frames() {
            for ((a, b), name) in found
                .pose(f)
                .iter()
                .zip(motion.pose(f))
                .zip(ares.coordinate_names())
            {
                assert!(
                    (a - b).abs() < 1e-9,
                    "{}, frame {f}, {name}: {a} not {b}",
                    other.name()
                );
            }
            assert!((found.root(f).position - motion.root(f).position).norm() < 1e-12);
        }
    }
}
