//! [`Plant`]: a model in the physics engine, its drives, and one step of both.

use kineme::control::Effort;
use kineme::{Error, Result};
use mujoco_rs::prelude::{MjData, MjModel, MjtJoint};
use nalgebra::Vector3;

use crate::settings::{Servo, SimSettings};

/// Angular velocity (radians a second) beyond which a simulation has diverged: 160 turns a second.
const FASTEST: f64 = 1e3;
/// Angular acceleration (radians a second squared) beyond which it has: the engine's own bound, under which it neither
/// resets its state nor writes a file about it.
const MOST_ACCELERATION: f64 = 1e9;
/// How near its limit a torque counts as being at it.
const AT_LIMIT: f64 = 1.0 - 1e-9;

/// What the hinges are to do during a step.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Target {
    /// Angles at the beginning of the step, radians.
    pub angles: Vec<f64>,
    /// Velocities half a step before its beginning, radians a second: semi-implicit integration keeps velocities half
    /// a step behind the angles.
    pub rates: Vec<f64>,
    /// Accelerations at its beginning, radians a second squared.
    pub accelerations: Vec<f64>,
}

impl Target {
    /// To be at rest at zero.
    pub(crate) fn new(count: usize) -> Self {
        Self {
            angles: vec![0.0; count],
            rates: vec![0.0; count],
            accelerations: vec![0.0; count],
        }
    }
}

/// A force at a point of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Push {
    /// The engine's body.
    pub body: usize,
    /// Where on it, in its own frame, metres.
    pub point: Vector3<f64>,
    /// Newtons, along the world's axes.
    pub force: Vector3<f64>,
}

/// A model of hinges (and sliders) alone, each with one drive, in the order of the drives.
pub struct Plant {
    data: MjData<Box<MjModel>>,
    /// Holds the posture that is commanded, for inverse dynamics.
    wanted: MjData<Box<MjModel>>,
    servo: Servo,
    /// Square of the natural frequency, and damping: errors to acceleration.
    feedback: [f64; 2],
    /// Feedback of each drive: N m a radian, N m s a radian.
    gains: Vec<[f64; 2]>,
    armature: Vec<f64>,
    limits: Vec<f64>,
    effort: Effort,
    /// Torques of inverse dynamics.
    torques: Vec<f64>,
    applied: Vec<f64>,
}

impl Plant {
    /// A model with its gains, which come out of the mass matrix: of its diagonal the greatest that the hinges have in
    /// these postures (their angles, radians).
    ///
    /// # Errors
    /// When a joint is neither hinge nor slider, when not every joint has one drive in the order of the joints, when
    /// nothing resists a joint.
    pub(crate) fn new(
        model: MjModel,
        servo: Servo,
        settings: &SimSettings,
        postures: &[Vec<f64>],
    ) -> Result<Self> {
        let count = model.jnt_type().len();
        if let Some(j) = model
            .jnt_type()
            .iter()
            .position(|t| !matches!(t, MjtJoint::mjJNT_HINGE | MjtJoint::mjJNT_SLIDE))
        {
            let name = model.id_to_name(mujoco_rs::prelude::MjtObjBase::mjOBJ_JOINT, j);
            return Err(Error::unsupported(format!(
                "joint `{}` is neither a hinge nor a slider",
                name.unwrap_or("without a name")
            )));
        }
        let drives = model.actuator_trnid();
        if drives.len() != count || (0..count).any(|j| drives[j][0] != j as i32) {
            return Err(Error::invalid(
                "a simulated body needs one drive a joint, in the order of the joints",
            ));
        }
        let mut model = Box::new(model);
        let stiffness = (std::f64::consts::TAU * settings.frequency_hz).powi(2);
        let damping = 2.0 * settings.damping_ratio * stiffness.sqrt();
        let inertias = inertias(&model, postures)?;
        let mut gains = Vec::with_capacity(count);
        for (j, inertia) in inertias.iter().enumerate() {
            if !(inertia.is_finite() && *inertia > 0.0) {
                return Err(Error::invalid(format!(
                    "joint {j} of the model moves no mass: give it an armature"
                )));
            }
            gains.push([inertia * stiffness, inertia * damping]);
        }
        for (bias, [kp, kv]) in model.actuator_biasprm_mut().iter_mut().zip(&gains) {
            let feedback = if servo == Servo::ComputedTorque {
                [0.0; 3]
            } else {
                [0.0, -kp, -kv]
            };
            bias[..3].copy_from_slice(&feedback);
        }
        let limits = model
            .actuator_forcelimited()
            .iter()
            .zip(model.actuator_forcerange())
            .map(|(limited, range)| if *limited { range[1] } else { f64::INFINITY })
            .collect();
        let armature = model.dof_armature().to_vec();
        let wanted = MjData::try_new(model.clone()).map_err(engine)?;
        Ok(Self {
            data: MjData::try_new(model).map_err(engine)?,
            wanted,
            servo,
            feedback: [stiffness, damping],
            gains,
            armature,
            limits,
            effort: Effort::default(),
            torques: vec![0.0; count],
            applied: vec![0.0; count],
        })
    }

    /// The model.
    pub fn model(&self) -> &MjModel {
        self.data.model()
    }

    /// The law of its drives.
    pub fn servo(&self) -> Servo {
        self.servo
    }

    /// The state of the engine.
    pub fn data(&self) -> &MjData<Box<MjModel>> {
        &self.data
    }

    /// Angles of the hinges, radians.
    pub fn angles(&self) -> &[f64] {
        self.data.qpos()
    }

    /// Their velocities, radians a second.
    pub fn rates(&self) -> &[f64] {
        self.data.qvel()
    }

    /// How hard the drives had to work since the last reset.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Puts the hinges at these angles and velocities.
    pub(crate) fn reset(&mut self, angles: &[f64], rates: &[f64]) {
        for data in [&mut self.data, &mut self.wanted] {
            data.reset();
            data.qpos_mut().copy_from_slice(angles);
            data.qvel_mut().copy_from_slice(rates);
        }
        self.data.fwd_position();
        self.effort = Effort::default();
    }

    /// One step of `secs` toward a target, while something may push.
    ///
    /// # Errors
    /// When the simulation diverges.
    pub(crate) fn step(&mut self, target: &Target, secs: f64, push: Option<&Push>) -> Result<()> {
        self.data.model_opt_mut().timestep = secs;
        self.data.fwd_position();
        self.data.fwd_velocity();
        self.command(target, secs);
        self.applied.fill(0.0);
        if let Some(push) = push {
            let frame = nalgebra::Matrix3::from_row_slice(&self.data.xmat()[push.body]);
            let point = Vector3::from(self.data.xpos()[push.body]) + frame * push.point;
            self.data
                .apply_ft(
                    &push.force.into(),
                    &[0.0; 3],
                    &point.into(),
                    push.body,
                    &mut self.applied,
                )
                .map_err(engine)?;
        }
        self.data.qfrc_applied_mut().copy_from_slice(&self.applied);
        self.data.fwd_actuation();
        let torques = self.data.actuator_force().iter().zip(&self.limits);
        let saturated = torques
            .filter(|(t, limit)| t.abs() >= *limit * AT_LIMIT)
            .count();
        self.effort.saturated += saturated as u64;
        self.effort.torques += self.limits.len() as u64;
        self.data.fwd_acceleration();
        self.data.fwd_constraint();
        self.bounded("acceleration", self.data.qacc(), MOST_ACCELERATION)?;
        self.data.implicit();
        self.bounded("velocity", self.data.qvel(), FASTEST)?;
        match self.data.warning().iter().position(|w| w.number > 0) {
            None => Ok(()),
            Some(kind) => Err(Error::unsupported(format!(
                "the simulation diverged at {:.3} s: the engine's warning {kind}",
                self.data.time()
            ))),
        }
    }

    /// Writes the drives' controls.
    fn command(&mut self, target: &Target, secs: f64) {
        let count = self.gains.len();
        match self.servo {
            Servo::Pd => self.torques.fill(0.0),
            Servo::FeedforwardFeedback => {
                let wanted = &mut self.wanted;
                wanted.qpos_mut().copy_from_slice(&target.angles);
                wanted.qvel_mut().copy_from_slice(&target.rates);
                wanted.qacc_mut().copy_from_slice(&target.accelerations);
                wanted.kinematics();
                wanted.com_pos();
                wanted.tendon_comp();
                wanted.com_vel();
                wanted.passive();
                wanted.rne_into(true, &mut self.torques);
                for i in 0..count {
                    let inertial = self.armature[i] * target.accelerations[i];
                    self.torques[i] += inertial - wanted.qfrc_passive()[i];
                }
            }
            Servo::ComputedTorque => {
                let [stiffness, damping] = self.feedback;
                for i in 0..count {
                    let error = target.angles[i] - self.data.qpos()[i];
                    let slip = target.rates[i] - self.data.qvel()[i];
                    self.data.qacc_mut()[i] =
                        target.accelerations[i] + stiffness * error + damping * slip;
                }
                self.data.rne_into(true, &mut self.torques);
                for i in 0..count {
                    self.torques[i] +=
                        self.armature[i] * self.data.qacc()[i] - self.data.qfrc_passive()[i];
                }
            }
        }
        if self.servo == Servo::ComputedTorque {
            self.data.ctrl_mut().copy_from_slice(&self.torques);
        } else {
            let controls = self.data.ctrl_mut();
            for (i, [kp, kv]) in self.gains.iter().enumerate() {
                // The engine damps by the velocity after the step, so that is what it is compared with.
                let rate = target.rates[i] + secs * target.accelerations[i];
                controls[i] = self.torques[i] + kp * target.angles[i] + kv * rate;
            }
        }
    }

    fn bounded(&self, what: &str, values: &[f64], most: f64) -> Result<()> {
        match values.iter().position(|v| v.is_nan() || v.abs() > most) {
            None => Ok(()),
            Some(i) => Err(Error::unsupported(format!(
                "the simulation diverged at {:.3} s: {what} {} of hinge {i}",
                self.data.time(),
                values[i]
            ))),
        }
    }
}

/// The greatest entries of the mass matrix' diagonal in these postures, kg m^2.
fn inertias(model: &MjModel, postures: &[Vec<f64>]) -> Result<Vec<f64>> {
    let mut data = MjData::try_new(model).map_err(engine)?;
    let count = model.jnt_type().len();
    let mut matrix = vec![0.0; count * count];
    let mut greatest = vec![0.0; count];
    for angles in postures {
        data.qpos_mut().copy_from_slice(angles);
        data.fwd_position();
        data.full_m(&mut matrix).map_err(engine)?;
        for (i, most) in greatest.iter_mut().enumerate() {
            *most = f64::max(*most, matrix[i * count + i]);
        }
    }
    Ok(greatest)
}

/// An error of the engine in ours.
pub(crate) fn engine(error: impl std::fmt::Display) -> Error {
    Error::invalid(format!("the physics engine: {error}"))
}
