//! [`Robot`]: what takes commands and moves; [`KinematicRobot`], which is always where it is told to be.

use std::sync::Arc;

use super::command::Command;
use crate::error::{Error, Result};
use crate::skeleton::Skeleton;

/// What a body feels of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensed {
    /// Joint coordinates, radians.
    pub pose: Vec<f64>,
    /// Their velocities, radians a second; of a ball, those of its rotation vector.
    pub velocity: Vec<f64>,
}

/// How hard a robot's joints had to work since it was reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effort {
    /// How many joint torques were at their limit ...
    pub saturated: u64,
    /// ... of how many; 0 where nothing has torques.
    pub torques: u64,
}

/// A body that takes commands: simulated, real, or merely drawn.
pub trait Robot {
    /// The body whose coordinates it understands.
    fn body(&self) -> &Arc<Skeleton>;

    /// Whether forces move it: then it comes near to what it is told, no more.
    fn is_physical(&self) -> bool;

    /// Puts it into a posture (radians) that moves so (radians a second), its effort forgotten.
    ///
    /// # Errors
    /// For coordinates of another body, or not finite.
    fn reset(&mut self, pose: &[f64], velocity: &[f64]) -> Result<()>;

    /// What it felt after the last [`Self::reset`] or [`Self::advance`].
    fn sensed(&self) -> &Sensed;

    /// Moves for `secs` toward a command that holds at their end; on the way it goes on from the command before.
    ///
    /// # Errors
    /// For a command of another body or seconds that are not positive; when a simulation diverges.
    fn advance(&mut self, command: &Command, secs: f64) -> Result<()>;

    /// How hard its joints had to work.
    fn effort(&self) -> Effort;
}

/// A robot without mass: it takes every command at once and exactly.
#[derive(Debug, Clone)]
pub struct KinematicRobot {
    body: Arc<Skeleton>,
    sensed: Sensed,
}

impl KinematicRobot {
    /// A robot of this body in its neutral pose, at rest.
    pub fn new(body: Arc<Skeleton>) -> Self {
        let sensed = Sensed {
            pose: body.neutral(),
            velocity: vec![0.0; body.dof()],
        };
        Self { body, sensed }
    }

    fn take(&mut self, pose: &[f64], velocity: &[f64]) -> Result<()> {
        let dof = self.body.dof();
        let finite = |values: &[f64]| values.len() == dof && values.iter().all(|v| v.is_finite());
        if !finite(pose) || !finite(velocity) {
            return Err(Error::invalid(format!(
                "`{}` is moved by {dof} finite coordinates and velocities, found {} and {}",
                self.body.name(),
                pose.len(),
                velocity.len()
            )));
        }
        self.sensed.pose.copy_from_slice(pose);
        self.sensed.velocity.copy_from_slice(velocity);
        Ok(())
    }
}

impl Robot for KinematicRobot {
    fn body(&self) -> &Arc<Skeleton> {
        &self.body
    }

    fn is_physical(&self) -> bool {
        false
    }

    fn reset(&mut self, pose: &[f64], velocity: &[f64]) -> Result<()> {
        self.take(pose, velocity)
    }

    fn sensed(&self) -> &Sensed {
        &self.sensed
    }

    fn advance(&mut self, command: &Command, secs: f64) -> Result<()> {
        if !(secs.is_finite() && secs > 0.0) {
            return Err(Error::invalid(format!(
                "a robot moves for a positive time, found {secs} s"
            )));
        }
        self.take(&command.pose, &command.velocity)
    }

    fn effort(&self) -> Effort {
        Effort::default()
    }
}
