//! Bodies that are pushed, or begin anywhere: whether they come back, and whether the movement completes.

use std::sync::Arc;

use kineme::control::{Arbitration, ControlSettings, Controller, Plan, Planned, Robot, State};
use kineme::math::rotation::exp;
use kineme::{Root, Skeleton, Vocabulary};
use kineme_sim::SimulatedRobot;
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;

use super::tracking::RATE_HZ;
use crate::sets::Result;

/// How hard and how long is pushed: newtons, seconds.
const PUSH_NEWTONS: f64 = 50.0;
const PUSH_SECS: f64 = 0.1;
/// What may be left of a push (radians, any joint) ...
pub const BACK_RAD: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// ... so long after its end, seconds.
pub const BACK_SECS: f64 = 0.5;
/// Seconds given to a movement beyond its own.
const PATIENCE_SECS: f64 = 4.0;

/// A joint whose coordinates change by less is not moved by a primitive, radians.
const MOVES_RAD: f64 = 0.02;

/// A plan of one primitive on all that it moves.
fn alone(primitive: &str, seconds: f64) -> Plan {
    Plan {
        rate_hz: RATE_HZ,
        seconds,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors: vec![Planned::new(primitive)],
        rules: Vec::new(),
    }
}

/// What came of a push.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pushed {
    /// How far a joint was turned away from where it would have been at most, radians.
    pub away_rad: f64,
    /// How far any joint still is half a second after the push, radians.
    pub left_rad: f64,
    /// Whether the movement came to its end.
    pub completed: bool,
}

/// Pushes a wrist sideways at a phase of a primitive's movement and compares with the same movement unpushed.
///
/// # Errors
/// When the simulation fails.
pub fn pushed(
    robot: &mut SimulatedRobot,
    vocabulary: &Vocabulary,
    primitive: &str,
    wrist: &str,
    phase: f64,
) -> Result<Pushed> {
    let own = vocabulary.primitive(primitive)?;
    let course = own.at(&own.middle())?;
    let start = State::resting(course.pose(0.0), Root::ORIGIN);
    let plan = alone(primitive, course.duration_secs() + PATIENCE_SECS);
    let body = Arc::clone(vocabulary.body());
    let settings = ControlSettings::default();
    let mut run = |push: bool| -> Result<(Vec<Vec<f64>>, bool, usize)> {
        let mut controller = Controller::new(vocabulary, &plan, &start, &settings)?;
        let first = controller.command().clone();
        robot.reset(&first.pose, &first.velocity)?;
        let (mut poses, mut at, mut given) = (Vec::new(), 0, false);
        while !controller.finished() {
            let sensed = robot.sensed().clone();
            let command = controller.tick(Some(&sensed), None).clone();
            if !given && command.phase >= phase {
                (given, at) = (true, poses.len());
                if push {
                    robot.push(wrist, Vector3::new(0.0, PUSH_NEWTONS, 0.0), PUSH_SECS)?;
                }
            }
            robot.advance(&command, 1.0 / RATE_HZ)?;
            poses.push(robot.sensed().pose.clone());
        }
        let completed = controller.ran().iter().any(|ran| ran.completed);
        Ok((poses, completed, at))
    };
    let (quiet, _, _) = run(false)?;
    let (moved, completed, at) = run(true)?;
    // A pushed flow may wait: what counts is how near the body is to where the movement passes.
    let window = (0.3 * RATE_HZ) as usize;
    let apart = |frame: usize| -> f64 {
        let last = quiet.len() - 1;
        (frame.saturating_sub(window)..=(frame + window).min(last))
            .map(|k| farthest(&body, &moved[frame.min(last)], &quiet[k]))
            .fold(f64::INFINITY, f64::min)
    };
    let after = at + ((PUSH_SECS + BACK_SECS) * RATE_HZ).ceil() as usize;
    let away = (at..after).map(|k| farthest(&body, &moved[k], &quiet[k]));
    Ok(Pushed {
        away_rad: away.fold(0.0, f64::max),
        left_rad: apart(after),
        completed,
    })
}

/// The greatest angle between joints of two postures, radians.
fn farthest(body: &Skeleton, one: &[f64], other: &[f64]) -> f64 {
    let joints = (0..body.joints().len()).filter(|&j| !body.coordinates(j).is_empty());
    joints
        .map(|j| {
            let at = body.coordinates(j);
            let turn = body.rotation(j, &one[at.clone()]);
            turn.angle_to(&body.rotation(j, &other[at]))
        })
        .fold(0.0, f64::max)
}

/// Whether a primitive that begins in a posture reaches its flow and completes: how far (radians) any joint that it
/// moves is from the end of its course then, `None` when it did not complete.
///
/// # Errors
/// When the simulation fails.
pub fn begun(
    robot: &mut dyn Robot,
    vocabulary: &Vocabulary,
    primitive: &str,
    posture: &[f64],
) -> Result<Option<f64>> {
    let own = vocabulary.primitive(primitive)?;
    let course = own.at(&own.middle())?;
    let plan = alone(primitive, course.duration_secs() + PATIENCE_SECS);
    let start = State::resting(posture.to_vec(), Root::ORIGIN);
    let mut controller = Controller::new(vocabulary, &plan, &start, &ControlSettings::default())?;
    let first = controller.command().clone();
    robot.reset(&first.pose, &first.velocity)?;
    while !controller.finished() {
        let sensed = robot.sensed().clone();
        let command = controller.tick(Some(&sensed), None).clone();
        robot.advance(&command, 1.0 / RATE_HZ)?;
    }
    let completed = controller.ran().iter().any(|ran| ran.completed);
    let body = vocabulary.body();
    let [start, early, late, end] = [0.0, 0.3, 0.6, 1.0].map(|phase| course.pose(phase));
    let moves = |c: usize| {
        let from = |pose: &Vec<f64>| (pose[c] - start[c]).abs() > MOVES_RAD;
        [&early, &late, &end].into_iter().any(from)
    };
    let moved = (0..body.joints().len()).filter(|&j| body.coordinates(j).any(moves));
    let done = &robot.sensed().pose;
    let off = moved.map(|j| {
        let at = body.coordinates(j);
        let there = body.rotation(j, &end[at.clone()]);
        there.angle_to(&body.rotation(j, &done[at]))
    });
    Ok(completed.then(|| off.fold(0.0, f64::max)))
}

/// A posture in which every joint is somewhere within its limits.
pub fn posture(body: &Skeleton, random: &mut Pcg64) -> Vec<f64> {
    let mut pose = body.neutral();
    for (j, joint) in body.joints().iter().enumerate() {
        let at = body.coordinates(j);
        match body.limits(j) {
            [one] => pose[at.start] = random.random_range(one.low..one.high),
            ranges @ [_, _, _] => {
                let axes = [joint.axes.flexion, joint.axes.abduction, joint.axes.axial];
                let turn: Vector3<f64> = axes
                    .iter()
                    .zip(ranges)
                    .map(|(axis, range)| axis * random.random_range(range.low..range.high))
                    .sum();
                // The box of a shoulder has corners beyond half a turn, which no pose has.
                let turn = kineme::math::rotation::log(&exp(&turn));
                pose[at].copy_from_slice(turn.as_slice());
            }
            _ => {}
        }
    }
    body.limited(&mut pose);
    pose
}
