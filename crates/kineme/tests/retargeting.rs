//! Retargeting: the same movement from any skeleton, any rest pose, from rotations as from bare positions.

mod sources;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use kineme::math::rotation::{exp, wrap};
use kineme::math::statistics::median;
use kineme::retargeting::{retarget, transfer};
use kineme::{Motion, Observed, Recording, Role, Root, Skeleton, adonis};
use nalgebra::{UnitQuaternion, Vector3};
use sources::{
    JOINTS, Rig, Style, body, jittered, moving, of_points, points, positions, rotations,
};

/// The limbs: upper part, lower part, where it ends.
const LIMBS: [[Role; 3]; 4] = [
    [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand],
    [Role::RightUpperArm, Role::RightLowerArm, Role::RightHand],
    [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot],
    [Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot],
];

fn to_ares(recording: &Recording) -> Motion {
    retarget(recording, &body(), None).expect("a motion").motion
}

fn joint(body: &Skeleton, role: Role) -> usize {
    *body.joints_of(role).last().expect("a joint")
}

/// World directions of the bones of a limb, and the bend between them (radians).
fn bones(motion: &Motion, f: usize, limb: &[Role; 3]) -> ([Vector3<f64>; 2], f64) {
    let frames = motion.frames_at(f);
    let [a, b, c] = limb.map(|r| frames[joint(motion.skeleton(), r)].position);
    let (upper, lower) = ((b - a).normalize(), (c - b).normalize());
    (
        [upper, lower],
        upper.cross(&lower).norm().atan2(upper.dot(&lower)),
    )
}

/// The turn of a limb's upper part against thorax or pelvis.
fn shoulder(motion: &Motion, f: usize, limb: &[Role; 3]) -> UnitQuaternion<f64> {
    let body = motion.skeleton();
    let frames = motion.frames_at(f);
    let carrier = match limb[2] {
        Role::LeftHand | Role::RightHand => *body.trunk().last().expect("a trunk"),
        _ => 0,
    };
    frames[carrier].rotation.inverse() * frames[joint(body, limb[0])].rotation
}

/// The angle between two unit vectors, exact for small ones.
fn apart(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// Directions of all limbs agree everywhere; turns of shoulders and hips where the limb is bent more than 25 degrees.
fn check(found: &Motion, wanted: &Motion, directions: f64, turns: f64, what: &str) {
    assert_eq!(found.frames(), wanted.frames(), "{what}");
    for f in 0..wanted.frames() {
        for limb in &LIMBS {
            let (is, _) = bones(found, f, limb);
            let (was, bend) = bones(wanted, f, limb);
            for (a, b) in is.iter().zip(&was) {
                let off = apart(a, b);
                assert!(
                    off < directions,
                    "{what}, frame {f}, {:?}: direction off by {off:e}",
                    limb[0]
                );
            }
            if bend > 25f64.to_radians() && bend < 155f64.to_radians() {
                let off = shoulder(found, f, limb).angle_to(&shoulder(wanted, f, limb));
                assert!(
                    off < turns,
                    "{what}, frame {f}, {:?} bent {bend:.2}: turn off by {off:e}",
                    limb[0]
                );
            }
        }
        let yaw = wrap(found.root(f).yaw - wanted.root(f).yaw);
        assert!(yaw.abs() < 1e-6, "{what}, frame {f}: heading off by {yaw}");
        let pelvis = found.frames_at(f)[0]
            .rotation
            .angle_to(&wanted.frames_at(f)[0].rotation);
        assert!(pelvis < 1e-6, "{what}, frame {f}: pelvis off by {pelvis}");
    }
}

/// The greatest change of any shoulder or hip from frame to frame, radians.
fn fastest(motion: &Motion) -> f64 {
    let turns = (1..motion.frames()).flat_map(|f| {
        LIMBS
            .iter()
            .map(move |limb| shoulder(motion, f, limb).angle_to(&shoulder(motion, f - 1, limb)))
    });
    turns.fold(0.0, f64::max)
}

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
        RATE,
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

const RATE: f64 = sources::RATE;

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
    let (a, b) = (to_ares(&still), to_ares(&of_points(turned, RATE)));
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

/// A motion of Ares from poses written in clinical angles, one a frame.
fn written(frames: usize, write: impl Fn(&Skeleton, f64, &mut [f64])) -> Motion {
    let body = body();
    let poses = (0..frames).flat_map(|f| {
        let mut pose = body.neutral();
        write(&body, f as f64 / RATE, &mut pose);
        pose
    });
    let poses = poses.collect();
    Motion::new(
        "written",
        body.clone(),
        RATE,
        poses,
        vec![Root::ORIGIN; frames],
    )
    .expect("a motion")
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
    let found = retarget(&of_points(seen, RATE), &body(), None).expect("a motion");
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
    let found = to_ares(&of_points(seen, RATE));
    for f in [20, 60, 100, 140, 180, 220] {
        for limb in &LIMBS {
            let (is, was) = (bones(&found, f, limb).0, bones(&wanted, f, limb).0);
            assert!(apart(&is[1], &was[1]) < 1e-6, "frame {f}");
        }
    }
    let nobody = of_points(vec![Some(Vector3::zeros()); 3 * n], RATE);
    assert!(
        retarget(&nobody, &body(), None).is_ok(),
        "a person in one point is finite nonsense, no panic"
    );
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
    let part =
        Recording::new("part", full.source().clone(), joints, RATE, observed).expect("valid");
    let profile = kineme::retargeting::Profile::named("mixamo").expect("a profile");
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

#[test]
fn the_same_recording_gives_the_same_numbers() {
    let recording = jittered(&positions(&moving(41, Style::default())), 0.01, 9);
    assert_eq!(to_ares(&recording).poses(), to_ares(&recording).poses());
}
