//! Logistic regression: how scores tell the unknown from the known, and how sure that is.

use nalgebra::{DMatrix, DVector};

use super::learned::SCORES;
use crate::math::statistics::mean_and_deviation;

/// Weight of the penalty.
const RIDGE: f64 = 1.0;

/// What a regression found.
pub(super) struct Regression {
    /// Mean and deviation of each score, and its weight.
    pub scores: [[f64; 3]; SCORES],
    /// The constant.
    pub bias: f64,
    /// The covariance of the weights and, last, the constant (Laplace's approximation).
    pub covariance: [[f64; SCORES + 1]; SCORES + 1],
}

/// Logistic regression with a ridge, by Newton's steps; known and unknown count alike. For the covariance an example
/// counts as `independent` of one.
pub(super) fn logistic(told: &[([f64; SCORES], bool)], independent: f64) -> Regression {
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
    let count = |unknown: bool| match unknown {
        true => 0.5 / share,
        false => 0.5 / (1.0 - share),
    };
    let probability =
        |weights: &DVector<f64>, x: &DVector<f64>| 1.0 / (1.0 + (-weights.dot(x)).exp());
    let curvature = |weights: &DVector<f64>| {
        let mut sum = DMatrix::<f64>::zeros(SCORES + 1, SCORES + 1);
        for (t, unknown) in told {
            let x = row(t);
            let p = probability(weights, &x);
            sum += &x * x.transpose() * (count(*unknown) * p * (1.0 - p));
        }
        sum
    };
    let mut weights = DVector::<f64>::zeros(SCORES + 1);
    for _ in 0..30 {
        let mut gradient = &weights * -RIDGE;
        for (t, unknown) in told {
            let x = row(t);
            let target = f64::from(u8::from(*unknown));
            gradient += &x * (count(*unknown) * (target - probability(&weights, &x)));
        }
        let hessian =
            DMatrix::<f64>::identity(SCORES + 1, SCORES + 1) * RIDGE + curvature(&weights);
        let Some(step) = hessian.cholesky().map(|c| c.solve(&gradient)) else {
            break;
        };
        weights += &step;
        if step.norm() < 1e-9 {
            break;
        }
    }
    let precision = DMatrix::<f64>::identity(SCORES + 1, SCORES + 1) * RIDGE
        + curvature(&weights) * independent;
    // Not less than the ridge's, it has an inverse.
    let covariance = precision.cholesky().map(|c| c.inverse());
    for (score, weight) in scores.iter_mut().zip(weights.iter()) {
        score[2] = *weight;
    }
    let at = |i: usize, j: usize| covariance.as_ref().map_or(0.0, |c| c[(i, j)]);
    Regression {
        scores,
        bias: weights[SCORES],
        covariance: std::array::from_fn(|i| std::array::from_fn(|j| at(i, j))),
    }
}
