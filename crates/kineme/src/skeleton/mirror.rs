//! The mirror image of a pose about the sagittal plane (y to -y).

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::body::Skeleton;
use super::joint::JointKind;
use crate::error::{Error, Result};

/// How far (metres, radians) two halves of a body may differ and still be each other's image.
const SYMMETRIC: f64 = 1e-9;

/// A rotation seen in the mirror: conjugated by diag(1, -1, 1).
fn image(q: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(q.w, -q.i, q.j, -q.k))
}

impl Skeleton {
    /// For each coordinate of the mirrored pose the coordinate that it comes from and its sign.
    ///
    /// A reflection takes the rotation vector (x, y, z) to (-x, y, -z). A joint's counterpart has the mirrored role and
    /// the same place among the joints of that role; a joint without a role is its own.
    ///
    /// # Errors
    /// When the halves of the body are not each other's image.
    pub(crate) fn mirror(&self) -> Result<Vec<(usize, f64)>> {
        let counterparts: Vec<Option<usize>> = (0..self.joints().len())
            .map(|j| match self.joints()[j].role {
                None => Some(j),
                Some(role) => {
                    let rank = self.joints_of(role).iter().position(|&k| k == j)?;
                    self.joints_of(role.mirrored()).get(rank).copied()
                }
            })
            .collect();
        let mut sources = Vec::with_capacity(self.dof());
        for (j, joint) in self.joints().iter().enumerate() {
            let lopsided = || {
                Error::unsupported(format!(
                    "{}: joint `{}` has no mirror image on the other side",
                    self.name(),
                    joint.name
                ))
            };
            let other = counterparts[j].ok_or_else(lopsided)?;
            let twin = &self.joints()[other];
            let offset = Vector3::new(twin.offset.x, -twin.offset.y, twin.offset.z);
            let parents = joint.parent.map(|p| counterparts[p]) == twin.parent.map(Some);
            if !parents || (offset - joint.offset).norm() > SYMMETRIC {
                return Err(lopsided());
            }
            let from = self.coordinates(other).start;
            match (&joint.kind, &twin.kind) {
                (JointKind::Fixed, JointKind::Fixed) => {}
                (JointKind::Hinge { axis, .. }, JointKind::Hinge { axis: a, .. }) => {
                    let along = axis.dot(&Vector3::new(-a.x, a.y, -a.z));
                    if 1.0 - along.abs() > SYMMETRIC {
                        return Err(lopsided());
                    }
                    sources.push((from, along.signum()));
                }
                (
                    JointKind::Ball { reference, .. },
                    JointKind::Ball {
                        reference: other, ..
                    },
                ) if reference.angle_to(&image(other)) < SYMMETRIC => {
                    sources.extend([(from, -1.0), (from + 1, 1.0), (from + 2, -1.0)]);
                }
                _ => return Err(lopsided()),
            }
        }
        Ok(sources)
    }
}
