//! Guessing roles of an unknown skeleton from the words in its joint names.

use std::collections::BTreeMap;

use super::profile::RoleMap;
use crate::skeleton::Role;

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

/// The words of a name: `leftUpperArm_01` -> left, upper, arm, 01.
fn words(name: &str) -> Vec<String> {
    let name = name.rsplit(':').next().unwrap_or(name);
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        let starts = (c.is_uppercase() && before.is_lowercase())
            || (c.is_ascii_digit() != before.is_ascii_digit() && before.is_alphanumeric());
        if !c.is_alphanumeric() {
            words.push(String::new());
        } else {
            if starts || words.is_empty() {
                words.push(String::new());
            }
            if let Some(last) = words.last_mut() {
                last.extend(c.to_lowercase());
            }
        }
        before = c;
    }
    words.retain(|w| !w.is_empty());
    words
}

fn side(words: &[String]) -> Option<Side> {
    words.iter().find_map(|w| match w.as_str() {
        "l" | "left" | "lft" => Some(Side::Left),
        "r" | "right" | "rgt" => Some(Side::Right),
        w if w.starts_with("left") => Some(Side::Left),
        w if w.starts_with("right") => Some(Side::Right),
        _ => None,
    })
}

/// Part of a limb, tested in this order: the first whose words all occur counts.
const LIMBS: &[(&[&str], Role, Role)] = &[
    (&["fore", "arm"], Role::LeftLowerArm, Role::RightLowerArm),
    (&["forearm"], Role::LeftLowerArm, Role::RightLowerArm),
    (&["lower", "arm"], Role::LeftLowerArm, Role::RightLowerArm),
    (&["elbow"], Role::LeftLowerArm, Role::RightLowerArm),
    (&["radius"], Role::LeftLowerArm, Role::RightLowerArm),
    (&["upper", "arm"], Role::LeftUpperArm, Role::RightUpperArm),
    (&["up", "arm"], Role::LeftUpperArm, Role::RightUpperArm),
    (&["upperarm"], Role::LeftUpperArm, Role::RightUpperArm),
    (&["humerus"], Role::LeftUpperArm, Role::RightUpperArm),
    (&["wrist"], Role::LeftHand, Role::RightHand),
    (&["hand"], Role::LeftHand, Role::RightHand),
    (&["arm"], Role::LeftUpperArm, Role::RightUpperArm),
    (&["clavicle"], Role::LeftShoulder, Role::RightShoulder),
    (&["collar"], Role::LeftShoulder, Role::RightShoulder),
    (&["shoulder"], Role::LeftShoulder, Role::RightShoulder),
    (&["upper", "leg"], Role::LeftUpperLeg, Role::RightUpperLeg),
    (&["up", "leg"], Role::LeftUpperLeg, Role::RightUpperLeg),
    (&["thigh"], Role::LeftUpperLeg, Role::RightUpperLeg),
    (&["femur"], Role::LeftUpperLeg, Role::RightUpperLeg),
    (&["hip"], Role::LeftUpperLeg, Role::RightUpperLeg),
    (&["lower", "leg"], Role::LeftLowerLeg, Role::RightLowerLeg),
    (&["knee"], Role::LeftLowerLeg, Role::RightLowerLeg),
    (&["shin"], Role::LeftLowerLeg, Role::RightLowerLeg),
    (&["calf"], Role::LeftLowerLeg, Role::RightLowerLeg),
    (&["tibia"], Role::LeftLowerLeg, Role::RightLowerLeg),
    (&["toe"], Role::LeftToes, Role::RightToes),
    (&["toes"], Role::LeftToes, Role::RightToes),
    (&["ankle"], Role::LeftFoot, Role::RightFoot),
    (&["foot"], Role::LeftFoot, Role::RightFoot),
    (&["leg"], Role::LeftLowerLeg, Role::RightLowerLeg),
];

const TRUNK: &[(&str, Role)] = &[
    ("hips", Role::Hips),
    ("pelvis", Role::Hips),
    ("root", Role::Hips),
    ("chest", Role::Chest),
    ("thorax", Role::Chest),
    ("spine", Role::Spine),
    ("abdomen", Role::Spine),
    ("waist", Role::Spine),
    ("neck", Role::Neck),
    ("head", Role::Head),
];

/// A guess at the part that a robot's joint of this name turns: a robot names several hinges alike, and has shoulders for
/// upper arms and a waist or torso for a chest.
pub fn guess_role(name: &str) -> Option<Role> {
    let words = words(name);
    if side(&words).is_none() && words.iter().any(|w| w == "torso" || w == "waist") {
        return Some(Role::Chest);
    }
    guess(&[name]).joints.into_keys().next()
}

/// A guess at the roles of joints with these names; the first joint of a role counts.
pub fn guess(names: &[&str]) -> RoleMap {
    let mut joints = BTreeMap::new();
    for (i, name) in names.iter().enumerate() {
        let words = words(name);
        let has = |w: &str| words.iter().any(|x| x.ends_with(w) || x.starts_with(w));
        let role = match side(&words) {
            Some(s) => LIMBS
                .iter()
                .find(|(parts, ..)| parts.iter().all(|p| has(p)))
                .map(|&(_, left, right)| if s == Side::Left { left } else { right }),
            None => TRUNK.iter().find(|(w, _)| has(w)).map(|&(_, r)| r),
        };
        if let Some(role) = role {
            joints.entry(role).or_insert(i);
        }
    }
    // Skeletons of points name the shoulder joint `shoulder` and have no upper arm.
    for (shoulder, arm) in [
        (Role::LeftShoulder, Role::LeftUpperArm),
        (Role::RightShoulder, Role::RightUpperArm),
    ] {
        if !joints.contains_key(&arm)
            && let Some(joint) = joints.remove(&shoulder)
        {
            joints.insert(arm, joint);
        }
    }
    RoleMap {
        profile: "guessed".into(),
        joints,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hinges_of_robots_are_guessed_one_by_one() {
        for (name, role) in [
            ("left_hip_yaw_joint", Some(Role::LeftUpperLeg)),
            ("left_shoulder_pitch", Some(Role::LeftUpperArm)),
            ("r_wrist_roll", Some(Role::RightHand)),
            ("torso", Some(Role::Chest)),
            ("waist_yaw_joint", Some(Role::Chest)),
            ("gripper", None),
        ] {
            assert_eq!(guess_role(name), role, "{name}");
        }
    }

    #[test]
    fn unknown_names_are_guessed_by_their_words() {
        for (name, role) in [
            ("Bip01 L UpperArm", Role::LeftUpperArm),
            ("RightUpLeg", Role::RightUpperLeg),
            ("l_forearm", Role::LeftLowerArm),
            ("rightShin", Role::RightLowerLeg),
            ("Spine1", Role::Spine),
            ("left_elbow", Role::LeftLowerArm),
            ("r_shoulder", Role::RightUpperArm),
        ] {
            assert_eq!(guess_role(name), Some(role), "{name}");
            let map = guess(&[name]);
            assert_eq!(map.joints.keys().collect::<Vec<_>>(), [&role], "{name}");
        }
    }
}
