//! [`EffectorPaths`]: where hands, feet and head were, seen from between the shoulders. All that an encoder looks at.

use nalgebra::{UnitQuaternion, Vector3};

use super::heading::headings;
use crate::error::{Error, Result};
use crate::motion::{Motion, Recording};
use crate::primitive::{Observation, Observations};
use crate::retargeting::{Profile, RoleMap};
use crate::skeleton::{Role, Root, Skeleton};

/// The effectors that paths may be of, with the joint that a recording has for each, and that joint's carrier, whose
/// bone's tip serves where the recording has no such joint.
const EFFECTORS: [(&str, Role, Option<Role>); 5] = [
    ("left_hand", Role::LeftHand, Some(Role::LeftLowerArm)),
    ("right_hand", Role::RightHand, Some(Role::RightLowerArm)),
    ("left_foot", Role::LeftFoot, Some(Role::LeftLowerLeg)),
    ("right_foot", Role::RightFoot, Some(Role::RightLowerLeg)),
    ("head", Role::Head, None),
];

/// Paths of effectors in the upright thorax frame: origin midway between the shoulders, z up, y along the horizontal
/// part of the line of the shoulders (left), x forward. Metres of whoever was observed; points may be missing.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectorPaths {
    rate_hz: f64,
    effectors: Vec<String>,
    /// Frame-major.
    points: Vec<Option<Vector3<f64>>>,
}

/// World places at one frame, as far as they were seen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Places {
    /// Left and right shoulder.
    pub shoulders: Option<[Vector3<f64>; 2]>,
    pub effectors: Vec<Option<Vector3<f64>>>,
}

impl EffectorPaths {
    /// Paths of points (frame-major, one an effector and frame) that somebody else has brought to the frame.
    ///
    /// # Errors
    /// Without effectors or frames, when the points are no whole frames, when a number is not finite or the rate not
    /// positive.
    pub fn new(
        rate_hz: f64,
        effectors: Vec<String>,
        points: Vec<Option<Vector3<f64>>>,
    ) -> Result<Self> {
        let whole = !effectors.is_empty()
            && !points.is_empty()
            && points.len().is_multiple_of(effectors.len());
        if !whole {
            return Err(Error::invalid(format!(
                "{} points are no whole frames of {} effectors",
                points.len(),
                effectors.len()
            )));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Error::invalid(format!(
                "paths need a positive rate, found {rate_hz} Hz"
            )));
        }
        if points
            .iter()
            .flatten()
            .any(|p| p.iter().any(|v| !v.is_finite()))
        {
            return Err(Error::invalid("paths need finite numbers"));
        }
        Ok(Self {
            rate_hz,
            effectors,
            points,
        })
    }

    /// The paths of a motion's effectors, by forward kinematics; the heading of the shoulders is smoothed over
    /// `heading_secs`.
    ///
    /// # Errors
    /// When the body lacks one of the effectors, or shoulders.
    pub fn of_motion(motion: &Motion, effectors: &[String], heading_secs: f64) -> Result<Self> {
        let chains = Chains::of(motion.skeleton(), effectors)?;
        let places = (0..motion.frames())
            .map(|f| chains.places(motion.pose(f), motion.root(f), &[]))
            .collect();
        Self::seen(motion.rate_hz(), effectors, places, heading_secs)
    }

    /// The paths of an observed motion's effectors: missing where a joint between thorax and effector is.
    ///
    /// # Errors
    /// As [`Self::of_motion`].
    pub fn of_observations(
        seen: &Observations,
        effectors: &[String],
        heading_secs: f64,
    ) -> Result<Self> {
        let motion = seen.motion();
        let chains = Chains::of(motion.skeleton(), effectors)?;
        let places = (0..motion.frames())
            .map(|f| chains.observed(&seen.at(f)))
            .collect();
        Self::seen(motion.rate_hz(), effectors, places, heading_secs)
    }

    /// The paths of a recording's effectors, whatever its skeleton: its profile must name shoulders and effectors and
    /// nothing else. `None` finds the profile that names the most. A point that is missing stays missing.
    ///
    /// # Errors
    /// When no profile names them; the message says what was not found.
    pub fn of_recording(
        recording: &Recording,
        profile: Option<&Profile>,
        effectors: &[String],
        heading_secs: f64,
    ) -> Result<Self> {
        let roles = effectors
            .iter()
            .map(|name| role(name))
            .collect::<Result<Vec<_>>>()?;
        let map = named(recording, profile, &roles)?;
        let joint = |r: Role| map.joints.get(&r).copied();
        let shoulders = [Role::LeftUpperArm, Role::RightUpperArm].map(joint);
        let [Some(left), Some(right)] = shoulders else {
            return Err(unnamed(recording, "shoulders"));
        };
        let mut ends = Vec::with_capacity(roles.len());
        for (&(role, carrier), name) in roles.iter().zip(effectors) {
            let tip = |j: usize| Some((j, recording.joints()[j].tip?));
            let end = match (joint(role), carrier.and_then(joint).and_then(tip)) {
                (Some(j), _) => (j, Vector3::zeros()),
                (None, Some(tip)) => tip,
                (None, None) => return Err(unnamed(recording, name)),
            };
            ends.push(end);
        }
        let mut placed = Vec::new();
        let mut places = Vec::with_capacity(recording.frames());
        for frame in 0..recording.frames() {
            recording.place(frame, &mut placed);
            let end = |&(j, tip): &(usize, Vector3<f64>)| match placed[j].rotation {
                Some(turn) => Some(placed[j].position? + turn * tip),
                None => placed[j].position,
            };
            places.push(Places {
                shoulders: placed[left]
                    .position
                    .zip(placed[right].position)
                    .map(|(l, r)| [l, r]),
                effectors: ends.iter().map(end).collect(),
            });
        }
        Self::seen(recording.rate_hz(), effectors, places, heading_secs)
    }

    pub(super) fn seen(
        rate_hz: f64,
        effectors: &[String],
        places: Vec<Places>,
        heading_secs: f64,
    ) -> Result<Self> {
        let lines: Vec<Option<Vector3<f64>>> = places
            .iter()
            .map(|p| p.shoulders.map(|[l, r]| l - r))
            .collect();
        let yaws = headings(&lines, rate_hz, heading_secs);
        let points = places
            .iter()
            .zip(yaws)
            .flat_map(|(p, yaw)| p.within(yaw))
            .collect();
        Self::new(rate_hz, effectors.to_vec(), points)
    }

    /// Frames a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The names of the effectors.
    pub fn effectors(&self) -> &[String] {
        &self.effectors
    }

    /// The number of frames, at least one.
    pub fn frames(&self) -> usize {
        self.points.len() / self.effectors.len()
    }

    /// Seconds from the first to the last frame.
    pub fn duration_secs(&self) -> f64 {
        (self.frames() - 1) as f64 / self.rate_hz
    }

    /// The points at a frame, in the order of [`Self::effectors`], metres; `None` where one was not seen.
    pub fn at(&self, frame: usize) -> &[Option<Vector3<f64>>] {
        let n = self.effectors.len();
        &self.points[frame * n..(frame + 1) * n]
    }

    /// How far the hands were from between the shoulders, at most but for one frame in fifty, metres: what bodies are
    /// scaled by. Without hands among the effectors, of all of them; `None` where none was seen.
    pub fn reach_m(&self) -> Option<f64> {
        const SHARE: f64 = 0.98;
        let hand = |name: &str| name.ends_with("hand");
        let any = self.effectors.iter().any(|e| hand(e));
        let n = self.effectors.len();
        let far: Vec<f64> = self
            .points
            .iter()
            .enumerate()
            .filter(|(i, _)| !any || hand(&self.effectors[i % n]))
            .filter_map(|(_, p)| Some(p.as_ref()?.norm()))
            .collect();
        crate::math::statistics::quantile(&far, SHARE).filter(|r| *r > 1e-6)
    }

    /// The points at a time, seconds: the mean of those within `width_secs` (at least one frame), near ones counting
    /// more; missing where none was seen there.
    pub(super) fn sample(&self, secs: f64, width_secs: f64) -> Vec<Option<Vector3<f64>>> {
        let n = self.effectors.len();
        let width = (width_secs * self.rate_hz).max(1.0);
        let at = secs * self.rate_hz;
        let first = (at - width).ceil().max(0.0) as usize;
        let last = ((at + width).floor().max(0.0) as usize).min(self.frames() - 1);
        let mut sums = vec![(Vector3::zeros(), 0.0); n];
        for frame in first..=last {
            let weight = 1.0 - (frame as f64 - at).abs() / width;
            if weight <= 1e-9 {
                continue;
            }
            for ((sum, all), p) in sums.iter_mut().zip(self.at(frame)) {
                if let Some(p) = p {
                    *sum += weight * p;
                    *all += weight;
                }
            }
        }
        sums.into_iter()
            .map(|(sum, all)| (all > 1e-9).then(|| sum / all))
            .collect()
    }
}

impl Places {
    /// The effectors in the upright thorax frame of this heading.
    pub fn within(&self, yaw: f64) -> Vec<Option<Vector3<f64>>> {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -yaw);
        let middle = self.shoulders.map(|[l, r]| 0.5 * (l + r));
        self.effectors
            .iter()
            .map(|p| Some(turn * (p.as_ref()? - middle?)))
            .collect()
    }
}

/// The role of an effector and its carrier.
fn role(name: &str) -> Result<(Role, Option<Role>)> {
    let known = EFFECTORS.iter().map(|(n, ..)| *n);
    let found = EFFECTORS.iter().find(|(n, ..)| *n == name);
    found
        .map(|&(_, role, carrier)| (role, carrier))
        .ok_or_else(|| Error::unknown_name("effector", name, known))
}

fn unnamed(recording: &Recording, what: &str) -> Error {
    let names: Vec<&str> = recording.joints().iter().map(|j| j.name.as_str()).collect();
    Error::unsupported(format!(
        "no joint found for {what}; the joints are {}; name them with a profile (--profile FILE)",
        names.join(", ")
    ))
}

/// The roles of a recording's joints: by the given profile, else by the one that names the most of what is needed.
fn named(
    recording: &Recording,
    profile: Option<&Profile>,
    roles: &[(Role, Option<Role>)],
) -> Result<RoleMap> {
    let names: Vec<&str> = recording.joints().iter().map(|j| j.name.as_str()).collect();
    if let Some(given) = profile {
        return Ok(given.matched(&names));
    }
    // Whole skeletons are told apart as everywhere; torso and hands alone by what is there.
    if let Ok(map) = RoleMap::detect(&names) {
        return Ok(map);
    }
    let useful = |map: &RoleMap| {
        let wanted = roles
            .iter()
            .map(|(r, _)| *r)
            .chain([Role::LeftUpperArm, Role::RightUpperArm]);
        wanted.filter(|r| map.joints.contains_key(r)).count()
    };
    let maps = Profile::built_in().into_iter().map(|p| p.matched(&names));
    let best = maps.rev().max_by_key(|map| (useful(map), map.joints.len()));
    best.ok_or_else(|| unnamed(recording, "shoulders"))
}

/// The joints of a body on which the effectors and the frame depend.
#[derive(Debug, Clone)]
pub(super) struct Chains<'a> {
    body: &'a Skeleton,
    shoulders: [usize; 2],
    /// Index among the body's effectors, and the joints between thorax and effector that move it.
    effectors: Vec<(usize, Vec<usize>)>,
}

impl<'a> Chains<'a> {
    pub fn of(body: &'a Skeleton, effectors: &[String]) -> Result<Self> {
        if effectors.is_empty() {
            return Err(Error::invalid("an encoder looks at one effector at least"));
        }
        let shoulder = |role: Role| {
            body.joints_of(role).first().copied().ok_or_else(|| {
                Error::unsupported(format!("{} has no {}", body.name(), role.name()))
            })
        };
        let trunk = body.trunk();
        let path = |end: usize, still: bool| {
            let parent = |j: &usize| body.joints()[*j].parent;
            std::iter::successors(Some(end), parent)
                .skip(usize::from(still))
                .take_while(|j| !trunk.contains(j) && body.joints()[*j].parent.is_some())
                .collect()
        };
        let effectors = effectors
            .iter()
            .map(|name| {
                let e = body.effector(name)?;
                let end = &body.effectors()[e];
                // A wrist's own turning does not move it.
                Ok((e, path(end.joint, end.point == Vector3::zeros())))
            })
            .collect::<Result<_>>()?;
        Ok(Self {
            body,
            shoulders: [
                shoulder(Role::LeftUpperArm)?,
                shoulder(Role::RightUpperArm)?,
            ],
            effectors,
        })
    }

    /// World places at a pose; `missing` has a flag a joint, or none.
    pub fn places(&self, pose: &[f64], root: &Root, missing: &[bool]) -> Places {
        let frames = self.body.frames(pose, root);
        let lost = |joints: &[usize]| joints.iter().any(|&j| missing.get(j) == Some(&true));
        Places {
            shoulders: Some(self.shoulders.map(|j| frames[j].position)),
            effectors: self
                .effectors
                .iter()
                .map(|(e, joints)| {
                    let end = &self.body.effectors()[*e];
                    (!lost(joints)).then(|| frames[end.joint].place(&end.point))
                })
                .collect(),
        }
    }

    /// World places of an observed posture.
    pub fn observed(&self, seen: &Observation<'_>) -> Places {
        let root = seen.root.unwrap_or(Root::ORIGIN);
        self.places(seen.pose, &root, seen.missing)
    }

    /// The effectors of a posture in the upright thorax frame, and the heading of that.
    pub fn posture(&self, pose: &[f64]) -> (Vec<Option<Vector3<f64>>>, f64) {
        let places = self.places(pose, &Root::ORIGIN, &[]);
        let line = places.shoulders.map(|[l, r]| l - r);
        let yaw = headings(&[line], 1.0, 0.0)[0];
        (places.within(yaw), yaw)
    }
}
