//! How well exemplars are predicted from the others.

use std::sync::Arc;

use nalgebra::Vector3;

use super::curve::Curve;
use super::modelling::LeaveOneOut;
use crate::skeleton::{Role, Root, Skeleton};

/// Phases at which postures are compared.
const PHASES: usize = 16;

/// Joint and wrist errors of the predictions that `weights` (row-major, folds x exemplars) make of the exemplars `folds`.
pub(super) fn leave_one_out(
    body: &Arc<Skeleton>,
    curves: &[Curve],
    folds: &[usize],
    weights: &[f64],
    [nearest_m, mean_m]: [f64; 2],
) -> LeaveOneOut {
    let n = curves.len();
    let mut joint_rad = 0.0;
    let mut wrist_m = 0.0;
    for (&i, weights) in folds.iter().zip(weights.chunks_exact(n)) {
        let guess = Curve::blended(curves, weights);
        let (joint, wrist) = difference(body, &curves[i], &guess);
        joint_rad += joint / folds.len() as f64;
        wrist_m += wrist / folds.len() as f64;
    }
    LeaveOneOut {
        joint_rad,
        wrist_m,
        nearest_m,
        mean_m,
    }
}

fn difference(body: &Arc<Skeleton>, a: &Curve, b: &Curve) -> (f64, f64) {
    let wrists: Vec<usize> = [Role::LeftHand, Role::RightHand]
        .iter()
        .filter_map(|&r| body.joints_of(r).first().copied())
        .collect();
    let moving: Vec<usize> = (0..body.joints().len())
        .filter(|&j| body.joints()[j].kind.dof() > 0)
        .collect();
    let (mut angles, mut metres) = (0.0, 0.0);
    let pose = |curve: &Curve, phase: f64| {
        let mut pose = vec![0.0; body.dof()];
        curve.add(phase, 1.0, 0, &mut pose);
        pose
    };
    for k in 0..PHASES {
        let phase = k as f64 / (PHASES - 1) as f64;
        let (p, q) = (pose(a, phase), pose(b, phase));
        for &j in &moving {
            let at = body.coordinates(j);
            let turn = body
                .rotation(j, &p[at.clone()])
                .angle_to(&body.rotation(j, &q[at]));
            angles += turn * turn;
        }
        let (f, g) = (
            body.frames(&p, &Root::ORIGIN),
            body.frames(&q, &Root::ORIGIN),
        );
        for &w in &wrists {
            let gap: Vector3<f64> = f[w].position - g[w].position;
            metres += gap.norm_squared();
        }
    }
    let mean = |sum: f64, count: usize| (sum / (PHASES * count.max(1)) as f64).sqrt();
    (mean(angles, moving.len()), mean(metres, wrists.len()))
}
