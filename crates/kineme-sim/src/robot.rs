//! [`SimulatedRobot`]: a humanoid that moves in physics.

use std::sync::Arc;

use kineme::control::{Command, Effort, Robot, Sensed};
use kineme::skeleton::JointKind;
use kineme::{Error, Result, Root, Skeleton};
use mujoco_rs::prelude::{MjModel, MjtObjBase};
use nalgebra::{Matrix3, Vector3};

use crate::file::{RobotFile, load};
use crate::hinges::Hinges;
use crate::mjcf::mjcf;
use crate::plant::{Plant, Push, Target, engine};
use crate::settings::{Servo, SimSettings};

/// Postures among which each hinge's greatest inertia is sought.
const POSTURES: usize = 64;

/// A push that goes on.
#[derive(Debug, Clone, Copy)]
struct Pushing {
    push: Push,
    left_secs: f64,
}

/// A body in the physics engine, driven toward what it is told. Its root is held: where a command says that it stands
/// is not followed.
pub struct SimulatedRobot {
    body: Arc<Skeleton>,
    settings: SimSettings,
    hinges: Hinges,
    plant: Plant,
    /// For each joint of the body, the engine's body that it moves and the joint's frame in that one's.
    parts: Vec<(usize, Vector3<f64>, Matrix3<f64>)>,
    sensed: Sensed,
    /// Angles and rates of the hinges at the command before and at the present one.
    before: (Vec<f64>, Vec<f64>),
    goal: (Vec<f64>, Vec<f64>),
    target: Target,
    pushing: Option<Pushing>,
}

impl SimulatedRobot {
    /// A body of [`mjcf`] in its neutral pose, at rest.
    ///
    /// # Errors
    /// For settings out of range, and when the engine refuses the model, as it does where a joint moves no mass.
    pub fn humanoid(body: &Arc<Skeleton>, settings: &SimSettings) -> Result<Self> {
        settings.check()?;
        let model = MjModel::from_xml_string(&mjcf(body, settings)).map_err(engine)?;
        let hinges = Hinges::of(body, |name| index(&model, MjtObjBase::mjOBJ_JOINT, name))?;
        let bodies = body
            .joints()
            .iter()
            .map(|joint| index(&model, MjtObjBase::mjOBJ_BODY, &joint.name))
            .collect::<Result<_>>()?;
        Self::new(body, model, hinges, bodies, settings)
    }

    /// A robot of an MJCF or URDF file, its base welded, in the posture of the file, at rest. Its own drives are taken off;
    /// ours have the gains of the settings and its own torque limits. Joints that no coordinate moves are held.
    ///
    /// # Errors
    /// For settings out of range, when the file cannot be read, lacks a joint or the base, or has joints that are
    /// neither hinges nor sliders besides the base's own.
    pub fn from_file(robot: &RobotFile, settings: &SimSettings) -> Result<Self> {
        settings.check()?;
        let model = load(robot, settings)?;
        let body = &robot.skeleton;
        let mut places = Vec::with_capacity(body.dof());
        for (name, offset) in robot.hinges.iter().zip(&robot.offsets) {
            places.push((index(&model, MjtObjBase::mjOBJ_JOINT, name)?, *offset));
        }
        let base = index(&model, MjtObjBase::mjOBJ_BODY, &robot.base)?;
        let mut bodies: Vec<usize> = Vec::with_capacity(body.joints().len());
        for (j, joint) in body.joints().iter().enumerate() {
            // The part that a joint moves; a joint that does not move is part of its parent.
            bodies.push(match (body.coordinates(j).last(), joint.parent) {
                (Some(c), _) => model.jnt_bodyid()[places[c].0] as usize,
                (None, Some(parent)) => bodies[parent],
                (None, None) => base,
            });
        }
        let hinges = Hinges::single(&places, model.jnt_type().len());
        Self::new(body, model, hinges, bodies, settings)
    }

    fn new(
        body: &Arc<Skeleton>,
        model: MjModel,
        hinges: Hinges,
        bodies: Vec<usize>,
        settings: &SimSettings,
    ) -> Result<Self> {
        let servo = settings.servo.unwrap_or_else(|| Servo::of(body));
        let count = hinges.count();
        let still = vec![0.0; body.dof()];
        let start = model.qpos0().to_vec();
        let mut rates = vec![0.0; count];
        let mut postures = Vec::with_capacity(POSTURES);
        for k in 0..POSTURES {
            let mut angles = start.clone();
            hinges.angles(&within(body, k), &still, &mut angles, &mut rates);
            postures.push(angles);
        }
        let plant = Plant::new(model, servo, settings, &postures)?;
        let mut robot = Self {
            body: Arc::clone(body),
            settings: settings.clone(),
            sensed: Sensed {
                pose: still.clone(),
                velocity: still.clone(),
            },
            before: (start.clone(), vec![0.0; count]),
            goal: (start, vec![0.0; count]),
            target: Target::new(count),
            parts: Vec::new(),
            pushing: None,
            hinges,
            plant,
        };
        robot.reset(&still, &still)?;
        robot.parts = robot.placed(&bodies);
        robot.reset(&body.neutral(), &still)?;
        Ok(robot)
    }

    /// Joints in the frames of the engine's bodies, while all coordinates are zero.
    fn placed(&self, bodies: &[usize]) -> Vec<(usize, Vector3<f64>, Matrix3<f64>)> {
        let frames = self.body.frames(&vec![0.0; self.body.dof()], &Root::ORIGIN);
        let data = self.plant.data();
        let place = |b: usize| Vector3::from(data.xpos()[b]);
        let turn = |b: usize| Matrix3::from_row_slice(&data.xmat()[b]);
        let origin = place(bodies[0]);
        let joints = bodies.iter().zip(&frames);
        joints
            .map(|(&b, frame)| {
                let inverse = turn(b).transpose();
                let point = inverse * (origin + frame.position - place(b));
                (b, point, inverse * frame.rotation.to_rotation_matrix())
            })
            .collect()
    }

    /// The law by which its joints are driven.
    pub fn servo(&self) -> Servo {
        self.plant.servo()
    }

    /// How its coordinates are made of hinges.
    pub fn hinges(&self) -> &Hinges {
        &self.hinges
    }

    /// The model that is simulated, and its present state, in the physics engine's own terms.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Pushes a part from now on for `secs`: the force (newtons, along the world's axes) acts at the effector of that
    /// name, else at the centre of the joint of that name. A push before this one ends.
    ///
    /// # Errors
    /// For an unknown name, a force that is not finite or seconds that are not positive.
    pub fn push(&mut self, at: &str, force: Vector3<f64>, secs: f64) -> Result<()> {
        if !(force.iter().all(|f| f.is_finite()) && secs.is_finite() && secs > 0.0) {
            return Err(Error::invalid(format!(
                "a push has a finite force and a positive time, found {:?} N for {secs} s",
                force.as_slice()
            )));
        }
        let effector = self.body.effectors().iter().find(|e| e.name == at);
        let (joint, point) = match effector {
            Some(effector) => (effector.joint, effector.point),
            None => (self.body.joint(at)?, Vector3::zeros()),
        };
        let (body, place, frame) = &self.parts[joint];
        self.pushing = Some(Pushing {
            push: Push {
                body: *body,
                point: place + frame * point,
                force,
            },
            left_secs: secs,
        });
        Ok(())
    }

    fn check(&self, pose: &[f64], velocity: &[f64]) -> Result<()> {
        let dof = self.body.dof();
        let fits = |values: &[f64]| values.len() == dof && values.iter().all(|v| v.is_finite());
        if fits(pose) && fits(velocity) {
            return Ok(());
        }
        Err(Error::invalid(format!(
            "`{}` is moved by {dof} finite coordinates and velocities, found {} and {}",
            self.body.name(),
            pose.len(),
            velocity.len()
        )))
    }

    /// Sets the target of the step that begins at the share `s` of a tick of `secs`, in `steps` steps.
    fn aim(&mut self, step: usize, steps: usize, secs: f64) {
        let s = step as f64 / steps as f64;
        let earlier = (step as f64 - 0.5) / steps as f64;
        for i in 0..self.target.angles.len() {
            let (a, b) = (self.before.0[i], self.goal.0[i]);
            let (u, v) = (self.before.1[i] * secs, self.goal.1[i] * secs);
            // Cubic Hermite: a + u s + c s^2 + d s^3.
            let (c, d) = (3.0 * (b - a) - 2.0 * u - v, 2.0 * (a - b) + u + v);
            self.target.angles[i] = a + s * (u + s * (c + s * d));
            self.target.rates[i] = (u + earlier * (2.0 * c + earlier * 3.0 * d)) / secs;
            self.target.accelerations[i] = (2.0 * c + 6.0 * s * d) / (secs * secs);
        }
    }

    fn sense(&mut self) {
        self.hinges.pose(
            self.plant.angles(),
            self.plant.rates(),
            &mut self.sensed.pose,
            &mut self.sensed.velocity,
        );
    }
}

impl Robot for SimulatedRobot {
    fn body(&self) -> &Arc<Skeleton> {
        &self.body
    }

    fn is_physical(&self) -> bool {
        true
    }

    fn reset(&mut self, pose: &[f64], velocity: &[f64]) -> Result<()> {
        self.check(pose, velocity)?;
        let (angles, rates) = &mut self.goal;
        angles.copy_from_slice(self.plant.model().qpos0());
        rates.fill(0.0);
        self.hinges.angles(pose, velocity, angles, rates);
        self.plant.reset(angles, rates);
        self.pushing = None;
        self.sensed.pose.copy_from_slice(pose);
        self.sensed.velocity.copy_from_slice(velocity);
        Ok(())
    }

    fn sensed(&self) -> &Sensed {
        &self.sensed
    }

    /// Moves for `secs` toward a command. Its posture and velocity, and those of the command before, are joined by a
    /// cubic in each hinge; what the command says of accelerations is not used, for those of the cubic belong to it.
    fn advance(&mut self, command: &Command, secs: f64) -> Result<()> {
        self.check(&command.pose, &command.velocity)?;
        if !(secs.is_finite() && secs > 0.0) {
            return Err(Error::invalid(format!(
                "a robot moves for a positive time, found {secs} s"
            )));
        }
        std::mem::swap(&mut self.before, &mut self.goal);
        self.goal.0.copy_from_slice(&self.before.0);
        let (angles, rates) = &mut self.goal;
        self.hinges
            .angles(&command.pose, &command.velocity, angles, rates);
        // A whole number of equal steps, with room for rounding: a tick of 10 ms is 10 steps of 1 ms.
        let steps = (secs / self.settings.step_secs - 1e-6).ceil().max(1.0) as usize;
        let step_secs = secs / steps as f64;
        for step in 0..steps {
            self.aim(step, steps, secs);
            let push = self.pushing.filter(|p| p.left_secs > 0.5 * step_secs);
            self.plant
                .step(&self.target, step_secs, push.map(|p| p.push).as_ref())?;
            self.pushing = push.map(|p| Pushing {
                left_secs: p.left_secs - step_secs,
                ..p
            });
        }
        self.sense();
        Ok(())
    }

    fn effort(&self) -> Effort {
        self.plant.effort()
    }
}

/// The `k`th of postures that spread evenly over the limits of a body, the first in the middle of them all; the root
/// stays upright.
fn within(body: &Skeleton, k: usize) -> Vec<f64> {
    let mut pose = vec![0.0; body.dof()];
    let mut n = 0;
    for (j, joint) in body.joints().iter().enumerate() {
        let axes = match joint.kind {
            JointKind::Ball { .. } => {
                vec![joint.axes.flexion, joint.axes.abduction, joint.axes.axial]
            }
            _ => vec![Vector3::x()],
        };
        for (range, axis) in body.limits(j).iter().zip(axes) {
            n += 1;
            // Additive recurrence: multiples of roots of primes spread evenly (Weyl).
            let share = (0.5 + k as f64 * (n as f64 + 1.0).sqrt()).fract();
            let value = range.low + share * (range.high - range.low);
            for (x, a) in pose[body.coordinates(j)].iter_mut().zip(axis.iter()) {
                *x += a * value;
            }
        }
    }
    pose
}

/// The place of a part of the model.
fn index(model: &MjModel, kind: MjtObjBase, name: &str) -> Result<usize> {
    model.name_to_id(kind, name).ok_or_else(|| {
        let known: Vec<&str> = (0..).map_while(|i| model.id_to_name(kind, i)).collect();
        Error::unknown_name("part of the model", name, known)
    })
}
