//! [`State`]: where a body is and how it moves; and the same numbers as a synthesizer carries them.

use nalgebra::Vector3;

use crate::error::{Error, Result};
use crate::math::rotation::{exp, log_near, right_jacobian};
use crate::motion::Motion;
use crate::primitive::{Course, Sample, Travel};
use crate::skeleton::{Root, Skeleton};

/// The longest rotation vector (radians) that a ball is given another name for: as far as a pose's coordinates go.
const FARTHEST: f64 = 1.2 * std::f64::consts::PI;
/// Half the phase over which the slope of the root's height is taken.
const SLOPE_PHASE: f64 = 1e-4;

/// Where a body is and how it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Joint coordinates, radians.
    pub pose: Vec<f64>,
    /// Their velocities, radians a second.
    pub velocity: Vec<f64>,
    /// Where the body stands.
    pub root: Root,
    /// How its root travels; the height here is not used, the root tells it.
    pub travel: Travel,
    /// Vertical velocity of the root, metres a second.
    pub rise: f64,
}

impl State {
    /// A posture at rest.
    pub fn resting(pose: Vec<f64>, root: Root) -> Self {
        Self {
            velocity: vec![0.0; pose.len()],
            pose,
            root,
            travel: Travel::default(),
            rise: 0.0,
        }
    }

    /// The posture at a frame of a motion, at rest.
    ///
    /// # Errors
    /// When the motion has no such frame.
    pub fn at_frame(motion: &Motion, frame: usize) -> Result<Self> {
        if frame >= motion.frames() {
            return Err(Error::invalid(format!(
                "`{}` has {} frames, but no frame {frame}",
                motion.name(),
                motion.frames()
            )));
        }
        Ok(Self::resting(
            motion.pose(frame).to_vec(),
            *motion.root(frame),
        ))
    }

    /// The state of a body that is in the midst of a course at its own pace times `speed`, over the origin and facing
    /// forward.
    pub fn on_course(course: &Course, phase: f64, speed: f64) -> Self {
        let sample = course.sample(phase);
        let along = Moving::along(&sample, speed);
        let mut velocities = along.velocities;
        velocities.pop();
        let [forward, left, yaw_rate] = along.travel;
        Self {
            velocity: velocities,
            root: Root {
                position: Vector3::new(0.0, 0.0, sample.travel.height),
                yaw: 0.0,
            },
            travel: Travel {
                forward,
                left,
                height: sample.travel.height,
                yaw_rate,
            },
            rise: rise(course, phase) * speed / sample.secs_per_phase,
            pose: sample.pose,
        }
    }

    /// Refuses what is no state of this body.
    pub(super) fn check(&self, body: &Skeleton) -> Result<()> {
        if self.pose.len() != body.dof() || self.velocity.len() != body.dof() {
            return Err(Error::invalid(format!(
                "a pose of {} has {} coordinates, found {} and {} velocities",
                body.name(),
                body.dof(),
                self.pose.len(),
                self.velocity.len()
            )));
        }
        let root = &self.root;
        let travel = [
            self.travel.forward,
            self.travel.left,
            self.travel.yaw_rate,
            self.rise,
            root.yaw,
        ];
        let mut numbers = self.pose.iter().chain(&self.velocity).chain(&travel);
        let finite = numbers.all(|v| v.is_finite()) && root.position.iter().all(|v| v.is_finite());
        if !finite {
            return Err(Error::invalid("a posture needs finite numbers"));
        }
        Ok(())
    }
}

/// What moves, in one row: the joint coordinates, then the root's height, with their velocities; and the velocities of
/// the root that have no place of their own (forward, left, yaw).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Moving {
    pub values: Vec<f64>,
    pub velocities: Vec<f64>,
    pub travel: [f64; 3],
}

impl Moving {
    pub fn of(state: &State) -> Self {
        let mut values = state.pose.clone();
        values.push(state.root.position.z);
        let mut velocities = state.velocity.clone();
        velocities.push(state.rise);
        let t = &state.travel;
        Self {
            values,
            velocities,
            travel: [t.forward, t.left, t.yaw_rate],
        }
    }

    /// A place of a course, run through at its own pace times `rate`. The height's velocity is left zero: see [`rise`].
    pub fn along(sample: &Sample, rate: f64) -> Self {
        let per_sec = rate / sample.secs_per_phase;
        let mut values = Vec::with_capacity(sample.pose.len() + 1);
        values.extend_from_slice(&sample.pose);
        values.push(sample.travel.height);
        let mut velocities = Vec::with_capacity(values.len());
        velocities.extend(sample.slope.iter().map(|s| s * per_sec));
        velocities.push(0.0);
        let t = &sample.travel;
        Self {
            values,
            velocities,
            travel: [t.forward, t.left, t.yaw_rate].map(|v| v * rate),
        }
    }

    /// Takes what does not join a goal for being there; nothing without `joining` (coordinates, the root last).
    pub fn elsewhere_as(&mut self, goal: &Moving, joining: Option<&[bool]>) {
        if let Some(joining) = joining {
            let others: Vec<bool> = joining.iter().map(|joins| !joins).collect();
            self.take(goal, &others);
        }
    }

    /// Takes these coordinates and their velocities from another, the root's travel with its height.
    pub fn take(&mut self, from: &Moving, which: &[bool]) {
        for (c, _) in which.iter().enumerate().filter(|(_, which)| **which) {
            self.values[c] = from.values[c];
            self.velocities[c] = from.velocities[c];
        }
        if which.last() == Some(&true) {
            self.travel = from.travel;
        }
    }

    /// The same places passed at a share of the velocity.
    pub fn slowed(&mut self, share: f64) {
        let velocities = self.velocities.iter_mut().chain(&mut self.travel);
        velocities.for_each(|v| *v *= share);
    }

    /// A posture that is held.
    pub fn still(values: Vec<f64>) -> Self {
        Self {
            velocities: vec![0.0; values.len()],
            values,
            travel: [0.0; 3],
        }
    }

    /// Gives each ball that has no limits the rotation vector nearest `goal`: a posture has two names for a rotation near
    /// a half turn, and the way from one name to the other is a whole turn. The rotations and their velocities stay as
    /// they are. True when a name has changed.
    ///
    /// A ball with limits needs none of this: the way between two places within its box is straight.
    pub fn named_near(&mut self, body: &Skeleton, goal: &[f64]) -> bool {
        let mut renamed = false;
        for joint in balls(body).filter(|&j| body.limits(j).is_empty()) {
            let at = body.coordinates(joint);
            let here = Vector3::from_column_slice(&self.values[at.clone()]);
            let there = Vector3::from_column_slice(&goal[at.clone()]);
            if (here - there).norm() > std::f64::consts::PI {
                renamed |= self.rename(at, &log_near(&exp(&here), &there));
            }
        }
        renamed
    }

    /// Gives each ball that lies beyond its limits its other name, if that lies within.
    pub fn named_within_limits(&mut self, body: &Skeleton) {
        for joint in balls(body).filter(|&j| !body.limits(j).is_empty()) {
            let axes = &body.joints()[joint].axes;
            let axes = [axes.flexion, axes.abduction, axes.axial];
            let within = |v: &Vector3<f64>| {
                let mut ranges = axes.iter().zip(body.limits(joint));
                ranges.all(|(axis, range)| (range.low..=range.high).contains(&axis.dot(v)))
            };
            let at = body.coordinates(joint);
            let here = Vector3::from_column_slice(&self.values[at.clone()]);
            let other = log_near(&exp(&here), &-here);
            if !within(&here) && within(&other) {
                self.rename(at, &other);
            }
        }
    }

    /// Gives a ball another rotation vector for the same rotation, unless that is longer than a pose's are.
    fn rename(&mut self, at: std::ops::Range<usize>, name: &Vector3<f64>) -> bool {
        let here = Vector3::from_column_slice(&self.values[at.clone()]);
        let velocity = Vector3::from_column_slice(&self.velocities[at.clone()]);
        // Singular at a whole turn only, which no name comes near.
        let inverse = right_jacobian(name).try_inverse();
        let (Some(inverse), true) = (inverse, name.norm() <= FARTHEST) else {
            return false;
        };
        let velocity = inverse * right_jacobian(&here) * velocity;
        self.values[at.clone()].copy_from_slice(name.as_slice());
        self.velocities[at].copy_from_slice(velocity.as_slice());
        true
    }
}

fn balls(body: &Skeleton) -> impl Iterator<Item = usize> {
    (0..body.joints().len()).filter(|&j| body.coordinates(j).len() == 3)
}

/// The slope of the root's height by phase, metres.
pub(super) fn rise(course: &Course, phase: f64) -> f64 {
    let (before, after) = if course.is_cyclic() {
        (phase - SLOPE_PHASE, phase + SLOPE_PHASE)
    } else {
        (
            (phase - SLOPE_PHASE).max(0.0),
            (phase + SLOPE_PHASE).min(1.0),
        )
    };
    let height = |phase: f64| course.sample(phase).travel.height;
    (height(after) - height(before)) / (after - before)
}
