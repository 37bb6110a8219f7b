//! Synthetic sources: random smooth motions of Ares, recorded by skeletons of other makes; and how to look at limbs.
#![allow(dead_code, reason = "every test file uses its part")]

use std::f64::consts::TAU;
use std::sync::Arc;

use kineme::math::rotation::{Axis, exp, wrap};
use kineme::retargeting::retarget;
use kineme::{
    Format, Motion, Observed, RecordedJoint, Recording, Role, Root, Skeleton, Source, ares,
};
use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

pub const RATE: f64 = 60.0;

/// A smooth random path between two values: sines below 1 Hz.
fn wander(random: &mut Pcg64, low: f64, high: f64) -> impl Fn(f64) -> f64 + use<> {
    let waves: [(f64, f64); 2] = [0.0; 2].map(|_| {
        (
            random.random_range(0.15..0.7),
            random.random_range(0.0..TAU),
        )
    });
    move |t| {
        let s: f64 = waves
            .iter()
            .map(|(hz, start)| (TAU * hz * t + start).sin())
            .sum();
        0.5 * (low + high) + 0.25 * (high - low) * s
    }
}

/// The body of all sources.
pub fn body() -> Arc<Skeleton> {
    Arc::new(ares().expect("a body"))
}

/// How a synthetic motion moves.
#[derive(Clone, Copy)]
pub struct Style {
    /// Range of elbow and knee flexion, degrees.
    pub bend: (f64, f64),
    /// Turn about the vertical over the whole motion, radians.
    pub turning: f64,
    /// Pitch of the pelvis at the end, degrees: -90 lies on the back.
    pub lying: f64,
    /// Frames.
    pub frames: usize,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            bend: (5.0, 120.0),
            turning: 1.0,
            lying: 0.0,
            frames: 240,
        }
    }
}

/// A smooth motion of Ares within clinical ranges. The trunk bends at one vertebra only, that of the landmark
/// between pelvis and thorax, and the head on the atlas only: so the landmarks of any skeleton see them rigid.
pub fn moving(seed: u64, style: Style) -> Motion {
    let body = body();
    let mut random = Pcg64::seed_from_u64(seed);
    let (low, high) = style.bend;
    let mut parts: Vec<(Role, Vec<(f64, f64)>)> = vec![(
        Role::Head,
        vec![(-20.0, 20.0), (-10.0, 10.0), (-30.0, 30.0)],
    )];
    for arm in [
        [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand],
        [Role::RightUpperArm, Role::RightLowerArm, Role::RightHand],
    ] {
        parts.push((arm[0], vec![(-20.0, 110.0), (0.0, 70.0), (-50.0, 40.0)]));
        parts.push((arm[1], vec![(low, high)]));
        parts.push((arm[2], vec![(-30.0, 40.0), (-15.0, 10.0), (-60.0, 60.0)]));
    }
    for leg in [
        [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot],
        [Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot],
    ] {
        parts.push((leg[0], vec![(-10.0, 80.0), (-10.0, 30.0), (-20.0, 20.0)]));
        parts.push((leg[1], vec![(low, high)]));
        parts.push((leg[2], vec![(-20.0, 10.0), (-5.0, 5.0), (-10.0, 10.0)]));
    }
    let parts: Vec<(Role, Vec<_>)> = parts
        .into_iter()
        .map(|(role, ranges)| {
            let paths = ranges.into_iter().map(|(a, b)| wander(&mut random, a, b));
            (role, paths.collect())
        })
        .collect();
    let trunk: Vec<_> = (0..3).map(|_| wander(&mut random, -0.3, 0.3)).collect();
    let tilt: Vec<_> = (0..2).map(|_| wander(&mut random, -12.0, 12.0)).collect();
    let waist = body.joint("lumbar_3").expect("a joint");
    let mut poses: Vec<f64> = Vec::new();
    let mut roots = Vec::new();
    for f in 0..style.frames {
        let t = f as f64 / RATE;
        let done = f as f64 / (style.frames.max(2) - 1) as f64;
        let mut pose = body.neutral();
        for (role, paths) in &parts {
            let angles: Vec<f64> = paths.iter().map(|p| p(t)).collect();
            body.set_clinical(&mut pose, *role, &angles)
                .expect("a pose");
        }
        let bend = exp(&Vector3::new(trunk[0](t), trunk[1](t), trunk[2](t)));
        body.set_rotation(&mut pose, waist, &bend, None);
        // About a level axis: the pelvis' own coordinates hold no heading.
        let lean = Vector3::new(tilt[1](t), tilt[0](t) + done * style.lying, 0.0);
        let before = (f > 0).then(|| poses[poses.len() - body.dof()..].to_vec());
        body.set_rotation(
            &mut pose,
            0,
            &exp(&lean.map(f64::to_radians)),
            before.as_deref(),
        );
        poses.extend(pose);
        roots.push(Root {
            position: Vector3::new(0.3 * t, 0.1 * t * t, 0.9),
            yaw: 0.4 + done * style.turning,
        });
    }
    Motion::new("moving", body, RATE, poses, roots).expect("a motion")
}

/// A joint of a source: the body's joint that it follows, its role, its name in one of the known skeletons.
pub const JOINTS: [(&str, Option<usize>, &str, &str); 20] = [
    ("pelvis", None, "Hips", "hip_center"),
    ("lumbar_3", Some(0), "Spine", "spine"),
    ("cervical_7", Some(1), "Neck", "shoulder_center"),
    ("skull", Some(2), "Head", "head"),
    ("left_shoulder", Some(1), "LeftArm", "left_shoulder"),
    ("left_elbow", Some(4), "LeftForeArm", "left_elbow"),
    ("left_wrist", Some(5), "LeftHand", "left_wrist"),
    ("right_shoulder", Some(1), "RightArm", "right_shoulder"),
    ("right_elbow", Some(7), "RightForeArm", "right_elbow"),
    ("right_wrist", Some(8), "RightHand", "right_wrist"),
    ("left_hip", Some(0), "LeftUpLeg", "left_hip"),
    ("left_knee", Some(10), "LeftLeg", "left_knee"),
    ("left_ankle", Some(11), "LeftFoot", "left_ankle"),
    ("right_hip", Some(0), "RightUpLeg", "right_hip"),
    ("right_knee", Some(13), "RightLeg", "right_knee"),
    ("right_ankle", Some(14), "RightFoot", "right_ankle"),
    ("left_fingers", Some(6), "LeftHandMiddle1", "left_hand"),
    ("right_fingers", Some(9), "RightHandMiddle1", "right_hand"),
    ("left_toes", Some(12), "LeftToeBase", "left_foot"),
    ("right_toes", Some(15), "RightToeBase", "right_foot"),
];

/// How a source's joint frames lie at its zero pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Rig {
    /// All frames the world's in the neutral standing pose.
    Neutral,
    /// The same in a T-pose: arms sideways, palms down.
    TPose,
    /// Every joint's frame turned at random: the zero pose is no posture.
    Scrambled,
}

fn synthetic() -> Source {
    Source {
        format: Format::Synthetic,
        up: Axis::Z,
        unit_metres: 1.0,
        warnings: vec![],
    }
}

/// The motion as rotations of another skeleton, whose limbs have other lengths: `stretch` times the body's, each bone
/// differently.
pub fn rotations(motion: &Motion, rig: Rig, stretch: f64) -> Recording {
    let body = motion.skeleton();
    let mut random = Pcg64::seed_from_u64(77);
    // The world orientation of each joint in which its own frame is the world's.
    let zero: Vec<UnitQuaternion<f64>> = JOINTS
        .iter()
        .map(|(name, ..)| match rig {
            Rig::Neutral => UnitQuaternion::identity(),
            Rig::Scrambled => exp(&Vector3::from_fn(|_, _| random.random_range(-1.7..1.7))),
            Rig::TPose => {
                let arm = ["shoulder", "elbow", "wrist", "fingers"];
                let side = match name.split_once('_') {
                    Some(("left", part)) if arm.contains(&part) => 1.0,
                    Some(("right", part)) if arm.contains(&part) => -1.0,
                    _ => 0.0,
                };
                exp(&(Vector3::x() * side * std::f64::consts::FRAC_PI_2))
            }
        })
        .collect();
    let index: Vec<usize> = JOINTS
        .iter()
        .map(|(n, ..)| body.joint(n).expect("a joint"))
        .collect();
    let lengths: Vec<f64> = JOINTS
        .iter()
        .map(|_| stretch * random.random_range(0.8..1.2))
        .collect();
    let mut turns = Vec::new();
    let mut joints: Vec<RecordedJoint> = Vec::new();
    for f in 0..motion.frames() {
        let world = motion.frames_at(f);
        let own = |k: usize| world[index[k]].rotation * zero[k].inverse();
        for (k, &(_, parent, name, _)) in JOINTS.iter().enumerate() {
            let Some(p) = parent else {
                turns.push(own(k));
                if f == 0 {
                    joints.push(recorded_joint(name, None, Vector3::zeros()));
                }
                continue;
            };
            turns.push(own(p).inverse() * own(k));
            if f == 0 {
                let local =
                    own(p).inverse() * (world[index[k]].position - world[index[p]].position);
                // Left and right alike, and the trunk as it is, so that its line stays straight.
                let mirror = JOINTS
                    .iter()
                    .position(|j| j.2 == name.replace("Right", "Left"));
                let arm_or_leg = name.contains("Arm") && p > 3 || name.contains("Leg") && p > 9;
                let limb = arm_or_leg || name.contains("Hand") || name.contains("Foot");
                let length = if limb {
                    lengths[mirror.unwrap_or(k)]
                } else {
                    stretch
                };
                joints.push(recorded_joint(name, Some(p), local * length));
            }
        }
    }
    let mut translations = vec![None; JOINTS.len()];
    translations[0] = Some(
        motion
            .roots()
            .iter()
            .map(|r| r.position * stretch)
            .collect(),
    );
    let observed = Observed::Rotations {
        rotations: turns,
        translations,
    };
    Recording::new("rotations", synthetic(), joints, motion.rate_hz(), observed).expect("valid")
}

/// The motion as bare positions, as a depth camera gives them.
pub fn positions(motion: &Motion) -> Recording {
    let body = motion.skeleton();
    let index: Vec<usize> = JOINTS
        .iter()
        .map(|(n, ..)| body.joint(n).expect("a joint"))
        .collect();
    let points = (0..motion.frames())
        .flat_map(|f| {
            let world = motion.frames_at(f);
            index
                .iter()
                .map(|&j| Some(world[j].position))
                .collect::<Vec<_>>()
        })
        .collect();
    of_points(points, motion.rate_hz())
}

/// A recording of these points of a depth camera.
pub fn of_points(points: Vec<Option<Vector3<f64>>>, rate_hz: f64) -> Recording {
    let joints = JOINTS
        .iter()
        .map(|(.., name)| recorded_joint(name, None, Vector3::zeros()))
        .collect();
    Recording::new(
        "points",
        synthetic(),
        joints,
        rate_hz,
        Observed::Positions(points),
    )
    .expect("valid")
}

/// The points of a recording of positions.
pub fn points(recording: &Recording) -> Vec<Option<Vector3<f64>>> {
    match recording.observed() {
        Observed::Positions(points) => points.clone(),
        Observed::Rotations { .. } => unreachable!("a recording of positions"),
    }
}

/// The points with normal noise of this deviation (metres).
pub fn jittered(recording: &Recording, deviation: f64, seed: u64) -> Recording {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut normal = || {
        // Sum of twelve uniform numbers: near enough to normal, and bounded.
        let sum: f64 = (0..12).map(|_| random.random_range(-0.5..0.5)).sum();
        sum * deviation
    };
    let noisy = points(recording)
        .into_iter()
        .map(|p| p.map(|p| p + Vector3::new(normal(), normal(), normal())))
        .collect();
    of_points(noisy, recording.rate_hz())
}

fn recorded_joint(name: &str, parent: Option<usize>, offset: Vector3<f64>) -> RecordedJoint {
    RecordedJoint {
        name: name.into(),
        parent,
        offset,
        tip: None,
        order: None,
        dof: 3,
    }
}

/// The limbs: upper part, lower part, where it ends.
pub const LIMBS: [[Role; 3]; 4] = [
    [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand],
    [Role::RightUpperArm, Role::RightLowerArm, Role::RightHand],
    [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot],
    [Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot],
];

pub fn to_ares(recording: &Recording) -> Motion {
    retarget(recording, &body(), None).expect("a motion").motion
}

pub fn joint(body: &Skeleton, role: Role) -> usize {
    *body.joints_of(role).last().expect("a joint")
}

/// World directions of the bones of a limb, and the bend between them (radians).
pub fn bones(motion: &Motion, f: usize, limb: &[Role; 3]) -> ([Vector3<f64>; 2], f64) {
    let frames = motion.frames_at(f);
    let [a, b, c] = limb.map(|r| frames[joint(motion.skeleton(), r)].position);
    let (upper, lower) = ((b - a).normalize(), (c - b).normalize());
    (
        [upper, lower],
        upper.cross(&lower).norm().atan2(upper.dot(&lower)),
    )
}

/// The turn of a limb's upper part against thorax or pelvis.
pub fn shoulder(motion: &Motion, f: usize, limb: &[Role; 3]) -> UnitQuaternion<f64> {
    let body = motion.skeleton();
    let frames = motion.frames_at(f);
    let carrier = match limb[2] {
        Role::LeftHand | Role::RightHand => *body.trunk().last().expect("a trunk"),
        _ => 0,
    };
    frames[carrier].rotation.inverse() * frames[joint(body, limb[0])].rotation
}

/// The angle between two unit vectors, exact for small ones.
pub fn apart(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// The greatest change of any shoulder or hip from frame to frame, radians.
pub fn fastest(motion: &Motion) -> f64 {
    let turns = (1..motion.frames()).flat_map(|f| {
        LIMBS
            .iter()
            .map(move |limb| shoulder(motion, f, limb).angle_to(&shoulder(motion, f - 1, limb)))
    });
    turns.fold(0.0, f64::max)
}

/// A motion of Ares from poses written in clinical angles, one a frame.
pub fn written(frames: usize, write: impl Fn(&Skeleton, f64, &mut [f64])) -> Motion {
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

/// Directions of all limbs agree everywhere; turns of shoulders and hips where the limb is bent more than 25 degrees.
pub fn check(found: &Motion, wanted: &Motion, directions: f64, turns: f64, what: &str) {
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
