//! Signals of a motion that segmentation looks at: limb centroids, joint angles with their weights.

use nalgebra::Vector3;

use super::body_motion::Motion;
use crate::skeleton::{Frame, JointKind, Role};

/// Limbs by the roles of their joints beyond the root one, and whether the thorax (else the pelvis) carries them.
const LIMBS: [([Role; 3], bool); 4] = [
    (
        [Role::LeftLowerArm, Role::LeftHand, Role::LeftFingers],
        true,
    ),
    (
        [Role::RightLowerArm, Role::RightHand, Role::RightFingers],
        true,
    ),
    ([Role::LeftLowerLeg, Role::LeftFoot, Role::LeftToes], false),
    (
        [Role::RightLowerLeg, Role::RightFoot, Role::RightToes],
        false,
    ),
];

/// Coordinates of one limb centroid.
pub const CENTROID_DIMS: usize = 3;
/// Coordinates of [`Motion::limb_centroids`] a frame: arms left and right, legs left and right.
pub const STACKED_DIMS: usize = CENTROID_DIMS * LIMBS.len();

impl Motion {
    /// Kinematic centroids of the four limbs, frame-major, [`STACKED_DIMS`] a frame, metres.
    ///
    /// A limb's centroid is the mean of its joint centres in the frame of the part that carries it: the thorax for arms
    /// and the pelvis for legs, so that walking and turning do not move it (Jenkins and Mataric 2004).
    pub fn limb_centroids(&self) -> Vec<f64> {
        let body = self.skeleton();
        let joints: Vec<(Vec<usize>, bool)> = LIMBS
            .iter()
            .map(|(roles, on_thorax)| {
                let joints = roles.iter().flat_map(|&r| body.joints_of(r)).collect();
                (joints, *on_thorax)
            })
            .collect();
        let mut centroids = Vec::with_capacity(self.frames() * STACKED_DIMS);
        for f in 0..self.frames() {
            let frames = self.frames_at(f);
            let pelvis = frames[0];
            let thorax: Frame = body.thorax(&frames).unwrap_or(pelvis);
            for (joints, on_thorax) in &joints {
                let carrier = if *on_thorax { &thorax } else { &pelvis };
                let sum: Vector3<f64> = joints
                    .iter()
                    .map(|&j| carrier.local(&frames[j].position))
                    .sum();
                let mean = sum / joints.len().max(1) as f64;
                centroids.extend_from_slice(mean.as_slice());
            }
        }
        centroids
    }

    /// The length of the body's arm from shoulder to wrist, metres: the unit of centroid thresholds.
    pub fn limb_length(&self) -> f64 {
        let body = self.skeleton();
        let bones: f64 = [Role::LeftLowerArm, Role::LeftHand]
            .into_iter()
            .filter_map(|r| body.joints_of(r).first().copied())
            .map(|j| body.joints()[j].offset.norm())
            .sum();
        if bones > 0.0 { bones } else { 1.0 }
    }

    /// Weights of the coordinates in the activity `z(t)`: one over the squared range of each (Fod, Mataric, Jenkins 2002,
    /// with ranges instead of ones, so that the wrist's roll does not dominate). The spine's many joints share one weight.
    pub fn activity_weights(&self) -> Vec<f64> {
        let mut weights = Vec::with_capacity(self.skeleton().dof());
        for joint in self.skeleton().joints() {
            match &joint.kind {
                JointKind::Fixed => {}
                JointKind::Hinge { range, .. } => {
                    weights.push(joint.share * (range.high - range.low).powi(-2));
                }
                JointKind::Ball { ranges, .. } => {
                    let widest = ranges
                        .iter()
                        .map(|r| r.high - r.low)
                        .fold(f64::MIN_POSITIVE, f64::max);
                    weights.extend([joint.share * widest.powi(-2); 3]);
                }
            }
        }
        weights
    }
}
