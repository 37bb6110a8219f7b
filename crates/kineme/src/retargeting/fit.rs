//! From anatomical frames to the coordinates of a body.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

use super::anatomy::Anatomy;
use super::landmarks::Landmarks;
use super::own::own_motion;
use super::profile::{Profile, RoleMap};
use crate::error::Result;
use crate::math::rotation::{exp, log};
use crate::motion::{Motion, Recording};
use crate::skeleton::{Role, Root, Skeleton, adonis, ares};

/// A motion of a body with what had to be left open.
#[derive(Debug, Clone, PartialEq)]
pub struct Retargeted {
    /// The motion.
    pub motion: Motion,
    /// The profile that named the joints, or `guessed`.
    pub profile: String,
    /// Moving parts of the body that the source did not observe; they stay neutral.
    pub unobserved: Vec<Role>,
    /// Share of point samples that were missing and filled from their neighbours in time, in [0, 1].
    pub filled: f64,
}

/// Expresses a recording in the joints of `body`; `profile` names its joints, `None` detects or guesses them.
///
/// # Errors
/// When joints of the required roles cannot be found or were never seen.
pub fn retarget(
    recording: &Recording,
    body: &Arc<Skeleton>,
    profile: Option<&Profile>,
) -> Result<Retargeted> {
    if profile.is_none()
        && let Some(motion) = written_by_us(recording, body)
    {
        let (motion, unobserved) = motion?;
        return Ok(Retargeted {
            motion,
            profile: OURS.into(),
            unobserved,
            filled: 0.0,
        });
    }
    let names: Vec<&str> = recording.joints().iter().map(|j| j.name.as_str()).collect();
    let map = match profile {
        Some(p) => p.matched(&names),
        None => RoleMap::detect(&names)?,
    };
    let marks = Landmarks::of(recording, &map);
    let anatomy = Anatomy::of(&marks, body)?;
    let (motion, unobserved) = fit(recording.name(), recording.rate_hz(), &anatomy, body)?;
    Ok(Retargeted {
        motion,
        profile: map.profile,
        unobserved,
        filled: marks.filled,
    })
}

/// The name of the profile under which recordings of our own bodies are reported.
const OURS: &str = "kineme";

/// The motion of a recording that was made of one of our bodies, brought to `body`; `None` for any other recording.
fn written_by_us(
    recording: &Recording,
    body: &Arc<Skeleton>,
) -> Option<Result<(Motion, Vec<Role>)>> {
    if let Some(motion) = own_motion(recording, body) {
        return Some(motion.map(|m| (m, Vec::new())));
    }
    [ares, adonis].into_iter().find_map(|built_in| {
        let other = Arc::new(built_in().ok()?);
        let motion = own_motion(recording, &other)?;
        Some(motion.and_then(|m| transfer(&m, body)))
    })
}

/// The same movement on another body, joint by joint through the roles; also the roles that the first body lacks.
/// On the same body it is the same motion.
///
/// # Errors
/// When the motion cannot be expressed in finite numbers.
pub fn transfer(motion: &Motion, body: &Arc<Skeleton>) -> Result<(Motion, Vec<Role>)> {
    let from = motion.skeleton();
    if from == body {
        return Ok((motion.clone(), Vec::new()));
    }
    // At the neutral pose the frames of all bodies agree, so a joint's world orientation is its part's anatomical frame.
    let carriers: BTreeMap<Role, usize> = Role::ALL
        .iter()
        .filter_map(|&role| Some((anatomical(role), *from.joints_of(role).last()?)))
        .collect();
    let mut parts: BTreeMap<Role, Vec<UnitQuaternion<f64>>> = BTreeMap::new();
    let mut hips = Vec::with_capacity(motion.frames());
    for f in 0..motion.frames() {
        let frames = motion.frames_at(f);
        for (&role, &joint) in &carriers {
            parts.entry(role).or_default().push(frames[joint].rotation);
        }
        hips.push(motion.root(f).position);
    }
    let anatomy = Anatomy {
        parts,
        hips,
        scale: leg_length(from),
    };
    fit(motion.name(), motion.rate_hz(), &anatomy, body)
}

/// The role under which the anatomy keeps a part: the whole trunk up to the thorax is `Chest`, neck and head `Head`.
fn anatomical(role: Role) -> Role {
    match role {
        Role::Spine | Role::UpperChest => Role::Chest,
        Role::Neck => Role::Head,
        other => other,
    }
}

fn leg_length(body: &Skeleton) -> f64 {
    [Role::LeftLowerLeg, Role::LeftFoot]
        .into_iter()
        .filter_map(|r| body.joints_of(r).first().copied())
        .map(|j| body.joints()[j].offset.norm())
        .sum()
}

/// The chain of joints that brings each anatomical part about, from the root outward.
fn chains(body: &Skeleton) -> Vec<(Role, Vec<usize>)> {
    let mut chains = vec![
        (Role::Hips, body.joints_of(Role::Hips)),
        (Role::Chest, body.trunk()),
        (Role::Head, body.neck()),
    ];
    for &role in Role::ALL {
        if anatomical(role) == role && chains.iter().all(|(r, _)| *r != role) {
            chains.push((role, body.joints_of(role)));
        }
    }
    chains.retain(|(_, joints)| joints.iter().any(|&j| body.joints()[j].kind.dof() > 0));
    chains
}

/// The coordinates that bring every part nearest its anatomical frame, from the root outward, each joint starting from
/// where the ones before it really are.
fn fit(
    name: &str,
    rate_hz: f64,
    anatomy: &Anatomy,
    body: &Arc<Skeleton>,
) -> Result<(Motion, Vec<Role>)> {
    let chains = chains(body);
    let scale = leg_length(body) / anatomy.scale.max(1e-9);
    let goals: Vec<Option<Goal>> = (0..body.joints().len())
        .map(|j| Goal::of(j, &chains, anatomy, body))
        .collect();
    let mut poses = Vec::with_capacity(anatomy.hips.len() * body.dof());
    let mut roots = Vec::with_capacity(anatomy.hips.len());
    let mut pose = body.neutral();
    let mut before: Option<Vec<f64>> = None;
    let mut turned = vec![UnitQuaternion::identity(); body.joints().len()];
    for (f, (hips, yaw)) in anatomy.hips.iter().zip(anatomy.headings()).enumerate() {
        let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        for (j, joint) in body.joints().iter().enumerate() {
            let base = joint.parent.map_or(heading, |p| turned[p]);
            turned[j] = match &goals[j] {
                Some(goal) => {
                    let local = goal.rotation(&base, f);
                    base * body.set_rotation(&mut pose, j, &local, before.as_deref())
                }
                None => base * body.rotation(j, &pose[body.coordinates(j)]),
            };
        }
        poses.extend_from_slice(&pose);
        before.get_or_insert_with(Vec::new).clone_from(&pose);
        roots.push(Root {
            position: hips * scale,
            yaw,
        });
    }
    let unobserved = chains
        .iter()
        .map(|(role, _)| *role)
        .filter(|role| !anatomy.parts.contains_key(role))
        .collect();
    Ok((
        Motion::new(name, Arc::clone(body), rate_hz, poses, roots)?,
        unobserved,
    ))
}

/// What a joint has to bring about.
struct Goal<'a> {
    /// Orientation of the part at the end of its chain, one a frame.
    target: &'a [UnitQuaternion<f64>],
    /// Its share of the turning that it and the joints after it in the chain still have to do; 1 for the last.
    share: f64,
}

impl<'a> Goal<'a> {
    fn of(
        joint: usize,
        chains: &[(Role, Vec<usize>)],
        anatomy: &'a Anatomy,
        body: &Skeleton,
    ) -> Option<Self> {
        let (role, chain) = chains.iter().find(|(_, joints)| joints.contains(&joint))?;
        let left: f64 = chain
            .iter()
            .filter(|&&k| k >= joint)
            .map(|&k| body.joints()[k].share)
            .sum();
        let last = chain.last() == Some(&joint);
        Some(Self {
            target: anatomy.parts.get(role)?,
            share: if last {
                1.0
            } else {
                body.joints()[joint].share / left.max(1e-12)
            },
        })
    }

    /// The rotation in the parent's frame `base` that does the joint's share at frame `f`.
    fn rotation(&self, base: &UnitQuaternion<f64>, f: usize) -> UnitQuaternion<f64> {
        let local = base.inverse() * self.target[f];
        if self.share < 1.0 {
            exp(&(log(&local) * self.share))
        } else {
            local
        }
    }
}
