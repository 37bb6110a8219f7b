//! Masks: which joints a behaviour moves.

use crate::error::{Error, Result};
use crate::primitive::{MOVES_RAD, Moved, Primitive};
use crate::skeleton::{JointSet, PARTS, Skeleton, part};

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
        let set = JointSet::named(body, names)?;
        let joints: Vec<bool> = (0..body.joints().len()).map(|j| set.holds(j)).collect();
        if !joints.iter().zip(&moved.joints).any(|(a, b)| *a && *b) {
            return Err(Error::invalid(format!(
                "`{}` moves none of {}: it moves {}",
                primitive.name(),
                names.join(", "),
                moved.names(body).join(", ")
            )));
        }
        let of_joints = joints.iter().zip(&moved.stakes);
        let stakes: Vec<f64> = of_joints
            .map(|(held, stake)| if *held { *stake } else { 0.0 })
            .collect();
        Ok(Self {
            joints,
            stakes: normalised(stakes),
            root: set.has_legs(body),
        })
    }

    /// What a primitive moves: parts of the body that differ between any two postures of its exemplars, each as a whole
    /// (a wave holds its elbow bent), and joints of no part that do.
    fn moved(primitive: &Primitive) -> Self {
        let body = primitive.body();
        let Moved { ranges, root } = Moved::of(primitive);
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
            root,
        }
    }

    /// The names of what it holds: whole parts, then single joints. Joints that cannot move are left out.
    pub fn names(&self, body: &Skeleton) -> Vec<String> {
        JointSet::of(self.joints.clone()).names(body)
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
