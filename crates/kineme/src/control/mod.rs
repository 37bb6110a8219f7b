//! Floor 5: moving a body: along courses, from any posture and without a jump; and by behaviours that share it.

mod arbiter;
mod behavior;
mod clock;
mod command;
mod connection;
mod controller;
mod entry;
mod feedback;
mod manner;
mod mask;
mod offset;
mod plan;
mod robot;
mod state;
mod synthesis;
mod synthesizer;
mod transition;

pub use command::Command;
pub use connection::{Connection, Effect, Percept};
pub use controller::{Active, ControlSettings, Controller, Ran};
pub use entry::Entry;
pub use feedback::Feedback;
pub use manner::{Manner, Pace};
pub use offset::Inertialization;
pub use plan::{Aiming, Arbitration, Fault, Place, Plan, Planned, Rule};
pub use robot::{Effort, KinematicRobot, Robot, Sensed};
pub use state::State;
pub use synthesis::{Synthesis, Synthesized};
pub use synthesizer::Synthesizer;
