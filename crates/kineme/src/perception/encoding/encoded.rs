//! The encoded motion: what the winners would have done, on the vocabulary's body, in one piece.

use std::sync::Arc;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::encoder::Seen;
use super::paths::Chains;
use super::rows::{Row, moved};
use super::settings::{EncodingSettings, SAMPLES};
use super::track::Leg;
use crate::error::Result;
use crate::math::rotation::{exp, log_near};
use crate::motion::Motion;
use crate::primitive::Vocabulary;
use crate::skeleton::{Reach, Root, Skeleton};

/// How long the gap at a join takes to close, seconds.
const BLEND_SECS: f64 = 0.3;
/// How far a coordinate goes in a second at most while an unknown movement is followed, radians.
const FASTEST_RAD: f64 = 8.0;
/// Damping of the steps toward observed effectors, metres.
const DAMPING_M: f64 = 0.05;

/// What the winners are to be joined from.
pub(super) struct Course<'a> {
    pub vocabulary: &'a Vocabulary,
    pub rows: &'a [Row],
    pub settings: &'a EncodingSettings,
    /// What was seen, metres of the observer.
    pub seen: &'a Seen,
    /// Metres of the observer that are a unit of no row in particular, and the metres on the body that it is.
    pub usual_m: [f64; 2],
}

impl Course<'_> {
    /// The motion of a path, and for each of its frames the factor from metres of the observer to metres on the body.
    pub fn motion(&self, name: &str, legs: &[Leg]) -> Result<(Motion, Vec<f64>)> {
        let s = self.settings;
        let body = self.vocabulary.body();
        let step = s.cell_secs();
        let cells = s.cells(1.0, SAMPLES) as usize;
        let last = s.cells(1.0, self.seen.instants.len().saturating_sub(1)) as usize;
        let follower = Follower::of(body, s)?;
        let mut pose = self.start();
        let mut root = Root::ORIGIN;
        let mut offset = vec![0.0; body.dof()];
        let mut age = f64::INFINITY;
        let (mut poses, mut roots, mut factors) = (Vec::new(), Vec::new(), Vec::new());
        let mut going = false;
        for frame in 0..=last {
            let block = (frame / cells).min(legs.len().saturating_sub(1));
            let ahead = frame - block * cells;
            let leg = legs.get(block).copied().unwrap_or(Leg::Rest);
            let mut factor = self.usual_m[1] / self.usual_m[0];
            match leg {
                Leg::Along {
                    row,
                    from,
                    rate,
                    begun,
                } => {
                    let row = &self.rows[row];
                    factor = row.unit_m / self.seen.unit_m(row);
                    let primitive = &self.vocabulary.primitives()[row.primitive];
                    let phase = row.phase(from as f64 + rate * ahead as f64);
                    let sample = primitive.registered(row.exemplar, phase);
                    if ahead == 0 && (begun || !going) {
                        age = 0.0;
                        offset = match frame {
                            0 => vec![0.0; body.dof()],
                            _ => difference(body, &pose, &sample.pose),
                        };
                    }
                    age += step;
                    let share = 1.0 - least_jerk(age / BLEND_SECS);
                    let pairs = sample.pose.iter().zip(&offset);
                    pose = pairs.map(|(x, o)| x + share * o).collect();
                    root = moved(&root, &sample, step * rate);
                    going = true;
                }
                Leg::Rest => going = false,
                Leg::None => {
                    let at = frame as f64 / s.cells(1.0, 1);
                    let seen = self.seen(at).into_iter().map(|p| p.map(|p| p * factor));
                    follower.follow(&mut pose, &seen.collect::<Vec<_>>(), step);
                    going = false;
                }
            }
            poses.extend_from_slice(&pose);
            roots.push(root);
            factors.push(factor);
        }
        let motion = Motion::new(name, Arc::clone(body), 1.0 / step, poses, roots)?;
        Ok((motion, factors))
    }

    /// The known posture whose effectors are nearest to the first ones seen.
    pub fn start(&self) -> Vec<f64> {
        let mut least = (f64::INFINITY, 0, 0);
        for (r, row) in self.rows.iter().enumerate() {
            let unit = self.seen.unit_m(row);
            for c in 0..row.cells() {
                let mut far = 0.0;
                for (e, p) in self.seen.instants[0].iter().enumerate() {
                    let Some(p) = p else { continue };
                    let gaps = (0..3).map(|a| p[a] / unit - f64::from(row.track(e, a)[c]));
                    far += gaps.map(|g| g * g).sum::<f64>();
                }
                if far < least.0 {
                    least = (far, r, c);
                }
            }
        }
        match self.rows.get(least.1) {
            Some(row) => {
                let primitive = &self.vocabulary.primitives()[row.primitive];
                primitive.registered(row.exemplar, row.phases[least.2]).pose
            }
            None => self.vocabulary.body().neutral(),
        }
    }

    /// The effectors between two instants.
    pub fn seen(&self, at: f64) -> Vec<Option<Vector3<f64>>> {
        let end = self.seen.instants.len() - 1;
        let k = (at.floor() as usize).min(end);
        let share = at - k as f64;
        let (a, b) = (
            &self.seen.instants[k],
            &self.seen.instants[(k + 1).min(end)],
        );
        let pairs = a.iter().zip(b);
        pairs
            .map(|(a, b)| match share > 1e-9 {
                true => Some((*a)?.lerp(b.as_ref()?, share)),
                false => *a,
            })
            .collect()
    }
}

/// `a` less `b`, balls under the names that are nearest to those of `b`.
fn difference(body: &Skeleton, a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut gap: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    for joint in 0..body.joints().len() {
        let ball = body.coordinates(joint);
        if ball.len() != 3 {
            continue;
        }
        let (from, to) = (
            &a[ball.clone()],
            Vector3::from_column_slice(&b[ball.clone()]),
        );
        let near = log_near(&exp(&Vector3::from_column_slice(from)), &to) - to;
        gap[ball].copy_from_slice(near.as_slice());
    }
    gap
}

/// From 0 to 1 with the least jerk (Flash and Hogan 1985).
fn least_jerk(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
}

/// Inverse kinematics that follows observed effectors: damped least squares (Wampler 1986), each effector by its own
/// limb.
struct Follower<'a> {
    body: &'a Skeleton,
    chains: Chains<'a>,
    limbs: Vec<Reach>,
}

impl<'a> Follower<'a> {
    fn of(body: &'a Skeleton, s: &EncodingSettings) -> Result<Self> {
        let limbs = s
            .effectors
            .iter()
            .map(|name| body.reach(body.effector(name)?));
        Ok(Self {
            body,
            chains: Chains::of(body, &s.effectors)?,
            limbs: limbs.collect::<Result<_>>()?,
        })
    }

    /// Brings a pose nearer to where the effectors were seen: metres in the upright thorax frame.
    fn follow(&self, pose: &mut [f64], seen: &[Option<Vector3<f64>>], secs: f64) {
        const ROUNDS: usize = 4;
        let dof = self.body.dof();
        let before = pose.to_vec();
        let most = FASTEST_RAD * secs;
        let mut jacobian = vec![0.0; 3 * dof];
        for _ in 0..ROUNDS {
            let (upright, yaw) = self.chains.posture(pose);
            let frames = self.body.frames(pose, &Root::ORIGIN);
            let Some(thorax) = self.body.thorax(&frames) else {
                return;
            };
            for ((limb, seen), here) in self.limbs.iter().zip(seen).zip(&upright) {
                let (Some(seen), Some(here)) = (seen, here) else {
                    continue;
                };
                limb.jacobian(pose, &mut jacobian);
                // The gap in the upright frame, turned into the thorax' own.
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
                let gap = thorax.rotation.inverse() * (turn * (seen - here));
                let square = Matrix3::from_fn(|i, k| {
                    (0..dof)
                        .map(|c| jacobian[i * dof + c] * jacobian[k * dof + c])
                        .sum()
                });
                let damped = square + Matrix3::identity() * (DAMPING_M * DAMPING_M);
                let Some(solved) = damped.cholesky().map(|d| d.solve(&gap)) else {
                    continue;
                };
                for (c, x) in pose.iter_mut().enumerate() {
                    *x += (0..3)
                        .map(|i| jacobian[i * dof + c] * solved[i])
                        .sum::<f64>();
                    *x = x.clamp(before[c] - most, before[c] + most);
                }
            }
        }
    }
}
