//! [`Transfer`]: what one body does, done by another, pose by pose.

use std::sync::Arc;

use nalgebra::UnitQuaternion;

use super::fitting::{Fitting, anatomical, carriers};
use super::hinges::Start;
use crate::error::{Error, Result};
use crate::skeleton::Skeleton;

/// Seconds to either side at which a movement is looked at for its velocity and acceleration on the other body.
const BESIDE_SECS: f64 = 1e-3;

/// A pose of the other body with its derivatives in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Transferred {
    /// Coordinates of the pose, radians.
    pub pose: Vec<f64>,
    /// Their first derivative, rad/s.
    pub velocity: Vec<f64>,
    /// Their second derivative, rad/s^2.
    pub acceleration: Vec<f64>,
}

/// Brings the poses of one body to another by roles: every part is turned in the world as on the first body, as far as
/// the other's joints reach, from the pelvis outward. Of the pelvis only its coordinates count, not the heading.
///
/// On the same body a pose stays what it is, bit for bit. A part that is moved by several hinges (a robot's) takes the
/// angles within their ranges that come nearest, and follows continuously from call to call; on such a body single
/// hinges stay within their ranges too.
#[derive(Debug, Clone)]
pub struct Transfer {
    from: Arc<Skeleton>,
    to: Arc<Skeleton>,
    same: bool,
    fitting: Fitting,
    /// For each part that the other body moves, the joint of the first that carries it.
    carriers: Vec<Option<usize>>,
    alone: Vec<usize>,
    neutral: Vec<f64>,
    before: Option<Vec<f64>>,
    turned: Vec<UnitQuaternion<f64>>,
    /// A pose of the first body beside the given one.
    moved: Vec<f64>,
    sides: [Vec<f64>; 2],
    out: Transferred,
}

impl Transfer {
    /// From poses of `from` to poses of `to`.
    ///
    /// # Errors
    /// When the bodies have no moving part in common.
    pub fn between(from: &Arc<Skeleton>, to: &Arc<Skeleton>) -> Result<Self> {
        let fitting = Fitting::of(to);
        let known = carriers(from);
        let carriers: Vec<Option<usize>> = fitting
            .parts()
            .iter()
            .map(|part| known.iter().find(|(r, _)| r == part).map(|(_, j)| *j))
            .collect();
        let moving = |j: &usize| from.joints()[*j].kind.dof() > 0;
        let shown = |j: &usize| {
            from.joints()[*j]
                .role
                .is_some_and(|role| fitting.parts().contains(&anatomical(role)))
        };
        let same = from == to;
        let joints = 0..from.joints().len();
        let alone: Vec<usize> = joints
            .clone()
            .filter(moving)
            .filter(|j| !same && !shown(j))
            .collect();
        if !same && !joints.filter(moving).any(|j| shown(&j)) {
            return Err(Error::unsupported(format!(
                "{} and {} move no part in common, by their roles",
                from.name(),
                to.name()
            )));
        }
        let zeros = vec![0.0; to.dof()];
        Ok(Self {
            from: Arc::clone(from),
            to: Arc::clone(to),
            same,
            fitting,
            carriers,
            alone,
            neutral: to.neutral(),
            before: None,
            turned: vec![UnitQuaternion::identity(); from.joints().len()],
            moved: vec![0.0; from.dof()],
            sides: [zeros.clone(), zeros.clone()],
            out: Transferred {
                pose: zeros.clone(),
                velocity: zeros.clone(),
                acceleration: zeros,
            },
        })
    }

    /// The body whose poses come in.
    pub fn from(&self) -> &Arc<Skeleton> {
        &self.from
    }

    /// The body whose poses come out.
    pub fn to(&self) -> &Arc<Skeleton> {
        &self.to
    }

    /// The moving joints of the first body whose part the other does not move. What they do to the parts beyond them
    /// is not lost: those are turned in the world as on the first body.
    pub fn without_counterpart(&self) -> &[usize] {
        &self.alone
    }

    /// Forgets the poses so far: the next one is found without regard to them.
    pub fn restart(&mut self) {
        self.before = None;
    }

    /// Writes into `out` the pose of the other body, the continuation of the call before.
    ///
    /// # Panics
    /// When `pose` or `out` have not as many coordinates as their bodies.
    pub fn pose(&mut self, pose: &[f64], out: &mut [f64]) {
        assert_eq!(pose.len(), self.from.dof(), "{}", self.from.name());
        assert_eq!(out.len(), self.to.dof(), "{}", self.to.name());
        if self.same {
            out.copy_from_slice(pose);
            return;
        }
        let before = self.before.take();
        let start = before.as_deref().map_or(Start::Anywhere, Start::After);
        self.fit(pose, start, out);
        let mut before = before.unwrap_or_default();
        before.clear();
        before.extend_from_slice(out);
        self.before = Some(before);
    }

    /// The same for a pose that moves: coordinates (radians) with their first and second derivatives in time, which
    /// are taken along the movement. Where a hinge is at its stop they are zero.
    ///
    /// # Panics
    /// When one of them has not as many coordinates as the first body.
    pub fn command(
        &mut self,
        pose: &[f64],
        velocity: &[f64],
        acceleration: &[f64],
    ) -> &Transferred {
        let dof = self.from.dof();
        assert_eq!(velocity.len(), dof, "{}", self.from.name());
        assert_eq!(acceleration.len(), dof, "{}", self.from.name());
        let mut out = std::mem::replace(
            &mut self.out,
            Transferred {
                pose: Vec::new(),
                velocity: Vec::new(),
                acceleration: Vec::new(),
            },
        );
        self.pose(pose, &mut out.pose);
        if self.same {
            out.velocity.copy_from_slice(velocity);
            out.acceleration.copy_from_slice(acceleration);
        } else {
            let mut sides = std::mem::take(&mut self.sides);
            let mut moved = std::mem::take(&mut self.moved);
            for (side, secs) in sides.iter_mut().zip([BESIDE_SECS, -BESIDE_SECS]) {
                for (k, to) in moved.iter_mut().enumerate() {
                    *to = pose[k] + secs * (velocity[k] + 0.5 * secs * acceleration[k]);
                }
                self.fit(&moved, Start::Beside(&out.pose), side);
            }
            let [after, before] = &sides;
            for k in 0..out.pose.len() {
                let (x, a, b) = (out.pose[k], after[k], before[k]);
                out.velocity[k] = (a - b) / (2.0 * BESIDE_SECS);
                out.acceleration[k] = ((a - x) + (b - x)) / (BESIDE_SECS * BESIDE_SECS);
            }
            self.sides = sides;
            self.moved = moved;
        }
        self.out = out;
        &self.out
    }

    fn fit(&mut self, pose: &[f64], start: Start<'_>, out: &mut [f64]) {
        for (j, joint) in self.from.joints().iter().enumerate() {
            let turn = self.from.rotation(j, &pose[self.from.coordinates(j)]);
            self.turned[j] = joint.parent.map_or(turn, |p| self.turned[p] * turn);
        }
        out.copy_from_slice(&self.neutral);
        let (carriers, turned) = (&self.carriers, &self.turned);
        let target = |part: usize| carriers[part].map(|j| turned[j]);
        self.fitting
            .fit(&UnitQuaternion::identity(), target, start, out);
    }
}
