//! From the steps of a warping path to a smooth warp.

use std::f64::consts::TAU;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::warp::Warp;
use crate::error::{Error, Result};

/// Least slope of a warp between two knots, as a share of its mean slope (Kovar and Gleicher 2003).
pub(super) const SLOPE_FLOOR: f64 = 0.2;

/// Waves of a path shorter than this share of the movement count as steps of the grid and are smoothed away.
const SHORTEST_WAVE: f64 = 0.25;

/// Makes warps of paths: penalised least squares with a floor under the slope.
///
/// The places that the path visits at each knot are smoothed by Whittaker's (1923) graduation, least squares with a
/// penalty on second differences, ends fixed; what then still rises too slowly is raised by isotonic regression of
/// `place - floor * phase`, which is the least-squares projection onto warps with that floor. A spline that is monotone
/// by construction would bend everywhere to keep it in one place, and needs iterations.
pub(super) struct Smoother {
    knots: usize,
    closed: bool,
    factor: Cholesky<f64, Dyn>,
}

impl Smoother {
    /// For warps of this many knots (at least three), closed or open.
    pub fn new(knots: usize, closed: bool) -> Result<Self> {
        let spans = knots - 1;
        let inner = spans - 1;
        let wave = TAU / (SHORTEST_WAVE * spans as f64).max(2.0);
        // A wave of this length is halved: (2 sin(w / 2))^4 times the penalty is 1.
        let penalty = (2.0 * (0.5 * wave).sin()).powi(4).recip();
        let mut normal = DMatrix::<f64>::identity(inner, inner);
        // Unknown u_k = place - phase at knot k; u at the ends is 0, and goes round for a closed warp.
        let unknown = |knot: usize| (knot % spans).checked_sub(1);
        let bends = if closed { 0..spans } else { 1..spans };
        for k in bends {
            let stencil = [(k + spans - 1, 1.0), (k, -2.0), (k + 1, 1.0)];
            for &(p, x) in &stencil {
                for &(q, y) in &stencil {
                    if let (Some(p), Some(q)) = (unknown(p), unknown(q)) {
                        normal[(p, q)] += penalty * x * y;
                    }
                }
            }
        }
        let factor = Cholesky::new(normal)
            .ok_or_else(|| Error::invalid(format!("no warp of {knots} knots can be smoothed")))?;
        Ok(Self {
            knots,
            closed,
            factor,
        })
    }

    /// The warp of a path whose first index runs over the knots and whose second over as many places.
    pub fn warp(&self, path: &[(usize, usize)]) -> Result<Warp> {
        let mut visits = vec![(0.0, 0.0); self.knots];
        for &(i, j) in path {
            visits[i].0 += j as f64;
            visits[i].1 += 1.0;
        }
        let places: Vec<f64> = visits.iter().map(|(sum, count)| sum / count).collect();
        let spans = self.knots - 1;
        let shifts = DVector::from_fn(spans - 1, |k, _| places[k + 1] - (k + 1) as f64);
        let shifts = self.factor.solve(&shifts);
        let at = |k: usize| match k.checked_sub(1) {
            Some(inner) if k < spans => k as f64 + shifts[inner],
            _ => k as f64,
        };
        let places: Vec<f64> = (0..=spans).map(|k| at(k) / spans as f64).collect();
        floored(&places, self.closed)
    }
}

/// The warp nearest to these places whose slope between knots is at least [`SLOPE_FLOOR`].
pub(super) fn floored(places: &[f64], closed: bool) -> Result<Warp> {
    let spans = places.len() - 1;
    let floor = |k: usize| SLOPE_FLOOR * k as f64 / spans as f64;
    let inner: Vec<f64> = (1..spans).map(|k| places[k] - floor(k)).collect();
    let mut places = vec![0.0];
    for (k, v) in isotonic(&inner).into_iter().enumerate() {
        places.push(v.clamp(0.0, 1.0 - SLOPE_FLOOR) + floor(k + 1));
    }
    places.push(1.0);
    Warp::through(places, closed)
}

/// The least-squares rising sequence: adjacent values that fall are pooled into their mean.
fn isotonic(values: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::with_capacity(values.len());
    for &v in values {
        let mut pool = (v, 1);
        while let Some(&(mean, count)) = pools.last() {
            if mean <= pool.0 {
                break;
            }
            pools.pop();
            let both = count + pool.1;
            pool.0 = (mean * count as f64 + pool.0 * pool.1 as f64) / both as f64;
            pool.1 = both;
        }
        pools.push(pool);
    }
    pools
        .into_iter()
        .flat_map(|(v, n)| std::iter::repeat_n(v, n))
        .collect()
}
