//! How an observation differs from the row that it follows: estimated from how rows of one primitive differ.

use nalgebra::{DMatrix, DVector};

use super::rows::Row;
use crate::perception::pairs::{MOST_PAIRS, all_pairs, farther};
use crate::perception::rows::manifold;
use crate::primitive::Vocabulary;

/// Standard deviations expected before any exemplar was seen, metres: of displacements, what people and retargeting are
/// good for; of postures more, as people stand differently, which displacements forget.
const PRIOR_DISPLACEMENT_M: f64 = 0.04;
const PRIOR_POSTURE_M: f64 = 0.06;
/// Never less than so much, metres: else what a few exemplars share by chance would decide everything.
const FLOOR_M: f64 = 0.03;
/// As many residuals of that size are taken for granted.
const PRIOR_COUNT: f64 = 200.0;
/// The share of the covariance that is replaced by its diagonal: features are more than exemplars determine.
const SHRINK: f64 = 0.1;
/// Phase within which the most alike moment is looked for.
const NEAR: f64 = 0.15;

/// The covariance of features about their row; `still` tells which of their numbers are of postures.
///
/// Residuals are differences of two rows of one primitive at the same phase.
pub(super) fn covariance(
    vocabulary: &Vocabulary,
    rows: &[Row],
    features: &[f64],
    still: &[bool],
) -> DMatrix<f64> {
    let prior = still.iter().map(|posture| match posture {
        true => PRIOR_COUNT * PRIOR_POSTURE_M * PRIOR_POSTURE_M,
        false => PRIOR_COUNT * PRIOR_DISPLACEMENT_M * PRIOR_DISPLACEMENT_M,
    });
    let dims = still.len();
    let mut sum = DMatrix::from_diagonal(&DVector::from_iterator(dims, prior));
    let mut count = PRIOR_COUNT;
    let mut starts = Vec::with_capacity(rows.len());
    let mut first = 0;
    for row in rows {
        starts.push(first);
        first += row.phases.len();
    }
    for primitive in 0..vocabulary.primitives().len() {
        let residual = |(a, b): (usize, usize)| {
            let r = residual((&rows[a], starts[a]), (&rows[b], starts[b]), features, dims);
            (r.norm_squared() / r.ncols() as f64, r)
        };
        for r in pairs(vocabulary, rows, primitive, residual) {
            // Two rows differ by twice what one differs from the truth.
            sum += &r * r.transpose() * 0.5;
            count += r.ncols() as f64;
        }
    }
    let covariance = sum / count;
    let diagonal = DMatrix::from_diagonal(&covariance.diagonal());
    covariance * (1.0 - SHRINK)
        + diagonal * SHRINK
        + DMatrix::identity(dims, dims) * (FLOOR_M * FLOOR_M)
}

/// What is left between rows of a primitive, pair by pair; `residual` gives it with its size.
///
/// Where exemplars are given by many people, or by one on several days, the more distant half of the pairs counts: a new
/// person will be as far. Where a grid of parameters is known, neighbours on it count: between them lies everything that
/// the primitive can be.
pub(super) fn pairs<R>(
    vocabulary: &Vocabulary,
    rows: &[Row],
    primitive: usize,
    residual: impl Fn((usize, usize)) -> (f64, R),
) -> Vec<R> {
    let members: Vec<usize> = (0..rows.len())
        .filter(|&r| rows[r].primitive == primitive)
        .collect();
    let principal = !manifold(&vocabulary.primitives()[primitive]);
    let pairs = match principal || members.iter().all(|&r| rows[r].parameters.is_empty()) {
        true => all_pairs(&members),
        false => neighbours(rows, &members),
    };
    let residuals: Vec<(f64, R)> = pairs.into_iter().map(residual).collect();
    match principal {
        true => farther(residuals),
        false => residuals.into_iter().map(|(_, r)| r).collect(),
    }
}

/// Each row with the one nearest in parameters.
fn neighbours(rows: &[Row], members: &[usize]) -> Vec<(usize, usize)> {
    let squared = |a: usize, b: usize| -> f64 {
        let pairs = rows[a].parameters.iter().zip(&rows[b].parameters);
        pairs.map(|(x, y)| (x - y) * (x - y)).sum()
    };
    let nearest = |&a: &usize| {
        let others = members.iter().copied().filter(|&b| b != a);
        let nearest = others.min_by(|&b, &c| squared(a, b).total_cmp(&squared(a, c)))?;
        Some((a, nearest))
    };
    members
        .iter()
        .filter_map(nearest)
        .take(MOST_PAIRS)
        .collect()
}

/// Features of a row less those of another where it is most alike, near the same phase: dims x moments. What is left of
/// differences of timing would hide the movement itself, as they lie along it.
fn residual(a: (&Row, usize), b: (&Row, usize), features: &[f64], dims: usize) -> DMatrix<f64> {
    let at = |start: usize, k: usize| &features[(start + k) * dims..(start + k + 1) * dims];
    let squared =
        |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum() };
    let column = |k: usize| {
        let own = at(a.1, k);
        let apart = |j: usize| {
            let d = (b.0.progress[j] - a.0.progress[k]).abs();
            if b.0.cyclic { d.min(1.0 - d) } else { d }
        };
        let near = |j: &usize| apart(*j) <= NEAR;
        let best = (0..b.0.phases.len())
            .filter(near)
            .min_by(|&i, &j| squared(own, at(b.1, i)).total_cmp(&squared(own, at(b.1, j))));
        let other = at(b.1, best.unwrap_or(0));
        DVector::from_iterator(dims, own.iter().zip(other).map(|(x, y)| x - y))
    };
    let columns: Vec<DVector<f64>> = (0..a.0.phases.len()).map(column).collect();
    DMatrix::from_columns(&columns)
}
