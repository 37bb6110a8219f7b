//! How far things of one primitive are from one another: the unit in which distances are told.

use super::Which;
use crate::math::statistics::median;

/// The median distance of `queries` to the nearest thing of another exemplar of their own primitive; to the nearest of
/// any other exemplar where no primitive has two; `fallback` where there is just one exemplar, or all are the same.
/// A row of `distances` is those of one query to all things.
pub(super) fn typical_distance(
    of: &[Which],
    queries: &[usize],
    distances: &[Vec<f64>],
    fallback: f64,
) -> f64 {
    let mut own = Vec::new();
    let mut any = Vec::new();
    for (&q, row) in queries.iter().zip(distances) {
        let (mut nearest_own, mut nearest) = (f64::INFINITY, f64::INFINITY);
        for (which, d) in of.iter().zip(row) {
            if *which == of[q] {
                continue;
            }
            nearest = nearest.min(*d);
            if which.primitive == of[q].primitive {
                nearest_own = nearest_own.min(*d);
            }
        }
        own.push(nearest_own);
        any.push(nearest);
    }
    // Medians pass over the infinite distances of those without a counterpart.
    let found = median(&own).or_else(|| median(&any));
    found.filter(|d| *d > 0.0).unwrap_or(fallback)
}

/// At most `most` of `count` indices, evenly spread.
pub(super) fn spread(count: usize, most: usize) -> Vec<usize> {
    let step = count.div_ceil(most.max(1)).max(1);
    (0..count).step_by(step).collect()
}
