//! [`Command`]: what a body is to do now.

use nalgebra::Vector3;

use super::state::Moving;
use crate::skeleton::{Root, Skeleton};

/// Seconds over which the limits' effect on velocities is taken.
const SLOPE_SECS: f64 = 1e-5;

/// What a body is to do now.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Joint coordinates, radians, within the body's limits.
    pub pose: Vec<f64>,
    /// Their velocities, radians a second.
    pub velocity: Vec<f64>,
    /// Their mean accelerations over the step that led here, radians a second squared.
    pub acceleration: Vec<f64>,
    /// Where the body stands.
    pub root: Root,
    /// The phase of the course in [0, 1]; 0 before the first.
    pub phase: f64,
    /// Whether the course has come to its end and the body with it, or none was begun. The last posture is held.
    pub finished: bool,
    /// How many coordinates the joint limits hold back.
    pub limited: usize,
}

impl Command {
    /// Moves the root for a step of `secs` by the mean of its velocities before and after, along the heading in its
    /// middle.
    pub(super) fn travel(&mut self, before: [f64; 3], now: &Moving, secs: f64) {
        let after = now.travel;
        let mean = |i: usize| 0.5 * (before[i] + after[i]) * secs;
        let (forward, left, turn) = (mean(0), mean(1), mean(2));
        let root = &mut self.root;
        let (sine, cosine) = (root.yaw + 0.5 * turn).sin_cos();
        root.position += Vector3::new(
            forward * cosine - left * sine,
            forward * sine + left * cosine,
            0.0,
        );
        root.position.z = now.values[self.pose.len()];
        root.yaw += turn;
    }

    /// Writes what the body is to do now, within its limits.
    pub(super) fn emit(&mut self, body: &Skeleton, now: &Moving, rate_hz: f64) {
        let dof = body.dof();
        let (pose, velocity) = (&now.values[..dof], &now.velocities[..dof]);
        self.pose.copy_from_slice(pose);
        self.limited = body.limited(&mut self.pose);
        for (a, v) in self.acceleration.iter_mut().zip(&self.velocity) {
            *a = -v;
        }
        self.velocity.copy_from_slice(velocity);
        if self.limited > 0 {
            let moved = |secs: f64| {
                let pairs = pose.iter().zip(velocity);
                let mut moved: Vec<f64> = pairs.map(|(x, v)| x + v * secs).collect();
                body.limited(&mut moved);
                moved
            };
            let (before, after) = (moved(-SLOPE_SECS), moved(SLOPE_SECS));
            for c in 0..dof {
                if self.pose[c] != pose[c] {
                    self.velocity[c] = (after[c] - before[c]) / (2.0 * SLOPE_SECS);
                }
            }
        }
        for (a, v) in self.acceleration.iter_mut().zip(&self.velocity) {
            *a = (*a + v) * rate_hz;
        }
    }
}
