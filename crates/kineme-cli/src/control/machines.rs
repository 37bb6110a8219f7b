//! The robot that a plan moves: simulated where the engine is built in, else where it is told to be.

use std::sync::Arc;

use kineme::control::{KinematicRobot, Robot};
use kineme::{Skeleton, Vocabulary};
use kineme_formats::robot::RobotModel;

use crate::args::ControlArgs;
use crate::bodies::{built_in, is_robot, robot as read};
use crate::failure::Failure;

/// A built-in body, or a robot of a file.
enum Body {
    BuiltIn(Arc<Skeleton>),
    File(Box<RobotModel>),
}

/// The robot of the command line; the vocabulary's body where it names none.
pub fn robot(args: &ControlArgs, vocabulary: &Vocabulary) -> Result<Box<dyn Robot>, Failure> {
    let body = match &args.body {
        Some(name) if is_robot(name) => Body::File(Box::new(read(name)?)),
        Some(name) => Body::BuiltIn(built_in(name)?),
        None => Body::BuiltIn(Arc::clone(vocabulary.body())),
    };
    match args.kinematic {
        true => Ok(Box::new(kinematic(body))),
        false => simulated(args, body),
    }
}

fn kinematic(body: Body) -> KinematicRobot {
    KinematicRobot::new(match body {
        Body::BuiltIn(body) => body,
        Body::File(model) => Arc::new(model.skeleton),
    })
}

#[cfg(feature = "sim")]
fn simulated(args: &ControlArgs, body: Body) -> Result<Box<dyn Robot>, Failure> {
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
    let robot = match body {
        Body::BuiltIn(body) => SimulatedRobot::humanoid(&body, &settings)?,
        Body::File(model) => SimulatedRobot::from_file(&(*model).into(), &settings)?,
    };
    Ok(Box::new(robot))
}

#[cfg(not(feature = "sim"))]
fn simulated(args: &ControlArgs, body: Body) -> Result<Box<dyn Robot>, Failure> {
    const WITH: &str = "`cargo xtask setup` fetches the engine, `cargo install --path crates/kineme-cli --features sim` builds with it";
    if args.servo.is_some() {
        return Err(
            Failure::usage("--servo drives a body in physics, which was not built in").hint(WITH),
        );
    }
    crate::failure::complain(&format!(
        "note: physics was not built in, so the body is where it is told to be; {WITH}"
    ));
    Ok(Box::new(kinematic(body)))
}
