//! Which hinges of a robot turn which part of a body.

use std::collections::BTreeMap;

use kineme::Role;
use kineme::retargeting::guess_role;

use crate::error::{FormatError, Place, Result};
use crate::profile::Profile;
use crate::sheet::quoted;

/// Built-in profiles: name, base, hinges of the trunk, hinges of either side (`{side}` left or right); of several hinges
/// of a role the names end in `_joint`.
const BUILT_IN: &[(&str, &str, &str)] = &[(
    "unitree-g1",
    "hips=pelvis chest=waist_yaw_joint,waist_roll_joint,waist_pitch_joint",
    "upper_arm={side}_shoulder_pitch_joint,{side}_shoulder_roll_joint,{side}_shoulder_yaw_joint \
     lower_arm={side}_elbow_joint \
     hand={side}_wrist_roll_joint,{side}_wrist_pitch_joint,{side}_wrist_yaw_joint \
     upper_leg={side}_hip_pitch_joint,{side}_hip_roll_joint,{side}_hip_yaw_joint \
     lower_leg={side}_knee_joint foot={side}_ankle_pitch_joint,{side}_ankle_roll_joint",
)];

/// Roles of joints, and the name of the profile that gave them.
pub struct Roles {
    pub profile: String,
    pub of: Vec<Option<Role>>,
}

/// The roles of joints of these names, of which `moving` move; the first is the base.
///
/// # Errors
/// When the given profile names a joint that is not there.
pub fn roles(
    file: &str,
    names: &[&str],
    moving: &[bool],
    profile: Option<&Profile>,
) -> Result<Roles> {
    let known: Vec<Profile>;
    let chosen = match profile {
        Some(given) => Some(given),
        None => {
            known = BUILT_IN.iter().map(built_in).collect();
            known.iter().find(|p| {
                let mut named = p.roles.values().flatten();
                named.all(|n| names.contains(&n.as_str()))
            })
        }
    };
    let mut of = vec![None; names.len()];
    let Some(profile) = chosen else {
        for (k, role) in of.iter_mut().enumerate() {
            *role = match k {
                0 => Some(Role::Hips),
                _ if moving[k] => guess_role(names[k]).filter(|r| *r != Role::Hips),
                _ => None,
            };
        }
        return Ok(Roles {
            profile: "guessed".into(),
            of,
        });
    };
    for (&role, joints) in &profile.roles {
        for joint in joints {
            let index = names.iter().position(|n| n == joint).ok_or_else(|| {
                let found = format!(
                    "no joint {}, which profile {} names as {}",
                    quoted(joint),
                    quoted(&profile.name),
                    role.name()
                );
                let expected = format!("one of {}", names.join(", "));
                FormatError::new(file, Place::File, found, expected)
            })?;
            of[index] = Some(role);
        }
    }
    if !of.contains(&Some(Role::Hips)) {
        of[0] = Some(Role::Hips);
    }
    Ok(Roles {
        profile: profile.name.clone(),
        of,
    })
}

fn built_in((name, trunk, sides): &(&str, &str, &str)) -> Profile {
    let mut roles = BTreeMap::new();
    let mut add = |prefix: &str, side: &str, entries: &str| {
        for entry in entries.split_whitespace() {
            let Some((role, joints)) = entry.split_once('=') else {
                continue;
            };
            if let Ok(role) = Role::parse(&format!("{prefix}{role}")) {
                let joints = joints.split(',').map(|j| j.replace("{side}", side));
                roles.insert(role, joints.collect());
            }
        }
    };
    add("", "", trunk);
    add("left_", "left", sides);
    add("right_", "right", sides);
    Profile {
        name: name.to_string(),
        up: None,
        unit_metres: None,
        roles,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_of_a_built_in_profile_is_a_role() {
        for entry @ (name, trunk, sides) in BUILT_IN {
            let count = trunk.split_whitespace().count() + 2 * sides.split_whitespace().count();
            assert_eq!(
                built_in(entry).roles.len(),
                count,
                "{name}: an entry is misspelt"
            );
        }
    }
}
