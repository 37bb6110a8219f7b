//! From markers on the skin to the centres of joints.

use std::collections::BTreeMap;

use kineme::retargeting::{Profile, REQUIRED};
use kineme::{Error, Observed, Recording, Role};

use super::marker_sets::{MarkerSet, plain};
use super::model::joints;
use super::places::{Path, Places};
use crate::tables::kinect::observed_joint;

/// The centres of joints as a recording, and which of them plays which role.
#[derive(Debug, Clone, PartialEq)]
pub struct Centred {
    /// A joint for each role, named `<role>_centre`.
    pub recording: Recording,
    /// For [`kineme::retargeting::retarget`].
    pub profile: Profile,
}

/// Where the joints are that markers surround.
///
/// With a profile each role's joint is midway between the markers that it lists, and missing where one of them is. Without
/// one the markers' names tell: of the conventional gait model the hips' centres follow from the pelvis (Harrington et al.
/// 2007), the shoulders lie below the acromion (Rab et al. 2002), elbows, knees and ankles inward of their marker, square
/// to the limb along the hinge's axis (Davis et al. 1991), or midway to a marker at the inside. `None` for markers of no
/// known set: then their own names are all there is.
///
/// # Errors
/// When the recording is none of positions, or a marker that the profile wants for a role that is needed is not there.
pub fn joint_centres(
    recording: &Recording,
    profile: Option<&Profile>,
) -> kineme::Result<Option<Centred>> {
    let Observed::Positions(seen) = recording.observed() else {
        return Err(Error::invalid("markers are positions, found rotations"));
    };
    let names: Vec<&str> = recording.joints().iter().map(|j| j.name.as_str()).collect();
    let markers = Places {
        seen,
        count: names.len(),
        frames: recording.frames(),
    };
    let (name, paths) = match profile {
        Some(profile) => (profile.name.clone(), listed(&markers, &names, profile)?),
        None => match MarkerSet::of(&names) {
            Some(set) => ("conventional-gait-model".into(), joints(&markers, &set)),
            None => return Ok(None),
        },
    };
    let centre = |role: Role| format!("{}_centre", role.name());
    let roles: Vec<Role> = paths.keys().copied().collect();
    let joints = roles
        .iter()
        .enumerate()
        .map(|(j, role)| observed_joint(&centre(*role), parent(*role, &roles[..j])));
    let frames = 0..recording.frames();
    let positions = frames.flat_map(|f| paths.values().map(move |path| path[f]));
    let profile = Profile {
        name,
        roles: roles.iter().map(|r| (*r, vec![centre(*r)])).collect(),
    };
    let recording = Recording::new(
        recording.name(),
        recording.source().clone(),
        joints.collect(),
        recording.rate_hz(),
        Observed::Positions(positions.collect()),
    )?;
    Ok(Some(Centred { recording, profile }))
}

/// The nearest of the joints before it on which a role's joint hangs.
fn parent(role: Role, before: &[Role]) -> Option<usize> {
    use Role::*;
    let chain: &[Role] = match role {
        Hips => &[],
        Spine | Chest | UpperChest | Neck | Head | LeftShoulder | RightShoulder => {
            &[Neck, UpperChest, Chest, Spine, Hips]
        }
        LeftUpperArm => &[LeftShoulder, Neck, UpperChest, Chest, Spine, Hips],
        RightUpperArm => &[RightShoulder, Neck, UpperChest, Chest, Spine, Hips],
        LeftUpperLeg | RightUpperLeg => &[Hips],
        LeftLowerArm | LeftHand | LeftFingers => &[LeftHand, LeftLowerArm, LeftUpperArm],
        RightLowerArm | RightHand | RightFingers => &[RightHand, RightLowerArm, RightUpperArm],
        LeftLowerLeg | LeftFoot | LeftToes => &[LeftFoot, LeftLowerLeg, LeftUpperLeg],
        RightLowerLeg | RightFoot | RightToes => &[RightFoot, RightLowerLeg, RightUpperLeg],
    };
    let find = |wanted: &Role| before.iter().position(|b| b == wanted);
    chain.iter().find_map(find)
}

/// Midway between the markers that a profile lists.
fn listed(
    markers: &Places<'_>,
    names: &[&str],
    profile: &Profile,
) -> kineme::Result<BTreeMap<Role, Path>> {
    let plain: Vec<String> = names.iter().map(|n| self::plain(n)).collect();
    let mut paths = BTreeMap::new();
    for (role, wanted) in &profile.roles {
        let mut found = Vec::new();
        let mut lost = None;
        for name in wanted {
            let own = self::plain(name);
            match plain.iter().position(|p| *p == own) {
                Some(marker) => found.push(marker),
                None => lost = Some(name),
            }
        }
        match lost {
            None => {
                paths.insert(*role, markers.middle(&found));
            }
            Some(name) if REQUIRED.contains(role) => {
                return Err(Error::invalid(format!(
                    "the profile `{}` wants the marker `{name}` for {}, which is needed; the markers are {}",
                    profile.name,
                    role.name(),
                    names.join(", ")
                )));
            }
            Some(_) => {}
        }
    }
    Ok(paths)
}
