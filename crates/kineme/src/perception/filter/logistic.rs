//! Logistic regression: how scores tell the unknown from the known.

use nalgebra::{DMatrix, DVector};

use super::learned::SCORES;
use crate::math::statistics::mean_and_deviation;

/// Weight of the penalty.
const RIDGE: f64 = 1.0;

/// Logistic regression with a ridge, by Newton's steps; known and unknown count alike.
pub(super) fn logistic(told: &[([f64; SCORES], bool)]) -> ([[f64; 3]; SCORES], f64) {
    let mut scores = [[0.0, 1.0, 0.0]; SCORES];
    for (k, score) in scores.iter_mut().enumerate() {
        let values: Vec<f64> = told.iter().map(|t| t.0[k]).collect();
        let (mean, deviation) = mean_and_deviation(&values);
        *score = [mean, deviation.max(1e-9), 0.0];
    }
    let row = |t: &[f64; SCORES]| {
        let mut x = DVector::from_element(SCORES + 1, 1.0);
        for k in 0..SCORES {
            x[k] = (t[k] - scores[k][0]) / scores[k][1];
        }
        x
    };
    let share = told.iter().filter(|t| t.1).count() as f64 / told.len() as f64;
    let mut weights = DVector::<f64>::zeros(SCORES + 1);
    for _ in 0..30 {
        let mut gradient = &weights * -RIDGE;
        let mut hessian = DMatrix::<f64>::identity(SCORES + 1, SCORES + 1) * RIDGE;
        for (t, unknown) in told {
            let x = row(t);
            let p = 1.0 / (1.0 + (-weights.dot(&x)).exp());
            let (target, count) = match unknown {
                true => (1.0, 0.5 / share),
                false => (0.0, 0.5 / (1.0 - share)),
            };
            gradient += &x * (count * (target - p));
            hessian += &x * x.transpose() * (count * p * (1.0 - p));
        }
        let Some(step) = hessian.cholesky().map(|c| c.solve(&gradient)) else {
            break;
        };
        weights += &step;
        if step.norm() < 1e-9 {
            break;
        }
    }
    for (score, weight) in scores.iter_mut().zip(weights.iter()) {
        score[2] = *weight;
    }
    (scores, weights[SCORES])
}
