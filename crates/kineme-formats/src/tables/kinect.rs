//! The 20 joints of the first Kinect's skeleton, which UTD-MHAD and MSR-Action3D share.

use kineme::RecordedJoint;
use nalgebra::Vector3;

/// Joint and parent, parents first; names as in UTD-MHAD, in the order of a walk from the hips.
pub(crate) const JOINTS: [(&str, Option<&str>); 20] = [
    ("hip_center", None),
    ("spine", Some("hip_center")),
    ("shoulder_center", Some("spine")),
    ("head", Some("shoulder_center")),
    ("left_shoulder", Some("shoulder_center")),
    ("left_elbow", Some("left_shoulder")),
    ("left_wrist", Some("left_elbow")),
    ("left_hand", Some("left_wrist")),
    ("right_shoulder", Some("shoulder_center")),
    ("right_elbow", Some("right_shoulder")),
    ("right_wrist", Some("right_elbow")),
    ("right_hand", Some("right_wrist")),
    ("left_hip", Some("hip_center")),
    ("left_knee", Some("left_hip")),
    ("left_ankle", Some("left_knee")),
    ("left_foot", Some("left_ankle")),
    ("right_hip", Some("hip_center")),
    ("right_knee", Some("right_hip")),
    ("right_ankle", Some("right_knee")),
    ("right_foot", Some("right_ankle")),
];

/// The place in [`JOINTS`] of a joint of this name, if it is one: `left_elbow`, `LeftElbow`, `ElbowLeft`.
pub(crate) fn find(name: &str) -> Option<usize> {
    let plain: String = name
        .chars()
        .filter(|c| c.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .collect();
    let sided = ["left", "right"].iter().find_map(|side| {
        let rest = plain.strip_suffix(side)?;
        Some(format!("{side}{rest}"))
    });
    let key = sided.unwrap_or(plain);
    JOINTS
        .iter()
        .position(|(joint, _)| joint.replace('_', "") == key)
}

/// The nearest ancestor of a joint of [`JOINTS`] that `present` knows.
pub(crate) fn ancestor(joint: usize, present: impl Fn(usize) -> bool) -> Option<usize> {
    let mut joint = joint;
    while let Some(parent) = JOINTS[joint].1 {
        joint = JOINTS.iter().position(|(name, _)| *name == parent)?;
        if present(joint) {
            return Some(joint);
        }
    }
    None
}

/// A joint of which only positions are observed: three coordinates, no rest offset known.
pub(crate) fn observed_joint(name: &str, parent: Option<usize>) -> RecordedJoint {
    RecordedJoint {
        name: name.to_string(),
        parent,
        offset: Vector3::zeros(),
        tip: None,
        order: None,
        dof: 3,
    }
}
