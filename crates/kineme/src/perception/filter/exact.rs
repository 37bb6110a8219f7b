//! How well a moment fits the manifold itself, around each moment of each row: for bodies that perform a primitive and
//! do not merely resemble it.
//!
//! People differ from exemplars by several centimetres, and the emission allows for that; a body that carries out
//! f(p, phase) differs by millimetres. Told by the wide measure alone, its slow beginnings look like rest, and the way
//! from one movement into another like a movement. Between grid points a row's moment stands for its neighbourhood on
//! the manifold: a Gaussian, long along the tangents at it and thin across (tangent distance, Simard et al. 1993).

use nalgebra::{DMatrix, DVector};

use super::features::Feature;
use crate::error::{Error, Result};
use crate::math::eigen::principal;

/// Standard deviation across the manifold, metres: sensors, and what a controller lags. Postures alone are compared: who
/// goes from one movement into the next has no displacement of either, and the pace along a row says as much.
const ACROSS_M: f64 = 0.004;
/// Who stands still is displaced by so much in a window, metres (radians of the turn): sensors, and a body's sway.
const SWAY_M: f64 = 0.005;
/// How much a squared distance counts, a second (see [`super::emission::Part`]).
const TRUST_PER_SEC: f64 = 12.0;
/// Movement that is not on the manifold is anywhere within so many deviations of the rows.
const BROAD: f64 = 10.0;
/// Directions in which the rows vary by less, in deviations, are all alike.
const ALIKE: f64 = 0.15;
/// A moment is worth comparing exactly if the wide measure has it this near to the best, in shares of what a moment
/// usually costs.
const WORTH: f64 = 0.5;

/// What may vary around the moments of the rows: vectors in the features' numbers, each as long as one deviation.
#[derive(Debug, Clone)]
pub(super) struct Tangents {
    /// Vectors of each state.
    pub count: usize,
    /// Of each state, count x dims; none where its primitive's parameters have no meaning.
    pub vectors: Vec<Option<Vec<f64>>>,
}

/// The densities of moments around the rows' moments, against that of movement anywhere.
#[derive(Debug, Clone)]
pub(super) struct Exact {
    known: Vec<usize>,
    /// Numbers that tell displacements.
    displaced: Vec<usize>,
    mean: DVector<f64>,
    /// Directions x known, orthonormal: those in which the rows vary.
    basis: DMatrix<f64>,
    /// Variances of the rows along them.
    variances: DVector<f64>,
    /// Of each state: its place, and `count` vectors whose products with a residual take their squares off its length;
    /// states x (1 + count) x directions.
    states: Vec<f64>,
    /// Logarithm of each state's determinant; none of states that are not compared.
    log_dets: Vec<Option<f64>>,
    count: usize,
}

impl Exact {
    /// Of the rows' features (states x dims) without the unknown numbers; `still` tells which are of postures. `None`
    /// where nothing is known.
    ///
    /// # Errors
    /// When a decomposition fails.
    pub fn new(
        features: &[f64],
        tangents: &Tangents,
        still: &[bool],
        unknown: &[bool],
    ) -> Result<Option<Self>> {
        let dims = still.len();
        let hidden = |i: usize| unknown.get(i).copied().unwrap_or(false);
        let known: Vec<usize> = (0..dims).filter(|&i| still[i] && !hidden(i)).collect();
        if known.is_empty() {
            return Ok(None);
        }
        let scaled = |values: &[f64]| {
            DVector::from_iterator(known.len(), known.iter().map(|&i| values[i] / ACROSS_M))
        };
        let columns: Vec<DVector<f64>> = features.chunks_exact(dims).map(scaled).collect();
        let mut centred = DMatrix::from_columns(&columns);
        let mean = centred.column_mean();
        for mut column in centred.column_iter_mut() {
            column -= &mean;
        }
        let count = columns.len();
        let (mut variances, directions) = principal(&centred)?;
        variances.retain(|v| *v > ALIKE * ALIKE);
        if variances.is_empty() {
            return Ok(None);
        }
        let basis = directions.rows(0, variances.len()).into_owned();
        let places = &basis * centred;
        let mut exact = Self {
            states: Vec::with_capacity(count * (1 + tangents.count) * variances.len()),
            variances: DVector::from_vec(variances),
            log_dets: Vec::with_capacity(count),
            count: tangents.count,
            displaced: (0..dims).filter(|&i| !still[i] && !hidden(i)).collect(),
            known,
            mean,
            basis,
        };
        for (place, vectors) in places.column_iter().zip(&tangents.vectors) {
            exact.push(place.as_slice(), vectors.as_deref(), dims)?;
        }
        Ok(Some(exact))
    }

    /// What the displacements of a feature cost a second if the body stands still.
    pub fn moving(&self, feature: &Feature) -> f64 {
        let squares = self.displaced.iter().map(|&i| feature.values[i].powi(2));
        0.5 * TRUST_PER_SEC * squares.sum::<f64>() / (SWAY_M * SWAY_M)
    }

    fn push(&mut self, place: &[f64], vectors: Option<&[f64]>, dims: usize) -> Result<()> {
        let directions = self.basis.nrows();
        self.states.extend_from_slice(place);
        let Some(vectors) = vectors else {
            self.states
                .extend(std::iter::repeat_n(0.0, self.count * directions));
            self.log_dets.push(None);
            return Ok(());
        };
        let rows: Vec<_> = vectors
            .chunks_exact(dims)
            .map(|v| {
                let own = self.known.iter().map(|&i| v[i] / ACROSS_M);
                (&self.basis * DVector::from_iterator(self.known.len(), own)).transpose()
            })
            .collect();
        let w = DMatrix::from_rows(&rows);
        let inner = DMatrix::identity(self.count, self.count) + &w * w.transpose();
        let factor = inner
            .cholesky()
            .ok_or_else(|| Error::invalid("tangents that are no numbers"))?;
        let l = factor.l();
        let u = l
            .solve_lower_triangular(&w)
            .ok_or_else(|| Error::invalid("tangents that are no numbers"))?;
        self.states.extend_from_slice(u.transpose().as_slice());
        let log_det = 2.0 * l.diagonal().iter().map(|d| d.ln()).sum::<f64>();
        self.log_dets.push(Some(log_det));
        Ok(())
    }

    /// Logarithms of the densities a second around each state, less that of movement anywhere; minus infinity where
    /// the wide measure (`wide`, of which `usual` is what a moment usually costs) is not near its best.
    pub fn fit(&self, feature: &Feature, wide: &[f64], usual: f64, out: &mut Vec<f64>) {
        let values = self.known.iter().map(|&i| feature.values[i] / ACROSS_M);
        let off = DVector::from_iterator(self.known.len(), values) - &self.mean;
        let z = &self.basis * &off;
        let outside = (off.norm_squared() - z.norm_squared()).max(0.0);
        let beyond = BROAD * BROAD;
        let mut broad = outside / beyond;
        broad += (self.known.len() - z.len()) as f64 * beyond.ln();
        for (x, v) in z.iter().zip(self.variances.iter()) {
            broad += x * x / (v + beyond) + (v + beyond).ln();
        }
        let best = wide.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (d, size) = (z.len(), (1 + self.count) * z.len());
        let mut residual = vec![0.0; d];
        out.clear();
        let pairs = wide.iter().zip(&self.log_dets).enumerate();
        out.extend(pairs.map(|(s, (w, log_det))| {
            let near = *w >= best - WORTH * usual;
            let Some(log_det) = log_det.filter(|_| near) else {
                return f64::NEG_INFINITY;
            };
            let state = &self.states[s * size..(s + 1) * size];
            let mut squared = outside;
            for ((r, x), y) in residual.iter_mut().zip(z.iter()).zip(&state[..d]) {
                *r = x - y;
                squared += *r * *r;
            }
            for u in state[d..].chunks_exact(d) {
                let along: f64 = u.iter().zip(&residual).map(|(a, b)| a * b).sum();
                squared -= along * along;
            }
            0.5 * TRUST_PER_SEC * (broad - squared - log_det)
        }));
    }
}
