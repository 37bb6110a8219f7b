//! A real robot's model that does what the vocabularies do.

use std::path::Path;

use kineme::control::{Arbitration, ControlSettings, Controller, Plan, Planned, Robot};
use kineme::interaction::{Performance, Session, SessionSettings, standing};
use kineme::skeleton::JointKind;
use kineme::{Motion, Vocabulary};
use kineme_formats::robot as file;
use kineme_sim::{SimSettings, SimulatedRobot};

use super::tracking::RATE_HZ;
use crate::sets::Result;

/// A simulated robot of an MJCF or URDF file, welded at its base.
///
/// # Errors
/// When the file cannot be read, or the engine refuses it.
pub fn robot(path: &Path) -> Result<SimulatedRobot> {
    let model = file::read(path, None)?;
    Ok(SimulatedRobot::from_file(
        &model.into(),
        &SimSettings::default(),
    )?)
}

/// One primitive after the other on a robot, at the middle of their parameters.
///
/// # Errors
/// When the robot's body shows nothing of them, or the simulation fails.
pub fn routine(
    vocabulary: &Vocabulary,
    primitives: &[&str],
    robot: &mut dyn Robot,
) -> Result<Performance> {
    let mut behaviors = Vec::new();
    let mut at = 0.5;
    for name in primitives {
        let primitive = vocabulary.primitive(name)?;
        let secs = primitive.at(&primitive.middle())?.duration_secs();
        behaviors.push(Planned {
            start_secs: at,
            ..Planned::new(*name)
        });
        // Joining takes less than this from wherever the one before ends.
        at += secs + 1.0;
    }
    let plan = Plan {
        rate_hz: RATE_HZ,
        seconds: at + 0.5,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors,
        rules: Vec::new(),
    };
    let start = standing(vocabulary, &plan)?;
    let controller = Controller::new(vocabulary, &plan, &start, &ControlSettings::default())?;
    let mut session = Session::new(controller, robot, None, &SessionSettings::default())?;
    session.run(None, &mut |_| {})?;
    Ok(session.performance("routine")?)
}

/// By how much hinges were beyond their ranges at most, radians; 0 or less where all were within.
pub fn beyond_limits(done: &Motion) -> f64 {
    let body = done.skeleton();
    let mut beyond = f64::NEG_INFINITY;
    for frame in 0..done.frames() {
        let pose = done.pose(frame);
        for (j, joint) in body.joints().iter().enumerate() {
            if let JointKind::Hinge { range, .. } = &joint.kind {
                let angle = pose[body.coordinates(j).start];
                beyond = beyond.max(angle - range.high).max(range.low - angle);
            }
        }
    }
    beyond
}
