//! [`JointSet`]: joints of a body, by the names of its parts and of single joints.

use super::body::Skeleton;
use super::role::Role;
use crate::error::{Error, Result};

/// The names of a body's parts. The trunk carries the pelvis' turning, and every arm its shoulder.
pub const PARTS: [&str; 6] = [
    "left_arm",
    "right_arm",
    "trunk",
    "head",
    "left_leg",
    "right_leg",
];

/// Some joints of a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JointSet {
    /// By joint.
    held: Vec<bool>,
}

/// The joints of a part of the body, those that cannot move included; empty when the body has no such part.
pub(crate) fn part(body: &Skeleton, name: &str) -> Vec<usize> {
    use Role::*;
    let of = |roles: &[Role]| -> Vec<usize> {
        roles
            .iter()
            .flat_map(|&role| body.joints_of(role))
            .collect()
    };
    match name {
        "left_arm" => of(&[
            LeftShoulder,
            LeftUpperArm,
            LeftLowerArm,
            LeftHand,
            LeftFingers,
        ]),
        "right_arm" => of(&[
            RightShoulder,
            RightUpperArm,
            RightLowerArm,
            RightHand,
            RightFingers,
        ]),
        "trunk" => [of(&[Hips]), body.trunk()].concat(),
        "head" => body.neck(),
        "left_leg" => of(&[LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes]),
        "right_leg" => of(&[RightUpperLeg, RightLowerLeg, RightFoot, RightToes]),
        _ => Vec::new(),
    }
}

impl JointSet {
    /// The joints that these names of parts ([`PARTS`]) and of single joints hold together.
    ///
    /// # Errors
    /// For a name that is neither a part nor a joint of the body: the message lists those that it has.
    pub fn named(body: &Skeleton, names: &[String]) -> Result<Self> {
        let mut held = vec![false; body.joints().len()];
        for name in names {
            let mut own = part(body, name);
            if own.is_empty() {
                own = vec![joint(body, name)?];
            }
            own.into_iter().for_each(|j| held[j] = true);
        }
        Ok(Self { held })
    }

    /// The joints with a flag that is true, one flag a joint.
    pub(crate) fn of(held: Vec<bool>) -> Self {
        Self { held }
    }

    /// Whether it holds a joint.
    pub fn holds(&self, joint: usize) -> bool {
        self.held[joint]
    }

    /// Whether it holds every joint that can move.
    pub fn is_whole(&self, body: &Skeleton) -> bool {
        (0..self.held.len()).all(|j| self.held[j] || body.coordinates(j).is_empty())
    }

    /// Whether it holds both legs, which carry the root.
    pub fn has_legs(&self, body: &Skeleton) -> bool {
        let legs = ["left_leg", "right_leg"].map(|name| part(body, name));
        let whole = |leg: &Vec<usize>| !leg.is_empty() && leg.iter().all(|&j| self.held[j]);
        legs.iter().all(whole)
    }

    /// The names of what it holds: whole parts, then single joints. Joints that cannot move are left out.
    pub fn names(&self, body: &Skeleton) -> Vec<String> {
        let moves = |j: &usize| !body.coordinates(*j).is_empty();
        let mut named = vec![false; self.held.len()];
        let mut names = Vec::new();
        for name in PARTS {
            let joints: Vec<usize> = part(body, name).into_iter().filter(moves).collect();
            if !joints.is_empty() && joints.iter().all(|&j| self.held[j]) {
                names.push(name.to_string());
                joints.into_iter().for_each(|j| named[j] = true);
            }
        }
        let single = (0..self.held.len()).filter(|&j| self.held[j] && !named[j]);
        names.extend(single.filter(moves).map(|j| body.joints()[j].name.clone()));
        names
    }
}

/// The joint of this name.
fn joint(body: &Skeleton, name: &str) -> Result<usize> {
    let joints = body.joints();
    joints.iter().position(|j| j.name == name).ok_or_else(|| {
        let parts = PARTS.into_iter().filter(|p| !part(body, p).is_empty());
        let known = parts.chain(joints.iter().map(|j| j.name.as_str()));
        Error::unknown_name("part or joint", name, known)
    })
}
