//! Poses written in clinical angles, as people describe them.

use super::body::Skeleton;
use super::joint::JointKind;
use super::role::Role;
use crate::error::{Error, Result};
use crate::math::rotation::{exp, log};

impl Skeleton {
    /// Writes clinical angles (degrees) of the part `role` into `pose`: of a ball joint flexion, abduction and axial
    /// rotation, of a hinge flexion; trailing angles that are left out are zero. Their meaning and signs are those
    /// of [`super::ClinicalAxes`]; at zero the part is neutral.
    ///
    /// Where several joints play the role (vertebrae) they share the rotation by [`super::Joint::share`], all about one
    /// axis, so that together they make exactly the rotation asked for. A body without a joint of its own for `spine`
    /// or `neck` (Adonis) moves the joint that does their work: that of `chest` or `head`.
    ///
    /// # Errors
    /// For a role that the body lacks or does not move (the message lists those it has), no angle or more than the
    /// joint has, an angle that is not finite, a pose of another body, a part made of several hinges.
    pub fn set_clinical(&self, pose: &mut [f64], role: Role, degrees: &[f64]) -> Result<()> {
        if pose.len() != self.dof() {
            return Err(Error::invalid(format!(
                "a pose of {} has {} coordinates, found {}",
                self.name(),
                self.dof(),
                pose.len()
            )));
        }
        let joints = self.moved_by(role)?;
        let hinge = matches!(self.joints()[joints[0]].kind, JointKind::Hinge { .. });
        let most = if hinge { 1 } else { 3 };
        if degrees.is_empty() || degrees.len() > most {
            return Err(Error::invalid(format!(
                "{} of {} takes {}, found {} angles",
                role.name(),
                self.name(),
                if hinge {
                    "one angle (flexion)"
                } else {
                    "one to three angles (flexion, abduction, axial rotation)"
                },
                degrees.len()
            )));
        }
        if let Some(angle) = degrees.iter().find(|a| !a.is_finite()) {
            return Err(Error::invalid(format!(
                "{}: angles are finite degrees, found {angle}",
                role.name()
            )));
        }
        let angle = |i: usize| degrees.get(i).map_or(0.0, |d| d.to_radians());
        if hinge {
            if joints.len() > 1 {
                return Err(Error::unsupported(format!(
                    "{} of {} is {} hinges; clinical angles need a ball joint or a single hinge",
                    role.name(),
                    self.name(),
                    joints.len()
                )));
            }
            let joint = &self.joints()[joints[0]];
            // A robot's hinge may count the other way.
            let sign = match &joint.kind {
                JointKind::Hinge { axis, .. } if axis.dot(&joint.axes.flexion) < 0.0 => -1.0,
                _ => 1.0,
            };
            pose[self.coordinates(joints[0]).start] = sign * angle(0);
            return Ok(());
        }
        let shares: f64 = joints.iter().map(|&j| self.joints()[j].share).sum();
        for &j in &joints {
            let joint = &self.joints()[j];
            let whole = joint.axes.rotation(angle(0), angle(1), angle(2));
            let part = if joints.len() == 1 {
                whole
            } else {
                exp(&(log(&whole) * (joint.share / shares)))
            };
            self.set_rotation(pose, j, &part, None);
        }
        Ok(())
    }

    /// The joints that move when a script names this role; at least one.
    fn moved_by(&self, role: Role) -> Result<Vec<usize>> {
        let moving = |r: Role| -> Vec<usize> {
            self.joints_of(r)
                .into_iter()
                .filter(|&j| self.joints()[j].kind.dof() > 0)
                .collect()
        };
        let mut joints = moving(role);
        if self.joints_of(role).is_empty() {
            joints = match role {
                Role::Spine => moving(Role::Chest),
                Role::Neck => moving(Role::Head),
                _ => joints,
            };
        }
        if joints.is_empty() {
            let known = Role::ALL.iter().filter(|&&r| !moving(r).is_empty());
            return Err(Error::unknown_name(
                &format!("moving part of {}", self.name()),
                role.name(),
                known.map(|r| r.name()),
            ));
        }
        Ok(joints)
    }
}
