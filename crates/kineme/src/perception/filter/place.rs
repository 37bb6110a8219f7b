//! Where on a primitive's manifold a posture is: what the filter believes, brought to the posture itself.

use nalgebra::{DMatrix, DVector};

use super::rows::Row;
use crate::error::Result;
use crate::perception::rows::manifold;
use crate::primitive::{Place, Primitive};

/// States within so much phase of the most probable one belong to it.
const AROUND: f64 = 0.15;
/// How finely states tell phase and parameters at best.
const PHASE_STEP: f64 = 0.03;
const PARAMETER_STEP: f64 = 0.15;
/// How closely a posture of the primitive is met in each coordinate, radians, where exemplars are interpolated exactly.
const EXACT_RAD: f64 = 0.02;
/// Steps of Gauss and Newton.
const STEPS: usize = 5;

/// What is believed of a primitive's phase and parameters.
pub(super) struct Spread {
    phase: [f64; 2],
    parameters: Vec<[f64; 2]>,
}

impl Spread {
    /// Mean and deviation around the most probable state of a primitive; `None` where no state has any mass.
    pub fn of(rows: &[Row], starts: &[usize], mass: &[f64], primitive: usize) -> Option<Self> {
        let own = || {
            let of = rows
                .iter()
                .enumerate()
                .filter(|(_, r)| r.primitive == primitive);
            of.flat_map(|(r, row)| {
                (0..row.phases.len()).map(move |k| (row, k, mass[starts[r] + k]))
            })
        };
        // The mode over phase, parameters summed out: a bin is as wide as states lie apart.
        let mut bins = [0.0; 33];
        for (row, k, m) in own() {
            bins[(row.phases[k] * 32.0).round() as usize] += m;
        }
        let most = (0..bins.len()).max_by(|&a, &b| bins[a].total_cmp(&bins[b]))?;
        if bins[most] <= 0.0 {
            return None;
        }
        let mode = most as f64 / 32.0;
        let cyclic = rows.iter().any(|r| r.primitive == primitive && r.cyclic);
        let apart = |row: &Row, k: usize| {
            let d = row.phases[k] - mode;
            if cyclic { d - d.round() } else { d }
        };
        let dims = rows
            .iter()
            .find(|r| r.primitive == primitive)?
            .parameters
            .len();
        let (mut sum, mut moments) = (0.0, vec![[0.0; 2]; dims + 1]);
        for (row, k, m) in own() {
            let d = apart(row, k);
            if d.abs() > AROUND {
                continue;
            }
            sum += m;
            let values = std::iter::once(d).chain(row.parameters.iter().copied());
            for (total, v) in moments.iter_mut().zip(values) {
                total[0] += m * v;
                total[1] += m * v * v;
            }
        }
        let mut told = moments.into_iter().map(|[a, b]| {
            let mean = a / sum;
            [mean, (b / sum - mean * mean).max(0.0).sqrt()]
        });
        let [offset, deviation] = told.next()?;
        Some(Self {
            phase: [mode + offset, deviation],
            parameters: told.collect(),
        })
    }
}

/// The place of a posture (coordinates that were not seen are no numbers). Where parameters have a meaning, belief and
/// posture are joined: the parameters and phase that are most probable given both (Gauss and Newton), with the
/// deviations of the quadratic there (Laplace).
pub(super) fn place(
    primitive: &Primitive,
    index: usize,
    spread: &Spread,
    pose: &[f64],
) -> Result<Place> {
    let m = spread.parameters.len();
    let wrap = |phase: f64| match primitive.is_cyclic() {
        true => phase.rem_euclid(1.0),
        false => phase.clamp(0.0, 1.0),
    };
    let mut mean = vec![spread.phase[0]];
    mean.extend(spread.parameters.iter().map(|p| p[0]));
    let mut deviation = vec![spread.phase[1].max(PHASE_STEP)];
    deviation.extend(spread.parameters.iter().map(|p| p[1].max(PARAMETER_STEP)));
    let mut at = mean.clone();
    if manifold(primitive) {
        let sigma = primitive
            .fitted()
            .error
            .filter(|_| !primitive.interpolator().is_exact());
        let sigma = sigma.map_or(EXACT_RAD, |e| e.joint_rad.max(EXACT_RAD));
        let prior = DVector::from_iterator(m + 1, deviation.iter().map(|d| 1.0 / (d * d)));
        let mut hessian = DMatrix::from_diagonal(&prior);
        for _ in 0..STEPS {
            let (p, phase) = (&at[1..], wrap(at[0]));
            let (own, rows) = primitive.pose_gradient(p, phase)?;
            let slope = primitive.sample(p, phase)?.slope;
            let dof = own.len();
            // A coordinate that was not seen pulls nowhere.
            let jacobian = DMatrix::from_fn(dof, m + 1, |c, k| match k {
                _ if pose[c].is_nan() => 0.0,
                0 => slope[c],
                _ => rows[(k - 1) * dof + c],
            });
            let miss = DVector::from_iterator(
                dof,
                pose.iter()
                    .zip(&own)
                    .map(|(x, f)| if x.is_nan() { 0.0 } else { x - f }),
            );
            let weight = 1.0 / (sigma * sigma);
            hessian = jacobian.transpose() * &jacobian * weight + DMatrix::from_diagonal(&prior);
            let away = DVector::from_iterator(m + 1, at.iter().zip(&mean).map(|(a, b)| a - b));
            let pull = jacobian.transpose() * miss * weight - away.component_mul(&prior);
            let Some(step) = hessian.clone().cholesky().map(|c| c.solve(&pull)) else {
                break;
            };
            // No step leaves the neighbourhood that the filter believes in.
            for ((a, s), d) in at.iter_mut().zip(step.iter()).zip(&deviation) {
                *a += s.clamp(-2.0 * d, 2.0 * d);
            }
            for p in &mut at[1..] {
                *p = p.clamp(0.0, 1.0);
            }
        }
        if let Some(inverse) = hessian.try_inverse() {
            for (d, v) in deviation.iter_mut().zip(inverse.diagonal().iter()) {
                *d = v.max(0.0).sqrt();
            }
        }
    }
    Ok(Place {
        primitive: index,
        phase: wrap(at[0]),
        phase_deviation: deviation[0],
        parameters: at[1..].to_vec(),
        parameters_deviation: deviation[1..].to_vec(),
    })
}
