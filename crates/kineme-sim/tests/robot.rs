//! What a simulated robot does besides following: it is deterministic, weak where it is meant to be, can be pushed, and
//! owns up to having diverged.

use std::path::Path;
use std::sync::Arc;

use kineme::control::{Command, Robot};
use kineme::{Result, Root, Skeleton};
use kineme_sim::{Servo, SimSettings, SimulatedRobot};
use nalgebra::Vector3;

const TICK: f64 = 1.0 / 120.0;

fn adonis() -> Arc<Skeleton> {
    Arc::new(kineme::adonis().expect("adonis"))
}

fn robot(body: &Arc<Skeleton>, settings: &SimSettings) -> SimulatedRobot {
    SimulatedRobot::humanoid(body, settings).expect("a robot")
}

fn resting(pose: &[f64]) -> Command {
    Command {
        pose: pose.to_vec(),
        velocity: vec![0.0; pose.len()],
        acceleration: vec![0.0; pose.len()],
        root: Root::ORIGIN,
        phase: 0.0,
        finished: true,
        limited: 0,
    }
}

/// The neutral posture with the coordinates of some joints changed.
fn posture(body: &Skeleton, changes: &[(&str, &[f64])]) -> Vec<f64> {
    let mut pose = body.neutral();
    for (name, values) in changes {
        let at = body.coordinates(body.joint(name).expect("a joint"));
        pose[at].copy_from_slice(values);
    }
    pose
}

fn hold(robot: &mut SimulatedRobot, pose: &[f64], secs: f64) -> Result<()> {
    let command = resting(pose);
    for _ in 0..(secs / TICK).round() as usize {
        robot.advance(&command, TICK)?;
    }
    Ok(())
}

/// The greatest angle (radians) between a joint of one posture and of another.
fn apart(body: &Skeleton, one: &[f64], other: &[f64]) -> f64 {
    (0..body.joints().len())
        .map(|j| {
            let at = body.coordinates(j);
            let rotation = body.rotation(j, &one[at.clone()]);
            rotation.angle_to(&body.rotation(j, &other[at]))
        })
        .fold(0.0, f64::max)
}

#[test]
fn the_same_commands_give_the_same_bits_on_any_thread() {
    let run = || {
        let body = Arc::new(kineme::ares().expect("ares"));
        let mut robot = robot(&body, &SimSettings::default());
        let raised = posture(&body, &[("left_shoulder", &[0.2, 0.3, 0.1])]);
        robot
            .push("right_hand", Vector3::new(20.0, 0.0, 5.0), 0.05)
            .expect("a push");
        hold(&mut robot, &raised, 0.2).expect("stable");
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        (bits(&robot.sensed().pose), bits(&robot.sensed().velocity))
    };
    let threads = [std::thread::spawn(run), std::thread::spawn(run)];
    let alone = run();
    for thread in threads {
        assert_eq!(thread.join().expect("a run"), alone);
    }
}

#[test]
fn a_simulation_that_diverges_is_an_error_and_leaves_no_file() {
    let body = adonis();
    let absurd = SimSettings {
        servo: Some(Servo::ComputedTorque),
        frequency_hz: 4000.0,
        torque_limits: false,
        ..SimSettings::default()
    };
    let raised = posture(&body, &[("left_elbow", &[1.5])]);
    let error = hold(&mut robot(&body, &absurd), &raised, 2.0).expect_err("diverged");
    assert!(error.to_string().contains("diverged"), "{error}");

    let free = SimSettings {
        torque_limits: false,
        joint_limits: false,
        ..SimSettings::default()
    };
    let beyond = posture(&body, &[("left_elbow", &[1e5])]);
    let error = hold(&mut robot(&body, &free), &beyond, 2.0).expect_err("diverged");
    assert!(error.to_string().contains("diverged"), "{error}");
    assert!(!Path::new("MUJOCO_LOG.TXT").exists());
}

#[test]
fn what_is_no_command_is_refused() {
    let body = adonis();
    let mut robot = robot(&body, &SimSettings::default());
    let mut bad = resting(&body.neutral());
    bad.pose[3] = f64::NAN;
    assert!(robot.advance(&bad, TICK).is_err_and(|e| e.is_invalid()));
    bad.pose.pop();
    assert!(robot.advance(&bad, TICK).is_err_and(|e| e.is_invalid()));
    let good = resting(&body.neutral());
    for secs in [0.0, -1.0, f64::NAN] {
        assert!(robot.advance(&good, secs).is_err_and(|e| e.is_invalid()));
    }
    let force = Vector3::x();
    assert!(
        robot
            .push("left_wing", force, 0.1)
            .is_err_and(|e| e.is_unknown_name())
    );
    assert!(
        robot
            .push("left_hand", force, 0.0)
            .is_err_and(|e| e.is_invalid())
    );
    for settings in [
        SimSettings {
            step_secs: 0.0,
            ..SimSettings::default()
        },
        SimSettings {
            frequency_hz: f64::NAN,
            ..SimSettings::default()
        },
        SimSettings {
            damping_ratio: -1.0,
            ..SimSettings::default()
        },
        SimSettings {
            armature: -0.1,
            ..SimSettings::default()
        },
    ] {
        assert!(SimulatedRobot::humanoid(&body, &settings).is_err_and(|e| e.is_invalid()));
    }
}

#[test]
fn torques_end_at_their_limit_and_are_counted() {
    let body = adonis();
    let mut robot = robot(&body, &SimSettings::default());
    hold(&mut robot, &body.neutral(), 0.5).expect("stable");
    let still = robot.effort();
    assert_eq!((still.saturated, still.torques), (0, 60 * 9 * 20));
    // Both arms up at once, in one tick: more than an arm can do.
    let up = posture(
        &body,
        &[
            ("left_shoulder", &[0.0, -1.5, 0.0]),
            ("right_shoulder", &[0.0, -1.5, 0.0]),
        ],
    );
    hold(&mut robot, &up, 1.5).expect("stable");
    let jumped = robot.effort();
    assert!(jumped.saturated > 0);
    assert!(
        apart(&body, &robot.sensed().pose, &up) < 3.0_f64.to_radians(),
        "it arrives in the end"
    );
    robot
        .reset(&body.neutral(), &vec![0.0; body.dof()])
        .expect("reset");
    assert_eq!(robot.effort(), kineme::control::Effort::default());
}

#[test]
fn a_hinge_stops_at_its_limit() {
    let body = adonis();
    let elbow = body.joint("left_elbow").expect("an elbow");
    let most = body.limits(elbow)[0].high;
    let at = body.coordinates(elbow).start;
    let beyond = posture(&body, &[("left_elbow", &[most + 0.3])]);
    for (limits, inside) in [(true, true), (false, false)] {
        let settings = SimSettings {
            joint_limits: limits,
            ..SimSettings::default()
        };
        let mut robot = robot(&body, &settings);
        hold(&mut robot, &beyond, 1.0).expect("stable");
        let angle = robot.sensed().pose[at];
        assert_eq!(
            angle < most + 0.1,
            inside,
            "{angle} of {most}, limits {limits}"
        );
    }
}

/// A wrist that is pushed goes along with the push, and comes back when it is over.
#[test]
fn a_push_is_felt_and_over() {
    for (body, servo) in [
        (adonis(), Servo::Pd),
        (
            Arc::new(kineme::ares().expect("ares")),
            Servo::FeedforwardFeedback,
        ),
    ] {
        let settings = SimSettings {
            servo: Some(servo),
            ..SimSettings::default()
        };
        let mut robot = robot(&body, &settings);
        let pose = body.neutral();
        hold(&mut robot, &pose, 0.5).expect("stable");
        let rest = robot.sensed().pose.clone();
        let hand = |robot: &SimulatedRobot| {
            let places = body.effector_positions(&robot.sensed().pose, &Root::ORIGIN);
            let i = body.effectors().iter().position(|e| e.name == "right_hand");
            places[i.expect("a hand")]
        };
        let before = hand(&robot);
        let force = Vector3::new(50.0, 0.0, 0.0);
        robot.push("right_hand", force, 0.1).expect("a push");
        hold(&mut robot, &pose, 0.1).expect("stable");
        let moved = hand(&robot) - before;
        assert!(moved.x > 0.01 && moved.x > 2.0 * moved.y.abs(), "{moved:?}");
        hold(&mut robot, &pose, 0.5).expect("stable");
        let left = apart(&body, &robot.sensed().pose, &rest).to_degrees();
        assert!(left < 1.0, "{}: {left} degrees", body.name());
    }
}
