//! Forward kinematics: from a pose to the places of joints and effectors.

use nalgebra::{UnitQuaternion, Vector3};

use super::body::Skeleton;
use super::role::Role;

/// Where the body stands: the root's position (metres) and its heading about the vertical (radians, 0 faces x).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// World position of the root joint, metres.
    pub position: Vector3<f64>,
    /// Heading, radians, not wrapped.
    pub yaw: f64,
}

impl Root {
    /// At the origin, facing forward.
    pub const ORIGIN: Root = Root {
        position: Vector3::new(0.0, 0.0, 0.0),
        yaw: 0.0,
    };
}

/// The world frame of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Position of the joint, metres.
    pub position: Vector3<f64>,
    /// Orientation of its link.
    pub rotation: UnitQuaternion<f64>,
}

impl Frame {
    /// A point of this frame in the world.
    pub fn place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.position + self.rotation * point
    }

    /// A world point in this frame.
    pub fn local(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.inverse() * (point - self.position)
    }
}

impl Skeleton {
    /// The world frames of all joints at a pose.
    ///
    /// # Panics
    /// When `pose` has not [`Skeleton::dof`] coordinates.
    pub fn frames(&self, pose: &[f64], root: &Root) -> Vec<Frame> {
        assert_eq!(pose.len(), self.dof(), "coordinates of {}", self.name());
        let mut frames: Vec<Frame> = Vec::with_capacity(self.joints().len());
        let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), root.yaw);
        for (j, joint) in self.joints().iter().enumerate() {
            let turn = self.rotation(j, &pose[self.coordinates(j)]);
            let (position, before) = match joint.parent {
                Some(p) => (frames[p].place(&joint.offset), frames[p].rotation),
                None => (root.position, heading),
            };
            frames.push(Frame {
                position,
                rotation: before * turn,
            });
        }
        frames
    }

    /// World positions of the effectors, in the order of [`Skeleton::effectors`], metres.
    pub fn effector_positions(&self, pose: &[f64], root: &Root) -> Vec<Vector3<f64>> {
        let frames = self.frames(pose, root);
        self.effectors()
            .iter()
            .map(|e| frames[e.joint].place(&e.point))
            .collect()
    }

    /// The thorax frame at a pose: origin midway between the shoulders, oriented as the uppermost trunk joint; `None` without shoulders.
    pub fn thorax(&self, frames: &[Frame]) -> Option<Frame> {
        let left = *self.joints_of(Role::LeftUpperArm).first()?;
        let right = *self.joints_of(Role::RightUpperArm).first()?;
        let trunk = self.trunk().last().copied().unwrap_or(0);
        Some(Frame {
            position: 0.5 * (frames[left].position + frames[right].position),
            rotation: frames[trunk].rotation,
        })
    }

    /// The joints between pelvis and thorax, from the root outward.
    pub fn trunk(&self) -> Vec<usize> {
        self.chain(&[Role::Spine, Role::Chest, Role::UpperChest])
    }

    /// The joints between thorax and head, from the root outward.
    pub fn neck(&self) -> Vec<usize> {
        self.chain(&[Role::Neck, Role::Head])
    }

    fn chain(&self, roles: &[Role]) -> Vec<usize> {
        roles.iter().flat_map(|&r| self.joints_of(r)).collect()
    }
}
