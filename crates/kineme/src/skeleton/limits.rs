//! Joint limits: postures that a body cannot take are brought back smoothly, without Euler angles and their gimbal lock.

use nalgebra::{UnitQuaternion, Vector3};

use super::body::Skeleton;
use super::joint::{Joint, JointKind, Range};
use crate::math::rotation::{exp, log};

/// How far before its limit a coordinate begins to be held back, radians (3 degrees) ...
const TRANSITION: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// ... but at most this share of the width: a vertebra moves by few degrees altogether.
const MOST_TRANSITION: f64 = 0.125;
/// Postures of each clinical angle, ends included, that say how far a ball's range extends.
const POSTURES: usize = 9;

/// The limits of a joint's coordinates: one range of a hinge, three of a ball (along its clinical axes), none of a
/// joint that is fixed or the root.
pub(super) fn limits(joint: &Joint) -> Vec<Range> {
    match &joint.kind {
        // The root carries the body's orientation, and a body may lie or turn a somersault.
        _ if joint.parent.is_none() => vec![],
        JointKind::Fixed => vec![],
        JointKind::Hinge { range, .. } => vec![*range],
        JointKind::Ball { reference, ranges } => {
            let axes = axes(joint);
            let turns = [0, 1, 2].map(|k| turns(&axes[k], &ranges[k]));
            let mut limits = [Range {
                low: 0.0,
                high: 0.0,
            }; 3];
            for flexion in &turns[0] {
                for abduction in &turns[1] {
                    let before = reference.inverse() * flexion * abduction;
                    for axial in &turns[2] {
                        let coordinates = log(&(before * axial));
                        for (limit, axis) in limits.iter_mut().zip(&axes) {
                            let along = coordinates.dot(axis);
                            limit.low = limit.low.min(along);
                            limit.high = limit.high.max(along);
                        }
                    }
                }
            }
            limits.to_vec()
        }
    }
}

/// Rotations about an axis that divide a range evenly, its ends included.
fn turns(axis: &Vector3<f64>, range: &Range) -> [UnitQuaternion<f64>; POSTURES] {
    std::array::from_fn(|i| {
        let share = i as f64 / (POSTURES - 1) as f64;
        exp(&(axis * (range.low + share * (range.high - range.low))))
    })
}

fn axes(joint: &Joint) -> [Vector3<f64>; 3] {
    [joint.axes.flexion, joint.axes.abduction, joint.axes.axial]
}

/// `x` where it is well inside the range, else a value that nears the end and never passes it. Twice continuously
/// differentiable: the hyperbolic tangent leaves zero with slope 1 and without curvature.
fn held(x: f64, range: &Range) -> f64 {
    let width = TRANSITION.min(MOST_TRANSITION * (range.high - range.low));
    let (low, high) = (range.low + width, range.high - width);
    if x > high {
        high + width * ((x - high) / width).tanh()
    } else if x < low {
        low + width * ((x - low) / width).tanh()
    } else {
        x
    }
}

impl Skeleton {
    /// Brings `pose` smoothly within [`Self::limits`] and returns how many coordinates were held back.
    ///
    /// A coordinate more than 3 degrees inside its limits (or an eighth of their distance, if that is less) stays as
    /// it is, bit for bit; nearer or beyond it nears the limit, which it does not pass. The result is a twice
    /// continuously differentiable function of the pose. Limited again, a pose moves by less than a quarter of these
    /// 3 degrees. A ball is limited in its rotation vector along the clinical axes (taken as orthonormal), so there is
    /// no gimbal lock, and the mirrored pose is limited to the mirror image.
    ///
    /// # Panics
    /// When `pose` has not [`Skeleton::dof`] coordinates.
    pub fn limited(&self, pose: &mut [f64]) -> usize {
        assert_eq!(pose.len(), self.dof(), "coordinates of {}", self.name());
        let mut count = 0;
        for (j, joint) in self.joints().iter().enumerate() {
            let at = self.coordinates(j);
            match self.limits(j) {
                [range] => {
                    let x = pose[at.start];
                    pose[at.start] = held(x, range);
                    count += usize::from(pose[at.start] != x);
                }
                ranges @ [_, _, _] => {
                    let before = Vector3::from_column_slice(&pose[at.clone()]);
                    let mut after = before;
                    for (axis, range) in axes(joint).iter().zip(ranges) {
                        let x = before.dot(axis);
                        let change = held(x, range) - x;
                        if change != 0.0 {
                            after += axis * change;
                            count += 1;
                        }
                    }
                    pose[at].copy_from_slice(after.as_slice());
                }
                _ => {}
            }
        }
        count
    }
}
