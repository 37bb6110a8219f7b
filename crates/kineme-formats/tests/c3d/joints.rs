//! From markers to joints: what Ares did is told again from the markers on its skin.

use std::collections::BTreeMap;
use std::sync::Arc;

use kineme::choreography::perform;
use kineme::retargeting::{Profile, retarget};
use kineme::{Motion, RecordedJoint, Recording, Role, Skeleton, ares};
use kineme_formats::c3d::{joint_centres, parse};
use kineme_formats::script;
use nalgebra::Vector3;

use super::written::Written;
use super::{names, seen};

/// An actor with all joints at work, elbows and knees bent and straight.
const SCRIPT: &str = r#"
body = "ares"
[[animation]]
name = "reach"
keys = [
  { time = 0.0 },
  { time = 0.5, left_upper_arm = [60, 20, 10], left_lower_arm = [80], right_upper_arm = [20, 60, -10], right_lower_arm = [40], left_upper_leg = [50, 5, 0], left_lower_leg = [70], chest = [10, 5, 20] },
  { time = 1.0, left_upper_arm = [100, 10, 0], left_lower_arm = [30], right_upper_arm = [80, 10, 20], right_lower_arm = [110], left_upper_leg = [10, 5, 0], left_lower_leg = [20], right_upper_leg = [60, 10, 5], right_lower_leg = [90], chest = [0, -10, -25], head = [10, 0, 15] },
  { time = 1.5 },
]
"#;

fn acted() -> Motion {
    let body = Arc::new(ares().expect("ares"));
    let script = script::parse("reach.toml", SCRIPT.as_bytes()).expect("a script");
    let animation = &script.animations[0];
    perform(&animation.name, &animation.keys, &body, 100.0).expect("a motion")
}

/// Where markers of the conventional gait model would be on the body's skin at a frame, metres.
fn markers(body: &Skeleton, motion: &Motion, frame: usize) -> BTreeMap<String, Vector3<f64>> {
    let frames = motion.frames_at(frame);
    let joint = |role: Role| frames[body.joints_of(role)[0]];
    let at = |role: Role| joint(role).position;
    let mut marks = BTreeMap::new();
    let mut put = |name: String, place: Vector3<f64>| {
        marks.insert(name, place);
    };
    // The pelvis of which the regression has these hips.
    let (left, right) = (at(Role::LeftUpperLeg), at(Role::RightUpperLeg));
    let pelvis = frames[0].rotation;
    let width = ((left - right).norm() / 2.0 - 0.0073) / 0.33;
    let depth = 0.15;
    let up = 0.30 * width + 0.0109;
    let front = 0.5 * (left + right) + pelvis * Vector3::new(0.24 * depth + 0.0099, 0.0, up);
    let thorax = body.thorax(&frames).expect("shoulders");
    let neck = at(Role::Neck);
    let hips = front - pelvis * Vector3::x() * depth / 2.0;
    let down = (hips - neck).normalize();
    // Both acromions so far above the shoulders that they are their own measure.
    let shoulders = (at(Role::LeftUpperArm) - at(Role::RightUpperArm)).norm();
    for (name, side, roles) in [
        (
            "L",
            1.0,
            [
                Role::LeftUpperArm,
                Role::LeftLowerArm,
                Role::LeftHand,
                Role::LeftUpperLeg,
                Role::LeftLowerLeg,
                Role::LeftFoot,
                Role::LeftToes,
            ],
        ),
        (
            "R",
            -1.0,
            [
                Role::RightUpperArm,
                Role::RightLowerArm,
                Role::RightHand,
                Role::RightUpperLeg,
                Role::RightLowerLeg,
                Role::RightFoot,
                Role::RightToes,
            ],
        ),
    ] {
        let [arm, forearm, hand, thigh, shank, foot, toes] = roles.map(joint);
        let aside = pelvis * Vector3::y() * side * width / 2.0;
        put(format!("{name}ASI"), front + aside);
        put(
            format!("{name}PSI"),
            front + 0.5 * aside - pelvis * Vector3::x() * depth,
        );
        put(format!("{name}SHO"), arm.position - 0.17 * shoulders * down);
        let out = |of: &kineme::skeleton::Frame| of.rotation * Vector3::y() * side;
        put(
            format!("{name}ELB"),
            forearm.position + 0.18 * width * out(&arm),
        );
        put(
            format!("{name}KNE"),
            shank.position + 0.23 * width * out(&thigh),
        );
        put(
            format!("{name}ANK"),
            foot.position + 0.18 * width * out(&shank),
        );
        let bar = hand.rotation * Vector3::new(0.03, 0.0, 0.0);
        put(format!("{name}WRA"), hand.position + bar);
        put(format!("{name}WRB"), hand.position - bar);
        put(
            format!("{name}FIN"),
            hand.position - hand.rotation * Vector3::z() * 0.08,
        );
        put(format!("{name}TOE"), toes.position);
        for (corner, x) in [("F", 0.1), ("B", -0.1)] {
            let skull = joint(Role::Head);
            let place = skull.place(&Vector3::new(x, 0.08 * side, 0.1));
            put(format!("{name}{corner}HD"), place);
        }
    }
    put("C7".into(), neck - thorax.rotation * Vector3::x() * 0.06);
    put("CLAV".into(), neck + thorax.rotation * Vector3::x() * 0.06);
    marks
}

/// A file of all markers, in millimetres, named as laboratories name them.
fn file(motion: &Motion, hide: &[(usize, &str)]) -> Recording {
    let body = motion.skeleton();
    let rows: Vec<_> = (0..motion.frames())
        .map(|f| markers(body, motion, f))
        .collect();
    let points = rows.iter().enumerate().map(|(f, row)| {
        let places = row.iter().map(|(name, p)| {
            let hidden = hide.iter().any(|(frame, of)| *frame == f && of == name);
            (!hidden).then(|| [p.x, p.y, p.z].map(|c| (1000.0 * c) as f32))
        });
        places.collect()
    });
    let written = Written {
        labels: rows[0].keys().map(|n| format!("Anna:{n}")).collect(),
        unit: "mm".into(),
        screen: String::new(),
        rate_hz: 100.0,
        points: points.collect(),
        ..Written::small()
    };
    parse("reach.c3d", &written.bytes()).unwrap_or_else(|e| panic!("{e}"))
}

/// How far, metres, the joint of each role is told from where it was, at most over the frames.
fn errors(motion: &Motion, recording: &Recording) -> BTreeMap<&'static str, f64> {
    let centred = joint_centres(recording, None)
        .expect("markers")
        .expect("a known set");
    let body = motion.skeleton();
    let mut far = BTreeMap::new();
    for (role, centre) in &centred.profile.roles {
        let own = names(&centred.recording)
            .iter()
            .position(|n| *n == centre[0]);
        let own = own.expect("the role's joint");
        let joint = body.joints_of(*role)[0];
        let most = (0..motion.frames()).filter_map(|f| {
            let place = seen(&centred.recording)[f * centred.recording.joints().len() + own]?;
            Some((place - motion.frames_at(f)[joint].position).norm())
        });
        far.insert(role.name(), most.fold(0.0, f64::max));
    }
    far
}

#[test]
fn joints_are_where_they_were_inside_the_body() {
    let motion = acted();
    let recording = file(&motion, &[]);
    assert!(recording.source().warnings.is_empty());
    let far = errors(&motion, &recording);
    assert_eq!(far.len(), 19, "{far:?}");
    for (role, far) in far {
        // Hips lie midway between the pelvis' markers, heads between four, knuckles beside the fingers' joint; elbows, knees
        // and ankles are told by how the limb bends, and carried along where it is straight.
        let most = match role {
            "hips" | "head" => 0.2,
            "left_fingers" | "right_fingers" => 0.01,
            "left_lower_arm" | "right_lower_arm" | "left_lower_leg" | "right_lower_leg"
            | "left_foot" | "right_foot" => 0.01,
            _ => 1e-6,
        };
        assert!(far < most, "{role}: {far}");
    }
}

#[test]
fn ares_does_again_what_its_markers_show() {
    let motion = acted();
    let recording = file(&motion, &[(40, "LELB"), (41, "LELB"), (60, "RWRA")]);
    let centred = joint_centres(&recording, None)
        .expect("markers")
        .expect("a known set");
    let body = motion.skeleton();
    let again = retarget(&centred.recording, body, Some(&centred.profile)).expect("a motion");
    assert_eq!(again.profile, "conventional-gait-model");
    for f in 0..motion.frames() {
        let (was, is) = (motion.frames_at(f), again.motion.frames_at(f));
        for (from, to) in [
            (Role::LeftUpperArm, Role::LeftLowerArm),
            (Role::LeftLowerArm, Role::LeftHand),
            (Role::RightUpperArm, Role::RightLowerArm),
            (Role::RightLowerArm, Role::RightHand),
            (Role::LeftUpperLeg, Role::LeftLowerLeg),
            (Role::RightLowerLeg, Role::RightFoot),
        ] {
            let bone = |frames: &[kineme::skeleton::Frame]| {
                let [a, b] = [from, to].map(|r| frames[body.joints_of(r)[0]].position);
                b - a
            };
            let apart = bone(&was).angle(&bone(&is)).to_degrees();
            assert!(apart < 2.0, "{} frame {f}: {apart} degrees", from.name());
        }
    }
}

#[test]
fn a_marker_at_the_inside_makes_a_hinge_exact() {
    let motion = acted();
    let recording = file(&motion, &[]);
    let outer = names(&recording)
        .iter()
        .position(|n| *n == "Anna:LELB")
        .expect("the elbow");
    let count = recording.joints().len();
    // The marker at the other side of the joint, in place of one of the head's.
    let head = names(&recording)
        .iter()
        .position(|n| *n == "Anna:LFHD")
        .expect("the head");
    let elbow = motion.skeleton().joints_of(Role::LeftLowerArm)[0];
    let mut places = seen(&recording).to_vec();
    for f in 0..motion.frames() {
        let centre = motion.frames_at(f)[elbow].position;
        places[f * count + head] = places[f * count + outer].map(|p| 2.0 * centre - p);
    }
    let mut joints = recording.joints().to_vec();
    joints[head].name = "Anna:LELM".into();
    let recording = Recording::new(
        "a",
        recording.source().clone(),
        joints,
        recording.rate_hz(),
        kineme::Observed::Positions(places),
    )
    .expect("a recording");
    assert!(errors(&motion, &recording)["left_lower_arm"] < 1e-6);
}

#[test]
fn waists_named_as_in_cmu_and_hdm05_say_the_same_and_limbs_hang_together() {
    let recording = file(&acted(), &[]);
    let renamed = recording.joints().iter().map(|joint| RecordedJoint {
        name: joint.name.replace("ASI", "FWT").replace("PSI", "BWT"),
        ..joint.clone()
    });
    let other = Recording::new(
        recording.name(),
        recording.source().clone(),
        renamed.collect(),
        recording.rate_hz(),
        recording.observed().clone(),
    )
    .expect("a recording");
    let centred = joint_centres(&recording, None).expect("markers");
    assert_eq!(joint_centres(&other, None).expect("markers"), centred);
    let joints = centred.expect("a known set").recording.joints().to_vec();
    for (joint, hangs_on) in [
        ("hips", None),
        ("neck", Some("hips")),
        ("head", Some("neck")),
        ("right_upper_arm", Some("neck")),
        ("right_lower_arm", Some("right_upper_arm")),
        ("left_fingers", Some("left_hand")),
        ("left_upper_leg", Some("hips")),
        ("right_toes", Some("right_foot")),
    ] {
        let own = joints.iter().find(|j| j.name == format!("{joint}_centre"));
        let parent = own
            .expect("a joint")
            .parent
            .map(|p| joints[p].name.as_str());
        let wanted = hangs_on.map(|p| format!("{p}_centre"));
        assert_eq!(parent, wanted.as_deref(), "{joint}");
    }
}

#[test]
fn a_profile_says_which_markers_surround_a_joint() {
    let written = Written {
        labels: ["Anna:in", "Anna:out", "tip"].map(String::from).into(),
        ..Written::small()
    };
    let recording = parse("a.c3d", &written.bytes()).expect("markers");
    assert_eq!(joint_centres(&recording, None).expect("markers"), None);
    let profile = |role: Role, markers: &[&str]| Profile {
        name: "mine".into(),
        roles: BTreeMap::from([(role, markers.iter().map(ToString::to_string).collect())]),
    };
    let centred = joint_centres(&recording, Some(&profile(Role::LeftHand, &["IN", "out"])));
    let centred = centred.expect("markers").expect("joints");
    assert_eq!(names(&centred.recording), ["left_hand_centre"]);
    let middle = |x: f64, z: f64| Some(Vector3::new(x, -0.5, z));
    assert_eq!(
        seen(&centred.recording),
        [middle(0.125, 0.875), middle(0.25, 1.0)]
    );
    // A marker that is not there: a role that can be spared is left out, another is an error.
    let spared = joint_centres(&recording, Some(&profile(Role::LeftHand, &["in", "up"])));
    assert!(spared.is_err(), "no joint at all is left");
    let needed = joint_centres(
        &recording,
        Some(&profile(Role::LeftUpperArm, &["in", "up"])),
    );
    let error = needed.expect_err("a marker is missing").to_string();
    for word in ["`up`", "left_upper_arm", "Anna:in, Anna:out, tip"] {
        assert!(error.contains(word), "{error}");
    }
}
