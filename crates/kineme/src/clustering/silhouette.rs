//! Silhouettes (Rousseeuw 1987): how much nearer items are to their own group than to the nearest other.

use rayon::prelude::*;

use crate::math::distances::DistanceMatrix;
use crate::math::partition::cluster_sizes;

/// The silhouette of each grouped item, in [-1, 1]: `(b - a) / max(a, b)`, a its mean distance to the rest of its group,
/// b to the nearest other group. 0 for an item alone; `None` without a group or with one group only.
pub fn silhouettes(distances: &DistanceMatrix, labels: &[Option<usize>]) -> Vec<Option<f64>> {
    let sizes = cluster_sizes(labels);
    let one = |row: &mut Vec<f64>, i: usize| {
        let own = labels[i]?;
        if sizes.len() < 2 {
            return None;
        }
        distances.row_into(i, row);
        let mut sums = vec![0.0; sizes.len()];
        for (label, d) in labels.iter().zip(row.iter()) {
            if let Some(g) = label {
                sums[*g] += d;
            }
        }
        let rest = sizes[own] - 1;
        if rest == 0 {
            return Some(0.0);
        }
        let inside = sums[own] / rest as f64;
        let outside = (0..sizes.len())
            .filter(|&g| g != own && sizes[g] > 0)
            .map(|g| sums[g] / sizes[g] as f64)
            .fold(f64::INFINITY, f64::min);
        Some(contrast(inside, outside))
    };
    (0..labels.len())
        .into_par_iter()
        .map_init(|| vec![0.0; labels.len()], one)
        .collect()
}

/// The mean silhouette over all items, those without a group counting as 0; -1 with fewer than two groups.
pub fn mean_silhouette(distances: &DistanceMatrix, labels: &[Option<usize>]) -> f64 {
    if cluster_sizes(labels).len() < 2 {
        return -1.0;
    }
    let all = silhouettes(distances, labels);
    all.iter().flatten().sum::<f64>() / labels.len() as f64
}

/// `(outside - inside) / max(outside, inside)`; 0 where both are 0 or `outside` is not finite.
pub fn contrast(inside: f64, outside: f64) -> f64 {
    let most = inside.max(outside);
    if most.is_finite() && most > 0.0 {
        (outside - inside) / most
    } else {
        0.0
    }
}
