//! Leading eigenpairs of the doubly centred matrix of classical scaling, `B = -1/2 H (D o D) H`.
//!
//! Small matrices are decomposed whole. Large ones by a block Lanczos method that never forms `B`: blocks, because data
//! on a loop have double eigenvalues, of which a single Krylov vector sees one; ordered by value, not magnitude,
//! because geodesics give large negative eigenvalues too.

use faer::Mat;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::krylov::{Krylov, WIDTH};
use crate::error::{Error, Result};
use crate::math::distances::DistanceMatrix;
use crate::math::eigen::decompose;

/// Matrices up to this size are decomposed whole.
const WHOLE: usize = 1000;
/// A pair is found when its residual is below this share of the largest eigenvalue.
const TOLERANCE: f64 = 1e-11;
/// Blocks at most: their memory is `32 * BLOCKS` bytes an item.
const BLOCKS: usize = 100;
/// Blocks of the estimate of the sum of magnitudes.
const PROBE_BLOCKS: usize = 10;

/// Leading eigenpairs, and what share of the spectrum is negative.
#[derive(Debug, Clone)]
pub(super) struct Eigenpairs {
    /// Decreasing.
    pub values: Vec<f64>,
    /// Unit vectors, the entry of largest magnitude positive.
    pub vectors: Vec<Vec<f64>>,
    /// Sum of negative magnitudes over sum of all magnitudes.
    pub negative_share: f64,
}

/// The `count` algebraically largest eigenpairs of the doubly centred squares of `distances`, which are finite.
pub(super) fn leading(distances: &DistanceMatrix, count: usize) -> Result<Eigenpairs> {
    let count = count.min(distances.len());
    let mut pairs = if distances.len() <= WHOLE {
        whole(distances, count)?
    } else {
        iterative(distances, count)?
    };
    for vector in &mut pairs.vectors {
        let largest = vector
            .iter()
            .fold(0.0f64, |m, v| if v.abs() > m.abs() { *v } else { m });
        if largest < 0.0 {
            vector.iter_mut().for_each(|v| *v = -*v);
        }
    }
    Ok(pairs)
}

fn whole(distances: &DistanceMatrix, count: usize) -> Result<Eigenpairs> {
    let len = distances.len();
    let mut b = Mat::from_fn(len, len, |i, j| distances.get(i, j).powi(2));
    let means: Vec<f64> = (0..len)
        .map(|j| b.col(j).iter().sum::<f64>() / len as f64)
        .collect();
    let mean = means.iter().sum::<f64>() / len as f64;
    for j in 0..len {
        for i in 0..len {
            b[(i, j)] = -0.5 * (b[(i, j)] - means[i] - means[j] + mean);
        }
    }
    let (values, vectors) = decompose(&b)?;
    let all: f64 = values.iter().map(|v| v.abs()).sum();
    let negative: f64 = values.iter().map(|v| (-v).max(0.0)).sum();
    let top = (0..count).map(|k| len - 1 - k);
    Ok(Eigenpairs {
        values: top.clone().map(|k| values[k]).collect(),
        vectors: top
            .map(|k| vectors.col(k).iter().copied().collect())
            .collect(),
        negative_share: if all > 0.0 { negative / all } else { 0.0 },
    })
}

fn iterative(distances: &DistanceMatrix, count: usize) -> Result<Eigenpairs> {
    let len = distances.len();
    let mut random = Pcg64::seed_from_u64(0);
    let mut krylov = Krylov::new(distances, Vec::new(), &mut random);
    let (values, weights) = loop {
        krylov.advance(&mut random);
        let steps = krylov.steps();
        let last = steps == BLOCKS;
        // Decomposing the small matrix costs little, but not nothing.
        if steps * WIDTH < count + WIDTH || !(steps.is_multiple_of(4) || last) {
            continue;
        }
        let (values, weights) = krylov.ritz()?;
        let size = values.len();
        let found = (size - count..size)
            .all(|k| krylov.residual(&weights, k) <= TOLERANCE * values[size - 1].abs());
        if found {
            break (values, weights);
        }
        if last {
            return Err(Error::unsupported(format!(
                "the {count} leading axes of the distances did not converge; ask for fewer"
            )));
        }
    };
    let top = (0..count).map(|k| values.len() - 1 - k);
    let vectors: Vec<Vec<f64>> = top.clone().map(|k| krylov.vector(&weights, k)).collect();
    // The negative end of the space is nearly as good: setting it aside steadies the estimate that follows.
    let bottom = (0..count.min(values.len() - count)).filter(|&k| values[k] < 0.0);
    let mut locked = vectors.clone();
    locked.extend(bottom.clone().map(|k| krylov.vector(&weights, k)));
    let known: f64 = bottom.chain(top.clone()).map(|k| values[k].abs()).sum();
    let values: Vec<f64> = top.map(|k| values[k]).collect();
    drop(krylov);
    // The trace is the sum of all eigenvalues; the sum of magnitudes outside the pairs found is a block quadrature of
    // |x| over the rest of the spectrum (stochastic Lanczos, Ubaru, Chen and Saad 2017).
    let trace = trace(distances);
    let mut krylov = Krylov::new(distances, locked, &mut random);
    for _ in 0..PROBE_BLOCKS {
        krylov.advance(&mut random);
    }
    let (ritz, weights) = krylov.ritz()?;
    let seen: f64 = (0..ritz.len())
        .map(|k| {
            let weight: f64 = (0..WIDTH).map(|r| weights[(r, k)].powi(2)).sum();
            ritz[k].abs() * weight
        })
        .sum();
    let others = len - 1 - krylov.locked();
    let all = known + others as f64 / WIDTH as f64 * seen;
    Ok(Eigenpairs {
        values,
        vectors,
        negative_share: if all > 0.0 {
            ((all - trace) / (2.0 * all)).max(0.0)
        } else {
            0.0
        },
    })
}

/// The trace of `B`: half the mean of all squares times the number of items.
fn trace(distances: &DistanceMatrix) -> f64 {
    let rows: Vec<f64> = (0..distances.len())
        .into_par_iter()
        .map(|i| distances.upper_row(i).iter().map(|d| d * d).sum())
        .collect();
    rows.iter().sum::<f64>() / distances.len() as f64
}
