//! [`SimSettings`]: what a simulation needs to know besides the body.

use kineme::{Error, Result, Skeleton};

/// How a joint is driven toward its command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Servo {
    /// Proportional and derivative feedback, `kp (q_d - q) + kv (q'_d - q')`, its damping integrated implicitly: the
    /// law of the paper's Adonis. It lags where a movement accelerates, and droops under weight.
    Pd,
    /// Inverse dynamics of what is commanded, and that feedback besides: the law of the paper's Ares.
    FeedforwardFeedback,
    /// Inverse dynamics at the body's own state of the commanded acceleration with the errors fed back into it.
    ComputedTorque,
}

impl Servo {
    /// The law that a body has by default: PD on Adonis, feedforward and feedback on every other.
    pub fn of(body: &Skeleton) -> Self {
        if body.name() == "adonis" {
            Servo::Pd
        } else {
            Servo::FeedforwardFeedback
        }
    }
}

/// How a body is simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct SimSettings {
    /// Longest step of the physics, seconds; a tick of control is divided into equal steps.
    pub step_secs: f64,
    /// How joints are driven; `None`: as [`Servo::of`] the body says.
    pub servo: Option<Servo>,
    /// Natural frequency of the driven joints, hertz: `kp = M_ii w^2` with `w = 2 pi f`.
    pub frequency_hz: f64,
    /// Their damping ratio: `kv = 2 zeta M_ii w`.
    pub damping_ratio: f64,
    /// Inertia of each hinge's drive, kg m^2. It steadies joints that carry little: fingers, hands, vertebrae.
    pub armature: f64,
    /// Whether drives are only as strong as [`crate::torque_limit`] or the robot's own file says.
    pub torque_limits: bool,
    /// Whether hinges end at the limits of the body, or at those of the robot's own file.
    pub joint_limits: bool,
    /// Whether parts collide that a robot's own MJCF file lets collide. Generated bodies and robots of URDF files have no
    /// parts that do.
    pub contacts: bool,
}

impl Default for SimSettings {
    fn default() -> Self {
        Self {
            step_secs: 0.001,
            servo: None,
            frequency_hz: 8.0,
            damping_ratio: 1.0,
            armature: 0.005,
            torque_limits: true,
            joint_limits: true,
            contacts: false,
        }
    }
}

impl SimSettings {
    /// # Errors
    /// When the step, the frequency or the damping ratio is not positive, or the armature negative.
    pub(crate) fn check(&self) -> Result<()> {
        let positive = [
            ("a step of the physics", self.step_secs),
            ("the natural frequency of a joint", self.frequency_hz),
            ("the damping ratio of a joint", self.damping_ratio),
        ];
        for (what, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::invalid(format!(
                    "{what} must be positive, found {value}"
                )));
            }
        }
        if !(self.armature.is_finite() && self.armature >= 0.0) {
            return Err(Error::invalid(format!(
                "an armature must not be negative, found {}",
                self.armature
            )));
        }
        Ok(())
    }
}
