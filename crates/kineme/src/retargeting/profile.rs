//! Profiles: which joint of a vendor's skeleton plays which role.

use std::collections::BTreeMap;

use crate::error::{Error, Result};
use crate::skeleton::Role;

/// Joint names of a kind of skeleton, by role; several candidates a role, the first that exists counts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Profile {
    /// The profile's name.
    pub name: String,
    /// Candidate joint names of each role.
    pub roles: BTreeMap<Role, Vec<String>>,
}

/// Which joint of a recording plays each role, and how that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoleMap {
    /// The profile that matched, or `guessed`.
    pub profile: String,
    /// Joint index of each role found.
    pub joints: BTreeMap<Role, usize>,
}

/// Roles without which a movement cannot be transferred: both arms to the elbow's end and both thighs.
pub const REQUIRED: [Role; 6] = [
    Role::LeftUpperArm,
    Role::LeftLowerArm,
    Role::RightUpperArm,
    Role::RightLowerArm,
    Role::LeftUpperLeg,
    Role::RightUpperLeg,
];

/// Built-in profiles: name, roles of the trunk, roles of the left side (`{Side}` Left, `{side}` left, `{S}` L, `{s}` l).
const BUILT_IN: &[(&str, &str, &str)] = &[
    (
        "cmu-bvh",
        "hips=Hips spine=LowerBack chest=Spine upper_chest=Spine1 neck=Neck head=Head",
        "shoulder={Side}Shoulder upper_arm={Side}Arm lower_arm={Side}ForeArm hand={Side}FingerBase,{Side}Hand \
         fingers={Side}HandIndex1 upper_leg={Side}UpLeg lower_leg={Side}Leg foot={Side}Foot toes={Side}ToeBase",
    ),
    (
        "acclaim",
        "hips=root spine=lowerback chest=upperback upper_chest=thorax neck=lowerneck head=head",
        "shoulder={s}clavicle upper_arm={s}humerus lower_arm={s}radius hand={s}hand,{s}wrist fingers={s}fingers \
         upper_leg={s}femur lower_leg={s}tibia foot={s}foot toes={s}toes",
    ),
    (
        "bandai-namco",
        "hips=Hips spine=Spine chest=Chest neck=Neck head=Head",
        "shoulder=Shoulder_{S} upper_arm=UpperArm_{S} lower_arm=LowerArm_{S} hand=Hand_{S} \
         upper_leg=UpperLeg_{S} lower_leg=LowerLeg_{S} foot=Foot_{S} toes=Toes_{S}",
    ),
    (
        "character-creator",
        "hips=CC_Base_Pelvis,CC_Base_Hip spine=CC_Base_Spine01 chest=CC_Base_Spine02 neck=CC_Base_NeckTwist01 head=CC_Base_Head",
        "shoulder=CC_Base_{S}_Clavicle upper_arm=CC_Base_{S}_Upperarm lower_arm=CC_Base_{S}_Forearm \
         hand=CC_Base_{S}_Hand fingers=CC_Base_{S}_Mid1 upper_leg=CC_Base_{S}_Thigh lower_leg=CC_Base_{S}_Calf \
         foot=CC_Base_{S}_Foot toes=CC_Base_{S}_ToeBase",
    ),
    (
        "daz",
        "hips=hip spine=abdomen chest=chest neck=neck head=head",
        "shoulder={s}Collar upper_arm={s}Shldr lower_arm={s}ForeArm hand={s}Hand fingers={s}Mid1 \
         upper_leg={s}Thigh lower_leg={s}Shin foot={s}Foot toes={s}Toe",
    ),
    (
        "lafan1",
        "hips=Hips spine=Spine chest=Spine1 upper_chest=Spine2 neck=Neck head=Head",
        "shoulder={Side}Shoulder upper_arm={Side}Arm lower_arm={Side}ForeArm hand={Side}Hand \
         upper_leg={Side}UpLeg lower_leg={Side}Leg foot={Side}Foot toes={Side}Toe",
    ),
    (
        "mixamo",
        "hips=Hips spine=Spine chest=Spine1 upper_chest=Spine2 neck=Neck head=Head",
        "shoulder={Side}Shoulder upper_arm={Side}Arm lower_arm={Side}ForeArm hand={Side}Hand \
         fingers={Side}HandMiddle1 upper_leg={Side}UpLeg lower_leg={Side}Leg foot={Side}Foot toes={Side}ToeBase",
    ),
    (
        "smpl",
        "hips=Pelvis spine=Spine1 chest=Spine2 upper_chest=Spine3 neck=Neck head=Head",
        "shoulder={S}_Collar upper_arm={S}_Shoulder lower_arm={S}_Elbow hand={S}_Wrist fingers={S}_Hand \
         upper_leg={S}_Hip lower_leg={S}_Knee foot={S}_Ankle toes={S}_Foot",
    ),
    (
        "deepmimic",
        "hips=root chest=chest neck=neck",
        "upper_arm={side}_shoulder lower_arm={side}_elbow hand={side}_wrist upper_leg={side}_hip \
         lower_leg={side}_knee foot={side}_ankle",
    ),
    (
        "kinect",
        "hips=hip_center spine=spine neck=shoulder_center head=head",
        "upper_arm={side}_shoulder lower_arm={side}_elbow hand={side}_wrist fingers={side}_hand \
         upper_leg={side}_hip lower_leg={side}_knee foot={side}_ankle toes={side}_foot",
    ),
    (
        "mediapipe",
        "head=nose",
        "upper_arm={side}_shoulder lower_arm={side}_elbow hand={side}_wrist fingers={side}_index \
         upper_leg={side}_hip lower_leg={side}_knee foot={side}_ankle toes={side}_foot_index",
    ),
    (
        "kineme",
        "hips=pelvis spine=lumbar_3 chest=thoracic_1,waist neck=cervical_7,neck head=skull",
        "shoulder={side}_clavicle upper_arm={side}_shoulder lower_arm={side}_elbow hand={side}_wrist \
         fingers={side}_fingers upper_leg={side}_hip lower_leg={side}_knee foot={side}_ankle toes={side}_toes",
    ),
];

impl Profile {
    /// The built-in profiles: CMU, Acclaim (CMU and HDM05), Bandai-Namco, Character Creator, DAZ, LAFAN1, Mixamo, SMPL,
    /// DeepMimic, Kinect (also MSR-Action3D), MediaPipe and our own bodies.
    pub fn built_in() -> Vec<Profile> {
        BUILT_IN
            .iter()
            .map(|(name, trunk, sides)| built_in(name, trunk, sides))
            .collect()
    }

    /// The built-in profile of this name.
    ///
    /// # Errors
    /// For an unknown name; the message lists the known ones.
    pub fn named(name: &str) -> Result<Profile> {
        Self::built_in()
            .into_iter()
            .find(|p| p.name == name)
            .ok_or_else(|| Error::unknown_name("profile", name, BUILT_IN.iter().map(|(n, ..)| *n)))
    }

    /// The roles that this profile finds among joint names.
    pub fn matched(&self, names: &[&str]) -> RoleMap {
        let present: Vec<String> = names.iter().map(|n| plain(n)).collect();
        let joints = self
            .roles
            .iter()
            .filter_map(|(&role, candidates)| {
                let found = candidates.iter().find_map(|c| {
                    let wanted = plain(c);
                    present.iter().position(|p| *p == wanted)
                })?;
                Some((role, found))
            })
            .collect();
        RoleMap {
            profile: self.name.clone(),
            joints,
        }
    }

    /// Which of the roles that are needed it does not find, and what it calls that; `None` where it finds all.
    pub(super) fn why_not(&self, found: &RoleMap) -> Option<Error> {
        let missing = found.missing();
        let role = missing.first()?;
        let called = match self.roles.get(role) {
            None => "does not name".to_owned(),
            Some(names) => format!(
                "has no joint of this recording (`{}`) for",
                names.join("`, `")
            ),
        };
        Some(Error::invalid(format!(
            "the profile `{}` {called} the role {}, which is needed",
            self.name,
            role.name()
        )))
    }
}

impl RoleMap {
    /// The roles that are needed and missing.
    pub fn missing(&self) -> Vec<Role> {
        REQUIRED
            .into_iter()
            .filter(|r| !self.joints.contains_key(r))
            .collect()
    }

    /// The best built-in match for these joint names, else a guess from the names.
    ///
    /// # Errors
    /// When neither finds all required roles; the message lists the joints and the roles not found.
    pub fn detect(names: &[&str]) -> Result<RoleMap> {
        let best = Profile::built_in()
            .iter()
            .map(|p| p.matched(names))
            .filter(|m| m.missing().is_empty())
            // On a tie the earlier profile counts: `max_by_key` keeps the last, so look from behind.
            .rev()
            .max_by_key(|m| m.joints.len());
        if let Some(map) = best {
            return Ok(map);
        }
        let guess = super::guess::guess(names);
        let missing = guess.missing();
        if missing.is_empty() {
            return Ok(guess);
        }
        let missing: Vec<&str> = missing.iter().map(|r| r.name()).collect();
        Err(Error::unsupported(format!(
            "no joint found for {}; the joints are {}; name them with a profile (--profile FILE)",
            missing.join(", "),
            names.join(", ")
        )))
    }
}

fn built_in(name: &str, trunk: &str, sides: &str) -> Profile {
    let mut roles = BTreeMap::new();
    let mut add = |prefix: &str, entry: &str, side: [&str; 4]| {
        let Some((role, names)) = entry.split_once('=') else {
            return;
        };
        let Ok(role) = Role::parse(&format!("{prefix}{role}")) else {
            return;
        };
        let fill = |n: &str| {
            n.replace("{Side}", side[0])
                .replace("{side}", side[1])
                .replace("{S}", side[2])
                .replace("{s}", side[3])
        };
        roles.insert(role, names.split(',').map(fill).collect());
    };
    for entry in trunk.split_whitespace() {
        add("", entry, [""; 4]);
    }
    for entry in sides.split_whitespace() {
        add("left_", entry, ["Left", "left", "L", "l"]);
        add("right_", entry, ["Right", "right", "R", "r"]);
    }
    Profile {
        name: name.into(),
        roles,
    }
}

/// A name without vendor prefix (`mixamorig:`), separators and case.
fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    name.chars()
        .filter(|c| c.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_profile_parses_whole_and_has_what_is_required() {
        for (profile, (name, trunk, sides)) in Profile::built_in().iter().zip(BUILT_IN) {
            let entries = trunk.split_whitespace().count() + 2 * sides.split_whitespace().count();
            assert_eq!(profile.roles.len(), entries, "{name}: an entry is misspelt");
            for role in REQUIRED {
                assert!(profile.roles.contains_key(&role), "{name}: {}", role.name());
            }
        }
    }
}
