//! [`Reach`]: where an effector is against the thorax, and how it moves with each coordinate of the pose.
//!
//! Only the joints between thorax and effector matter, so this costs a fraction of [`Skeleton::frames`] and allocates
//! nothing: it is what searches for a pose ask thousands of times.

use nalgebra::{Unit, UnitQuaternion, Vector3};

use super::body::Skeleton;
use super::joint::JointKind;
use super::kinematics::Frame;
use super::role::Role;
use crate::error::{Error, Result};
use crate::math::rotation::{exp, right_jacobian};

/// How a step of a path turns, and the first coordinate that turns it.
#[derive(Debug, Clone)]
enum Turn {
    Hinge(Unit<Vector3<f64>>, usize),
    Ball(UnitQuaternion<f64>, usize),
}

impl Turn {
    fn rotation(&self, pose: &[f64]) -> UnitQuaternion<f64> {
        match self {
            Turn::Hinge(axis, at) => UnitQuaternion::from_axis_angle(axis, pose[*at]),
            Turn::Ball(reference, at) => reference * exp(&coordinates(pose, *at)),
        }
    }
}

fn coordinates(pose: &[f64], at: usize) -> Vector3<f64> {
    Vector3::new(pose[at], pose[at + 1], pose[at + 2])
}

/// A moving joint of a path, with its place in the frame of the moving joint before it.
#[derive(Debug, Clone)]
struct Step {
    offset: Vector3<f64>,
    turn: Turn,
}

/// A point that hangs on a chain of moving joints; fixed joints are folded into the offsets.
#[derive(Debug, Clone)]
struct Limb {
    steps: Vec<Step>,
    point: Vector3<f64>,
}

impl Limb {
    /// The chain of `joints` (parents first) with `point` in the frame of the last.
    fn new(body: &Skeleton, joints: &[usize], point: Vector3<f64>) -> Self {
        let mut steps = Vec::new();
        let mut offset = Vector3::zeros();
        for &j in joints {
            offset += body.joints()[j].offset;
            let at = body.coordinates(j).start;
            let turn = match &body.joints()[j].kind {
                JointKind::Fixed => continue,
                JointKind::Hinge { axis, .. } => Turn::Hinge(*axis, at),
                JointKind::Ball { reference, .. } => Turn::Ball(*reference, at),
            };
            steps.push(Step {
                offset: std::mem::take(&mut offset),
                turn,
            });
        }
        Self {
            steps,
            point: offset + point,
        }
    }

    /// Without the joints that the point lies in: turning about a point does not move it, and a wrist's own joint is
    /// no part of its path.
    fn trimmed(mut self) -> Self {
        while self.point == Vector3::zeros()
            && let Some(step) = self.steps.pop()
        {
            self.point = step.offset;
        }
        self
    }

    /// The point with the orientation of the last joint, in the frame that the chain starts from.
    fn frame(&self, pose: &[f64]) -> Frame {
        let mut position = self.point;
        let mut rotation = UnitQuaternion::identity();
        for step in self.steps.iter().rev() {
            let turn = step.turn.rotation(pose);
            position = step.offset + turn * position;
            rotation = turn * rotation;
        }
        Frame { position, rotation }
    }

    /// The point in the frame that the chain starts from.
    fn place(&self, pose: &[f64]) -> Vector3<f64> {
        self.steps.iter().rev().fold(self.point, |p, step| {
            step.offset + step.turn.rotation(pose) * p
        })
    }

    /// Calls `each` with every coordinate and the velocity (metres a radian) that its unit rate gives to a point now at
    /// `place` that the whole chain carries.
    fn levers(
        &self,
        pose: &[f64],
        place: &Vector3<f64>,
        mut each: impl FnMut(usize, Vector3<f64>),
    ) {
        let mut origin = Vector3::zeros();
        let mut rotation = UnitQuaternion::identity();
        for step in &self.steps {
            origin += rotation * step.offset;
            let before = rotation;
            rotation *= step.turn.rotation(pose);
            let lever = place - origin;
            match &step.turn {
                Turn::Hinge(axis, at) => each(*at, (before * axis.into_inner()).cross(&lever)),
                Turn::Ball(_, at) => {
                    let spin = right_jacobian(&coordinates(pose, *at));
                    for k in 0..3 {
                        each(at + k, (rotation * spin.column(k)).cross(&lever));
                    }
                }
            }
        }
    }
}

/// Adds `column` to column `at` of a row-major matrix of three rows.
fn add(jacobian: &mut [f64], at: usize, column: &Vector3<f64>) {
    let dof = jacobian.len() / 3;
    for (row, value) in column.iter().enumerate() {
        jacobian[row * dof + at] += value;
    }
}

/// An effector in the thorax frame (origin midway between the shoulders; x forward, y left, z up with the uppermost
/// trunk joint) as a function of the pose. Made by [`Skeleton::reach`]; holds what it needs and no reference to the body.
#[derive(Debug, Clone)]
pub struct Reach {
    dof: usize,
    /// From the last joint that carries both effector and thorax: to the effector.
    effector: Limb,
    /// From the same joint to the thorax; without steps for hands and head.
    trunk: Limb,
    /// From the thorax to the shoulders.
    shoulders: [Limb; 2],
}

impl Reach {
    /// The number of coordinates of a pose.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// The effector's place in the thorax frame, metres: that of [`Skeleton::thorax`].
    ///
    /// # Panics
    /// When `pose` has not [`Self::dof`] coordinates.
    pub fn position(&self, pose: &[f64]) -> Vector3<f64> {
        assert_eq!(pose.len(), self.dof, "coordinates of a pose");
        let [left, right] = &self.shoulders;
        let middle = 0.5 * (left.place(pose) + right.place(pose));
        let thorax = self.trunk.frame(pose);
        thorax.local(&self.effector.place(pose)) - middle
    }

    /// The same place, and its derivatives: `jacobian` becomes 3 x dof, row-major, metres a radian of each coordinate.
    ///
    /// A ball's coordinates are rotation vectors, so a column goes through the right Jacobian of SO(3).
    ///
    /// # Panics
    /// When `pose` has not [`Self::dof`] coordinates or `jacobian` not three times as many numbers.
    pub fn jacobian(&self, pose: &[f64], jacobian: &mut [f64]) -> Vector3<f64> {
        assert_eq!(pose.len(), self.dof, "coordinates of a pose");
        assert_eq!(jacobian.len(), 3 * self.dof, "three rows");
        jacobian.fill(0.0);
        let place = self.effector.place(pose);
        let thorax = self.trunk.frame(pose);
        let view = thorax.rotation.inverse();
        let mut position = thorax.local(&place);
        self.effector.levers(pose, &place, |at, velocity| {
            add(jacobian, at, &(view * velocity));
        });
        // In the thorax' frame the effector goes the other way when a joint below turns the thorax.
        self.trunk.levers(pose, &place, |at, velocity| {
            add(jacobian, at, &(view * -velocity));
        });
        for shoulder in &self.shoulders {
            let place = shoulder.place(pose);
            position -= 0.5 * place;
            shoulder.levers(pose, &place, |at, velocity| {
                add(jacobian, at, &(-0.5 * velocity));
            });
        }
        position
    }
}

impl Skeleton {
    /// The index of the effector with this name in [`Self::effectors`].
    ///
    /// # Errors
    /// For an unknown name; the message lists the known ones.
    pub fn effector(&self, name: &str) -> Result<usize> {
        self.effectors()
            .iter()
            .position(|e| e.name == name)
            .ok_or_else(|| {
                let known = self.effectors().iter().map(|e| e.name.as_str());
                Error::unknown_name("effector", name, known)
            })
    }

    /// Effector number `effector` of [`Self::effectors`] in the thorax frame, as a function of the pose.
    ///
    /// # Errors
    /// When there is no such effector, or the body has no shoulders and so no thorax frame.
    pub fn reach(&self, effector: usize) -> Result<Reach> {
        let Some(end) = self.effectors().get(effector) else {
            return Err(Error::invalid(format!(
                "{} has {} effectors, found number {effector}",
                self.name(),
                self.effectors().len()
            )));
        };
        let shoulder = |role: Role| {
            self.joints_of(role).first().copied().ok_or_else(|| {
                Error::unsupported(format!(
                    "{} has no {}: without shoulders there is no thorax frame",
                    self.name(),
                    role.name()
                ))
            })
        };
        let thorax = self.trunk().last().copied().unwrap_or(0);
        let trunk = self.path(thorax);
        let hanging = |role: Role| {
            let path = self.path(shoulder(role)?);
            let limb = path.strip_prefix(trunk.as_slice()).ok_or_else(|| {
                Error::unsupported(format!(
                    "{}: {} does not hang on `{}`, its uppermost trunk joint",
                    self.name(),
                    role.name(),
                    self.joints()[thorax].name
                ))
            })?;
            Ok(Limb::new(self, limb, Vector3::zeros()).trimmed())
        };
        let shoulders = [hanging(Role::LeftUpperArm)?, hanging(Role::RightUpperArm)?];
        let path = self.path(end.joint);
        let shared = path.iter().zip(&trunk).take_while(|(a, b)| a == b).count();
        Ok(Reach {
            dof: self.dof(),
            effector: Limb::new(self, &path[shared..], end.point).trimmed(),
            trunk: Limb::new(self, &trunk[shared..], Vector3::zeros()),
            shoulders,
        })
    }

    /// The joints from the root to this one, both included.
    fn path(&self, joint: usize) -> Vec<usize> {
        let parent = |j: &usize| self.joints()[*j].parent;
        let mut path: Vec<usize> = std::iter::successors(Some(joint), parent).collect();
        path.reverse();
        path
    }
}
