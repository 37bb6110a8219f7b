//! How well exemplars are predicted from the others.

use std::sync::Arc;

use nalgebra::Vector3;

use super::curve::Curve;
use super::fitting::SHAPE_PHASES;
use crate::error::Result;
use crate::motion::{Motion, landmark_dims};
use crate::skeleton::{Role, Root, Skeleton};

/// The registered exemplars' postures at some phases, blended as the primitive blends them.
pub(super) struct Judge<'a> {
    body: &'a Arc<Skeleton>,
    /// The postures of each exemplar, exemplars x phases x coordinates.
    poses: Vec<f64>,
    /// Their landmarks.
    landmarks: Vec<f64>,
}

impl<'a> Judge<'a> {
    pub fn new(body: &'a Arc<Skeleton>, curves: &[Curve]) -> Result<Self> {
        let dof = body.dof();
        let mut poses = vec![0.0; curves.len() * SHAPE_PHASES * dof];
        for (i, pose) in poses.chunks_exact_mut(dof).enumerate() {
            let phase = (i % SHAPE_PHASES) as f64 / (SHAPE_PHASES - 1) as f64;
            curves[i / SHAPE_PHASES].add(phase, 1.0, 0, pose);
        }
        let landmarks = landmarks(body, poses.clone())?;
        Ok(Self {
            body,
            poses,
            landmarks,
        })
    }

    /// The postures that weights make.
    fn blended(&self, weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; SHAPE_PHASES * self.body.dof()];
        for (poses, w) in self.poses.chunks_exact(sum.len()).zip(weights) {
            for (s, v) in sum.iter_mut().zip(poses) {
                *s += w * v;
            }
        }
        sum
    }

    /// Root mean square distance of a landmark from its true place, the mean over `folds`, metres: each exemplar of
    /// these predicted with its row of `weights` (row-major, folds x exemplars).
    pub fn landmark_m(&self, folds: &[usize], weights: &[f64]) -> Result<f64> {
        let one = SHAPE_PHASES * landmark_dims(self.body);
        let each = weights.len() / folds.len();
        let mut sum = 0.0;
        for (&i, weights) in folds.iter().zip(weights.chunks_exact(each)) {
            let guess = landmarks(self.body, self.blended(weights))?;
            let truth = &self.landmarks[i * one..(i + 1) * one];
            let square: f64 = guess
                .iter()
                .zip(truth)
                .map(|(a, b)| (a - b) * (a - b))
                .sum();
            sum += (square / (one / 3) as f64).sqrt();
        }
        Ok(sum / folds.len() as f64)
    }

    /// Root mean square angle between joint rotations (radians) and distance of the wrists (metres) of the same
    /// predictions, the means over folds.
    pub fn joint_rad_and_wrist_m(&self, folds: &[usize], weights: &[f64]) -> (f64, f64) {
        let one = SHAPE_PHASES * self.body.dof();
        let each = weights.len() / folds.len();
        let (mut joint_rad, mut wrist_m) = (0.0, 0.0);
        for (&i, weights) in folds.iter().zip(weights.chunks_exact(each)) {
            let truth = &self.poses[i * one..(i + 1) * one];
            let (joint, wrist) = difference(self.body, truth, &self.blended(weights));
            joint_rad += joint / folds.len() as f64;
            wrist_m += wrist / folds.len() as f64;
        }
        (joint_rad, wrist_m)
    }
}

fn landmarks(body: &Arc<Skeleton>, poses: Vec<f64>) -> Result<Vec<f64>> {
    let roots = vec![Root::ORIGIN; poses.len() / body.dof()];
    Ok(Motion::new("postures", Arc::clone(body), 1.0, poses, roots)?.landmarks())
}

fn difference(body: &Arc<Skeleton>, a: &[f64], b: &[f64]) -> (f64, f64) {
    let wrists: Vec<usize> = [Role::LeftHand, Role::RightHand]
        .iter()
        .filter_map(|&r| body.joints_of(r).first().copied())
        .collect();
    let moving: Vec<usize> = (0..body.joints().len())
        .filter(|&j| body.joints()[j].kind.dof() > 0)
        .collect();
    let (mut angles, mut metres) = (0.0, 0.0);
    let pairs = a.chunks_exact(body.dof()).zip(b.chunks_exact(body.dof()));
    for (p, q) in pairs {
        for &j in &moving {
            let at = body.coordinates(j);
            let turn = body
                .rotation(j, &p[at.clone()])
                .angle_to(&body.rotation(j, &q[at]));
            angles += turn * turn;
        }
        let (f, g) = (body.frames(p, &Root::ORIGIN), body.frames(q, &Root::ORIGIN));
        for &w in &wrists {
            let gap: Vector3<f64> = f[w].position - g[w].position;
            metres += gap.norm_squared();
        }
    }
    let mean = |sum: f64, count: usize| (sum / (SHAPE_PHASES * count.max(1)) as f64).sqrt();
    (mean(angles, moving.len()), mean(metres, wrists.len()))
}
