//! [`Parts`]: what the frame classifiers compare: a pose, part by part of the body.

use std::ops::Range;

use nalgebra::Vector3;

use crate::error::{Error, Result};
use crate::primitive::{Observation, Vocabulary};
use crate::skeleton::{JointKind, Skeleton};

/// Parts at most: their flags share a word.
const MOST_PARTS: usize = 64;
/// Coordinates that all primitives together move by less are constants, radians (2 degrees).
const STILL_RAD: f64 = 0.035;

/// A pose as univariate coordinates, grouped by part of the body: the joints of one role.
///
/// A hinge gives one coordinate, a ball the three of its rotation vector. The balls of a chain that shares a role, the
/// vertebrae of a region, give three together, the sums of theirs: their turns are small, so the sum is the rotation of
/// the chain to second order. A tolerance then means the same for a trunk of one joint and of twelve, and independent
/// errors of vertebrae average out.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    /// Of each part, its joints.
    joints: Vec<Vec<usize>>,
    /// Coordinates of a pose, and the first of the coordinates that they are added to.
    sources: Vec<(Range<usize>, usize)>,
    /// First coordinates of single balls, whose rotations have two names.
    balls: Vec<usize>,
    /// The part of each coordinate.
    part_of: Vec<usize>,
    /// The joint limits of each coordinate, radians.
    limits: Vec<[f64; 2]>,
    /// The name of each coordinate.
    names: Vec<String>,
}

impl Parts {
    pub fn of(body: &Skeleton) -> Result<Self> {
        let mut parts = Self {
            joints: Vec::new(),
            sources: Vec::new(),
            balls: Vec::new(),
            part_of: Vec::new(),
            limits: Vec::new(),
            names: Vec::new(),
        };
        let mut roles = Vec::new();
        // Of each part, the first coordinate of its ball.
        let mut chains: Vec<Option<usize>> = Vec::new();
        for (j, joint) in body.joints().iter().enumerate() {
            let at = body.coordinates(j);
            if at.is_empty() {
                continue;
            }
            let known = joint
                .role
                .and_then(|r| roles.iter().position(|&k| k == Some(r)));
            let part = known.unwrap_or(roles.len());
            if known.is_none() {
                roles.push(joint.role);
                chains.push(None);
                parts.joints.push(Vec::new());
            }
            parts.joints[part].push(j);
            let limits = coordinate_limits(body, j);
            let chained = chains[part].filter(|_| at.len() == 3);
            let first = chained.unwrap_or(parts.part_of.len());
            if chained.is_some() {
                parts.balls.retain(|&b| b != first);
                for (sum, own) in parts.limits[first..].iter_mut().zip(&limits) {
                    *sum = [sum[0] + own[0], sum[1] + own[1]];
                }
            } else {
                if at.len() == 3 {
                    chains[part] = Some(first);
                    parts.balls.push(first);
                    let of = joint.role.map_or(joint.name.as_str(), |r| r.name());
                    parts
                        .names
                        .extend(["x", "y", "z"].map(|axis| format!("{of}_{axis}")));
                } else {
                    parts.names.extend(at.clone().map(|_| joint.name.clone()));
                }
                parts.part_of.extend(at.clone().map(|_| part));
                parts.limits.extend(limits);
            }
            parts.sources.push((at, first));
        }
        if parts.joints.len() > MOST_PARTS {
            return Err(Error::unsupported(format!(
                "the body `{}` has {} parts that move; at most {MOST_PARTS} are compared",
                body.name(),
                parts.joints.len()
            )));
        }
        Ok(parts)
    }

    /// The number of coordinates.
    pub fn dims(&self) -> usize {
        self.part_of.len()
    }

    /// The number of parts.
    pub fn count(&self) -> usize {
        self.joints.len()
    }

    /// The part of a coordinate.
    pub fn part_of(&self, coordinate: usize) -> usize {
        self.part_of[coordinate]
    }

    /// The name of each coordinate: a hinge's own, or a ball's role with the axis of its rotation vector.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// A pose in these coordinates: a linear map.
    pub fn place(&self, pose: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.dims()];
        for (from, first) in &self.sources {
            for (o, x) in out[*first..].iter_mut().zip(&pose[from.clone()]) {
                *o += x;
            }
        }
        out
    }

    /// Gives balls that turned by more than pi over the way to `middle` the other name of their rotation.
    pub fn rename(&self, place: &mut [f64], middle: &[f64]) {
        for &b in &self.balls {
            let v = Vector3::from_column_slice(&place[b..b + 3]);
            let m = Vector3::from_column_slice(&middle[b..b + 3]);
            let n = v.norm();
            if n > 1e-9 {
                let other = v * ((n - std::f64::consts::TAU) / n);
                if (other - m).norm_squared() < (v - m).norm_squared() {
                    place[b..b + 3].copy_from_slice(other.as_slice());
                }
            }
        }
    }

    /// Whether each part was seen: all joints of it.
    pub fn seen(&self, missing: &[bool]) -> Vec<bool> {
        let seen = |joints: &Vec<usize>| missing.is_empty() || joints.iter().all(|&j| !missing[j]);
        self.joints.iter().map(seen).collect()
    }
}

/// The box that a joint's limits span in its coordinates; of the root, which has none, all rotation vectors.
fn coordinate_limits(body: &Skeleton, joint: usize) -> Vec<[f64; 2]> {
    use std::f64::consts::PI;
    let dof = body.coordinates(joint).len();
    match (body.limits(joint), &body.joints()[joint].kind) {
        ([range], JointKind::Hinge { .. }) => vec![[range.low, range.high]],
        (ranges @ [_, _, _], JointKind::Ball { .. }) => {
            let axes = body.joints()[joint].axes;
            let axes = [axes.flexion, axes.abduction, axes.axial];
            let mut limits = vec![[0.0; 2]; 3];
            for (axis, range) in axes.iter().zip(ranges) {
                for (limit, a) in limits.iter_mut().zip(axis.iter()) {
                    let (x, y) = (a * range.low, a * range.high);
                    *limit = [limit[0] + x.min(y), limit[1] + x.max(y)];
                }
            }
            limits
        }
        _ => vec![[-PI, PI]; dof],
    }
}

/// How near counts as equal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerances {
    /// Half width of "equals" of a coordinate that some primitive moves, radians.
    pub delta: f64,
    /// The same of one that none moves.
    pub constant: f64,
    /// How far readings may pass the joint limits.
    pub limits: f64,
}

/// Which coordinates tell the primitives of a vocabulary, how near counts as equal, and how far they range.
#[derive(Debug, Clone)]
pub(super) struct Scope {
    pub parts: Parts,
    pub tolerances: Tolerances,
    /// Coordinates that some primitive moves.
    pub moving: Vec<usize>,
    /// Coordinates that none moves, and the value that all have.
    pub constant: Vec<(usize, f64)>,
    /// The least and greatest value of each coordinate over all primitives.
    bounds: Vec<[f64; 2]>,
    /// The middle of the same.
    middle: Vec<f64>,
    /// Where each coordinate may be: joint limits and whatever the primitives do, widened by the tolerance.
    ranges: Vec<[f64; 2]>,
}

/// A posture as it is compared; coordinates that were not seen are NaN, which lies outside of no bound.
#[derive(Debug, Clone)]
pub(super) struct Posture {
    /// Every coordinate.
    pub place: Vec<f64>,
    /// Whether each part was seen.
    pub seen: Vec<bool>,
    /// Of each part, how far its constants are from their values, tolerances.
    pub constant_gap: Vec<f64>,
}

impl Scope {
    /// From the least and greatest value of each coordinate in each primitive.
    pub fn new(
        parts: Parts,
        primitives: impl IntoIterator<Item = Vec<[f64; 2]>>,
        tolerances: Tolerances,
    ) -> Self {
        let join = |mut all: Vec<[f64; 2]>, own: Vec<[f64; 2]>| {
            for (b, o) in all.iter_mut().zip(own) {
                *b = [b[0].min(o[0]), b[1].max(o[1])];
            }
            all
        };
        let bounds = primitives.into_iter().reduce(join);
        let bounds = bounds.unwrap_or_else(|| vec![[0.0, 0.0]; parts.dims()]);
        let width = |c: usize| bounds[c][1] - bounds[c][0];
        let middle: Vec<f64> = bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
        let (moving, still): (Vec<usize>, Vec<usize>) =
            (0..parts.dims()).partition(|&c| width(c) > STILL_RAD);
        let ranges = parts.limits.iter().zip(&bounds).map(|(l, b)| {
            let wide = tolerances.limits;
            [l[0].min(b[0]) - wide, l[1].max(b[1]) + wide]
        });
        Self {
            ranges: ranges.collect(),
            constant: still.into_iter().map(|c| (c, middle[c])).collect(),
            parts,
            tolerances,
            moving,
            middle,
            bounds,
        }
    }

    /// How far a coordinate goes over all primitives, radians.
    pub fn extent(&self, coordinate: usize) -> f64 {
        self.bounds[coordinate][1] - self.bounds[coordinate][0]
    }

    /// The length of a coordinate's range, radians.
    pub fn range(&self, coordinate: usize) -> f64 {
        self.ranges[coordinate][1] - self.ranges[coordinate][0]
    }

    /// Whether every coordinate that was seen lies in its range: else a sensor is at fault.
    pub fn in_range(&self, posture: &Posture) -> bool {
        let mut pairs = posture.place.iter().zip(&self.ranges);
        pairs.all(|(x, r)| x.is_nan() || (*x >= r[0] && *x <= r[1]))
    }

    /// An observed posture in these coordinates.
    pub fn posture(&self, seen: &Observation<'_>) -> Posture {
        let mut place = self.parts.place(seen.pose);
        self.parts.rename(&mut place, &self.middle);
        let seen = self.parts.seen(seen.missing);
        let mut constant_gap = vec![0.0_f64; self.parts.count()];
        for (c, x) in place.iter_mut().enumerate() {
            if !seen[self.parts.part_of(c)] {
                *x = f64::NAN;
            }
        }
        for &(c, value) in &self.constant {
            let gap = (place[c] - value).abs() / self.tolerances.constant;
            let own = &mut constant_gap[self.parts.part_of(c)];
            // `max` ignores a NaN.
            *own = own.max(gap);
        }
        Posture {
            place,
            seen,
            constant_gap,
        }
    }
}

/// Half width of "equals" for a vocabulary: a tolerance, or a multiple of what its exemplars leave unexplained, their
/// mean leave-one-out error, where that is more.
pub(super) fn widened(vocabulary: &Vocabulary, delta_rad: f64, residual: f64) -> f64 {
    let errors: Vec<f64> = vocabulary
        .primitives()
        .iter()
        .filter_map(|p| p.fitted().error.map(|e| e.joint_rad))
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    delta_rad.max(residual * mean)
}

/// Guards a stream: postures are of the body, and their times rise.
#[derive(Debug, Clone, Default)]
pub(super) struct Guard {
    last_secs: Option<f64>,
}

impl Guard {
    pub fn check(&mut self, body: &Skeleton, seen: &Observation<'_>) -> Result<()> {
        let joints = body.joints().len();
        if seen.pose.len() != body.dof()
            || !(seen.missing.is_empty() || seen.missing.len() == joints)
        {
            return Err(Error::invalid(format!(
                "a posture of {} coordinates with {} flags of missing joints is none of the body `{}`, which has {} and {joints}",
                seen.pose.len(),
                seen.missing.len(),
                body.name(),
                body.dof()
            )));
        }
        for j in 0..joints {
            let known = seen.missing.is_empty() || !seen.missing[j];
            if known
                && seen.pose[body.coordinates(j)]
                    .iter()
                    .any(|x| !x.is_finite())
            {
                return Err(Error::invalid(format!(
                    "the coordinates of `{}` are not finite",
                    body.joints()[j].name
                )));
            }
        }
        if !seen.secs.is_finite() || self.last_secs.is_some_and(|last| seen.secs <= last) {
            return Err(Error::invalid(format!(
                "a posture at {} s follows one at {} s; times rise",
                seen.secs,
                self.last_secs.unwrap_or(f64::NEG_INFINITY)
            )));
        }
        self.last_secs = Some(seen.secs);
        Ok(())
    }
}

/// Refuses a motion of another body.
pub(super) fn same_body(vocabulary: &Vocabulary, body: &Skeleton) -> Result<()> {
    if **vocabulary.body() == *body {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "a motion of the body `{}` for a vocabulary of `{}`",
        body.name(),
        vocabulary.body().name()
    )))
}
