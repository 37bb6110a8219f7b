//! Robots of MJCF files: what is read, how they stand, and movements brought to them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::choreography::perform;
use kineme::retargeting::Transfer;
use kineme::skeleton::JointKind;
use kineme::{Role, Root, Skeleton, ares};
use kineme_formats::robot::{self as robots, RobotModel};
use kineme_formats::{FormatError, Place, Result, profile};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// A small robot that stands with its arms out and its elbows bent, written in degrees and with classes.
const ROBOT: &str = include_str!("common/small.xml");

fn alone(file: &str) -> Result<Vec<u8>> {
    Err(FormatError::new(file, Place::File, "nothing", "a file"))
}

fn robot(text: &str) -> RobotModel {
    robots::parse("small.xml", text.as_bytes(), &alone, None).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(text: &str) -> FormatError {
    match robots::parse("small.xml", text.as_bytes(), &alone, None) {
        Ok(robot) => panic!("read as {robot:?}"),
        Err(error) => error,
    }
}

/// The joint of this name.
fn joint(body: &Skeleton, name: &str) -> usize {
    body.joint(name).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_robot_stands_with_hanging_arms_whatever_its_zero_is() {
    let robot = robot(ROBOT);
    let body = &robot.skeleton;
    assert_eq!((body.name(), robot.root.as_str()), ("small", "pelvis"));
    assert_eq!(robot.profile, "guessed");
    let names: Vec<&str> = robot.hinges.iter().map(|h| h.joint.as_str()).collect();
    assert_eq!(names, body.coordinate_names());
    assert_eq!(
        names[..4],
        [
            "waist_yaw",
            "left_shoulder_pitch",
            "left_shoulder_roll",
            "left_shoulder_yaw"
        ]
    );
    let frames = body.frames(&vec![0.0; body.dof()], &Root::ORIGIN);
    for side in ["left", "right"] {
        let at = |part: &str| frames[joint(body, &format!("{side}_{part}"))].position;
        for (from, to) in [("shoulder_roll", "elbow"), ("elbow", "wrist")] {
            let bone = at(to) - at(from);
            let off = bone.angle(&-Vector3::z());
            assert!(
                off < 1e-4,
                "{side} {from} to {to}: {} degrees",
                off.to_degrees()
            );
        }
        // Bending the elbow brings the hand forward.
        let elbow = joint(body, &format!("{side}_elbow"));
        let JointKind::Hinge { axis, range } = &body.joints()[elbow].kind else {
            panic!("the elbow is a hinge");
        };
        assert!(axis.y.abs() > 0.999, "{axis:?}");
        assert!(range.low <= 0.0 && 0.0 <= range.high, "{range:?}");
    }
    let angle = |name: &str| {
        let k = names.iter().position(|n| *n == name).expect("a hinge");
        robot.hinges[k].neutral_rad.to_degrees()
    };
    // The left arm's zero is at ref: the engine counts 10 degrees there.
    assert!((angle("left_shoulder_roll") - (10.0 - 90.0)).abs() < 0.1);
    assert!((angle("right_shoulder_roll") - 90.0).abs() < 0.1);
    assert!(
        (angle("left_elbow") - 90.0).abs() < 0.1,
        "{}",
        angle("left_elbow")
    );
    assert!((body.mass_kg() - 15.0).abs() < 1e-12);
    // The trunk's principal axes are turned by 90 degrees about z.
    let inertia = body.joints()[joint(body, "waist_yaw")].link.inertia;
    assert!((inertia[(0, 0)] - 0.2).abs() < 1e-12 && (inertia[(1, 1)] - 0.1).abs() < 1e-12);
    let head = &body.joints()[joint(body, "head_shell")];
    assert_eq!((&head.kind, head.role), (&JointKind::Fixed, None));
    let ends: Vec<&str> = body.effectors().iter().map(|e| e.name.as_str()).collect();
    assert_eq!(ends, ["left_hand", "right_hand"]);
}

/// The oracle's values, if they are there.
fn oracle(name: &str) -> Option<serde_json::Value> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = std::env::var_os("KINEME_DATA").map_or(root.join("../shared/data"), PathBuf::from);
    let text = fs::read_to_string(data.join("../oracles").join(name)).ok();
    if text.is_none() {
        println!("skipped: no oracle {name}");
    }
    serde_json::from_str(&text?).ok()
}

fn numbers<const N: usize>(value: &serde_json::Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().expect("a number"))
}

#[test]
fn joints_are_where_the_engine_has_them() {
    let Some(oracle) = oracle("mujoco_fk.json") else {
        return;
    };
    let text = oracle["mjcf"].as_str().expect("a model");
    // The hand hangs on a ball; where its joint lies does not depend on it.
    let hinges: Vec<&str> = text.lines().filter(|l| !l.contains("\"ball\"")).collect();
    let robot = robot(&hinges.join("\n"));
    let body = &robot.skeleton;
    let rest = UnitQuaternion::from_scaled_axis(Vector3::x() * std::f64::consts::FRAC_PI_4);
    for state in oracle["states"].as_array().expect("states") {
        let pose: [f64; 3] = numbers(&state["qpos"]);
        let root = Root {
            position: Vector3::new(0.0, 0.0, 1.2),
            yaw: 0.0,
        };
        let frames = body.frames(&pose, &root);
        for (name, index) in [("elbow", 2), ("hand", 3)] {
            let found = frames[joint(body, name)].position;
            let wanted = Vector3::from(numbers::<3>(&state["xpos"][index]));
            assert!(
                (found - wanted).norm() < 1e-9,
                "{name}: {found} not {wanted}"
            );
        }
        let [w, x, y, z] = numbers(&state["xquat_wxyz"][2]);
        let wanted = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        let found = frames[joint(body, "elbow")].rotation * rest;
        assert!(
            found.angle_to(&wanted) < 1e-9,
            "{}",
            found.angle_to(&wanted)
        );
    }
}

#[test]
fn what_is_no_robot_is_refused_with_the_line_of_the_fault() {
    for (old, new, line, found) in [
        ("angle=\"degree\"", "angle=\"turns\"", 2, "angle = `turns`"),
        ("eulerseq=\"XYZ\"", "eulerseq=\"XY\"", 2, "eulerseq = `XY`"),
        (
            "<default class=\"side\">",
            "<default>",
            5,
            "a <default> in another without `class`",
        ),
        ("pos=\"0 0 1\"", "pos=\"0 0\"", 11, "pos = `0 0`"),
        ("pos=\"0 0 1\"", "pos=\"0 0 nan\"", 11, "pos = `0 0 nan`"),
        ("pos=\"0 0 1\"", "pos=\"0 0 1e99\"", 11, "pos = `0 0 1e99`"),
        ("mass=\"5\"", "", 13, "<inertial> without `mass`"),
        ("mass=\"5\"", "mass=\"-5\"", 13, "mass = -5"),
        (
            "<joint name=\"waist_yaw\"/>",
            "<joint/>",
            15,
            "<joint> without `name`",
        ),
        (
            "<joint name=\"waist_yaw\"/>",
            "<joint name=\"b\" type=\"ball\"/>",
            15,
            "a joint of type `ball`",
        ),
        (
            "<joint name=\"waist_yaw\"/>",
            "<joint name=\"b\" class=\"no\"/>",
            15,
            "class `no`",
        ),
        (
            "<joint name=\"waist_yaw\"/>",
            "<joint name=\"b\" axis=\"0 0 0\"/>",
            15,
            "an axis of no length",
        ),
        (
            "<joint name=\"waist_yaw\"/>",
            "<joint name=\"b\" range=\"9 -9\"/>",
            15,
            "range = `9 -9`",
        ),
        (
            "<joint name=\"waist_yaw\"/>",
            "<freejoint/>",
            15,
            "a free joint in a body in a body",
        ),
        (
            "<joint name=\"waist_yaw\"/>",
            "<replicate/>",
            15,
            "<replicate>",
        ),
        (
            "euler=\"90 0 0\"",
            "euler=\"90 0 0\" quat=\"1 0 0 0\"",
            22,
            "quat and euler",
        ),
        (
            "<body name=\"head_shell\" pos=\"0 0 0.6\"/>",
            "<joint",
            18,
            "expected",
        ),
    ] {
        assert!(ROBOT.contains(old), "{old}");
        let error = refused(&ROBOT.replacen(old, new, 1));
        assert!(error.to_string().contains(found), "{new}: {error}");
        // A tag that is not closed is found out where the next begins.
        let near = matches!(error.place, Place::Line(l) if l == line || (new == "<joint" && l.abs_diff(line) < 2));
        assert!(near, "{new}: {error}");
    }
    assert_eq!(refused("<robot/>").place, Place::Line(1));
    assert_eq!(
        refused("<mujoco><worldbody/></mujoco>").found,
        "no body with a hinge"
    );
    assert!(
        refused("<mujoco><worldbody><joint/></worldbody></mujoco>")
            .found
            .contains("in the world")
    );
    let twice = ROBOT.replacen("right_elbow", "left_elbow", 1);
    assert!(refused(&twice).found.contains("left_elbow"));
}

#[test]
fn a_model_may_include_files_and_a_profile_may_stand_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let (head, body) = ROBOT.split_once("  <worldbody>").expect("a world");
    let (compiler, defaults) = head.split_once("  <default>").expect("defaults");
    let main = format!("{compiler}  <include file=\"defaults.xml\"/>\n  <worldbody>{body}");
    fs::write(at("small.xml"), main).expect("a file");
    let defaults = format!("<mujocoinclude>\n  <default>{defaults}</mujocoinclude>");
    fs::write(at("defaults.xml"), &defaults).expect("a file");
    let included = robots::read(&at("small.xml"), None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(included.skeleton, robot(ROBOT).skeleton);

    let profile = "name = \"mine\"\n[roles]\nchest = \"waist_yaw\"\nhead = \"head_shell\"\n\
                   left_upper_arm = [\"left_shoulder_pitch\", \"left_shoulder_roll\", \"left_shoulder_yaw\"]\n";
    fs::write(at("small.toml"), profile).expect("a file");
    let named = robots::read(&at("small.xml"), None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(named.profile, "mine");
    assert_eq!(named.skeleton.joints_of(Role::LeftUpperArm).len(), 3);
    assert_eq!(named.skeleton.joints_of(Role::Head).len(), 1);
    assert!(named.skeleton.joints_of(Role::RightUpperArm).is_empty());

    let strange = profile::parse("p", b"name = 'p'\n[roles]\nhead = 'nose'").expect("a profile");
    let error = robots::read(&at("small.xml"), Some(&strange)).expect_err("no such joint");
    assert!(error.found.contains("`nose`"), "{error}");

    let broken = defaults.replacen("axis=\"1 0 0\"", "axis=\"1 0\"", 1);
    fs::write(at("defaults.xml"), broken).expect("a file");
    fs::remove_file(at("small.toml")).expect("a file");
    let error = robots::read(&at("small.xml"), None).expect_err("a short axis");
    assert!(error.found.contains("axis = `1 0`"), "{error}");
    fs::remove_file(at("defaults.xml")).expect("a file");
    let error = robots::read(&at("small.xml"), None).expect_err("no defaults");
    assert!(error.file.ends_with("defaults.xml"), "{error}");
    let twice = "<mujoco><include file='a'/><include file='a'/></mujoco>";
    let found = robots::parse("m", twice.as_bytes(), &|_| Ok(b"<a/>".to_vec()), None);
    assert!(found.expect_err("twice").found.contains("second include"));
}

proptest! {
    #[test]
    fn a_damaged_model_is_read_or_refused(at in 0..ROBOT.len(), byte in any::<u8>(), cut in any::<bool>()) {
        let mut bytes = ROBOT.as_bytes().to_vec();
        bytes[at] = byte;
        if cut {
            bytes.truncate(at);
        }
        let _ = robots::parse("damaged", &bytes, &alone, None);
    }
}

/// The Unitree G1, if `cargo xtask setup --robots` has fetched it.
fn g1() -> Option<RobotModel> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let path = root.join(".mujoco/robots/unitree_g1/g1.xml");
    if !path.is_file() {
        println!("skipped: no Unitree G1; cargo xtask setup --robots fetches it");
        return None;
    }
    Some(robots::read(&path, None).unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn the_unitree_g1_stands_as_a_person_stands() {
    let Some(robot) = g1() else { return };
    let body = &robot.skeleton;
    assert_eq!(
        (robot.profile.as_str(), robot.root.as_str()),
        ("unitree-g1", "pelvis")
    );
    assert_eq!((body.dof(), robot.warnings.len()), (29, 0));
    assert!((body.mass_kg() - 33.34).abs() < 0.01, "{}", body.mass_kg());
    let frames = body.frames(&vec![0.0; body.dof()], &Root::ORIGIN);
    let at = |name: &str| frames[joint(body, name)].position;
    for side in ["left", "right"] {
        let place = |part: &str| at(&format!("{side}_{part}_joint"));
        for (bone, most) in [
            (place("elbow") - place("shoulder_yaw"), 13.0),
            (place("wrist_yaw") - place("elbow"), 1.0),
            (place("ankle_pitch") - place("knee"), 1.0),
        ] {
            let off = bone.angle(&-Vector3::z()).to_degrees();
            assert!(off < most, "{side}: {off} degrees");
        }
    }
    let neutral = |name: &str| {
        let hinge = robot.hinges.iter().find(|h| h.joint == name);
        hinge.expect("a hinge").neutral_rad.to_degrees()
    };
    for part in ["shoulder_pitch", "elbow", "knee", "hip_pitch"] {
        let [left, right] = ["left", "right"].map(|s| neutral(&format!("{s}_{part}_joint")));
        assert!((left - right).abs() < 0.1, "{part}: {left} and {right}");
    }
    // Zero has the forearms forward: to stand, the elbows open by a right angle, less what the arm is crooked.
    assert!((80.0..92.0).contains(&neutral("left_elbow_joint")));
    assert!(neutral("waist_yaw_joint").abs() < 1e-9);
}

#[test]
fn g1_points_its_arms_where_ares_points_them_in_every_movement_of_the_choreography() {
    let Some(robot) = g1() else { return };
    let ares = Arc::new(ares().expect("a body"));
    let to = Arc::new(robot.skeleton);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../choreography");
    let last = |body: &Skeleton, role: Role| *body.joints_of(role).last().expect("a joint");
    let arms = [
        [Role::LeftUpperArm, Role::LeftLowerArm],
        [Role::RightUpperArm, Role::RightLowerArm],
    ];
    let down = -Vector3::z();
    let (mut seen, mut stopped) = (0, 0);
    let mut fastest = 0f64;
    for file in [
        "boxing",
        "punching",
        "vertical-waving",
        "horizontal-waving",
        "twist",
    ] {
        let bytes = fs::read(folder.join(format!("{file}.toml"))).expect("a script");
        let script = kineme_formats::script::parse(file, &bytes).expect("a script");
        let mut worst = [0f64; 2];
        for exemplar in &script.exemplars {
            let motion =
                perform(&exemplar.primitive, &exemplar.keys, &ares, 120.0).expect("a motion");
            let mut way = Transfer::between(&ares, &to).expect("bodies alike");
            let mut pose = vec![0.0; to.dof()];
            let mut before: Option<Vec<f64>> = None;
            for f in 0..motion.frames() {
                way.pose(motion.pose(f), &mut pose);
                let wanted = motion.frames_at(f);
                let root = Root {
                    yaw: motion.root(f).yaw,
                    ..Root::ORIGIN
                };
                let found = to.frames(&pose, &root);
                if let Some(before) = before.replace(pose.clone()) {
                    let steps = before.iter().zip(&pose).map(|(a, b)| 120.0 * (a - b).abs());
                    fastest = steps.fold(fastest, f64::max);
                }
                for (j, at) in to.joints().iter().enumerate() {
                    if let JointKind::Hinge { range, .. } = at.kind {
                        let angle = pose[to.coordinates(j).start];
                        assert!((range.low..=range.high).contains(&angle), "{}", at.name);
                    }
                }
                for arm in arms {
                    seen += 1;
                    let free = arm.iter().flat_map(|&r| to.joints_of(r)).all(|j| {
                        let angle = pose[to.coordinates(j).start];
                        let range = to.limits(j)[0];
                        range.low < angle && angle < range.high
                    });
                    if !free {
                        stopped += 1;
                        continue;
                    }
                    for (worst, role) in worst.iter_mut().zip(arm) {
                        let wanted = wanted[last(&ares, role)].rotation * down;
                        let found = found[last(&to, role)].rotation * down;
                        *worst = worst.max(wanted.angle(&found).to_degrees());
                    }
                }
            }
        }
        println!(
            "{file}: upper arms {:.3}, forearms {:.3} degrees",
            worst[0], worst[1]
        );
        assert!(
            worst[0] < 1.0 && worst[1] < 1.0,
            "{file}: {worst:?} degrees"
        );
    }
    println!(
        "at a stop in {stopped} of {seen} postures of an arm; fastest hinge {fastest:.1} rad/s"
    );
}
