//! How near simulated bodies come to what they are told.

use std::f64::consts::TAU;
use std::sync::Arc;

use kineme::control::{Command, Inertialization, Manner, Robot, State};
use kineme::{Course, Root, Skeleton, Synthesizer};
use kineme_sim::{Servo, SimSettings, SimulatedRobot};

use crate::sets::Result;

/// Ticks of control a second.
pub const RATE_HZ: f64 = 120.0;
/// The first of a swing is not judged, seconds.
const SETTLING_SECS: f64 = 0.5;
/// Half the width of a swing, radians; it takes a second.
const SWING_RAD: f64 = 0.5;

/// Angles between what was told and what was done.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    squares: f64,
    count: usize,
    /// The greatest, radians.
    pub max_rad: f64,
}

impl Errors {
    /// Root mean square, radians.
    pub fn rms_rad(&self) -> f64 {
        (self.squares / self.count.max(1) as f64).sqrt()
    }

    fn add(&mut self, angle: f64) {
        self.squares += angle * angle;
        self.count += 1;
        self.max_rad = self.max_rad.max(angle.abs());
    }

    /// Both together.
    pub fn and(self, other: Errors) -> Errors {
        Errors {
            squares: self.squares + other.squares,
            count: self.count + other.count,
            max_rad: self.max_rad.max(other.max_rad),
        }
    }
}

/// Every hinge swings by half a radian to both sides once a second, each in a phase of its own, about the neutral
/// posture, limits of joints and torques off: the angles of hinges after the first half second.
///
/// # Errors
/// When the simulation fails.
pub fn swinging(body: &Arc<Skeleton>, servo: Servo, secs: f64) -> Result<Errors> {
    let settings = SimSettings {
        servo: Some(servo),
        torque_limits: false,
        joint_limits: false,
        ..SimSettings::default()
    };
    let mut robot = SimulatedRobot::humanoid(body, &settings)?;
    let hinges = robot.hinges().clone();
    let middle = robot.plant().angles().to_vec();
    let swing = |secs: f64| -> (Vec<f64>, Vec<f64>) {
        // Phases of the golden ratio: as even as can be, for any number of hinges.
        let phase = |i: usize| TAU * (secs + (0.618_033_988_749_895 * i as f64).fract());
        let angle = |(i, m): (usize, &f64)| m + SWING_RAD * phase(i).sin();
        let rate = |i: usize| SWING_RAD * TAU * phase(i).cos();
        (
            middle.iter().enumerate().map(angle).collect(),
            (0..middle.len()).map(rate).collect(),
        )
    };
    let (mut pose, mut velocity) = (body.neutral(), vec![0.0; body.dof()]);
    let mut told = |secs: f64| {
        let (angles, rates) = swing(secs);
        hinges.pose(&angles, &rates, &mut pose, &mut velocity);
        Command {
            acceleration: vec![0.0; pose.len()],
            pose: pose.clone(),
            velocity: velocity.clone(),
            root: Root::ORIGIN,
            phase: 0.0,
            finished: false,
            limited: 0,
        }
    };
    let start = told(0.0);
    robot.reset(&start.pose, &start.velocity)?;
    let mut errors = Errors::default();
    for tick in 1..=(secs * RATE_HZ) as usize {
        let now = tick as f64 / RATE_HZ;
        robot.advance(&told(now), 1.0 / RATE_HZ)?;
        if now >= SETTLING_SECS {
            let wanted = swing(now).0;
            let off = wanted.iter().zip(robot.plant().angles());
            off.for_each(|(a, b)| errors.add(a - b));
        }
    }
    Ok(errors)
}

/// A course from its own beginning to its end: rotation angles of joints that move, limits on.
///
/// # Errors
/// When the robot is of another body, or the simulation fails.
pub fn performing(robot: &mut dyn Robot, course: &Arc<Course>) -> Result<Errors> {
    let body = Arc::clone(course.body());
    let start = State::resting(course.pose(0.0), Root::ORIGIN);
    let mut synthesizer = Synthesizer::new(
        Arc::clone(&body),
        RATE_HZ,
        &start,
        Inertialization::default(),
    )?;
    let first = synthesizer.command().clone();
    robot.reset(&first.pose, &first.velocity)?;
    synthesizer.start(Arc::clone(course), &Manner::default())?;
    let mut errors = Errors::default();
    while !synthesizer.command().finished {
        let told = synthesizer.step();
        robot.advance(told, 1.0 / RATE_HZ)?;
        let done = &robot.sensed().pose;
        for joint in 0..body.joints().len() {
            let at = body.coordinates(joint);
            if !at.is_empty() {
                let told = body.rotation(joint, &told.pose[at.clone()]);
                errors.add(told.angle_to(&body.rotation(joint, &done[at])));
            }
        }
    }
    Ok(errors)
}
