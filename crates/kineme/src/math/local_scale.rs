//! Local scaling of distances: what is near depends on how dense the neighbourhood is.

use crate::error::{Error, Result};

use super::distances::{DistanceMatrix, Neighbours, k_nearest};

/// Below this share of the median scale a neighbourhood of duplicates would make everything else infinitely far.
const LEAST_SHARE: f64 = 1e-6;

/// Every distance divided by the geometric mean of its two items' scales, an item's scale being the distance to its
/// `k`-th nearest (Zelnik-Manor and Perona 2004, "Self-tuning spectral clustering"). Without unit: a neighbour at the
/// usual distance of its surroundings is at 1, whether movements there differ much or little.
///
/// # Errors
/// When `k` is 0.
pub fn locally_scaled(distances: &DistanceMatrix, k: usize) -> Result<DistanceMatrix> {
    let len = distances.len();
    let mut row = vec![0.0; len];
    let scales = (0..len)
        .map(|i| {
            distances.row_into(i, &mut row);
            let near = k_nearest(&row, k, Some(i));
            near.last().map_or(1.0, |n| n.1)
        })
        .collect();
    let scales = guarded(scales, k)?;
    DistanceMatrix::from_fn(len, |i, j| {
        distances.get(i, j) / (scales[i] * scales[j]).sqrt()
    })
}

/// The same for lists of candidates, which stay as long as they are.
///
/// # Errors
/// When `k` is 0.
pub fn locally_scaled_lists(lists: &Neighbours, k: usize) -> Result<Neighbours> {
    let scale = |i: usize| {
        let list = lists.of(i);
        list.get(k.max(1) - 1).or(list.last()).map_or(1.0, |n| n.1)
    };
    let scales = guarded((0..lists.len()).map(scale).collect(), k)?;
    let scaled = |i: usize| {
        let pair = |&(j, d): &(usize, f64)| (j, d / (scales[i] * scales[j]).sqrt());
        lists.of(i).iter().map(pair).collect()
    };
    Neighbours::new((0..lists.len()).map(scaled).collect())
}

fn guarded(scales: Vec<f64>, k: usize) -> Result<Vec<f64>> {
    if k == 0 {
        return Err(Error::invalid(
            "local scaling needs at least the nearest neighbour",
        ));
    }
    let least = super::statistics::median(&scales).unwrap_or(1.0) * LEAST_SHARE;
    let least = if least > 0.0 { least } else { 1.0 };
    Ok(scales.into_iter().map(|s| s.max(least)).collect())
}
