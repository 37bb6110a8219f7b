//! Density-based clustering on distances: HDBSCAN (Campello, Moulavi and Sander 2013), by the crate `hdbscan`.

use ::hdbscan::{DistanceMetric, Hdbscan, HdbscanHyperParams};
use rayon::prelude::*;

use super::silhouette::mean_silhouette;
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
    /// Larger groups are not chosen but parted; `None` for no limit.
    pub max_cluster_size: Option<usize>,
}

impl Default for Density {
    fn default() -> Self {
        Self {
            min_cluster_size: 5,
            min_samples: 5,
            max_cluster_size: None,
        }
    }
}

impl Density {
    /// Groups of at least `size`, which is also the neighbourhood of the density.
    pub fn of_size(size: usize) -> Self {
        Self {
            min_cluster_size: size,
            min_samples: size,
            ..Self::default()
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
    check(density)?;
    let len = distances.len();
    if len < density.min_cluster_size {
        return Ok(vec![None; len]);
    }
    let rows = scaled_rows(distances);
    cluster(&rows, density)
}

/// Limits of the group size that [`hdbscan_judged`] tries, as shares of the items; the first is no limit.
const LIMITS: [usize; 5] = [1, 2, 4, 8, 16];

/// [`hdbscan()`] with the limit of the group size that parts the items best: excess of mass alone sometimes prefers one
/// group of nearly everything. Tried are no limit, a half, a quarter, an eighth and a sixteenth of the items; the
/// highest mean silhouette over `distances` wins (noise counts as 0), the larger limit on a tie.
///
/// # Errors
/// As [`hdbscan()`].
pub fn hdbscan_judged(distances: &DistanceMatrix, density: &Density) -> Result<Vec<Option<usize>>> {
    check(density)?;
    let len = distances.len();
    if len < density.min_cluster_size {
        return Ok(vec![None; len]);
    }
    let rows = scaled_rows(distances);
    let tried: Vec<(f64, Vec<Option<usize>>)> = LIMITS
        .par_iter()
        .filter(|&&part| part == 1 || len / part >= 2 * density.min_cluster_size)
        .map(|&part| {
            let limited = Density {
                max_cluster_size: (part > 1).then_some(len / part),
                ..density.clone()
            };
            let labels = cluster(&rows, &limited)?;
            Ok((mean_silhouette(distances, &labels), labels))
        })
        .collect::<Result<_>>()?;
    let mut best: Option<(f64, Vec<Option<usize>>)> = None;
    for (quality, labels) in tried {
        if best
            .as_ref()
            .is_none_or(|(most, _)| quality > *most + 1e-12)
        {
            best = Some((quality, labels));
        }
    }
    Ok(best.map(|(_, labels)| labels).unwrap_or_default())
}

fn check(density: &Density) -> Result<()> {
    if density.min_cluster_size < 2 || density.min_samples == 0 {
        return Err(Error::invalid(format!(
            "a group has at least 2 items and a density at least 1 sample, found {} and {}",
            density.min_cluster_size, density.min_samples
        )));
    }
    Ok(())
}

fn cluster(rows: &[Vec<f32>], density: &Density) -> Result<Vec<Option<usize>>> {
    let parameters = HdbscanHyperParams::builder()
        .min_cluster_size(density.min_cluster_size)
        .min_samples(density.min_samples.min(rows.len()))
        .max_cluster_size(density.max_cluster_size.map_or(usize::MAX, |m| m.max(2)))
        .dist_metric(DistanceMetric::Precalculated)
        .build();
    let labels = Hdbscan::new(rows, parameters)
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
