//! Humanoids that move in physics: the bodies of kineme and robots from MJCF files, in MuJoCo.

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
pub use plant::{Plant, Target};
pub use robot::SimulatedRobot;
pub use settings::{Servo, SimSettings};
pub use triple::Triple;
