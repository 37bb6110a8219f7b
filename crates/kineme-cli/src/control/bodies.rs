//! The body that a plan moves: simulated where the engine is built in, else where it is told to be.

use std::sync::Arc;

use kineme::control::{KinematicRobot, Robot};
use kineme::{Skeleton, Vocabulary};

use crate::args::ControlArgs;
use crate::failure::Failure;
#[cfg(not(feature = "sim"))]
use crate::failure::complain;
use crate::source::body;

/// The robot of the command line.
pub fn robot(args: &ControlArgs, vocabulary: &Vocabulary) -> Result<Box<dyn Robot>, Failure> {
    let body = match &args.body {
        Some(name) => body(name)?,
        None => Arc::clone(vocabulary.body()),
    };
    match args.kinematic {
        true => Ok(Box::new(KinematicRobot::new(body))),
        false => simulated(args, body),
    }
}

#[cfg(feature = "sim")]
fn simulated(args: &ControlArgs, body: Arc<Skeleton>) -> Result<Box<dyn Robot>, Failure> {
    use crate::args::ServoName;
    use kineme_sim::{Servo, SimSettings, SimulatedRobot};
    let settings = SimSettings {
        servo: args.servo.map(|servo| match servo {
            ServoName::Pd => Servo::Pd,
            ServoName::Feedforward => Servo::FeedforwardFeedback,
            ServoName::ComputedTorque => Servo::ComputedTorque,
        }),
        ..SimSettings::default()
    };
    Ok(Box::new(SimulatedRobot::humanoid(&body, &settings)?))
}

#[cfg(not(feature = "sim"))]
fn simulated(args: &ControlArgs, body: Arc<Skeleton>) -> Result<Box<dyn Robot>, Failure> {
    if args.servo.is_some() {
        return Err(Failure::usage("--servo drives a body in physics").hint(WITH_PHYSICS));
    }
    complain(&format!(
        "note: this kineme was built without physics: the body is where it is told to be; {WITH_PHYSICS}"
    ));
    Ok(Box::new(KinematicRobot::new(body)))
}

#[cfg(not(feature = "sim"))]
const WITH_PHYSICS: &str = "`cargo xtask setup` fetches the engine, `cargo build --release -p kineme-cli --features sim` builds with it";
