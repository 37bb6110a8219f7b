//! Floor 6: observe, recognise, answer: the one place that sees control and perception both.
//!
//! A [`Session`] runs a plan on a robot, tick by tick: what the robot watches goes through a recogniser, what is announced
//! triggers the plan's rules, what the controller commands goes to the robot, and what the robot feels comes back.

mod performance;
mod session;

pub use performance::{Noticed, Performance, Tracking};
pub use session::{Session, SessionSettings, standing};
