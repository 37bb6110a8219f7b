//! Anatomical landmarks of a recording: where the joints of each role were, and how they were turned.

use std::collections::BTreeMap;

use nalgebra::{UnitQuaternion, Vector3};

use super::profile::RoleMap;
use crate::motion::{Observed, Recording};
use crate::skeleton::Role;

/// Paths of landmarks by role, gaps filled, and the orientations of the joints where the source has them.
#[derive(Debug, Clone, PartialEq)]
pub struct Landmarks {
    /// Frames.
    pub frames: usize,
    /// World position of each role's joint, metres, one a frame.
    pub positions: BTreeMap<Role, Vec<Vector3<f64>>>,
    /// World orientation of each role's joint in the source's own convention.
    pub rotations: BTreeMap<Role, Vec<UnitQuaternion<f64>>>,
    /// World positions of the source's zero pose, where it has rotations.
    pub rest: BTreeMap<Role, Vector3<f64>>,
    /// Share of point samples that were missing and have been filled, in [0, 1].
    pub filled: f64,
}

/// Ends of limbs that a source may give only as the tip of the bone before.
const TIPS: [(Role, Role); 6] = [
    (Role::LeftHand, Role::LeftLowerArm),
    (Role::RightHand, Role::RightLowerArm),
    (Role::LeftFingers, Role::LeftHand),
    (Role::RightFingers, Role::RightHand),
    (Role::LeftToes, Role::LeftFoot),
    (Role::RightToes, Role::RightFoot),
];

impl Landmarks {
    /// The landmarks of a recording whose joints play these roles. Points missing in some frames are filled linearly
    /// between their neighbours in time; a point that was never seen is absent.
    pub fn of(recording: &Recording, map: &RoleMap) -> Self {
        let frames = recording.frames();
        let mut seen: BTreeMap<Role, Vec<Option<Vector3<f64>>>> = BTreeMap::new();
        let mut rotations: BTreeMap<Role, Vec<UnitQuaternion<f64>>> = BTreeMap::new();
        let tips: Vec<(Role, usize, Vector3<f64>)> = TIPS
            .iter()
            .filter(|(role, _)| !map.joints.contains_key(role))
            .filter_map(|(role, carrier)| {
                let joint = *map.joints.get(carrier)?;
                let tip = recording.joints()[joint].tip?;
                (tip.norm() > 1e-6).then_some((*role, joint, tip))
            })
            .collect();
        for frame in 0..frames {
            let placed = recording.placements(frame);
            for (&role, &joint) in &map.joints {
                seen.entry(role).or_default().push(placed[joint].position);
                if let Some(q) = placed[joint].rotation {
                    rotations.entry(role).or_default().push(q);
                }
            }
            for (role, joint, tip) in &tips {
                let point = match (placed[*joint].position, placed[*joint].rotation) {
                    (Some(p), Some(q)) => Some(p + q * tip),
                    _ => None,
                };
                seen.entry(*role).or_default().push(point);
            }
        }
        let samples: usize = seen.values().map(Vec::len).sum();
        let missing: usize = seen
            .values()
            .map(|p| p.iter().filter(|x| x.is_none()).count())
            .sum();
        let positions = seen
            .into_iter()
            .filter_map(|(role, path)| Some((role, filled(&path)?)))
            .collect();
        Self {
            frames,
            positions,
            rotations,
            rest: rest(recording, map, &tips),
            filled: missing as f64 / samples.max(1) as f64,
        }
    }

    /// The path of a role's joint.
    pub fn path(&self, role: Role) -> Option<&[Vector3<f64>]> {
        self.positions.get(&role).map(Vec::as_slice)
    }

    /// The path midway between two roles' joints.
    pub fn middle(&self, a: Role, b: Role) -> Option<Vec<Vector3<f64>>> {
        let (a, b) = (self.path(a)?, self.path(b)?);
        Some(a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect())
    }
}

/// The zero pose of a recording with rotations: offsets added up.
fn rest(
    recording: &Recording,
    map: &RoleMap,
    tips: &[(Role, usize, Vector3<f64>)],
) -> BTreeMap<Role, Vector3<f64>> {
    if matches!(recording.observed(), Observed::Positions(_)) {
        return BTreeMap::new();
    }
    let mut places: Vec<Vector3<f64>> = Vec::with_capacity(recording.joints().len());
    for joint in recording.joints() {
        let base = joint.parent.map_or(Vector3::zeros(), |p| places[p]);
        places.push(base + joint.offset);
    }
    let joints = map
        .joints
        .iter()
        .map(|(&role, &joint)| (role, places[joint]));
    let ends = tips
        .iter()
        .map(|(role, joint, tip)| (*role, places[*joint] + tip));
    joints.chain(ends).collect()
}

/// A path with its gaps filled linearly and its ends held; `None` when nothing was seen.
fn filled(path: &[Option<Vector3<f64>>]) -> Option<Vec<Vector3<f64>>> {
    let known: Vec<usize> = (0..path.len()).filter(|&i| path[i].is_some()).collect();
    let (first, last) = (*known.first()?, *known.last()?);
    let at = |i: usize| path[i].unwrap_or_else(Vector3::zeros);
    let mut next = 0;
    let fill = |i: usize| {
        if i <= first {
            return at(first);
        }
        if i >= last {
            return at(last);
        }
        while known[next] < i {
            next += 1;
        }
        let b = known[next];
        if b == i {
            return at(i);
        }
        let a = known[next - 1];
        at(a) + (at(b) - at(a)) * ((i - a) as f64 / (b - a) as f64)
    };
    Some((0..path.len()).map(fill).collect())
}
