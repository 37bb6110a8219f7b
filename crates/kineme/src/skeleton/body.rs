//! [`Skeleton`]: an articulated body, immutable once made.

use std::collections::BTreeSet;

use nalgebra::{UnitQuaternion, Vector3};

use super::joint::{Joint, JointKind, Range};
use super::limits::limits;
use super::role::Role;
use crate::error::{Error, Result};
use crate::math::rotation::{exp, log, log_near};

/// The longest rotation vector (radians) that a ball's coordinates keep for the sake of continuity.
const FARTHEST: f64 = 1.2 * std::f64::consts::PI;

/// A point of the body that acts on the world: hands, feet, head.
#[derive(Debug, Clone, PartialEq)]
pub struct Effector {
    /// `left_hand`, `right_hand`, `left_foot`, `right_foot` or `head`.
    pub name: String,
    /// The joint that carries it.
    pub joint: usize,
    /// Its place in the joint's frame, metres.
    pub point: Vector3<f64>,
}

/// An articulated body: joints with parents before children, their coordinates, effectors. Immutable.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    name: String,
    joints: Vec<Joint>,
    first_coordinate: Vec<usize>,
    dof: usize,
    limits: Vec<Vec<Range>>,
    effectors: Vec<Effector>,
}

impl Skeleton {
    /// A body of these joints, the first of which is the root.
    ///
    /// # Errors
    /// Without joints, when a parent does not come before its child, when names repeat, when an effector's joint does not exist.
    pub fn new(
        name: impl Into<String>,
        joints: Vec<Joint>,
        effectors: Vec<Effector>,
    ) -> Result<Self> {
        if joints.is_empty() || joints[0].parent.is_some() {
            return Err(Error::invalid(
                "a body needs joints, the first of them its root",
            ));
        }
        let mut names = BTreeSet::new();
        for (i, joint) in joints.iter().enumerate() {
            if i > 0 && joint.parent.is_none_or(|p| p >= i) {
                return Err(Error::invalid(format!(
                    "joint `{}` must follow its parent",
                    joint.name
                )));
            }
            if !names.insert(joint.name.as_str()) {
                return Err(Error::invalid(format!(
                    "two joints are named `{}`",
                    joint.name
                )));
            }
        }
        if let Some(e) = effectors.iter().find(|e| e.joint >= joints.len()) {
            return Err(Error::invalid(format!(
                "effector `{}` has no joint",
                e.name
            )));
        }
        let mut dof = 0;
        let first_coordinate = joints
            .iter()
            .map(|j| {
                let first = dof;
                dof += j.kind.dof();
                first
            })
            .collect();
        let limits = joints.iter().map(limits).collect();
        Ok(Self {
            name: name.into(),
            joints,
            first_coordinate,
            dof,
            limits,
            effectors,
        })
    }

    /// The body's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its joints, parents before children.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Its effectors.
    pub fn effectors(&self) -> &[Effector] {
        &self.effectors
    }

    /// The number of coordinates of a pose.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// The coordinates of joint `joint` within a pose.
    pub fn coordinates(&self, joint: usize) -> std::ops::Range<usize> {
        let first = self.first_coordinate[joint];
        first..first + self.joints[joint].kind.dof()
    }

    /// How far joint `joint` goes, radians: of a hinge the range of its angle; of a ball three ranges, of its rotation
    /// vector along flexion, abduction and axial rotation; empty for a fixed joint and for the root, which has no limit.
    ///
    /// A ball's limits are the smallest box that holds every posture whose clinical angles lie in the joint's ranges.
    /// Clinical angles that combine reach farther along an axis than each alone: the box is wider than the ranges by
    /// little for a vertebra, by much for wrist and hip, and for the shoulder it leaves out next to nothing.
    pub fn limits(&self, joint: usize) -> &[Range] {
        &self.limits[joint]
    }

    /// The names of all coordinates: `<joint>_x`, `_y`, `_z` of a ball, `<joint>` of a hinge.
    pub fn coordinate_names(&self) -> Vec<String> {
        self.joints
            .iter()
            .flat_map(|j| match j.kind {
                JointKind::Fixed => vec![],
                JointKind::Hinge { .. } => vec![j.name.clone()],
                JointKind::Ball { .. } => {
                    ["x", "y", "z"].map(|c| format!("{}_{c}", j.name)).to_vec()
                }
            })
            .collect()
    }

    /// The joint with this name.
    ///
    /// # Errors
    /// For an unknown name; the message lists the known ones.
    pub fn joint(&self, name: &str) -> Result<usize> {
        self.joints
            .iter()
            .position(|j| j.name == name)
            .ok_or_else(|| {
                Error::unknown_name("joint", name, self.joints.iter().map(|j| j.name.as_str()))
            })
    }

    /// The joints of a role, from the root outward; empty when the body has none.
    pub fn joints_of(&self, role: Role) -> Vec<usize> {
        (0..self.joints.len())
            .filter(|&i| self.joints[i].role == Some(role))
            .collect()
    }

    /// The sum of the links' masses, kilograms.
    pub fn mass_kg(&self) -> f64 {
        self.joints.iter().map(|j| j.link.mass_kg).sum()
    }

    /// The rotation of joint `joint` in its parent's frame for these coordinates of it.
    pub fn rotation(&self, joint: usize, coordinates: &[f64]) -> UnitQuaternion<f64> {
        match &self.joints[joint].kind {
            JointKind::Fixed => UnitQuaternion::identity(),
            JointKind::Hinge { axis, .. } => UnitQuaternion::from_axis_angle(axis, coordinates[0]),
            JointKind::Ball { reference, .. } => {
                reference
                    * exp(&Vector3::new(
                        coordinates[0],
                        coordinates[1],
                        coordinates[2],
                    ))
            }
        }
    }

    /// Writes into `pose` the coordinates of `joint` that come nearest `rotation` (in the parent's frame);
    /// `previous` is the pose before, for continuity. Returns the rotation that the joint really takes.
    ///
    /// A ball's coordinates may pass pi to follow the pose before, but only as far as no human joint goes: a joint that a
    /// glitch of the source turned round comes back to the coordinates that everyone else has for the same posture.
    pub fn set_rotation(
        &self,
        pose: &mut [f64],
        joint: usize,
        rotation: &UnitQuaternion<f64>,
        previous: Option<&[f64]>,
    ) -> UnitQuaternion<f64> {
        let at = self.coordinates(joint);
        match &self.joints[joint].kind {
            JointKind::Fixed => {}
            JointKind::Hinge { axis, .. } => {
                let angle = crate::math::rotation::twist_angle(rotation, axis);
                let before = previous.map_or(0.0, |p| p[at.start]);
                pose[at.start] = before + crate::math::rotation::wrap(angle - before);
            }
            JointKind::Ball { reference, .. } => {
                let before = previous.map_or(Vector3::zeros(), |p| {
                    Vector3::from_column_slice(&p[at.clone()])
                });
                let turn = reference.inverse() * rotation;
                let near = log_near(&turn, &before);
                let v = if near.norm() > FARTHEST {
                    log(&turn)
                } else {
                    near
                };
                pose[at.clone()].copy_from_slice(v.as_slice());
            }
        }
        self.rotation(joint, &pose[at])
    }

    /// The neutral standing pose: every joint's frame is the world's, arms hang, palms face the thighs.
    pub fn neutral(&self) -> Vec<f64> {
        let mut pose = vec![0.0; self.dof];
        for joint in 0..self.joints.len() {
            self.set_rotation(&mut pose, joint, &UnitQuaternion::identity(), None);
        }
        pose
    }
}
