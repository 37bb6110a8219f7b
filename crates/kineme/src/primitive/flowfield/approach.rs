//! [`Approach`]: the way back to the manifold for postures that the field does not vouch for.

use super::field::Flowfield;
use super::flow::FlowState;
use crate::error::Result;

/// Greatest speed of a coordinate on the way, radians a second.
const SPEED: f64 = 4.0;
/// Least duration, seconds.
const LEAST_SECS: f64 = 0.15;
/// Greatest speed of a movement of least jerk, as a multiple of its mean speed (Flash and Hogan 1985).
const PEAK: f64 = 1.875;

/// A movement of least jerk from a posture to an entry of the field, where it ends with the field's velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Approach {
    start: Vec<f64>,
    velocity: Vec<f64>,
    target: FlowState,
    target_velocity: Vec<f64>,
    secs: f64,
}

impl Flowfield {
    /// The way from a moving posture to the nearest entry of the field: the primitive's own posture there, so that
    /// following the field from [`Approach::target`] goes on without a jump in posture or velocity. No coordinate is
    /// asked to go faster than 4 rad/s by it.
    ///
    /// # Errors
    /// As [`Self::enter`].
    pub fn approach(&self, pose: &[f64], velocity: &[f64]) -> Result<Approach> {
        let start = self.enter_moving(pose, velocity)?;
        let nearest = self.update(&start).nearest;
        let target = self.enter_at(&nearest, start.phase)?;
        let target_velocity = self.update(&target).velocity;
        let pairs = start.pose.iter().zip(&target.pose);
        let farthest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        Ok(Approach {
            start: start.pose,
            velocity: velocity.to_vec(),
            target,
            target_velocity,
            secs: (PEAK * farthest / SPEED).max(LEAST_SECS),
        })
    }
}

impl Approach {
    /// How long it takes, seconds.
    pub fn duration_secs(&self) -> f64 {
        self.secs
    }

    /// The state in which it ends.
    pub fn target(&self) -> &FlowState {
        &self.target
    }

    /// The posture so many seconds after its start: the polynomial of the fifth degree with the velocities of both ends
    /// and no acceleration there.
    pub fn pose(&self, secs: f64) -> Vec<f64> {
        let s = (secs / self.secs).clamp(0.0, 1.0);
        let (s3, s4, s5) = (s.powi(3), s.powi(4), s.powi(5));
        let ends = self.start.iter().zip(&self.target.pose);
        let velocities = self.velocity.iter().zip(&self.target_velocity);
        ends.zip(velocities)
            .map(|((x0, x1), (v0, v1))| {
                let (way, v0, v1) = (x1 - x0, v0 * self.secs, v1 * self.secs);
                x0 + v0 * s
                    + (10.0 * way - 6.0 * v0 - 4.0 * v1) * s3
                    + (-15.0 * way + 8.0 * v0 + 7.0 * v1) * s4
                    + (6.0 * way - 3.0 * v0 - 3.0 * v1) * s5
            })
            .collect()
    }
}
