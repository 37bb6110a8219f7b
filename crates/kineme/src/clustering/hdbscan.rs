//! Density-based clustering on distances: HDBSCAN (Campello, Moulavi and Sander 2013), by the crate `hdbscan`.

use ::hdbscan::{DistanceMetric, Hdbscan, HdbscanHyperParams};

use crate::error::{Error, Result};
use crate::math::distances::DistanceMatrix;
use crate::math::partition::renumbered;

/// What counts as dense.
#[derive(Debug, Clone, PartialEq)]
pub struct Density {
    /// The smallest group, at least 2.
    pub min_cluster_size: usize,
    /// The density at an item is that of its nearest `min_samples` items, itself among them; at least 1. More make
    /// more noise.
    pub min_samples: usize,
}

impl Default for Density {
    fn default() -> Self {
        Self {
            min_cluster_size: 5,
            min_samples: 5,
        }
    }
}

/// The group of every item, numbered in the order of first appearance, or `None` for noise: the most persistent
/// clusters (excess of mass), never all items as one.
///
/// Infinite distances count as far beyond all finite ones. O(n^2 log n) steps; works on a copy in f32, 4 n^2 bytes.
///
/// # Errors
/// When a group may have fewer than two items or a density none.
pub fn hdbscan(distances: &DistanceMatrix, density: &Density) -> Result<Vec<Option<usize>>> {
    if density.min_cluster_size < 2 || density.min_samples == 0 {
        return Err(Error::invalid(format!(
            "a group has at least 2 items and a density at least 1 sample, found {} and {}",
            density.min_cluster_size, density.min_samples
        )));
    }
    let len = distances.len();
    if len < density.min_cluster_size {
        return Ok(vec![None; len]);
    }
    let rows = scaled_rows(distances);
    let parameters = HdbscanHyperParams::builder()
        .min_cluster_size(density.min_cluster_size)
        .min_samples(density.min_samples.min(len))
        .dist_metric(DistanceMetric::Precalculated)
        .build();
    let labels = Hdbscan::new(&rows, parameters)
        .cluster()
        .map_err(|e| Error::unsupported(format!("density clustering failed: {e}")))?;
    let labels: Vec<Option<usize>> = labels.iter().map(|&l| usize::try_from(l).ok()).collect();
    Ok(renumbered(&labels))
}

/// The full matrix, divided by its largest finite distance: f32 then holds any unit. Infinite ones, which the crate
/// refuses, become a thousand times the largest.
fn scaled_rows(distances: &DistanceMatrix) -> Vec<Vec<f32>> {
    let finite = distances.upper().iter().filter(|d| d.is_finite());
    let largest = finite.fold(0.0, |m: f64, d| m.max(*d));
    let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
    let len = distances.len();
    let mut row = vec![0.0; len];
    (0..len)
        .map(|i| {
            distances.row_into(i, &mut row);
            row.iter().map(|d| (d * scale).min(1e3) as f32).collect()
        })
        .collect()
}
