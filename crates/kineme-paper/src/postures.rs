//! How far a predicted posture is from the true one, in the units that people know.

use std::sync::Arc;

use kineme::motion::landmark_dims;
use kineme::{Motion, Role, Root, Skeleton};
use nalgebra::{UnitQuaternion, Vector3};

use crate::sets::Result;

/// The joints of a person, each as a segment and the segment against which it turns. A spine of many vertebrae counts as
/// one joint, from pelvis to chest, or it would drown the limbs.
const JOINTS: [(Role, Option<Role>); 15] = [
    (Role::Hips, None),
    (Role::Chest, Some(Role::Hips)),
    (Role::Head, Some(Role::Chest)),
    (Role::LeftUpperArm, Some(Role::Chest)),
    (Role::LeftLowerArm, Some(Role::LeftUpperArm)),
    (Role::LeftHand, Some(Role::LeftLowerArm)),
    (Role::RightUpperArm, Some(Role::Chest)),
    (Role::RightLowerArm, Some(Role::RightUpperArm)),
    (Role::RightHand, Some(Role::RightLowerArm)),
    (Role::LeftUpperLeg, Some(Role::Hips)),
    (Role::LeftLowerLeg, Some(Role::LeftUpperLeg)),
    (Role::LeftFoot, Some(Role::LeftLowerLeg)),
    (Role::RightUpperLeg, Some(Role::Hips)),
    (Role::RightLowerLeg, Some(Role::RightUpperLeg)),
    (Role::RightFoot, Some(Role::RightLowerLeg)),
];

const WRISTS: [Role; 2] = [Role::LeftHand, Role::RightHand];

/// How far predicted postures are from the true ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Angle between joint rotations, degrees: root mean square over fifteen joints (pelvis against the heading, chest
    /// against pelvis, head against chest, shoulders, elbows, wrists, hips, knees, ankles) and postures.
    pub joint_deg: f64,
    /// Distance of the wrists, root and heading taken off, centimetres: root mean square over both and postures.
    pub wrist_cm: f64,
    /// Distance of the landmarks ([`Motion::landmarks`]), centimetres: root mean square over landmarks and postures.
    pub landmark_cm: f64,
}

impl Errors {
    /// The three numbers in the order of the fields.
    pub fn values(&self) -> [f64; 3] {
        [self.joint_deg, self.wrist_cm, self.landmark_cm]
    }
}

/// Postures prepared for comparison: what the root does is taken off.
#[derive(Debug, Clone)]
pub struct Postures {
    dims: usize,
    landmarks: Vec<f64>,
    /// Of each posture in turn.
    joints: Vec<UnitQuaternion<f64>>,
    wrists: Vec<Vector3<f64>>,
    per_posture: [usize; 2],
}

impl Postures {
    /// Poses of a body, frame-major.
    ///
    /// # Errors
    /// When the poses are none of the body.
    pub fn of_poses(body: &Arc<Skeleton>, poses: Vec<f64>) -> Result<Self> {
        let roots = vec![Root::ORIGIN; poses.len() / body.dof()];
        Ok(Self::of_motion(&Motion::new(
            "postures",
            Arc::clone(body),
            1.0,
            poses,
            roots,
        )?))
    }

    /// The postures of a motion, frame by frame.
    pub fn of_motion(motion: &Motion) -> Self {
        let body = motion.skeleton();
        let segment = |r: Role| body.joints_of(r).last().copied();
        let pairs: Vec<(usize, Option<usize>)> = JOINTS
            .iter()
            .filter_map(|&(own, against)| match against {
                Some(role) => Some((segment(own)?, Some(segment(role)?))),
                None => Some((segment(own)?, None)),
            })
            .collect();
        let hands: Vec<usize> = WRISTS
            .iter()
            .filter_map(|&r| body.joints_of(r).first().copied())
            .collect();
        let mut joints = Vec::with_capacity(motion.frames() * pairs.len());
        let mut wrists = Vec::with_capacity(motion.frames() * hands.len());
        for f in 0..motion.frames() {
            let frames = body.frames(motion.pose(f), &Root::ORIGIN);
            joints.extend(pairs.iter().map(|&(own, against)| match against {
                Some(a) => frames[a].rotation.inverse() * frames[own].rotation,
                None => frames[own].rotation,
            }));
            wrists.extend(hands.iter().map(|&h| frames[h].position));
        }
        Self {
            dims: landmark_dims(body),
            landmarks: motion.landmarks(),
            joints,
            wrists,
            per_posture: [pairs.len(), hands.len()],
        }
    }

    /// The number of postures.
    pub fn len(&self) -> usize {
        self.landmarks.len() / self.dims
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.landmarks.is_empty()
    }

    /// Landmarks of the postures, one after another, metres.
    pub fn landmarks(&self) -> &[f64] {
        &self.landmarks
    }

    /// The errors of these postures, each against that of the same place in `truth`.
    ///
    /// # Panics
    /// When there are not as many.
    pub fn against(&self, truth: &Postures) -> Errors {
        let places: Vec<(usize, usize)> = (0..self.len()).map(|i| (i, i)).collect();
        assert_eq!(self.len(), truth.len(), "as many postures as true ones");
        self.errors(truth, &places)
    }

    /// The error of one posture against one of `truth`.
    ///
    /// # Panics
    /// When there is no such posture.
    pub fn at(&self, own: usize, truth: &Postures, other: usize) -> Errors {
        self.errors(truth, &[(own, other)])
    }

    fn errors(&self, truth: &Postures, places: &[(usize, usize)]) -> Errors {
        let [joints, hands] = self.per_posture;
        let (mut turns, mut gaps, mut marks) = (0.0, 0.0, 0.0);
        for &(i, k) in places {
            let own = &self.joints[i * joints..(i + 1) * joints];
            let other = &truth.joints[k * joints..(k + 1) * joints];
            turns += squares(own.iter().zip(other).map(|(a, b)| a.angle_to(b)));
            let own = &self.wrists[i * hands..(i + 1) * hands];
            let other = &truth.wrists[k * hands..(k + 1) * hands];
            gaps += squares(own.iter().zip(other).map(|(a, b)| (a - b).norm()));
            let own = &self.landmarks[i * self.dims..(i + 1) * self.dims];
            let other = &truth.landmarks[k * self.dims..(k + 1) * self.dims];
            marks += squares(own.iter().zip(other).map(|(a, b)| a - b));
        }
        let root = |sum: f64, each: usize| (sum / (places.len() * each).max(1) as f64).sqrt();
        Errors {
            joint_deg: root(turns, joints).to_degrees(),
            wrist_cm: 100.0 * root(gaps, hands),
            landmark_cm: 100.0 * root(marks, self.dims / 3),
        }
    }
}

fn squares(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|v| v * v).sum()
}
