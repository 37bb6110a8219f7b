//! Robots from URDF files, beside what the engine's own reader makes of the same text.

use std::sync::Arc;

use kineme::Root;
use kineme::control::{Command, Robot};
use kineme_formats::robot::{self, RobotModel};
use kineme_formats::{FormatError, Place};
use kineme_sim::{SimSettings, SimulatedRobot};
use mujoco_rs::prelude::{MjData, MjModel, MjtObjBase};
use nalgebra::Vector3;
use rand::{RngExt as _, SeedableRng};
use rand_pcg::Pcg64;

/// Hinges along no axis of the world, frames and inertias that are turned, a link without mass between two hinges, one
/// that is fixed. What is said to the engine alone keeps its links apart and its masses as ours are.
const ROBOT: &str = r#"<robot name="oblique">
  <mujoco><compiler fusestatic="false" boundmass="1e-6" boundinertia="1e-9"/></mujoco>
  <link name="base">
    <inertial><origin xyz="0.01 0 0.1"/><mass value="8"/>
      <inertia ixx="0.1" ixy="0.01" ixz="0" iyy="0.12" iyz="0" izz="0.09"/></inertial>
  </link>
  <link name="shoulder"/>
  <link name="upper">
    <inertial><origin xyz="0 0.02 -0.15" rpy="0.3 -0.2 0.7"/><mass value="2.5"/>
      <inertia ixx="0.02" ixy="0.001" ixz="-0.002" iyy="0.021" iyz="0.003" izz="0.005"/></inertial>
  </link>
  <link name="plate">
    <inertial><origin xyz="0.03 0 0" rpy="1 0 0"/><mass value="0.4"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.003"/></inertial>
  </link>
  <link name="lower">
    <inertial><origin xyz="0 0 -0.12"/><mass value="1.1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.011" iyz="0" izz="0.002"/></inertial>
  </link>
  <joint name="pitch" type="revolute"><parent link="base"/><child link="shoulder"/>
    <origin xyz="0.05 0.2 0.4" rpy="0.1 0.2 -0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="2" effort="40" velocity="5"/><dynamics damping="0.3" friction="0.1"/></joint>
  <joint name="roll" type="continuous"><parent link="shoulder"/><child link="upper"/>
    <origin rpy="0 0.4 0"/><axis xyz="1 2 -0.5"/><limit effort="35" velocity="5"/></joint>
  <joint name="weld" type="fixed"><parent link="upper"/><child link="plate"/>
    <origin xyz="0.04 0 -0.1" rpy="0.5 0.6 0.7"/></joint>
  <joint name="bend" type="revolute"><parent link="plate"/><child link="lower"/>
    <origin xyz="0 -0.03 -0.2" rpy="-1.2 0.3 0.9"/><axis xyz="0 0.6 0.8"/>
    <limit lower="0" upper="2.2" effort="20" velocity="5"/></joint>
</robot>"#;

fn read(text: &str) -> RobotModel {
    let alone = |file: &str| Err(FormatError::new(file, Place::File, "nothing", "a file"));
    robot::parse("oblique.urdf", text.as_bytes(), &alone, None).expect("a robot")
}

/// Without inertia of our own in the joints, so that the mass matrix is the file's.
fn bare() -> SimSettings {
    SimSettings {
        armature: 0.0,
        ..SimSettings::default()
    }
}

fn ids(model: &MjModel, kind: MjtObjBase, names: &[&str]) -> Vec<usize> {
    let id = |name: &&str| model.name_to_id(kind, name).expect("a name");
    names.iter().map(id).collect()
}

#[test]
fn the_engine_reads_the_same_robot_from_the_file_itself() {
    let made = SimulatedRobot::from_file(&read(ROBOT).into(), &bare()).expect("a robot");
    let ours = made.plant().model();
    let theirs = MjModel::from_xml_string(ROBOT).expect("a model");
    let (joints, bodies) = (
        ["pitch", "roll", "bend"],
        ["base", "shoulder", "upper", "plate", "lower"],
    );
    let [a, b] = [ours, &theirs].map(|m| ids(m, MjtObjBase::mjOBJ_JOINT, &joints));
    let [c, d] = [ours, &theirs].map(|m| ids(m, MjtObjBase::mjOBJ_BODY, &bodies));
    for (j, k) in a.iter().zip(&b) {
        assert_eq!(ours.jnt_limited()[*j], theirs.jnt_limited()[*k]);
        if ours.jnt_limited()[*j] {
            assert_eq!(ours.jnt_range()[*j], theirs.jnt_range()[*k]);
        }
        assert_eq!(ours.dof_damping()[*j], theirs.dof_damping()[*k]);
        assert_eq!(ours.dof_frictionloss()[*j], theirs.dof_frictionloss()[*k]);
        // The file's greatest torques are those of our drives.
        assert_eq!(ours.actuator_forcerange()[*j], theirs.jnt_actfrcrange()[*k]);
    }
    let mass = |m: &MjModel| m.body_mass().iter().sum::<f64>();
    assert!((mass(ours) - mass(&theirs)).abs() < 1e-9);
    assert!((mass(ours) - 12.0).abs() < 1e-5);
    let mut random = Pcg64::seed_from_u64(7);
    let [mut one, mut other] = [ours, &theirs].map(|m| MjData::try_new(m).expect("a state"));
    for _ in 0..50 {
        for (j, k) in a.iter().zip(&b) {
            let angle = random.random_range(-3.0..3.0);
            one.qpos_mut()[*j] = angle;
            other.qpos_mut()[*k] = angle;
        }
        let (mut m, mut n) = (vec![0.0; 9], vec![0.0; 9]);
        for (data, matrix) in [(&mut one, &mut m), (&mut other, &mut n)] {
            data.fwd_position();
            data.fwd_velocity();
            data.full_m(matrix).expect("a matrix");
        }
        for (x, y) in c.iter().zip(&d) {
            let apart = Vector3::from(one.xpos()[*x]) - Vector3::from(other.xpos()[*y]);
            let centers = Vector3::from(one.xipos()[*x]) - Vector3::from(other.xipos()[*y]);
            assert!(apart.norm() < 1e-9, "{apart}");
            // What weighs next to nothing has its centre anywhere.
            assert!(
                centers.norm() < 1e-9 || ours.body_mass()[*x] < 1e-5,
                "{centers}"
            );
        }
        // Masses and inertias: what moves the hinges, and what gravity does to them.
        for (i, (j, k)) in a.iter().zip(&b).enumerate() {
            let weight = one.qfrc_bias()[*j] - other.qfrc_bias()[*k];
            // Where a milligram is that the file does not place, the two need not agree: 5e-6 N m and 2.5e-7 kg m^2 at
            // half a metre.
            assert!(weight.abs() < 1e-5, "{}: {weight} N m", joints[i]);
            for (p, q) in a.iter().zip(&b) {
                let entry = m[j * 3 + p] - n[k * 3 + q];
                assert!(entry.abs() < 5e-7, "{} {entry} kg m^2", joints[i]);
            }
        }
    }
}

#[test]
fn the_robot_stands_where_its_body_does_and_follows_what_it_is_told() {
    let model = read(ROBOT);
    let body = Arc::new(model.skeleton.clone());
    let hinges = model.hinges.clone();
    let mut made =
        SimulatedRobot::from_file(&model.into(), &SimSettings::default()).expect("a robot");
    let still = vec![0.0; body.dof()];
    for pose in [[0.2, -0.3, 0.4], [-0.5, 1.1, 0.9]] {
        made.reset(&pose, &still).expect("reset");
        let data = made.plant().data();
        let frames = body.frames(&pose, &Root::ORIGIN);
        for (c, hinge) in hinges.iter().enumerate() {
            let [id] = ids(
                made.plant().model(),
                MjtObjBase::mjOBJ_JOINT,
                &[&hinge.joint],
            )[..] else {
                panic!("a hinge");
            };
            let joint = body.joint(&hinge.joint).expect("a joint");
            let apart = Vector3::from(data.xanchor()[id]) - frames[joint].position;
            assert!(apart.norm() < 1e-9, "{}: {apart}", hinge.joint);
            let angle = data.qpos()[id] - hinge.neutral_rad;
            assert!((angle - pose[c]).abs() < 1e-12);
        }
    }
    made.reset(&body.neutral(), &still).expect("reset");
    let told = Command {
        pose: vec![0.4, -0.3, 0.5],
        velocity: still.clone(),
        acceleration: still,
        root: Root::ORIGIN,
        phase: 0.0,
        finished: false,
        limited: 0,
    };
    for _ in 0..240 {
        made.advance(&told, 1.0 / 120.0).expect("stable");
    }
    for (is, wanted) in made.sensed().pose.iter().zip(&told.pose) {
        assert!((is - wanted).abs() < 2e-3, "{:?}", made.sensed().pose);
    }
}

/// Whatever the file leaves out, and whatever no body can have, the engine takes what it is given.
#[test]
fn a_robot_whose_file_says_little_is_simulated_all_the_same() {
    let bare = |text: &str, from: &str, to: &str| {
        let mut text = text.to_string();
        while let Some(start) = text.find(from) {
            let end = text[start..]
                .find(to)
                .map_or(text.len(), |e| start + e + to.len());
            text.replace_range(start..end, "");
        }
        text
    };
    let weightless = bare(ROBOT, "<inertial>", "</inertial>");
    let impossible = ROBOT.replace("izz=\"0.002\"", "izz=\"0.9\"");
    let points = ROBOT
        .replace("ixx=\"0.01\"", "ixx=\"0\"")
        .replace("iyy=\"0.011\"", "iyy=\"0\"")
        .replace("izz=\"0.002\"", "izz=\"0\"");
    let mimics = ROBOT.replace(
        "<axis xyz=\"0 0.6 0.8\"/>",
        "<axis xyz=\"0 0.6 0.8\"/><mimic joint=\"pitch\" multiplier=\"2\" offset=\"0.3\"/>",
    );
    let world = ROBOT.replace(
        "</robot>",
        "<link name='world'/><joint name='stand' type='floating'><parent link='world'/><child link='base'/>\
         <origin xyz='0 0 1'/></joint></robot>",
    );
    let slider = ROBOT
        .replace("type=\"continuous\"", "type=\"prismatic\"")
        .replace(
            "<limit effort=\"35\"",
            "<limit lower=\"0.1\" upper=\"0.2\" effort=\"35\"",
        );
    for (text, dof) in [
        (weightless, 3),
        (impossible, 3),
        (points, 3),
        (mimics, 2),
        (world, 3),
        (slider, 2),
    ] {
        let model = read(&text);
        assert_eq!(model.skeleton.dof(), dof);
        let dof = model.skeleton.dof();
        let mut made = SimulatedRobot::from_file(&model.into(), &SimSettings::default())
            .unwrap_or_else(|e| panic!("{e}: {text}"));
        let told = Command {
            pose: vec![0.2; dof],
            velocity: vec![0.0; dof],
            acceleration: vec![0.0; dof],
            root: Root::ORIGIN,
            phase: 0.0,
            finished: false,
            limited: 0,
        };
        for _ in 0..60 {
            made.advance(&told, 1.0 / 120.0).expect("stable");
        }
    }
}
