//! The neutral standing posture of a robot, found from where its joints lie, and the robot's joints as seen from it.
//!
//! At the engine's zero the arms of a robot may stick out, or its elbows be bent. The bone of a limb is the line between
//! the centres of its joints, and its hinge's axis says which way it faces; the posture is the one in which bones hang
//! and hinges lie across, as near as the hinges come.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use kineme::error::Result;
use kineme::math::rotation::frame_z_y;
use kineme::retargeting::posture;
use kineme::skeleton::{Joint, JointKind, Range};
use kineme::{Role, Skeleton};

/// A joint of a robot with its place in the world at rest, metres.
pub struct Rest {
    pub joint: Joint,
    pub place: Vector3<f64>,
}

/// Upper part, lower part, end.
const LIMBS: [[Role; 3]; 4] = [
    [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand],
    [Role::RightUpperArm, Role::RightLowerArm, Role::RightHand],
    [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot],
    [Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot],
];

/// Turns joints as at rest into joints as at the neutral posture, their offsets and tips set; returns the angle of each
/// hinge there, radians from rest.
///
/// # Errors
/// When the joints make no body.
pub fn neutral(name: &str, rest: &mut [Rest]) -> Result<Vec<f64>> {
    link(rest);
    let joints = rest.iter().map(|j| j.joint.clone()).collect();
    let body = Arc::new(Skeleton::new(name, joints, vec![])?);
    let mut angles = posture(&body, &targets(rest))?;
    for (j, at) in rest.iter().enumerate() {
        // Rest itself may lie beyond a stop.
        if let JointKind::Hinge { range, .. } = &at.joint.kind {
            let angle = &mut angles[body.coordinates(j).start];
            *angle = angle.max(range.low).min(range.high);
        }
    }
    let mut turned: Vec<UnitQuaternion<f64>> = Vec::with_capacity(rest.len());
    let mut places: Vec<Vector3<f64>> = Vec::with_capacity(rest.len());
    for (j, at) in rest.iter_mut().enumerate() {
        let (before, place) = match at.joint.parent {
            Some(p) => (turned[p], places[p] + turned[p] * at.joint.offset),
            None => (UnitQuaternion::identity(), at.place),
        };
        let turn = before * body.rotation(j, &angles[body.coordinates(j)]);
        if let JointKind::Hinge { axis, range } = &mut at.joint.kind {
            *axis = before * *axis;
            let angle = angles[body.coordinates(j).start];
            *range = Range {
                low: range.low - angle,
                high: range.high - angle,
            };
        }
        let link = &mut at.joint.link;
        link.center = turn * link.center;
        let matrix = turn.to_rotation_matrix().into_inner();
        link.inertia = matrix * link.inertia * matrix.transpose();
        turned.push(turn);
        places.push(place);
    }
    for (at, place) in rest.iter_mut().zip(places) {
        at.place = place;
    }
    link(rest);
    Ok(angles)
}

/// Sets the offsets of joints from their places, and where their bones end: where the next part begins, else as far
/// beyond the centre of mass as that lies away.
fn link(rest: &mut [Rest]) {
    // The first child of each joint, from behind so that the first comes last; before sensors and covers, which may
    // stand anywhere on a part, what moves.
    let mut next: Vec<Option<usize>> = vec![None; rest.len()];
    let hinge = |at: &Rest| matches!(at.joint.kind, JointKind::Hinge { .. });
    let mut moves: Vec<bool> = rest.iter().map(hinge).collect();
    for j in (0..rest.len()).rev() {
        if let Some(parent) = rest[j].joint.parent {
            moves[parent] |= moves[j];
            if moves[j] || next[parent].is_none_or(|other| !moves[other]) {
                next[parent] = Some(j);
            }
        }
    }
    for j in 0..rest.len() {
        rest[j].joint.offset = match rest[j].joint.parent {
            Some(p) => rest[j].place - rest[p].place,
            None => Vector3::zeros(),
        };
        rest[j].joint.tip = match next[j] {
            Some(next) => rest[next].place - rest[j].place,
            None => 2.0 * rest[j].joint.link.center,
        };
    }
}

/// How each part of a limb lies at the neutral posture, as a turn from rest.
fn targets(rest: &[Rest]) -> BTreeMap<Role, UnitQuaternion<f64>> {
    let mut targets = BTreeMap::new();
    for [upper, lower, end] in LIMBS {
        let (Some(root), Some(hinge)) = (center(rest, upper), center(rest, lower)) else {
            continue;
        };
        let last = rest.iter().rposition(|j| j.joint.role == Some(lower));
        let tip = center(rest, end)
            .or_else(|| last.map(|j| rest[j].place + rest[j].joint.tip))
            .unwrap_or(hinge);
        let across = hinges(rest, lower).next().map(|(_, axis)| axis);
        let Some(across) = across else {
            continue;
        };
        for (role, bone) in [(upper, hinge - root), (lower, tip - hinge)] {
            if let Some(turn) = hanging(&bone, &across) {
                targets.insert(role, turn);
            }
        }
        // The foot stands as it does at rest; the hand goes with the forearm.
        if matches!(end, Role::LeftFoot | Role::RightFoot) {
            targets.insert(end, UnitQuaternion::identity());
        }
    }
    targets
}

/// The least turn that makes a bone hang with its hinge across, whichever way round; `None` when it lies along the hinge.
fn hanging(bone: &Vector3<f64>, across: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let ways = [*across, -across];
    ways.iter()
        .filter_map(|y| Some(frame_z_y(&-bone, y)?.inverse()))
        .min_by(|a, b| a.angle().total_cmp(&b.angle()))
}

/// Places and axes of a role's hinges at rest, from the body outward.
fn hinges(rest: &[Rest], role: Role) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> {
    rest.iter()
        .filter(move |j| j.joint.role == Some(role))
        .filter_map(|j| match &j.joint.kind {
            JointKind::Hinge { axis, .. } => Some((j.place, axis.into_inner())),
            _ => None,
        })
}

/// The centre of a part's joint: the point of its last hinge's axis, which carries the bone, that lies nearest the axes
/// of the others (least squares); of a single hinge where it stands.
fn center(rest: &[Rest], role: Role) -> Option<Vector3<f64>> {
    let all: Vec<_> = hinges(rest, role).collect();
    let (&(place, along), others) = all.split_last()?;
    let (mut square, mut right) = (0.0, 0.0);
    for (other, axis) in others {
        let aside = Matrix3::identity() - axis * axis.transpose();
        let lever = aside * along;
        square += lever.norm_squared();
        right += lever.dot(&(other - place));
    }
    Some(match square > 1e-6 {
        true => place + along * (right / square),
        false => place,
    })
}
