//! Recordings of our own bodies, as written from a [`Motion`]: read back joint by joint, without any geometry.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

use super::anatomy::headings;
use crate::error::Result;
use crate::motion::{Motion, Observed, Recording};
use crate::skeleton::{Root, Skeleton};

/// Angle (radians) by which a bone may lie off the body's: files round their offsets.
const OFF: f64 = 1e-2;

/// The motion of `body` that this is a recording of; `None` when it is the recording of anything else: when names,
/// parents or the directions of bones differ, or rotations are missing.
pub fn own_motion(recording: &Recording, body: &Arc<Skeleton>) -> Option<Result<Motion>> {
    let Observed::Rotations {
        rotations,
        translations,
    } = recording.observed()
    else {
        return None;
    };
    let joints = same_joints(recording, body)?;
    let columns = recording.joints().len();
    let frames = recording.frames();
    let turn = |f: usize, j: usize| rotations[f * columns + joints[j]];
    let roots: Vec<UnitQuaternion<f64>> = (0..frames).map(|f| turn(f, 0)).collect();
    let length = |offset: &dyn Fn(usize) -> Vector3<f64>| -> f64 {
        (1..body.joints().len()).map(|j| offset(j).norm()).sum()
    };
    let ours = length(&|j| body.joints()[j].offset);
    let theirs = length(&|j| recording.joints()[joints[j]].offset);
    let path = translations[joints[0]].as_deref();
    let mut pose = body.neutral();
    let mut before: Option<Vec<f64>> = None;
    let mut poses = Vec::with_capacity(frames * body.dof());
    let mut stands = Vec::with_capacity(frames);
    for (f, yaw) in headings(&roots).into_iter().enumerate() {
        let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        for j in 0..body.joints().len() {
            let local = match j {
                0 => heading.inverse() * turn(f, 0),
                _ => turn(f, j),
            };
            body.set_rotation(&mut pose, j, &local, before.as_deref());
        }
        poses.extend_from_slice(&pose);
        before.get_or_insert_with(Vec::new).clone_from(&pose);
        let place = path.map_or(recording.joints()[joints[0]].offset, |p| p[f]);
        stands.push(Root {
            position: place * (ours / theirs.max(1e-9)),
            yaw,
        });
    }
    Some(Motion::new(
        recording.name(),
        Arc::clone(body),
        recording.rate_hz(),
        poses,
        stands,
    ))
}

/// The recording's joint for each joint of the body, if all are there and their bones lie as the body's.
fn same_joints(recording: &Recording, body: &Skeleton) -> Option<Vec<usize>> {
    let theirs = recording.joints();
    if theirs.len() != body.joints().len() {
        return None;
    }
    let found: Vec<usize> = body
        .joints()
        .iter()
        .map(|joint| theirs.iter().position(|r| r.name == joint.name))
        .collect::<Option<_>>()?;
    let agree = body.joints().iter().enumerate().all(|(j, joint)| {
        let recorded = &theirs[found[j]];
        let short = |v: &Vector3<f64>| v.norm() < 1e-6;
        recorded.parent == joint.parent.map(|p| found[p])
            && (joint.parent.is_none()
                || short(&joint.offset) && short(&recorded.offset)
                || recorded.offset.angle(&joint.offset) < OFF)
    });
    agree.then_some(found)
}
