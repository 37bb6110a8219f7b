//! Parts whose orientation only the source's own rotations tell: head, hands and feet.

use nalgebra::{UnitQuaternion, Vector3};

use super::landmarks::Landmarks;
use crate::math::rotation::{frame_z_y, shortest};
use crate::skeleton::Role;

/// An angle (radians) that the mean orientation of a part never departs from what its landmarks say: more means that
/// the zero pose was misread.
const PLAUSIBLE: f64 = 1.75;

/// The source's zero pose, if it is a standing person: then it says how each part's own axes lie in the anatomy.
pub struct Resting<'a> {
    marks: &'a Landmarks,
    /// The orientation of the standing person.
    pub frame: UnitQuaternion<f64>,
}

impl<'a> Resting<'a> {
    /// The zero pose of these landmarks; `None` without one or when it does not stand upright.
    pub fn of(marks: &'a Landmarks) -> Option<Self> {
        let at = |r: Role| marks.rest.get(&r).copied();
        let (left, right) = (at(Role::LeftUpperLeg)?, at(Role::RightUpperLeg)?);
        let hips = 0.5 * (left + right);
        let shoulders = 0.5 * (at(Role::LeftUpperArm)? + at(Role::RightUpperArm)?);
        let feet = 0.5 * (at(Role::LeftFoot)? + at(Role::RightFoot)?);
        let upright = |v: Vector3<f64>| v.try_normalize(1e-9).is_some_and(|v| v.z > 0.8);
        let frame = frame_z_y(&Vector3::z(), &(left - right))?;
        (upright(shoulders - hips) && upright(hips - feet)).then_some(Self { marks, frame })
    }

    /// How a bone from `from` to `to` lies at rest: the neutral hanging bone swung the shortest way.
    pub fn bone(&self, from: Role, to: Role) -> Option<UnitQuaternion<f64>> {
        let direction = self.marks.rest.get(&to)? - self.marks.rest.get(&from)?;
        let local = (self.frame.inverse() * direction).try_normalize(1e-9)?;
        Some(self.frame * shortest(&-Vector3::z(), &local))
    }
}

/// A part's anatomical orientation from its own axes: turned as at rest, or where there is no usable rest so that it
/// agrees best with `estimate` over the recording.
pub fn oriented(
    own: &[UnitQuaternion<f64>],
    resting: Option<UnitQuaternion<f64>>,
    estimate: &[UnitQuaternion<f64>],
) -> Vec<UnitQuaternion<f64>> {
    let mean = calibration(own, estimate);
    let turn = resting
        .filter(|turn| turn.angle_to(&mean) < PLAUSIBLE)
        .unwrap_or(mean);
    own.iter().map(|q| q * turn).collect()
}

/// The constant turn from a part's own axes to the anatomy that agrees best with `estimate` over the recording.
fn calibration(
    own: &[UnitQuaternion<f64>],
    estimate: &[UnitQuaternion<f64>],
) -> UnitQuaternion<f64> {
    // Chordal mean (Markley et al. 2007): the main eigenvector of the sum of q q'.
    let mut sum = nalgebra::Matrix4::<f64>::zeros();
    let step = (own.len() / 512).max(1);
    for (a, b) in own.iter().zip(estimate).step_by(step) {
        let q = (a.inverse() * b).into_inner().coords;
        sum += q * q.transpose();
    }
    let eigen = sum.symmetric_eigen();
    let best = eigen.eigenvalues.imax();
    let v = eigen.eigenvectors.column(best);
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(v[3], v[0], v[1], v[2]))
}
