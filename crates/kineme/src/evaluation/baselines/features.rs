//! What postures are compared by.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

use crate::error::{Error, Result};
use crate::motion::{Motion, landmark_dims};
use crate::primitive::{Observation, Observations};
use crate::skeleton::{Role, Root, Skeleton};

/// What postures are compared by: positions in metres, the root's place and heading removed.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Features {
    /// All landmarks of the body ([`Motion::landmarks`]).
    #[default]
    Landmarks,
    /// These effectors alone, from the middle of the shoulders, turned until the line of the shoulders lies across. A trunk
    /// that bows keeps this heading, where the way its front faces is soon none.
    Effectors(Vec<String>),
}

/// Turns postures of a body into features.
#[derive(Debug, Clone)]
pub(super) struct Extractor {
    body: Arc<Skeleton>,
    /// What is looked at; `None`: all landmarks.
    effectors: Option<FromShoulders>,
}

/// Effectors, and the joints that they are seen from.
#[derive(Debug, Clone)]
struct FromShoulders {
    /// Left, then right.
    shoulders: [usize; 2],
    effectors: Vec<usize>,
}

impl Extractor {
    /// # Errors
    /// When an effector is unknown, none is named, or the body has no shoulders to see effectors from.
    pub fn new(body: &Arc<Skeleton>, features: &Features) -> Result<Self> {
        let effectors = match features {
            Features::Landmarks => None,
            Features::Effectors(names) => Some(FromShoulders::new(body, names)?),
        };
        let extractor = Self {
            body: Arc::clone(body),
            effectors,
        };
        if extractor.dims() == 0 {
            return Err(Error::invalid(format!(
                "there is nothing to compare postures of `{}` by",
                body.name()
            )));
        }
        Ok(extractor)
    }

    /// Numbers a frame.
    pub fn dims(&self) -> usize {
        match &self.effectors {
            None => landmark_dims(&self.body),
            Some(seen) => 3 * seen.effectors.len(),
        }
    }

    /// The distance of two frames all of whose points are a decimetre apart: what is taken for usual where no two exemplars
    /// can be compared.
    pub fn decimetre(&self) -> f64 {
        0.1 * (self.dims() as f64 / 3.0).sqrt()
    }

    /// Features of poses, both frame-major; at least one pose.
    pub fn of_poses(&self, poses: Vec<f64>) -> Result<Vec<f64>> {
        let roots = vec![Root::ORIGIN; poses.len() / self.body.dof().max(1)];
        let motion = Motion::new("", Arc::clone(&self.body), 1.0, poses, roots)?;
        match &self.effectors {
            None => Ok(motion.landmarks()),
            Some(seen) => Ok((0..motion.frames())
                .flat_map(|f| seen.places(&motion, f))
                .collect()),
        }
    }

    /// Features of what was seen; a missing joint stays as it was last seen.
    pub fn of_seen(&self, seen: &Observations) -> Result<Vec<f64>> {
        check_body(&self.body, seen)?;
        let mut last = LastSeen::new(&self.body);
        let mut poses = Vec::with_capacity(seen.motion().poses().len());
        for f in 0..seen.motion().frames() {
            poses.extend_from_slice(last.see(&seen.at(f))?);
        }
        self.of_poses(poses)
    }
}

impl FromShoulders {
    fn new(body: &Skeleton, names: &[String]) -> Result<Self> {
        let shoulder = |role: Role| {
            let joint = body.joints_of(role).first().copied();
            joint.ok_or_else(|| {
                Error::unsupported(format!(
                    "`{}` has no {} to see effectors from",
                    body.name(),
                    role.name()
                ))
            })
        };
        let effectors = names.iter().map(|name| body.effector(name));
        Ok(Self {
            shoulders: [
                shoulder(Role::LeftUpperArm)?,
                shoulder(Role::RightUpperArm)?,
            ],
            effectors: effectors.collect::<Result<_>>()?,
        })
    }

    /// The effectors of a frame.
    fn places(&self, motion: &Motion, frame: usize) -> Vec<f64> {
        let frames = motion.frames_at(frame);
        let across = frames[self.shoulders[0]].position - frames[self.shoulders[1]].position;
        let middle =
            0.5 * (frames[self.shoulders[0]].position + frames[self.shoulders[1]].position);
        // The line points to the left.
        let heading = (-across.x).atan2(across.y);
        let upright = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -heading);
        let place = |&e: &usize| {
            let effector = &motion.skeleton().effectors()[e];
            let point = frames[effector.joint].place(&effector.point);
            let p = upright * (point - middle);
            [p.x, p.y, p.z]
        };
        self.effectors.iter().flat_map(place).collect()
    }
}

/// The posture that is known: every joint as it was last seen, first neutral.
#[derive(Debug, Clone)]
pub(super) struct LastSeen {
    body: Arc<Skeleton>,
    pose: Vec<f64>,
    secs: f64,
}

impl LastSeen {
    pub fn new(body: &Arc<Skeleton>) -> Self {
        Self {
            body: Arc::clone(body),
            pose: body.neutral(),
            secs: f64::NEG_INFINITY,
        }
    }

    /// Takes what was seen.
    ///
    /// # Errors
    /// When it is of another body, or not later than what was seen before.
    pub fn see(&mut self, seen: &Observation<'_>) -> Result<&[f64]> {
        let joints = self.body.joints().len();
        let flags = seen.missing.len();
        if seen.pose.len() != self.body.dof() || !(flags == 0 || flags == joints) {
            return Err(Error::invalid(format!(
                "a posture of {} coordinates and {flags} flags of missing joints is none of `{}`: {} and {joints}",
                seen.pose.len(),
                self.body.name(),
                self.body.dof()
            )));
        }
        if !seen.secs.is_finite() || seen.secs <= self.secs {
            return Err(Error::invalid(format!(
                "observations come one after the other, found {} s after {} s",
                seen.secs, self.secs
            )));
        }
        self.secs = seen.secs;
        for j in 0..joints {
            if !seen.missing.get(j).is_some_and(|m| *m) {
                let at = self.body.coordinates(j);
                self.pose[at.clone()].copy_from_slice(&seen.pose[at]);
            }
        }
        Ok(&self.pose)
    }
}

/// Refuses motion of another body.
pub(super) fn check_body(body: &Arc<Skeleton>, seen: &Observations) -> Result<()> {
    let other = seen.motion().skeleton();
    if Arc::ptr_eq(body, other) || **body == **other {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "`{}` is a motion of `{}`, the vocabulary is of `{}`",
        seen.motion().name(),
        other.name(),
        body.name()
    )))
}
