//! Humanoids that move in physics: the bodies of kineme, and robots that MJCF and URDF files describe, in MuJoCo.
//!
//! A [`SimulatedRobot`] takes commands like any [`kineme::control::Robot`], and comes as near to them as its joints'
//! drives allow. [`SimulatedRobot::humanoid`] makes Adonis, Ares or another body, whose model ([`mjcf`]) is made from
//! its skeleton; [`SimulatedRobot::from_file`] a robot of a file. Its root is held: nothing here keeps a balance.
//!
//! The engine knows hinges alone. [`Hinges`] goes between their angles and the coordinates of a body, in which a ball
//! joint is a rotation vector; a ball is a [`Triple`] of hinges in one part. [`Servo`] says how each hinge is driven,
//! [`SimSettings`] everything else.
//!
//! Same commands, same bits, on one thread or many of one machine. A simulation that diverges is an error, before the
//! engine would reset it.
//!
//! ```
//! use std::sync::Arc;
//!
//! use kineme::control::{Inertialization, Robot, State};
//! use kineme::{Root, Synthesizer, adonis};
//! use kineme_sim::{SimSettings, SimulatedRobot};
//!
//! # fn main() -> kineme::Result<()> {
//! let body = Arc::new(adonis()?);
//! let mut robot = SimulatedRobot::humanoid(&body, &SimSettings::default())?;
//!
//! // Sense, decide, command: here the arms are simply to hang.
//! let state = State::resting(body.neutral(), Root::ORIGIN);
//! let mut synthesizer = Synthesizer::new(body, 120.0, &state, Inertialization::default())?;
//! for _ in 0..60 {
//!     robot.advance(synthesizer.step(), 1.0 / 120.0)?;
//! }
//! assert!(robot.sensed().velocity.iter().all(|v| v.abs() < 0.01));
//! # Ok(())
//! # }
//! ```

mod file;
mod hinges;
mod mjcf;
mod plant;
mod robot;
mod settings;
mod triple;

pub use file::RobotFile;
pub use hinges::Hinges;
pub use mjcf::{mjcf, torque_limit};
pub use plant::Plant;
pub use robot::SimulatedRobot;
pub use settings::{Servo, SimSettings};
pub use triple::Triple;
