//! Retargeting where limbs are straight, bent the wrong way, noisy or hidden.

mod sources;

use kineme::Role;
use kineme::math::statistics::median;
use kineme::retargeting::retarget;
use nalgebra::Vector3;
use sources::{
    JOINTS, LIMBS, Rig, Style, apart, body, bones, check, fastest, jittered, moving, of_points,
    points, positions, rotations, shoulder, to_ares, written,
};

#[test]
fn nothing_jumps_where_arms_pass_through_straight() {
    for seed in 22..28 {
        let motion = moving(
            seed,
            Style {
                bend: (-2.0, 70.0),
                ..Style::default()
            },
        );
        let found = to_ares(&positions(&motion));
        let (is, was) = (fastest(&found), fastest(&motion));
        assert!(
            is < was + 0.12,
            "{seed}: {is} rad a frame where the motion has {was}"
        );
    }
}

#[test]
fn limbs_straight_throughout_keep_a_usual_twist() {
    let motion = moving(
        30,
        Style {
            bend: (0.0, 0.0),
            ..Style::default()
        },
    );
    for recording in [positions(&motion), rotations(&motion, Rig::Neutral, 1.0)] {
        let found = to_ares(&recording);
        check(&found, &motion, 1e-6, f64::MAX, "straight");
        assert!(fastest(&found) < fastest(&motion) + 0.05);
    }
    // Known from the zero pose, where there is one.
    let found = to_ares(&rotations(&motion, Rig::Neutral, 1.0));
    for f in 0..motion.frames() {
        for limb in &LIMBS {
            let off = shoulder(&found, f, limb).angle_to(&shoulder(&motion, f, limb));
            assert!(off < 1e-6, "frame {f}, {:?}: {off}", limb[0]);
        }
    }
}

#[test]
fn a_person_standing_straight_is_neutral() {
    let motion = written(30, |_, _, _| {});
    let found = to_ares(&positions(&motion));
    for f in 0..30 {
        for limb in &LIMBS {
            let off = shoulder(&found, f, limb).angle();
            assert!(off < 1e-6, "{:?}: {off}", limb[0]);
        }
    }
}

#[test]
fn straight_arms_raised_overhead_neither_jump_nor_spin() {
    let motion = written(120, |body, t, pose| {
        for role in [Role::LeftUpperArm, Role::RightUpperArm] {
            body.set_clinical(pose, role, &[90.0 * t, 15.0 * (3.0 * t).sin()])
                .expect("a pose");
        }
    });
    for (noise, bound) in [(0.0, 0.1), (0.01, 0.48)] {
        let found = to_ares(&jittered(&positions(&motion), noise, 1));
        let fastest = fastest(&found);
        assert!(fastest < bound, "noise {noise}: {fastest} rad a frame");
    }
}

#[test]
fn camera_noise_does_not_make_limbs_spin() {
    for (noise, bend, often, ever) in [
        (0.01, 6.0, 0.14, 0.45),
        (0.02, 6.0, 0.28, 0.9),
        (0.02, 25.0, 0.28, 0.9),
    ] {
        let motion = written(300, |body, t, pose| {
            for limb in &LIMBS {
                body.set_clinical(pose, limb[0], &[20.0 + 20.0 * t.sin(), 10.0])
                    .expect("a pose");
                body.set_clinical(pose, limb[1], &[bend]).expect("a pose");
            }
        });
        let found = to_ares(&jittered(&positions(&motion), noise, 3));
        for limb in &LIMBS {
            let steps: Vec<f64> = (1..found.frames())
                .map(|f| shoulder(&found, f, limb).angle_to(&shoulder(&found, f - 1, limb)))
                .collect();
            // The bones' own directions shake by noise over length, carrier's and limb's together by 0.12 rad a frame
            // for every centimetre: hardly more may come of it.
            let (middle, most) = (
                median(&steps).expect("steps"),
                steps.iter().copied().fold(0.0, f64::max),
            );
            let what = format!("{:?}, noise {noise}, bent {bend}", limb[0]);
            assert!(
                middle < often && most < ever,
                "{what}: {middle} rad a frame, at most {most}"
            );
        }
    }
}

#[test]
fn a_hyperextended_knee_or_elbow_does_not_turn_the_limb_round() {
    let motion = written(180, |body, t, pose| {
        // Bent by 60 degrees, then straight and 15 degrees beyond.
        let bend = 60.0 - 75.0 * (t / 2.0).min(1.0);
        for limb in &LIMBS {
            body.set_clinical(pose, limb[0], &[20.0, 10.0, 15.0])
                .expect("a pose");
            body.set_clinical(pose, limb[1], &[bend]).expect("a pose");
        }
    });
    for recording in [positions(&motion), rotations(&motion, Rig::Scrambled, 1.0)] {
        let found = to_ares(&recording);
        for f in 0..motion.frames() {
            for limb in &LIMBS {
                let off = shoulder(&found, f, limb).angle_to(&shoulder(&motion, f, limb));
                assert!(off < 0.6, "frame {f}, {:?}: {off}", limb[0]);
            }
        }
        assert!(fastest(&found) < 0.06, "{}", fastest(&found));
    }
}

#[test]
fn points_that_were_hidden_go_along_with_what_carries_them() {
    let wanted = moving(
        31,
        Style {
            turning: 0.0,
            ..Style::default()
        },
    );
    let mut seen = points(&positions(&wanted));
    let n = JOINTS.len();
    let hide =
        |seen: &mut Vec<Option<Vector3<f64>>>, name: &str, frames: std::ops::Range<usize>| {
            let k = JOINTS.iter().position(|j| j.3 == name).expect("a joint");
            frames.for_each(|f| seen[f * n + k] = None);
        };
    hide(&mut seen, "left_wrist", 50..60);
    hide(&mut seen, "left_shoulder", 90..95);
    hide(&mut seen, "right_elbow", 0..10);
    hide(&mut seen, "right_ankle", 200..240);
    hide(&mut seen, "left_hip", 120..123);
    let found = retarget(&of_points(seen, sources::RATE), &body(), None).expect("a motion");
    let share = (10 + 5 + 10 + 40 + 3) as f64 / (240 * n) as f64;
    assert!((found.filled - share).abs() < 1e-12);
    for f in 0..240 {
        for (limb, bound) in LIMBS.iter().zip([0.15, 0.8, 0.25, 3.0]) {
            let hidden = [50..60, 90..95, 0..10, 200..240, 120..123]
                .iter()
                .any(|g| g.contains(&f));
            let bound = if hidden { bound } else { 1e-6 };
            let (is, was) = (bones(&found.motion, f, limb).0, bones(&wanted, f, limb).0);
            for (a, b) in is.iter().zip(&was) {
                assert!(
                    apart(a, b) < bound,
                    "frame {f}, {:?}: {}",
                    limb[0],
                    apart(a, b)
                );
            }
        }
    }
}

#[test]
fn points_that_coincide_for_a_frame_do_no_harm() {
    let wanted = moving(32, Style::default());
    let mut seen = points(&positions(&wanted));
    let n = JOINTS.len();
    for (f, a, b) in [
        (40, 10, 13),
        (80, 4, 7),
        (0, 10, 13),
        (120, 5, 6),
        (160, 4, 5),
        (200, 1, 2),
    ] {
        seen[f * n + a] = seen[f * n + b];
    }
    let found = to_ares(&of_points(seen, sources::RATE));
    for f in [20, 60, 100, 140, 180, 220] {
        for limb in &LIMBS {
            let (is, was) = (bones(&found, f, limb).0, bones(&wanted, f, limb).0);
            assert!(apart(&is[1], &was[1]) < 1e-6, "frame {f}");
        }
    }
    let nobody = of_points(vec![Some(Vector3::zeros()); 3 * n], sources::RATE);
    assert!(
        retarget(&nobody, &body(), None).is_ok(),
        "a person in one point is finite nonsense, no panic"
    );
}
