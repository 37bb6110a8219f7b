//! [`Motion`]: a movement of a body, in its joint coordinates.

use std::sync::Arc;

use nalgebra::Vector3;

use super::resample::places;
use super::track::Track;
use crate::error::{Error, Result};
use crate::math::rotation::{exp, log_near};
use crate::skeleton::{Frame, Root, Skeleton};

/// A movement of one body at one rate: poses, and beside them where the body stands. Finite, at least one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    name: String,
    skeleton: Arc<Skeleton>,
    rate_hz: f64,
    poses: Vec<f64>,
    roots: Vec<Root>,
}

impl Motion {
    /// A motion of `skeleton` from its poses, frame-major (`frames x dof`), and one root a frame.
    ///
    /// # Errors
    /// Without frames, when lengths disagree, when a number is not finite or the rate not positive.
    pub fn new(
        name: impl Into<String>,
        skeleton: Arc<Skeleton>,
        rate_hz: f64,
        poses: Vec<f64>,
        roots: Vec<Root>,
    ) -> Result<Self> {
        let name = name.into();
        if roots.is_empty() || poses.len() != roots.len() * skeleton.dof() {
            return Err(Error::invalid(format!(
                "`{name}`: {} coordinates and {} roots are no motion of {} coordinates a pose",
                poses.len(),
                roots.len(),
                skeleton.dof()
            )));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Error::invalid(format!(
                "`{name}`: a motion needs a positive rate, found {rate_hz} Hz"
            )));
        }
        let finite = poses.iter().all(|v| v.is_finite())
            && roots
                .iter()
                .all(|r| r.yaw.is_finite() && r.position.iter().all(|v| v.is_finite()));
        if !finite {
            return Err(Error::invalid(format!(
                "`{name}`: a motion needs finite numbers"
            )));
        }
        Ok(Self {
            name,
            skeleton,
            rate_hz,
            poses,
            roots,
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The body that moves.
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Frames a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The number of frames, at least one.
    pub fn frames(&self) -> usize {
        self.roots.len()
    }

    /// Seconds from the first to the last frame: 0 for a single one.
    pub fn duration_secs(&self) -> f64 {
        (self.frames() - 1) as f64 / self.rate_hz
    }

    /// The pose at a frame.
    pub fn pose(&self, frame: usize) -> &[f64] {
        let dof = self.skeleton.dof();
        &self.poses[frame * dof..(frame + 1) * dof]
    }

    /// All poses, frame-major.
    pub fn poses(&self) -> &[f64] {
        &self.poses
    }

    /// Where the body stands at a frame.
    pub fn root(&self, frame: usize) -> &Root {
        &self.roots[frame]
    }

    /// Where the body stands, frame by frame.
    pub fn roots(&self) -> &[Root] {
        &self.roots
    }

    /// World frames of all joints at a frame.
    pub fn frames_at(&self, frame: usize) -> Vec<Frame> {
        self.skeleton.frames(self.pose(frame), self.root(frame))
    }

    /// The part of the motion in these frames; at least one.
    ///
    /// # Errors
    /// When the range is empty or passes the end.
    pub fn slice(&self, range: std::ops::Range<usize>) -> Result<Self> {
        if range.is_empty() || range.end > self.frames() {
            return Err(Error::invalid(format!(
                "`{}`: frames {}..{} of {}",
                self.name,
                range.start,
                range.end,
                self.frames()
            )));
        }
        let dof = self.skeleton.dof();
        Ok(Self {
            name: self.name.clone(),
            skeleton: Arc::clone(&self.skeleton),
            rate_hz: self.rate_hz,
            poses: self.poses[range.start * dof..range.end * dof].to_vec(),
            roots: self.roots[range].to_vec(),
        })
    }

    /// The motion at another rate, coordinates interpolated linearly; the first frame stays at time zero.
    /// A ball whose two names for a rotation change between frames is interpolated the short way.
    ///
    /// # Errors
    /// When the rate is not positive, or would make more than a million frames of fewer.
    pub fn resampled(&self, rate_hz: f64) -> Result<Self> {
        let places = places(self.frames(), self.rate_hz, rate_hz)?;
        let balls: Vec<_> = (0..self.skeleton.joints().len())
            .map(|j| self.skeleton.coordinates(j))
            .filter(|at| at.len() == 3)
            .collect();
        let mut poses = Vec::with_capacity(places.len() * self.skeleton.dof());
        let mut roots = Vec::with_capacity(places.len());
        for p in places {
            let blend = |x: f64, y: f64| x + (y - x) * p.share;
            let first = poses.len();
            let pair = self.pose(p.before).iter().zip(self.pose(p.after));
            poses.extend(pair.map(|(x, y)| blend(*x, *y)));
            for ball in &balls {
                let at = |f: usize| Vector3::from_column_slice(&self.pose(f)[ball.clone()]);
                let (x, y) = (at(p.before), at(p.after));
                if (y - x).norm() > std::f64::consts::PI {
                    let v = x + (log_near(&exp(&y), &x) - x) * p.share;
                    let nearer_first = p.share < 0.5;
                    let v = if nearer_first {
                        v
                    } else {
                        log_near(&exp(&v), &y)
                    };
                    poses[first + ball.start..first + ball.end].copy_from_slice(v.as_slice());
                }
            }
            let (a, b) = (self.root(p.before), self.root(p.after));
            roots.push(Root {
                position: a.position + (b.position - a.position) * p.share,
                yaw: blend(a.yaw, b.yaw),
            });
        }
        Self::new(
            self.name.clone(),
            Arc::clone(&self.skeleton),
            rate_hz,
            poses,
            roots,
        )
    }

    /// The mirror image of the motion about the sagittal plane: left and right swapped, the root's y and its heading
    /// negated. Exact: mirrored twice it is the same, bit for bit.
    ///
    /// # Errors
    /// When the halves of the body are not each other's image.
    pub fn mirrored(&self) -> Result<Self> {
        let sources = self.skeleton.mirror()?;
        let poses = (0..self.frames())
            .flat_map(|f| {
                let pose = self.pose(f);
                sources.iter().map(move |&(from, sign)| sign * pose[from])
            })
            .collect();
        let roots = self
            .roots
            .iter()
            .map(|r| Root {
                position: Vector3::new(r.position.x, -r.position.y, r.position.z),
                yaw: -r.yaw,
            })
            .collect();
        Self::new(
            self.name.clone(),
            Arc::clone(&self.skeleton),
            self.rate_hz,
            poses,
            roots,
        )
    }

    /// World paths of the effectors.
    pub fn effectors(&self) -> Track {
        let names = self
            .skeleton
            .effectors()
            .iter()
            .map(|e| e.name.clone())
            .collect();
        let points: Vec<Vector3<f64>> = (0..self.frames())
            .flat_map(|f| self.skeleton.effector_positions(self.pose(f), self.root(f)))
            .collect();
        Track::new(self.rate_hz, names, points)
    }

    /// World paths of all joints.
    pub fn joints(&self) -> Track {
        let names = self.skeleton.joints().iter().map(|j| j.name.clone());
        let points = (0..self.frames())
            .flat_map(|f| self.frames_at(f).into_iter().map(|j| j.position))
            .collect();
        Track::new(self.rate_hz, names.collect(), points)
    }
}
