//! How well a moment fits each moment of each row: Gaussian distances, whitened by how exemplars of one primitive differ.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

use super::features::Feature;
use crate::error::{Error, Result};
use crate::math::eigen::principal;

/// One part of the features, hands or body: its own covariance, its own trust.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Which numbers of a feature.
    pub range: Range<usize>,
    /// How much a squared distance counts, a second: features of successive moments are far from independent, and
    /// those of one moment too (the likelihood is tempered).
    pub trust_per_sec: f64,
    /// At most so many directions are kept, those in which the rows vary most once whitened.
    pub directions: usize,
    /// Covariance of an observation about the truth.
    pub covariance: DMatrix<f64>,
}

/// The distances of moments to all rows' moments, when certain numbers are unknown.
#[derive(Debug, Clone)]
pub(super) struct Emission {
    parts: Vec<Whitened>,
    states: usize,
    /// The unknown numbers that it is made for; empty: none.
    pub unknown: Vec<bool>,
}

#[derive(Debug, Clone)]
struct Whitened {
    trust_per_sec: f64,
    /// The numbers used.
    known: Vec<usize>,
    /// Directions x known: what makes residuals white.
    transform: DMatrix<f64>,
    /// Directions x states: the rows' moments, whitened; a direction's numbers lie together.
    states: Vec<f64>,
    /// A broad Gaussian over all moments of all rows: mean and variances along the directions.
    broad: Broad,
}

#[derive(Debug, Clone)]
struct Broad {
    mean: DVector<f64>,
    /// In these directions the rows vary independently.
    variances: DVector<f64>,
    log_det: f64,
}

/// What is told of a moment: for each state, and for movement of no known kind.
#[derive(Debug, Clone, Default)]
pub(super) struct Fit {
    /// Logarithm of the tempered density a second, one a state, up to a constant that all share.
    pub states: Vec<f64>,
    /// The same under the broad Gaussian.
    pub broad: f64,
}

impl Emission {
    /// Whitens the rows' features (states x dims) in these parts, without the unknown numbers.
    ///
    /// # Errors
    /// When a covariance is not positive definite.
    pub fn new(parts: &[Part], features: &[f64], dims: usize, unknown: &[bool]) -> Result<Self> {
        let hidden = |i: usize| unknown.get(i).copied().unwrap_or(false);
        let mut whitened = Vec::new();
        for part in parts {
            let known: Vec<usize> = part.range.clone().filter(|&i| !hidden(i)).collect();
            if !known.is_empty() {
                whitened.push(Whitened::new(part, known, features, dims)?);
            }
        }
        Ok(Self {
            parts: whitened,
            states: features.len() / dims,
            unknown: unknown.to_vec(),
        })
    }

    /// The number of directions, and how much each counts a second: what a moment costs that fits a state as well as
    /// any does.
    pub fn usual_cost(&self) -> f64 {
        let own = |p: &Whitened| 0.5 * p.trust_per_sec * p.transform.nrows() as f64;
        self.parts.iter().map(own).sum()
    }

    /// The tempered logarithm, a second, by which a feature fits zero everywhere if what is at zero varies `still` times
    /// less than what moves, and both vary as well by so much variance a number, which is sensors'.
    pub fn fit_to_zero(&self, feature: &Feature, still: f64, shaken: f64) -> f64 {
        let cost = |part: &Whitened| {
            let known = part.known.iter().map(|&i| feature.values[i]);
            let z = &part.transform * DVector::from_iterator(part.known.len(), known);
            let shaken = shaken * part.transform.norm_squared() / z.len() as f64;
            let times = (1.0 + shaken) / (1.0 / still + shaken);
            -0.5 * part.trust_per_sec * times * z.norm_squared()
        };
        self.parts.iter().map(cost).sum()
    }

    /// How well a feature fits.
    pub fn fit(&self, feature: &Feature, fit: &mut Fit) {
        fit.states.clear();
        fit.states.resize(self.states, 0.0);
        fit.broad = 0.0;
        for part in &self.parts {
            let known = DVector::from_iterator(
                part.known.len(),
                part.known.iter().map(|&i| feature.values[i]),
            );
            let z = &part.transform * known;
            Arch::new().dispatch(Distances {
                point: z.as_slice(),
                states: &part.states,
                factor: -0.5 * part.trust_per_sec,
                sums: &mut fit.states,
            });
            let off = &z - &part.broad.mean;
            let squared = off
                .component_mul(&off)
                .component_div(&part.broad.variances)
                .sum();
            fit.broad -= 0.5 * part.trust_per_sec * (squared + part.broad.log_det);
        }
    }
}

impl Whitened {
    fn new(part: &Part, known: Vec<usize>, features: &[f64], dims: usize) -> Result<Self> {
        let n = known.len();
        let states = features.len() / dims;
        let at = |i: usize| known[i] - part.range.start;
        let covariance = DMatrix::from_fn(n, n, |i, j| part.covariance[(at(i), at(j))]);
        let factor = Cholesky::new(covariance)
            .ok_or_else(|| Error::invalid("the exemplars differ in no direction: no covariance"))?;
        let raw = DMatrix::from_fn(n, states, |i, s| features[s * dims + known[i]]);
        let inverse = factor
            .l()
            .solve_lower_triangular(&DMatrix::identity(n, n))
            .ok_or_else(|| Error::invalid("a covariance that cannot be inverted"))?;
        let white = &inverse * raw;
        let mean = white.column_mean();
        let mut centred = white;
        for mut column in centred.column_iter_mut() {
            column -= &mean;
        }
        let (mut spread, directions) = principal(&centred)?;
        let kept = part.directions.clamp(1, n);
        spread.truncate(kept);
        let basis = directions.rows(0, kept).into_owned();
        let mean = &basis * mean;
        let mut reduced = &basis * centred;
        for mut column in reduced.column_iter_mut() {
            column += &mean;
        }
        // An observation is as white as ever about the rows.
        let variances = DVector::from_iterator(kept, spread.iter().map(|v| v.max(0.0) + 1.0));
        Ok(Self {
            trust_per_sec: part.trust_per_sec,
            known,
            transform: basis * inverse,
            states: reduced.transpose().as_slice().to_vec(),
            broad: Broad {
                log_det: variances.iter().map(|v| v.ln()).sum(),
                variances,
                mean,
            },
        })
    }
}

/// Adds to each sum the squared distance of a point to a state, times a factor.
struct Distances<'a> {
    point: &'a [f64],
    /// Directions x states.
    states: &'a [f64],
    factor: f64,
    sums: &'a mut [f64],
}

/// States whose sums are kept at hand while the directions are gone through.
const BLOCK: usize = 256;

impl WithSimd for Distances<'_> {
    type Output = ();

    // Inlined into a function compiled for the machine's vector instructions; the inner loop vectorises there, each
    // state's sum in the order of the directions whatever the width.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.sums.len();
        let mut squared = [0.0; BLOCK];
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            let block = &mut squared[..count];
            block.fill(0.0);
            for (x, states) in self.point.iter().zip(self.states.chunks_exact(n)) {
                for (sum, y) in block.iter_mut().zip(&states[first..first + count]) {
                    let d = x - y;
                    *sum += d * d;
                }
            }
            for (sum, d) in self.sums[first..first + count].iter_mut().zip(block) {
                *sum += self.factor * *d;
            }
        }
    }
}
