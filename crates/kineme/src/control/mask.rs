//! Masks: which joints a behaviour moves. Parts of the body by name, joints that a primitive moves.

use crate::error::{Error, Result};
use crate::primitive::Primitive;
use crate::skeleton::{Role, Skeleton};

/// The names of the parts.
const PARTS: [&str; 6] = [
    "left_arm",
    "right_arm",
    "trunk",
    "head",
    "left_leg",
    "right_leg",
];
/// Phases at which exemplars are looked at.
const PHASES: usize = 33;
/// A part of the body whose joints turn by less altogether is not moved, radians (about a degree).
const MOVES_RAD: f64 = 0.02;
/// Travel below this (metres, a second) is none.
const TRAVELS: f64 = 1e-3;

/// What a behaviour may move.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mask {
    /// By joint.
    pub joints: Vec<bool>,
    /// How much of its movement each joint is: shares of the ranges through which the primitive moves them; they sum to 1.
    pub stakes: Vec<f64>,
    /// Whether the root goes with it.
    pub root: bool,
}

/// The joints of a part of the body, those that cannot move included; empty when the body has no such part.
/// The trunk carries the pelvis' turning.
fn part(body: &Skeleton, name: &str) -> Vec<usize> {
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

impl Mask {
    /// The mask of these names of parts and joints; without any, the joints that the primitive moves, and the root if
    /// it travels. With names the root goes with both legs.
    ///
    /// # Errors
    /// For a name that is neither a part nor a joint of the body; when the primitive moves none of the joints.
    pub fn of(primitive: &Primitive, names: &[String]) -> Result<Self> {
        let body = primitive.body();
        let moved = Self::moved(primitive);
        if names.is_empty() {
            return Ok(moved);
        }
        let mut joints = vec![false; body.joints().len()];
        for name in names {
            let mut held = part(body, name);
            if held.is_empty() {
                held = vec![joint(body, name)?];
            }
            held.into_iter().for_each(|j| joints[j] = true);
        }
        if !joints.iter().zip(&moved.joints).any(|(a, b)| *a && *b) {
            return Err(Error::invalid(format!(
                "`{}` moves none of {}: it moves {}",
                primitive.name(),
                names.join(", "),
                moved.names(body).join(", ")
            )));
        }
        let legs = |name: &str| {
            let leg = part(body, name);
            !leg.is_empty() && leg.into_iter().all(|j| joints[j])
        };
        let root = legs("left_leg") && legs("right_leg");
        let of_joints = joints.iter().zip(&moved.stakes);
        let stakes: Vec<f64> = of_joints
            .map(|(held, stake)| if *held { *stake } else { 0.0 })
            .collect();
        Ok(Self {
            joints,
            stakes: normalised(stakes),
            root,
        })
    }

    /// What a primitive moves: parts of the body that differ between any two postures of its exemplars, each as a whole
    /// (a wave holds its elbow bent), and joints of no part that do.
    fn moved(primitive: &Primitive) -> Self {
        let body = primitive.body();
        let mut low = vec![f64::INFINITY; body.dof()];
        let mut high = vec![f64::NEG_INFINITY; body.dof()];
        let mut heights = [f64::INFINITY, f64::NEG_INFINITY];
        let mut travels = false;
        for exemplar in 0..primitive.exemplars().len() {
            for k in 0..PHASES {
                let sample = primitive.registered(exemplar, k as f64 / (PHASES - 1) as f64);
                for (c, x) in sample.pose.iter().enumerate() {
                    low[c] = low[c].min(*x);
                    high[c] = high[c].max(*x);
                }
                let t = &sample.travel;
                heights = [heights[0].min(t.height), heights[1].max(t.height)];
                travels |= [t.forward, t.left, t.yaw_rate]
                    .iter()
                    .any(|v| v.abs() > TRAVELS);
            }
        }
        let range = |j: usize| -> f64 {
            let square = |c: usize| (high[c] - low[c]).powi(2);
            body.coordinates(j).map(square).sum::<f64>().sqrt()
        };
        let ranges: Vec<f64> = (0..body.joints().len()).map(range).collect();
        let mut joints: Vec<bool> = ranges.iter().map(|range| *range > MOVES_RAD).collect();
        for name in PARTS {
            let own = part(body, name);
            let moves = own.iter().map(|&j| ranges[j]).sum::<f64>() > MOVES_RAD;
            own.into_iter().for_each(|j| joints[j] = moves);
        }
        let of_joints = joints.iter().zip(ranges);
        let stakes = of_joints.map(|(moves, range)| if *moves { range } else { 0.0 });
        Self {
            stakes: normalised(stakes.collect()),
            joints,
            root: travels || heights[1] - heights[0] > TRAVELS,
        }
    }

    /// The names of what it holds: whole parts, then single joints. Joints that cannot move are left out.
    pub fn names(&self, body: &Skeleton) -> Vec<String> {
        let moves = |j: &usize| !body.coordinates(*j).is_empty();
        let mut named = vec![false; self.joints.len()];
        let mut names = Vec::new();
        for name in PARTS {
            let joints: Vec<usize> = part(body, name).into_iter().filter(moves).collect();
            if !joints.is_empty() && joints.iter().all(|&j| self.joints[j]) {
                names.push(name.to_string());
                joints.into_iter().for_each(|j| named[j] = true);
            }
        }
        let single = (0..self.joints.len()).filter(|&j| self.joints[j] && !named[j]);
        names.extend(single.filter(moves).map(|j| body.joints()[j].name.clone()));
        names
    }
}

/// Shares of the whole; none of nothing.
fn normalised(mut shares: Vec<f64>) -> Vec<f64> {
    let whole: f64 = shares.iter().sum();
    if whole > 0.0 {
        shares.iter_mut().for_each(|share| *share /= whole);
    }
    shares
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
