//! Retargeting: the same movement from any skeleton, any rest pose, from rotations as from bare positions.

mod sources;

use kineme::math::rotation::wrap;
use kineme::math::statistics::median;
use kineme::retargeting::retarget;
use kineme::{Observed, Recording, Role, adonis};
use nalgebra::{UnitQuaternion, Vector3};
use sources::{
    JOINTS, LIMBS, Rig, Style, apart, body, bones, check, jittered, joint, moving, of_points,
    points, positions, rotations, shoulder, to_ares,
};
use std::f64::consts::TAU;
use std::sync::Arc;

#[test]
fn rotations_of_any_rig_and_any_limb_lengths_give_the_movement() {
    for rig in [Rig::Neutral, Rig::TPose, Rig::Scrambled] {
        for (seed, stretch) in [(1, 1.0), (2, 0.7), (3, 1.4)] {
            let wanted = moving(seed, Style::default());
            let recording = rotations(&wanted, rig, stretch);
            let found = retarget(&recording, &body(), None).expect("a motion");
            let what = format!("{rig:?} {seed}");
            assert_eq!(found.profile, "mixamo", "{what}");
            check(&found.motion, &wanted, 1e-6, 1e-3, &what);
            // The source's own twist carries through straight limbs.
            for f in 0..wanted.frames() {
                for limb in &LIMBS {
                    let off =
                        shoulder(&found.motion, f, limb).angle_to(&shoulder(&wanted, f, limb));
                    assert!(off < 1e-3, "{what}, frame {f}, {:?}: {off}", limb[0]);
                }
            }
        }
    }
}

#[test]
fn rotations_of_an_anatomical_rig_give_head_hands_and_feet() {
    for rig in [Rig::Neutral, Rig::TPose] {
        let wanted = moving(4, Style::default());
        let found = to_ares(&rotations(&wanted, rig, 1.0));
        for f in 0..wanted.frames() {
            let (is, was) = (found.frames_at(f), wanted.frames_at(f));
            for role in [
                Role::Head,
                Role::LeftHand,
                Role::RightHand,
                Role::LeftFoot,
                Role::RightFoot,
            ] {
                let j = joint(&body(), role);
                let off = is[j].rotation.angle_to(&was[j].rotation);
                assert!(
                    off < 1e-6,
                    "{rig:?}, frame {f}, {}: off by {off}",
                    role.name()
                );
            }
        }
    }
}

#[test]
fn bare_positions_give_the_movement_where_limbs_are_bent() {
    for seed in 5..9 {
        let wanted = moving(seed, Style::default());
        let found = retarget(&positions(&wanted), &body(), None).expect("a motion");
        assert_eq!((found.profile.as_str(), found.filled), ("kinect", 0.0));
        check(
            &found.motion,
            &wanted,
            1e-6,
            1e-2,
            &format!("positions {seed}"),
        );
    }
}

#[test]
fn positions_and_rotations_give_the_same_arms() {
    for seed in 10..14 {
        let motion = moving(
            seed,
            Style {
                bend: (30.0, 120.0),
                ..Style::default()
            },
        );
        let a = to_ares(&positions(&motion));
        let b = to_ares(&rotations(&motion, Rig::Scrambled, 1.1));
        let body = body();
        for name in [
            "left_shoulder",
            "right_shoulder",
            "left_elbow",
            "right_elbow",
            "left_hip",
            "right_knee",
        ] {
            let at = body.coordinates(body.joint(name).expect("a joint"));
            let squares: f64 = (0..motion.frames())
                .flat_map(|f| at.clone().map(move |c| (f, c)))
                .map(|(f, c)| (a.pose(f)[c] - b.pose(f)[c]).powi(2))
                .sum();
            let rms = (squares / motion.frames() as f64).sqrt().to_degrees();
            assert!(rms < 0.5, "{name} of {seed}: {rms} degrees");
        }
    }
}

#[test]
fn turning_the_scene_turns_only_the_root() {
    let turn = 2.0;
    let q = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
    let motion = moving(18, Style::default());
    let still = positions(&motion);
    let turned = points(&still)
        .into_iter()
        .map(|p| p.map(|p| q * p))
        .collect();
    let (a, b) = (to_ares(&still), to_ares(&of_points(turned, sources::RATE)));
    for f in 0..a.frames() {
        for (x, y) in a.pose(f).iter().zip(b.pose(f)) {
            assert!((x - y).abs() < 1e-9, "frame {f}: {x} {y}");
        }
        assert!(
            wrap(b.root(f).yaw - a.root(f).yaw - turn).abs() < 1e-9,
            "frame {f}"
        );
        assert!(
            (b.root(f).position - q * a.root(f).position).norm() < 1e-9,
            "frame {f}"
        );
    }
}

#[test]
fn turning_round_twice_is_counted_and_shows_nowhere_else() {
    let motion = moving(
        19,
        Style {
            turning: 2.0 * TAU,
            frames: 300,
            ..Style::default()
        },
    );
    for recording in [positions(&motion), rotations(&motion, Rig::TPose, 1.0)] {
        let found = to_ares(&recording);
        check(&found, &motion, 1e-6, 1e-2, "turning");
        let turned = found.root(299).yaw - found.root(0).yaw;
        assert!((turned - 2.0 * TAU).abs() < 1e-6, "turned {turned}");
    }
}

#[test]
fn lying_down_is_a_turn_of_the_pelvis() {
    for lying in [-90.0, 90.0] {
        let motion = moving(
            20,
            Style {
                lying,
                turning: 0.0,
                ..Style::default()
            },
        );
        for recording in [positions(&motion), rotations(&motion, Rig::Scrambled, 1.0)] {
            check(
                &to_ares(&recording),
                &motion,
                1e-6,
                1e-2,
                &format!("lying {lying}"),
            );
        }
    }
}

#[test]
fn a_somersault_ends_where_it_began() {
    let motion = moving(
        21,
        Style {
            lying: 360.0,
            turning: 0.3,
            ..Style::default()
        },
    );
    let found = to_ares(&positions(&motion));
    for f in 0..found.frames() {
        let (is, was) = (
            found.frames_at(f)[0].rotation,
            motion.frames_at(f)[0].rotation,
        );
        assert!(is.angle_to(&was) < 1e-6, "frame {f}");
        if f > 0 {
            let yaw = (found.root(f).yaw - found.root(f - 1).yaw).abs();
            assert!(yaw < 0.5, "frame {f}: heading steps by {yaw}");
        }
    }
    let standing = Vector3::from_column_slice(&found.pose(239)[..3]);
    assert!(standing.norm() < 0.5, "upright again: {standing:?}");
}

#[test]
fn sources_without_legs_or_hands_still_move_the_rest() {
    let wanted = moving(33, Style::default());
    let full = rotations(&wanted, Rig::Neutral, 0.5);
    let keep: Vec<usize> = (0..16)
        .filter(|k| ![9, 11, 12, 14, 15].contains(k))
        .collect();
    let joints = keep
        .iter()
        .map(|&k| {
            let mut j = full.joints()[k].clone();
            j.parent = j.parent.and_then(|p| keep.iter().position(|&x| x == p));
            j
        })
        .collect();
    let Observed::Rotations {
        rotations,
        translations,
    } = full.observed()
    else {
        unreachable!("rotations")
    };
    let observed = Observed::Rotations {
        rotations: (0..wanted.frames())
            .flat_map(|f| keep.iter().map(move |&k| rotations[f * JOINTS.len() + k]))
            .collect(),
        translations: keep.iter().map(|&k| translations[k].clone()).collect(),
    };
    let part = Recording::new(
        "part",
        full.source().clone(),
        joints,
        sources::RATE,
        observed,
    )
    .expect("valid");
    let mut profile = kineme::retargeting::Profile::named("mixamo").expect("a profile");
    let found = retarget(&part, &body(), Some(&profile)).expect("a motion");
    for role in [Role::RightHand, Role::LeftLowerLeg, Role::LeftFoot] {
        assert!(found.unobserved.contains(&role), "{}", role.name());
    }
    for f in 0..wanted.frames() {
        let (is, was) = (
            bones(&found.motion, f, &LIMBS[0]).0,
            bones(&wanted, f, &LIMBS[0]).0,
        );
        assert!(apart(&is[1], &was[1]) < 1e-6, "frame {f}");
    }
    // Half the size, told from the trunk alone: positions come back to the body's size within a tenth.
    let ratio = (found.motion.root(100).position - found.motion.root(0).position).norm()
        / (wanted.root(100).position - wanted.root(0).position).norm();
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    // A profile that misses a joint says which, and what it calls it.
    let wrong = vec!["LeftUpLog".to_owned()];
    profile.roles.insert(Role::LeftUpperLeg, wrong);
    let why = retarget(&part, &body(), Some(&profile)).expect_err("no thigh");
    for said in ["`mixamo`", "`LeftUpLog`", "left_upper_leg"] {
        assert!(why.to_string().contains(said), "{why}");
    }
}

#[test]
fn adonis_points_his_arms_the_same_way() {
    let adonis = Arc::new(adonis().expect("a body"));
    for seed in 34..37 {
        let wanted = moving(
            seed,
            Style {
                bend: (0.0, 120.0),
                ..Style::default()
            },
        );
        for recording in [positions(&wanted), rotations(&wanted, Rig::TPose, 1.0)] {
            let found = retarget(&recording, &adonis, None)
                .expect("a motion")
                .motion;
            let mut off = Vec::new();
            for f in 0..wanted.frames() {
                for limb in &LIMBS[..2] {
                    let (is, was) = (bones(&found, f, limb).0, bones(&wanted, f, limb).0);
                    assert!(
                        apart(&is[0], &was[0]) < 1e-6,
                        "{seed}, frame {f}: upper arm"
                    );
                    off.push(apart(&is[1], &was[1]).to_degrees());
                }
            }
            let (middle, most) = (
                median(&off).expect("values"),
                off.iter().copied().fold(0.0, f64::max),
            );
            assert!(
                middle < 1.0 && most < 25.0,
                "{seed}: forearms off by {middle}, at most {most} degrees"
            );
        }
    }
}

#[test]
fn the_same_recording_gives_the_same_numbers() {
    let recording = jittered(&positions(&moving(41, Style::default())), 0.01, 9);
    assert_eq!(to_ares(&recording).poses(), to_ares(&recording).poses());
}
