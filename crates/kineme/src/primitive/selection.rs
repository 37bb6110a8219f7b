//! Which interpolator, and of how many parameters: each exemplar predicted from the others, by their inner products alone.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::modelling::{Interpolation, Trial};
use crate::error::Result;
use crate::interpolation::{Interpolator, Kernel, Method, Tail, wendland_support};

/// Parameters that data may choose at most: Wendland's function is positive definite up to three dimensions.
const MOST_PRINCIPAL: usize = 3;
/// A smoother interpolator must be better by this factor before the exact one is left.
const BETTER: f64 = 0.98;
/// Nuggets that are tried: relative to the kernel's value 1 at distance 0.
const NUGGETS: [f64; 3] = [0.03, 0.3, 3.0];

/// Where the exemplars' parameters come from.
pub(super) enum Points<'a> {
    /// Given, row-major, so many each.
    Given(&'a [f64], usize),
    /// Principal coordinates.
    Principal,
}

/// Exemplars that are left out in turn at most; of more, evenly chosen ones.
const MOST_FOLDS: usize = 60;

/// What the selection found: the best of each family of interpolators, exact ones first. Where nothing can be left out,
/// one that was not tried.
pub(super) struct Selection {
    /// The exemplars that were left out in turn.
    pub folds: Vec<usize>,
    pub finalists: Vec<Finalist>,
    /// Weights of the mean of the others, as [`Finalist::weights`].
    pub mean: Vec<f64>,
}

/// An interpolator with what it needs.
pub(super) struct Finalist {
    pub trial: Trial,
    /// Parameters in the unit cube, row-major.
    pub points: Vec<f64>,
    /// The weights of the others for each fold, row-major `folds x n`, zero for itself.
    pub weights: Vec<f64>,
    /// Likewise, one for the exemplar that is nearest in parameters.
    pub nearest: Vec<f64>,
}

/// Finds the best interpolators of each family. `gram` holds the inner products of the exemplars' registered landmarks,
/// `per_landmark` the number of landmarks that one exemplar has over all phases: errors are those of landmarks blended
/// as they are, near those of blended postures and quickly had.
pub(super) fn select(
    gram: &DMatrix<f64>,
    per_landmark: f64,
    points: &Points,
    wanted: Interpolation,
) -> Result<Selection> {
    let n = gram.nrows();
    let dims: Vec<usize> = match points {
        Points::Given(_, dims) => vec![*dims],
        // A direction needs exemplars on it: three for each after the first two.
        Points::Principal => {
            (1..=MOST_PRINCIPAL.min((n / 3).max(1)).min(n.saturating_sub(1))).collect()
        }
    };
    let dims = if dims.is_empty() { vec![0] } else { dims };
    let most = dims[dims.len() - 1];
    let left = folds(n);
    let (all, folds) = match points {
        Points::Given(values, dims) => (values.to_vec(), given_folds(values, *dims, n, &left)),
        Points::Principal => (
            principal(gram, None, most),
            principal_folds(gram, most, &left),
        ),
    };
    if n < 2 {
        let m = dims[0];
        let points = unit(&all, most, m, n).0;
        let trial = Trial {
            method: default_method(&points, n, m, wanted),
            dims: m,
            error_m: 0.0,
        };
        return Ok(Selection {
            folds: Vec::new(),
            finalists: vec![Finalist {
                trial,
                points,
                weights: Vec::new(),
                nearest: Vec::new(),
            }],
            mean: Vec::new(),
        });
    }
    let mut trials: Vec<(Trial, Vec<f64>)> = Vec::new();
    for &m in &dims {
        for method in candidates(&unit(&all, most, m, n).0, n, m, wanted) {
            let weights = fold_weights(&folds, n, most, m, &method)?;
            let error_m = mean_error(gram, &folds, &weights, per_landmark);
            let dims = m;
            let trial = Trial {
                method,
                dims,
                error_m,
            };
            trials.push((trial, weights));
        }
    }
    let finalists = [Family::Exact, Family::Smoothed, Family::Shepard]
        .into_iter()
        .filter_map(|family| {
            let own: Vec<usize> = (0..trials.len())
                .filter(|&t| Family::of(&trials[t].0.method) == family)
                .collect();
            let errors: Vec<f64> = own.iter().map(|&t| trials[t].0.error_m).collect();
            let (trial, weights) = trials[own[clearly_best(&errors)?]].clone();
            Some(Finalist {
                points: unit(&all, most, trial.dims, n).0,
                nearest: nearest_weights(&folds, n, most, trial.dims),
                trial,
                weights,
            })
        })
        .collect();
    Ok(Selection {
        finalists,
        mean: mean_weights(&folds, n),
        folds: left,
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Family {
    Exact,
    Smoothed,
    Shepard,
}

impl Family {
    fn of(method: &Method) -> Self {
        match method {
            Method::Shepard { .. } => Family::Shepard,
            Method::Cardinal { nugget, .. } if *nugget > 0.0 => Family::Smoothed,
            Method::Cardinal { .. } => Family::Exact,
        }
    }
}

/// The first error that no later one beats clearly.
pub(super) fn clearly_best(errors: &[f64]) -> Option<usize> {
    let mut best: Option<usize> = None;
    for (i, &error) in errors.iter().enumerate() {
        if best.is_none_or(|b| error < BETTER * errors[b]) {
            best = Some(i);
        }
    }
    best
}

fn verbs_and_adverbs(points: &[f64], n: usize, dims: usize, nugget: f64) -> Method {
    let support = wendland_support(points, n, dims);
    Method::Cardinal {
        kernel: Kernel::Wendland { support },
        tail: Tail::LeastSquares,
        nugget,
    }
}

/// Shepard's power must pass the dimension, or far exemplars together outweigh the near one.
fn shepard(dims: usize, times: f64) -> Method {
    Method::Shepard {
        power: times * (dims + 1).max(2) as f64,
    }
}

fn default_method(points: &[f64], n: usize, dims: usize, wanted: Interpolation) -> Method {
    match wanted {
        Interpolation::Shepard => shepard(dims, 1.0),
        _ => verbs_and_adverbs(points, n, dims, 0.0),
    }
}

fn candidates(points: &[f64], n: usize, dims: usize, wanted: Interpolation) -> Vec<Method> {
    let exact = verbs_and_adverbs(points, n, dims, 0.0);
    let inverse = [1.0, 2.0].map(|times| shepard(dims, times));
    match wanted {
        Interpolation::VerbsAndAdverbs => vec![exact],
        Interpolation::Shepard => inverse.to_vec(),
        Interpolation::Automatic => {
            let mut all = vec![exact];
            all.extend(NUGGETS.map(|nugget| verbs_and_adverbs(points, n, dims, nugget)));
            all.extend(inverse);
            all
        }
    }
}

/// Raw parameters without one exemplar, and its own under the transform fitted without it.
struct Fold {
    exemplar: usize,
    others: Vec<f64>,
    own: Vec<f64>,
}

/// Which exemplars are left out in turn.
fn folds(n: usize) -> Vec<usize> {
    let count = n.min(MOST_FOLDS);
    (0..count).map(|k| k * n / count).collect()
}

fn given_folds(values: &[f64], dims: usize, n: usize, left: &[usize]) -> Vec<Fold> {
    let row = |i: usize| &values[i * dims..(i + 1) * dims];
    left.iter()
        .map(|&i| Fold {
            exemplar: i,
            others: (0..n).filter(|&k| k != i).flat_map(row).copied().collect(),
            own: row(i).to_vec(),
        })
        .collect()
}

fn principal_folds(gram: &DMatrix<f64>, dims: usize, left: &[usize]) -> Vec<Fold> {
    let n = gram.nrows();
    if n < 2 {
        return Vec::new();
    }
    left.iter()
        .map(|&i| {
            let mut scores = principal(gram, Some(i), dims);
            let own = scores.split_off((n - 1) * dims);
            Fold {
                exemplar: i,
                others: scores,
                own,
            }
        })
        .collect()
}

/// Principal coordinates of all exemplars but `without`, row-major, and behind them those of `without` itself,
/// from inner products alone (kernel PCA with a linear kernel).
fn principal(gram: &DMatrix<f64>, without: Option<usize>, dims: usize) -> Vec<f64> {
    let kept: Vec<usize> = (0..gram.nrows()).filter(|i| Some(*i) != without).collect();
    let n = kept.len();
    let inner = DMatrix::from_fn(n, n, |a, b| gram[(kept[a], kept[b])]);
    let rows: Vec<f64> = (0..n).map(|a| inner.row(a).sum() / n as f64).collect();
    let all = rows.iter().sum::<f64>() / n as f64;
    let centred = DMatrix::from_fn(n, n, |a, b| inner[(a, b)] - rows[a] - rows[b] + all);
    let directions = leading(centred, dims);
    let mut scores = vec![0.0; (n + usize::from(without.is_some())) * dims];
    for (d, (value, vector)) in directions.iter().enumerate() {
        let length = value.max(0.0).sqrt();
        for a in 0..n {
            scores[a * dims + d] = vector[a] * length;
        }
        if let Some(i) = without {
            let cross: Vec<f64> = kept.iter().map(|&k| gram[(i, k)]).collect();
            let mean = cross.iter().sum::<f64>() / n as f64;
            let along: f64 = (0..n)
                .map(|a| vector[a] * (cross[a] - mean - rows[a] + all))
                .sum();
            scores[n * dims + d] = if length > 0.0 { along / length } else { 0.0 };
        }
    }
    scores
}

/// Eigenvectors of the largest eigenvalues, each with its largest entry positive.
pub(super) fn leading(matrix: DMatrix<f64>, count: usize) -> Vec<(f64, DVector<f64>)> {
    let eigen = SymmetricEigen::new(matrix);
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| {
        eigen.eigenvalues[b]
            .total_cmp(&eigen.eigenvalues[a])
            .then(a.cmp(&b))
    });
    let vector = |i: usize| {
        let v = eigen.eigenvectors.column(i).into_owned();
        let sign = if v[v.iamax()] < 0.0 { -1.0 } else { 1.0 };
        (eigen.eigenvalues[i], v * sign)
    };
    order.into_iter().take(count).map(vector).collect()
}

/// The first `m` of `most` coordinates of `n` points brought into [0, 1], with their ranges; a coordinate that does not
/// vary becomes 0.
pub(super) fn unit(points: &[f64], most: usize, m: usize, n: usize) -> (Vec<f64>, Vec<[f64; 2]>) {
    let ranges: Vec<[f64; 2]> = (0..m)
        .map(|d| {
            let column = (0..n).map(|i| points[i * most + d]);
            column.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            })
        })
        .collect();
    let places = (0..n).flat_map(|i| (0..m).map(move |d| (i, d)));
    let places = places.map(|(i, d)| place(points[i * most + d], ranges[d]));
    (places.collect(), ranges)
}

fn place(value: f64, [low, high]: [f64; 2]) -> f64 {
    if high > low {
        (value - low) / (high - low)
    } else {
        0.0
    }
}

/// Weights of the others for every exemplar, parameters and interpolator made without it.
fn fold_weights(
    folds: &[Fold],
    n: usize,
    most: usize,
    m: usize,
    method: &Method,
) -> Result<Vec<f64>> {
    let mut weights = Vec::with_capacity(folds.len() * n);
    let mut own = vec![0.0; n - 1];
    for fold in folds {
        let (points, ranges) = unit(&fold.others, most, m, n - 1);
        let interpolator = Interpolator::new(&points, n - 1, m, method)?;
        let asked: Vec<f64> = (0..m).map(|d| place(fold.own[d], ranges[d])).collect();
        interpolator.weights(&interpolator.clamped(&asked), &mut own);
        spread(&own, fold.exemplar, &mut weights);
    }
    Ok(weights)
}

/// Appends the weights of the others with a zero for the exemplar itself.
fn spread(own: &[f64], exemplar: usize, weights: &mut Vec<f64>) {
    weights.extend_from_slice(&own[..exemplar]);
    weights.push(0.0);
    weights.extend_from_slice(&own[exemplar..]);
}

fn nearest_weights(folds: &[Fold], n: usize, most: usize, m: usize) -> Vec<f64> {
    let mut weights = Vec::with_capacity(folds.len() * n);
    for fold in folds {
        let (points, ranges) = unit(&fold.others, most, m, n - 1);
        let asked: Vec<f64> = (0..m).map(|d| place(fold.own[d], ranges[d])).collect();
        let distance = |k: usize| -> f64 {
            let other = &points[k * m..(k + 1) * m];
            other
                .iter()
                .zip(&asked)
                .map(|(a, b)| (a - b) * (a - b))
                .sum()
        };
        let nearest = (0..n - 1).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        let mut own = vec![0.0; n - 1];
        if let Some(k) = nearest {
            own[k] = 1.0;
        }
        spread(&own, fold.exemplar, &mut weights);
    }
    weights
}

fn mean_weights(folds: &[Fold], n: usize) -> Vec<f64> {
    let own = vec![1.0 / (n - 1) as f64; n - 1];
    let mut weights = Vec::with_capacity(folds.len() * n);
    for fold in folds {
        spread(&own, fold.exemplar, &mut weights);
    }
    weights
}

/// The mean over folds of the root mean square landmark error that these weights make.
fn mean_error(gram: &DMatrix<f64>, folds: &[Fold], weights: &[f64], per_landmark: f64) -> f64 {
    let n = gram.nrows();
    let error = |(fold, w): (&Fold, &[f64])| {
        let i = fold.exemplar;
        let mut square = gram[(i, i)];
        for k in 0..n {
            square -= 2.0 * w[k] * gram[(i, k)];
            square += w[k] * (0..n).map(|l| w[l] * gram[(k, l)]).sum::<f64>();
        }
        (square.max(0.0) / per_landmark).sqrt()
    };
    let errors = folds.iter().zip(weights.chunks_exact(n)).map(error);
    errors.sum::<f64>() / folds.len() as f64
}
