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
    /// Frames a second.
    pub rate_hz: f64,
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

/// The landmark that carries another: gaps are filled in the vector from the one to the other, so that a hidden hand
/// goes along with its arm. Carriers come first.
const CARRIED: [(Role, Role); 20] = [
    (Role::RightUpperLeg, Role::LeftUpperLeg),
    (Role::Spine, Role::LeftUpperLeg),
    (Role::Chest, Role::LeftUpperLeg),
    (Role::UpperChest, Role::LeftUpperLeg),
    (Role::Neck, Role::LeftUpperLeg),
    (Role::LeftUpperArm, Role::LeftUpperLeg),
    (Role::RightUpperArm, Role::LeftUpperLeg),
    (Role::Head, Role::LeftUpperArm),
    (Role::LeftLowerArm, Role::LeftUpperArm),
    (Role::LeftHand, Role::LeftLowerArm),
    (Role::LeftFingers, Role::LeftHand),
    (Role::RightLowerArm, Role::RightUpperArm),
    (Role::RightHand, Role::RightLowerArm),
    (Role::RightFingers, Role::RightHand),
    (Role::LeftLowerLeg, Role::LeftUpperLeg),
    (Role::LeftFoot, Role::LeftLowerLeg),
    (Role::LeftToes, Role::LeftFoot),
    (Role::RightLowerLeg, Role::RightUpperLeg),
    (Role::RightFoot, Role::RightLowerLeg),
    (Role::RightToes, Role::RightFoot),
];

impl Landmarks {
    /// The landmarks of a recording whose joints play these roles. A point missing in some frames is filled linearly
    /// between its neighbours in time, relative to the landmark that carries it, and before the first and after the
    /// last moves along with that; a point that was never seen is absent.
    pub fn of(recording: &Recording, map: &RoleMap) -> Self {
        let frames = recording.frames();
        let joints: Vec<(Role, usize)> = map.joints.iter().map(|(&r, &j)| (r, j)).collect();
        let tips: Vec<(Role, usize, Vector3<f64>)> = TIPS
            .iter()
            .filter(|(role, _)| !map.joints.contains_key(role))
            .filter_map(|(role, carrier)| {
                let joint = *map.joints.get(carrier)?;
                let tip = recording.joints()[joint].tip?;
                (tip.norm() > 1e-6).then_some((*role, joint, tip))
            })
            .collect();
        let roles = || {
            let of_joints = joints.iter().map(|(r, _)| *r);
            of_joints.chain(tips.iter().map(|(r, ..)| *r))
        };
        let mut seen: Vec<Vec<Option<Vector3<f64>>>> =
            roles().map(|_| Vec::with_capacity(frames)).collect();
        let mut turns: Vec<Vec<UnitQuaternion<f64>>> = vec![Vec::new(); joints.len()];
        let mut placed = Vec::new();
        for frame in 0..frames {
            recording.place(frame, &mut placed);
            for (k, &(_, joint)) in joints.iter().enumerate() {
                seen[k].push(placed[joint].position);
                if let Some(q) = placed[joint].rotation {
                    turns[k].push(q);
                }
            }
            for (k, (_, joint, tip)) in tips.iter().enumerate() {
                let place = placed[*joint].position.zip(placed[*joint].rotation);
                seen[joints.len() + k].push(place.map(|(p, q)| p + q * tip));
            }
        }
        let samples: usize = seen.iter().map(Vec::len).sum();
        let missing: usize = seen
            .iter()
            .map(|p| p.iter().filter(|x| x.is_none()).count())
            .sum();
        let seen: BTreeMap<_, _> = roles().zip(seen).collect();
        let rotations = joints
            .iter()
            .map(|(r, _)| *r)
            .zip(turns)
            .filter(|(_, t)| t.len() == frames)
            .collect();
        Self {
            frames,
            rate_hz: recording.rate_hz(),
            positions: all_filled(seen),
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

/// All paths with their gaps filled, carriers first.
fn all_filled(
    mut seen: BTreeMap<Role, Vec<Option<Vector3<f64>>>>,
) -> BTreeMap<Role, Vec<Vector3<f64>>> {
    let mut done: BTreeMap<Role, Vec<Vector3<f64>>> = BTreeMap::new();
    let carried = CARRIED
        .iter()
        .map(|(role, carrier)| (*role, Some(*carrier)));
    let order: Vec<(Role, Option<Role>)> = std::iter::once((Role::LeftUpperLeg, None))
        .chain(carried)
        .chain(Role::ALL.iter().map(|&r| (r, Some(Role::LeftUpperLeg))))
        .collect();
    for (role, carrier) in order {
        let Some(path) = seen.remove(&role) else {
            continue;
        };
        let base = carrier.and_then(|c| done.get(&c));
        if let Some(whole) = filled(&path, base.map(Vec::as_slice)) {
            done.insert(role, whole);
        }
    }
    done
}

/// A path with its gaps filled linearly and its ends held, relative to `base`; `None` when nothing was seen.
fn filled(
    path: &[Option<Vector3<f64>>],
    base: Option<&[Vector3<f64>]>,
) -> Option<Vec<Vector3<f64>>> {
    let known: Vec<usize> = (0..path.len()).filter(|&i| path[i].is_some()).collect();
    let (first, last) = (*known.first()?, *known.last()?);
    let from = |i: usize| base.map_or(Vector3::zeros(), |b| b[i]);
    let at = |i: usize| path[i].map_or(Vector3::zeros(), |p| p - from(i));
    let mut next = 0;
    let fill = |i: usize| {
        if let Some(seen) = path[i] {
            return seen;
        }
        if i < first {
            return from(i) + at(first);
        }
        if i > last {
            return from(i) + at(last);
        }
        while known[next] < i {
            next += 1;
        }
        let (a, b) = (known[next - 1], known[next]);
        from(i) + at(a) + (at(b) - at(a)) * ((i - a) as f64 / (b - a) as f64)
    };
    Some((0..path.len()).map(fill).collect())
}
