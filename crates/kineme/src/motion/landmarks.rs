//! Landmarks: where the joints are against the root, heading removed. What postures are compared by.

use nalgebra::{UnitQuaternion, Vector3};

use super::body_motion::Motion;
use crate::skeleton::{Role, Root, Skeleton};

/// The joints whose positions are compared: trunk, head, and each limb from its root to its tip.
const ROLES: [Role; 20] = [
    Role::Chest,
    Role::Head,
    Role::LeftUpperArm,
    Role::LeftLowerArm,
    Role::LeftHand,
    Role::LeftFingers,
    Role::RightUpperArm,
    Role::RightLowerArm,
    Role::RightHand,
    Role::RightFingers,
    Role::LeftUpperLeg,
    Role::LeftLowerLeg,
    Role::LeftFoot,
    Role::LeftToes,
    Role::RightUpperLeg,
    Role::RightLowerLeg,
    Role::RightFoot,
    Role::RightToes,
    Role::Neck,
    Role::Spine,
];

/// The landmarks of a body, in their order: of each role that it has, the joint farthest from the root.
pub fn landmarks_of(body: &Skeleton) -> Vec<(Role, usize)> {
    ROLES
        .iter()
        .filter_map(|&r| Some((r, *body.joints_of(r).last()?)))
        .collect()
}

/// Numbers a frame of [`Motion::landmarks`]: three a landmark.
pub fn landmark_dims(body: &Skeleton) -> usize {
    3 * landmarks_of(body).len()
}

/// The landmarks of the mirror image: left and right swapped, y negated; exact, and its own inverse.
/// A landmark whose counterpart the body lacks stays with its role.
///
/// # Panics
/// When `landmarks` is no whole number of frames of [`landmark_dims`].
pub fn mirror_landmarks(body: &Skeleton, landmarks: &[f64]) -> Vec<f64> {
    let roles: Vec<Role> = landmarks_of(body).into_iter().map(|(r, _)| r).collect();
    let source: Vec<usize> = (0..roles.len())
        .map(|i| {
            let counterpart = roles.iter().position(|r| *r == roles[i].mirrored());
            counterpart.unwrap_or(i)
        })
        .collect();
    let dims = 3 * roles.len();
    assert!(
        dims > 0 && landmarks.len().is_multiple_of(dims),
        "whole frames of {dims} numbers"
    );
    let mut mirrored = Vec::with_capacity(landmarks.len());
    for frame in landmarks.chunks_exact(dims) {
        for &i in &source {
            let [x, y, z] = [frame[3 * i], frame[3 * i + 1], frame[3 * i + 2]];
            mirrored.extend([x, -y, z]);
        }
    }
    mirrored
}

/// Positions (metres) of the compared joints at a pose against the root, heading removed: [`landmark_dims`] numbers.
///
/// # Panics
/// When `pose` has not [`Skeleton::dof`] coordinates.
pub fn landmarks_at(body: &Skeleton, pose: &[f64]) -> Vec<f64> {
    let frames = body.frames(pose, &Root::ORIGIN);
    let joints = landmarks_of(body).into_iter();
    joints
        .flat_map(|(_, j)| <[f64; 3]>::from(frames[j].position))
        .collect()
}

impl Motion {
    /// Positions (metres) of the compared joints against the root, heading removed: frame-major, [`landmark_dims`] a
    /// frame.
    ///
    /// On real people positions beat joint angles and rotation vectors in every comparison that was made.
    pub fn landmarks(&self) -> Vec<f64> {
        let joints = landmarks_of(self.skeleton());
        let mut landmarks = Vec::with_capacity(self.frames() * 3 * joints.len());
        for f in 0..self.frames() {
            let root = self.root(f);
            let upright = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -root.yaw);
            let frames = self.frames_at(f);
            for &(_, j) in &joints {
                let p = upright * (frames[j].position - root.position);
                landmarks.extend_from_slice(p.as_slice());
            }
        }
        landmarks
    }
}
