//! From a robot's bodies to a [`RobotModel`]: one joint a hinge, roles, the neutral posture, effectors.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Vector3};

use kineme::skeleton::{ClinicalAxes, Effector, Joint, JointKind, Link};
use kineme::{Role, Skeleton};

use super::neutral::{Rest, neutral};
use super::roles::{Roles, roles};
use super::tree::{Body, Hinge, Tree};
use super::{RobotHinge, RobotModel};
use crate::error::{FormatError, Place, Result};
use crate::profile::Profile;
use crate::sheet::quoted;

/// The robot of a file's bodies.
pub fn model(file: &str, mut tree: Tree, profile: Option<&Profile>) -> Result<RobotModel> {
    let mut warnings = std::mem::take(&mut tree.warnings);
    let members = robot_bodies(file, &tree.bodies, &mut warnings)?;
    let root = tree.bodies[members[0]].name.clone();
    let (mut rest, hinges) = joints(&tree.bodies, &members);
    let refused = |e: kineme::Error| FormatError::new(file, Place::File, e.to_string(), "a robot");
    let names: Vec<&str> = rest.iter().map(|j| j.joint.name.as_str()).collect();
    let moving: Vec<bool> = hinges.iter().map(Option::is_some).collect();
    let Roles { profile, of } = roles(file, &names, &moving, profile)?;
    for (joint, role) in rest.iter_mut().zip(of) {
        joint.joint.role = role;
        joint.joint.axes = ClinicalAxes::of(role);
    }
    if rest.iter().all(|j| j.joint.link.mass_kg == 0.0) {
        warnings.push("no <inertial>: masses are not known".into());
    }
    let title = tree.title.as_deref().filter(|t| !t.trim().is_empty());
    let title = title.unwrap_or(&root);
    let angles = neutral(title, &mut rest).map_err(refused)?;
    let effectors = effectors(&rest);
    let joints: Vec<Joint> = rest.into_iter().map(|j| j.joint).collect();
    let skeleton = Skeleton::new(title, joints, effectors).map_err(refused)?;
    let hinges = hinges.iter().flatten();
    Ok(RobotModel {
        skeleton,
        path: file.into(),
        mjcf: tree.mjcf.take(),
        hinges: hinges
            .zip(angles)
            .map(|(hinge, angle)| RobotHinge {
                joint: hinge.name.clone(),
                neutral_rad: hinge.reference + angle,
            })
            .collect(),
        root,
        profile,
        warnings,
    })
}

/// The bodies of the robot: of all that stand in the world the one with the most hinges, and what hangs on it.
fn robot_bodies(file: &str, bodies: &[Body], warnings: &mut Vec<String>) -> Result<Vec<usize>> {
    let mut base: Vec<usize> = (0..bodies.len()).collect();
    let mut count: BTreeMap<usize, usize> = BTreeMap::new();
    for (k, body) in bodies.iter().enumerate() {
        if let Some(parent) = body.parent {
            base[k] = base[parent];
        }
        *count.entry(base[k]).or_default() += body.hinges.len();
    }
    let most = count.iter().max_by_key(|(k, n)| (**n, usize::MAX - **k));
    let Some((&chosen, _)) = most.filter(|(_, n)| **n > 0) else {
        let found = "no body with a hinge";
        return Err(FormatError::new(
            file,
            Place::File,
            found,
            "a robot of hinges",
        ));
    };
    for (&other, _) in count.iter().filter(|(k, n)| **k != chosen && **n > 0) {
        let name = quoted(&bodies[other].name);
        warnings.push(format!("body {name} is not the robot; it is passed over"));
    }
    Ok((0..bodies.len()).filter(|&k| base[k] == chosen).collect())
}

/// One joint for each hinge, a fixed one for a body without; frames as at rest, not yet neutral. Beside each joint the
/// hinge that it is.
fn joints<'b>(bodies: &'b [Body], members: &[usize]) -> (Vec<Rest>, Vec<Option<&'b Hinge>>) {
    let mut rest: Vec<Rest> = Vec::new();
    let mut hinges = Vec::new();
    let mut last: BTreeMap<usize, usize> = BTreeMap::new();
    let names: BTreeSet<&str> = members
        .iter()
        .flat_map(|&k| &bodies[k].hinges)
        .map(|hinge| hinge.name.as_str())
        .collect();
    let mut taken: BTreeSet<String> = BTreeSet::new();
    for &k in members {
        let body = &bodies[k];
        let mut parent = body.parent.and_then(|p| last.get(&p).copied());
        let mut push = |name: String, kind, place, hinge| {
            let joint = Joint {
                name,
                parent,
                offset: Vector3::zeros(),
                kind,
                axes: ClinicalAxes::of(None),
                role: None,
                share: 1.0,
                tip: Vector3::zeros(),
                link: Link {
                    mass_kg: 0.0,
                    center: Vector3::zeros(),
                    inertia: Matrix3::zeros(),
                },
            };
            rest.push(Rest { joint, place });
            hinges.push(hinge);
            parent = Some(rest.len() - 1);
        };
        // The base is held, so that it is a joint even where hinges turn it.
        if body.parent.is_none() || body.hinges.is_empty() {
            let mut name = body.name.clone();
            while names.contains(name.as_str()) || !taken.insert(name.clone()) {
                name.push_str("_body");
            }
            push(name, JointKind::Fixed, body.position, None);
        }
        for hinge in &body.hinges {
            let kind = JointKind::Hinge {
                axis: hinge.axis,
                range: hinge.range,
            };
            push(hinge.name.clone(), kind, hinge.anchor, Some(hinge));
        }
        let end = rest.len() - 1;
        if let Some((mass_kg, center, inertia)) = body.inertial {
            rest[end].joint.link = Link {
                mass_kg,
                center: center - rest[end].place,
                inertia,
            };
        }
        last.insert(k, end);
    }
    (rest, hinges)
}

/// Wrists, ankles and the head's centre, as far as there are such parts; a limb without hand or foot ends at its tip.
fn effectors(rest: &[Rest]) -> Vec<Effector> {
    let last = |role: Role| rest.iter().rposition(|j| j.joint.role == Some(role));
    let end = |name: &str, end: Role, lower: Role| {
        let hinge = last(end).map(|joint| (joint, Vector3::zeros()));
        let (joint, point) =
            hinge.or_else(|| last(lower).map(|joint| (joint, rest[joint].joint.tip)))?;
        Some(Effector {
            name: name.into(),
            joint,
            point,
        })
    };
    let head = last(Role::Head).map(|joint| Effector {
        name: "head".into(),
        joint,
        point: rest[joint].joint.link.center,
    });
    [
        end("left_hand", Role::LeftHand, Role::LeftLowerArm),
        end("right_hand", Role::RightHand, Role::RightLowerArm),
        end("left_foot", Role::LeftFoot, Role::LeftLowerLeg),
        end("right_foot", Role::RightFoot, Role::RightLowerLeg),
        head,
    ]
    .into_iter()
    .flatten()
    .collect()
}
