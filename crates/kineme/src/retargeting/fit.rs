//! From anatomical frames to the coordinates of a body.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

use super::anatomy::Anatomy;
use super::fitting::{Fitting, carriers, leg_length};
use super::hinges::Start;
use super::landmarks::Landmarks;
use super::own::own_motion;
use super::profile::{Profile, RoleMap};
use crate::error::{Error, Result};
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
    let anatomy = Anatomy::of(&marks, body).map_err(|e| match profile {
        Some(p) => p.why_not(&map).unwrap_or(e),
        None => e,
    })?;
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
    let carriers = carriers(from);
    let mut parts: BTreeMap<Role, Vec<UnitQuaternion<f64>>> = BTreeMap::new();
    let mut hips = Vec::with_capacity(motion.frames());
    for f in 0..motion.frames() {
        let frames = motion.frames_at(f);
        for &(role, joint) in &carriers {
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

/// The pose at which parts of `body` come nearest these orientations in the world; the trunk's is `Chest`, neck and head
/// are `Head`. Parts that are not named stay neutral. Hinges keep within their ranges where several move one part.
///
/// # Errors
/// When the body moves none of these parts.
pub fn posture(
    body: &Arc<Skeleton>,
    parts: &BTreeMap<Role, UnitQuaternion<f64>>,
) -> Result<Vec<f64>> {
    let mut fitting = Fitting::of(body);
    let targets: Vec<Option<UnitQuaternion<f64>>> = fitting
        .parts()
        .iter()
        .map(|role| parts.get(role).copied())
        .collect();
    if !parts.is_empty() && targets.iter().all(Option::is_none) {
        let names: Vec<&str> = parts.keys().map(|role| role.name()).collect();
        return Err(Error::unsupported(format!(
            "{} moves none of {}",
            body.name(),
            names.join(", ")
        )));
    }
    let mut pose = body.neutral();
    let heading = UnitQuaternion::identity();
    fitting.fit(&heading, |part| targets[part], Start::Anywhere, &mut pose);
    Ok(pose)
}

/// The coordinates that bring every part nearest its anatomical frame, from the root outward, each joint starting from
/// where the ones before it really are.
fn fit(
    name: &str,
    rate_hz: f64,
    anatomy: &Anatomy,
    body: &Arc<Skeleton>,
) -> Result<(Motion, Vec<Role>)> {
    let mut fitting = Fitting::of(body);
    let targets: Vec<Option<&[UnitQuaternion<f64>]>> = fitting
        .parts()
        .iter()
        .map(|role| anatomy.parts.get(role).map(Vec::as_slice))
        .collect();
    let scale = leg_length(body) / anatomy.scale.max(1e-9);
    let mut poses = Vec::with_capacity(anatomy.hips.len() * body.dof());
    let mut roots = Vec::with_capacity(anatomy.hips.len());
    let mut pose = body.neutral();
    let mut before: Option<Vec<f64>> = None;
    for (f, (hips, yaw)) in anatomy.hips.iter().zip(anatomy.headings()).enumerate() {
        let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let target = |part: usize| targets[part].map(|turns| turns[f]);
        let start = before.as_deref().map_or(Start::Anywhere, Start::After);
        fitting.fit(&heading, target, start, &mut pose);
        poses.extend_from_slice(&pose);
        before.get_or_insert_with(Vec::new).clone_from(&pose);
        roots.push(Root {
            position: hips * scale,
            yaw,
        });
    }
    let unobserved = fitting
        .parts()
        .iter()
        .copied()
        .filter(|role| !anatomy.parts.contains_key(role))
        .collect();
    Ok((
        Motion::new(name, Arc::clone(body), rate_hz, poses, roots)?,
        unobserved,
    ))
}
