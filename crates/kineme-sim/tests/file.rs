//! Robots from MJCF files: a small one written here, and the Unitree G1 where it was fetched.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::control::{Command, Robot};
use kineme::retargeting::Transfer;
use kineme::skeleton::JointKind;
use kineme::{Root, Skeleton};
use kineme_formats::robot::{RobotModel, read};
use kineme_sim::{RobotFile, Servo, SimSettings, SimulatedRobot};
use nalgebra::Vector3;

const RATE_HZ: f64 = 120.0;

/// A trunk that floats, with one arm of two hinges and a finger that nobody moves; its file has drives, sensors and a
/// posture of its own.
const SMALL: &str = r#"<mujoco model="small">
  <compiler angle="radian"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="trunk" pos="0 0 1">
      <freejoint name="float"/>
      <geom type="box" size="0.1 0.1 0.3" mass="10"/>
      <body name="arm" pos="0 0.2 0.2">
        <joint name="lift" axis="0 1 0" range="-1 1" actuatorfrcrange="-40 40"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03" mass="2"/>
        <body name="forearm" pos="0 0 -0.3">
          <joint name="bend" axis="0 1 0" ref="0.2" range="-2 2"/>
          <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03" mass="1"/>
          <body name="finger" pos="0 0 -0.3">
            <joint name="curl" axis="1 0 0"/>
            <geom type="sphere" size="0.02" mass="0.1"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="lift_motor" joint="lift" ctrlrange="-5 5"/>
    <motor name="bend_motor" joint="bend" gear="10" ctrlrange="-3 3"/>
  </actuator>
  <sensor><actuatorfrc actuator="lift_motor"/></sensor>
  <keyframe><key qpos="0 0 2 1 0 0 0 0.1 0.2 0.3"/></keyframe>
</mujoco>"#;

fn file(model: &RobotModel) -> RobotFile {
    model.clone().into()
}

/// The small robot, with the arm's two hinges alone for coordinates.
fn small(folder: &Path) -> RobotFile {
    use kineme::skeleton::{ClinicalAxes, Joint, Link, Range};
    let path = folder.join("small.xml");
    std::fs::write(&path, SMALL).expect("written");
    let joint = |name: &str, parent, offset, kind| Joint {
        name: String::from(name),
        parent,
        offset,
        kind,
        axes: ClinicalAxes {
            flexion: Vector3::y(),
            abduction: Vector3::x(),
            axial: Vector3::z(),
        },
        role: None,
        share: 1.0,
        tip: Vector3::new(0.0, 0.0, -0.3),
        link: Link {
            mass_kg: 0.0,
            center: Vector3::zeros(),
            inertia: nalgebra::Matrix3::zeros(),
        },
    };
    let hinge = |range: f64| JointKind::Hinge {
        axis: Vector3::y_axis(),
        range: Range {
            low: -range,
            high: range,
        },
    };
    let joints = vec![
        joint("trunk", None, Vector3::zeros(), JointKind::Fixed),
        joint("lift", Some(0), Vector3::new(0.0, 0.2, 0.2), hinge(1.0)),
        joint("bend", Some(1), Vector3::new(0.0, 0.0, -0.3), hinge(2.0)),
    ];
    RobotFile {
        path,
        mjcf: None,
        skeleton: Arc::new(Skeleton::new("small", joints, vec![]).expect("a body")),
        hinges: vec!["lift".into(), "bend".into()],
        offsets: vec![0.0, 0.2],
        base: "trunk".into(),
    }
}

fn command(pose: &[f64], velocity: &[f64]) -> Command {
    Command {
        pose: pose.to_vec(),
        velocity: velocity.to_vec(),
        acceleration: vec![0.0; pose.len()],
        root: Root::ORIGIN,
        phase: 0.0,
        finished: false,
        limited: 0,
    }
}

#[test]
fn a_robot_is_welded_and_driven_by_our_servo() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = small(folder.path());
    for servo in [Servo::Pd, Servo::FeedforwardFeedback, Servo::ComputedTorque] {
        let settings = SimSettings {
            servo: Some(servo),
            ..SimSettings::default()
        };
        let mut moved = SimulatedRobot::from_file(&robot, &settings).expect("a robot");
        let told = command(&[0.5, 0.7], &[0.0, 0.0]);
        for _ in 0..240 {
            moved.advance(&told, 1.0 / RATE_HZ).expect("stable");
        }
        let pose = &moved.sensed().pose;
        let most = if servo == Servo::Pd { 0.05 } else { 1e-3 };
        assert!((pose[0] - 0.5).abs() < most, "{servo:?}: {pose:?}");
        assert!((pose[1] - 0.7).abs() < most, "{servo:?}: {pose:?}");
        // The engine's angle has the file's own zero; the finger is held; the trunk has not fallen.
        let angles = moved.plant().angles();
        assert_eq!(angles.len(), 3);
        assert!((angles[1] - 0.9).abs() < most && angles[2].abs() < 0.05);
        assert!((moved.plant().data().xpos()[1][2] - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_robot_is_as_strong_as_its_file_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = small(folder.path());
    let made = SimulatedRobot::from_file(&robot, &SimSettings::default()).expect("a robot");
    let limits: Vec<_> = made.plant().model().actuator_forcerange().to_vec();
    // Of the joint itself before that of its drive; through the gear; none.
    assert_eq!(limits[0], [-40.0, 40.0]);
    assert_eq!(limits[1], [-30.0, 30.0]);
    assert!(!made.plant().model().actuator_forcelimited()[2]);
}

#[test]
fn what_a_file_does_not_have_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = small(folder.path());
    let refused = |robot: RobotFile| {
        let made = SimulatedRobot::from_file(&robot, &SimSettings::default());
        made.err().expect("refused").to_string()
    };
    let mut robot = good.clone();
    robot.base = "trnk".into();
    assert!(refused(robot).contains("nearest: `trunk`"));
    let mut robot = good.clone();
    robot.hinges[0] = "lifd".into();
    assert!(refused(robot).contains("nearest: `lift`"));
    let mut robot = good.clone();
    robot.offsets.pop();
    assert!(refused(robot).contains("found 2 and 1"));
    let mut robot = good.clone();
    robot.skeleton = Arc::new(kineme::adonis().expect("adonis"));
    assert!(refused(robot).contains("`waist` is a ball"));
    // Not welded, it floats.
    let mut robot = good.clone();
    robot.base = "arm".into();
    assert!(refused(robot).contains("float"));
    let mut robot = good;
    robot.path = folder.path().join("none.xml");
    assert!(refused(robot).contains("none.xml"));
}

fn g1() -> Option<RobotModel> {
    let place: PathBuf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.mujoco/robots/unitree_g1/g1.xml");
    if !place.is_file() {
        eprintln!("SKIPPED: no Unitree G1; `cargo xtask setup --robots` fetches it");
        return None;
    }
    Some(read(&place, None).expect("a robot"))
}

/// Adonis' movement, brought to the robot by roles: root mean square and greatest error (radians), limits kept.
#[test]
fn the_g1_follows_a_wave_and_keeps_its_limits() {
    let Some(model) = g1() else { return };
    let robot = file(&model);
    let body = Arc::clone(&robot.skeleton);
    let adonis = Arc::new(kineme::adonis().expect("adonis"));
    let mut made = SimulatedRobot::from_file(&robot, &SimSettings::default()).expect("a robot");
    let mut transfer = Transfer::between(&adonis, &body).expect("parts in common");
    let shoulder = adonis.coordinates(adonis.joint("right_shoulder").expect("a shoulder"));
    let elbow = adonis
        .coordinates(adonis.joint("right_elbow").expect("an elbow"))
        .start;
    let waist = adonis.coordinates(adonis.joint("waist").expect("a waist"));
    let tau = std::f64::consts::TAU;
    // A raised arm waves and the trunk turns, once a second.
    let at = |secs: f64| {
        let (sine, cosine) = (tau * secs).sin_cos();
        let mut pose = adonis.neutral();
        let mut velocity = vec![0.0; adonis.dof()];
        pose[shoulder.clone()].copy_from_slice(&[0.1, -0.4, 0.1 + 0.2 * sine]);
        velocity[shoulder.start + 2] = 0.2 * tau * cosine;
        pose[elbow] = 1.2 + 0.5 * sine;
        velocity[elbow] = 0.5 * tau * cosine;
        pose[waist.end - 1] += 0.3 * sine;
        velocity[waist.end - 1] = 0.3 * tau * cosine;
        (pose, velocity)
    };
    let mut told = |secs: f64| {
        let (pose, velocity) = at(secs);
        let moved = transfer.command(&pose, &velocity, &vec![0.0; pose.len()]);
        command(&moved.pose, &moved.velocity)
    };
    let start = told(0.0);
    made.reset(&start.pose, &start.velocity).expect("reset");
    let (mut sum, mut n, mut worst) = (0.0, 0, 0.0_f64);
    for tick in 1..=240 {
        let told = told(f64::from(tick) / RATE_HZ);
        made.advance(&told, 1.0 / RATE_HZ).expect("stable");
        for (is, wanted) in made.sensed().pose.iter().zip(&told.pose) {
            let error = (is - wanted).abs();
            sum += error * error;
            n += 1;
            worst = worst.max(error);
        }
        for j in 0..body.joints().len() {
            if let JointKind::Hinge { range, .. } = &body.joints()[j].kind {
                let angle = made.sensed().pose[body.coordinates(j).start];
                let inside = range.low - 0.01..range.high + 0.01;
                assert!(
                    inside.contains(&angle),
                    "{}: {angle}",
                    body.joints()[j].name
                );
            }
        }
    }
    let rms = (sum / f64::from(n)).sqrt();
    println!(
        "G1: rms {rms:.5} rad, worst {worst:.5}, saturated {:?}",
        made.effort()
    );
    assert!(rms < 0.01, "{rms} rad");
    assert!(worst < 0.1, "{worst} rad");
}

/// With all coordinates zero the engine has the robot's joints where our body has them.
#[test]
fn the_g1_stands_where_its_body_does() {
    let Some(model) = g1() else { return };
    let robot = file(&model);
    let body = Arc::clone(&robot.skeleton);
    let mut made = SimulatedRobot::from_file(&robot, &SimSettings::default()).expect("a robot");
    let mut pose = vec![0.0; body.dof()];
    for (c, x) in pose.iter_mut().enumerate() {
        *x = 0.3 * (1.7 * c as f64).sin();
    }
    made.reset(&pose, &vec![0.0; body.dof()]).expect("reset");
    let frames = body.frames(&pose, &Root::ORIGIN);
    let engine = made.plant();
    let base = Vector3::from(engine.data().xpos()[1]);
    for (j, frame) in frames.iter().enumerate() {
        let Some(c) = body.coordinates(j).next() else {
            continue;
        };
        let kind = mujoco_rs::prelude::MjtObjBase::mjOBJ_JOINT;
        let hinge = engine
            .model()
            .name_to_id(kind, &robot.hinges[c])
            .expect("a hinge");
        let place = Vector3::from(engine.data().xanchor()[hinge]) - base;
        assert!(
            (place - frame.position).norm() < 1e-6,
            "{}: {place:?} {:?}",
            robot.hinges[c],
            frame.position
        );
    }
}
