//! How fast it goes: physics beside real time, and our own work of a tick.

use std::sync::Arc;
use std::time::Instant;

use kineme::control::{
    Arbitration, ControlSettings, Controller, KinematicRobot, Plan, Planned, Robot,
};
use kineme::interaction::standing;
use kineme::math::statistics::quantile;
use kineme::{Skeleton, Vocabulary};
use kineme_sim::{SimSettings, SimulatedRobot};

use super::tracking::RATE_HZ;
use crate::choreographies::everything;
use crate::sets::Result;

/// Seconds of movement that are timed.
const SECONDS: f64 = 20.0;

/// Times of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speed {
    /// Seconds of movement in a second of time, physics included, from the median tick.
    pub real_time_factor: f64,
    /// Our own work of a tick, microseconds: median, 99th percentile, greatest.
    pub tick_us: [f64; 3],
}

/// Three behaviours that share a body: waves, a twist, and jabs that interrupt them.
fn busy(seconds: f64) -> Plan {
    let on = |primitive: &str, joints: &[&str], priority: i32| Planned {
        joints: joints.iter().map(|j| (*j).into()).collect(),
        repeat: 100,
        priority,
        ..Planned::new(primitive)
    };
    Plan {
        rate_hz: RATE_HZ,
        seconds,
        arbitration: Arbitration::Superposition,
        observed: None,
        behaviors: vec![
            on("wave-up", &["right_arm"], 0),
            on("twist-left", &["trunk", "head"], 0),
            on("jab", &["left_arm"], 0),
        ],
        rules: Vec::new(),
    }
}

/// Times a body, on one thread.
///
/// # Errors
/// When the simulation fails.
pub fn speed(body: &Arc<Skeleton>) -> Result<Speed> {
    let vocabulary = everything(body)?;
    let mut simulated = SimulatedRobot::humanoid(body, &SimSettings::default())?;
    let mut kinematic = KinematicRobot::new(Arc::clone(body));
    let (own, _) = timed(&vocabulary, &mut kinematic)?;
    let (ours, physics) = timed(&vocabulary, &mut simulated)?;
    let both: Vec<f64> = ours.iter().zip(&physics).map(|(a, b)| a + b).collect();
    let us = |p: f64| 1e6 * quantile(&own, p).unwrap_or(f64::NAN);
    Ok(Speed {
        real_time_factor: 1.0 / (RATE_HZ * quantile(&both, 0.5).unwrap_or(f64::NAN)),
        tick_us: [us(0.5), us(0.99), us(1.0)],
    })
}

/// Seconds of each tick, of the controller and of the robot.
fn timed(vocabulary: &Vocabulary, robot: &mut dyn Robot) -> Result<(Vec<f64>, Vec<f64>)> {
    let plan = busy(SECONDS);
    let start = standing(vocabulary, &plan)?;
    let mut controller = Controller::new(vocabulary, &plan, &start, &ControlSettings::default())?;
    let first = controller.command().clone();
    robot.reset(&first.pose, &first.velocity)?;
    let (mut ours, mut physics) = (Vec::new(), Vec::new());
    while !controller.finished() {
        let sensed = robot.sensed().clone();
        let begun = Instant::now();
        let command = controller.tick(Some(&sensed), None);
        ours.push(begun.elapsed().as_secs_f64());
        let begun = Instant::now();
        robot.advance(command, 1.0 / RATE_HZ)?;
        physics.push(begun.elapsed().as_secs_f64());
    }
    Ok((ours, physics))
}
