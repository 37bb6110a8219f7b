//! A motion of a body as a recording, so that it can be written to motion files.

use nalgebra::{UnitQuaternion, Vector3};

use super::body_motion::Motion;
use super::recording::{Format, Observed, RecordedJoint, Recording, Source};
use crate::math::rotation::{Axis, EulerOrder};

/// The Euler order under which rotations are written.
const ZYX: EulerOrder = EulerOrder([Axis::Z, Axis::Y, Axis::X]);

impl Recording {
    /// The recording of a motion: joints, offsets and names of its body, one rotation a joint and frame in the
    /// parent's frame, the root's position and heading in its own joint. Leaves carry the tips of their bones;
    /// joints that do not move have no Euler order.
    pub fn from_motion(motion: &Motion) -> Recording {
        let body = motion.skeleton();
        let carries = |j: usize| body.joints().iter().any(|k| k.parent == Some(j));
        let joints = body.joints().iter().enumerate().map(|(j, joint)| {
            let root = joint.parent.is_none();
            let moves = root || joint.kind.dof() > 0;
            RecordedJoint {
                name: joint.name.clone(),
                parent: joint.parent,
                offset: if root { Vector3::zeros() } else { joint.offset },
                tip: (!carries(j)).then_some(joint.tip),
                order: moves.then_some(ZYX),
                dof: match (root, moves) {
                    (true, _) => 6,
                    (false, true) => 3,
                    (false, false) => 0,
                },
            }
        });
        let mut rotations = Vec::with_capacity(motion.frames() * body.joints().len());
        for f in 0..motion.frames() {
            let pose = motion.pose(f);
            let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), motion.root(f).yaw);
            rotations.extend(body.joints().iter().enumerate().map(|(j, joint)| {
                let turn = body.rotation(j, &pose[body.coordinates(j)]);
                if joint.parent.is_none() {
                    heading * turn
                } else {
                    turn
                }
            }));
        }
        let mut translations = vec![None; body.joints().len()];
        translations[0] = Some(motion.roots().iter().map(|r| r.position).collect());
        Recording::of_parts(
            motion.name(),
            Source {
                format: Format::Synthetic,
                up: Axis::Z,
                unit_metres: 1.0,
                warnings: Vec::new(),
            },
            joints.collect(),
            motion.rate_hz(),
            motion.frames(),
            Observed::Rotations {
                rotations,
                translations,
            },
        )
    }
}
