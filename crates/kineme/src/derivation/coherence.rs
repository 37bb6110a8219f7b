//! How well the segments of a group belong together.

use crate::clustering::{contrast, silhouettes};
use crate::math::distances::DistanceMatrix;

/// Mean silhouette of each group over the segments' warping distances, in [-1, 1]. `None` with one group only.
pub fn coherence(
    distances: &DistanceMatrix,
    labels: &[Option<usize>],
    groups: usize,
) -> Vec<Option<f64>> {
    let mut sums = vec![0.0; groups];
    let mut sizes = vec![0usize; groups];
    for (label, value) in labels.iter().zip(silhouettes(distances, labels)) {
        if let Some(g) = *label {
            sizes[g] += 1;
            sums[g] += value.unwrap_or(0.0);
        }
    }
    means(&sums, &sizes)
}

/// The same from sequences alone, for too many segments to compare all pairs: distances are Euclidean, to the mean
/// sequence of each group (simplified silhouette, Hruschka et al. 2004).
pub fn simplified_coherence(
    sequences: &[Vec<f64>],
    labels: &[Option<usize>],
    groups: usize,
) -> Vec<Option<f64>> {
    let length = sequences.first().map_or(0, Vec::len);
    let mut sizes = vec![0usize; groups];
    let mut means_of = vec![vec![0.0; length]; groups];
    for (sequence, label) in sequences.iter().zip(labels) {
        if let Some(g) = *label {
            sizes[g] += 1;
            means_of[g]
                .iter_mut()
                .zip(sequence)
                .for_each(|(m, v)| *m += v);
        }
    }
    for (mean, &size) in means_of.iter_mut().zip(&sizes) {
        mean.iter_mut().for_each(|m| *m /= size.max(1) as f64);
    }
    let distance = |a: &[f64], b: &[f64]| -> f64 {
        a.iter()
            .zip(b)
            .map(|(x, y)| (x - y).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let mut sums = vec![0.0; groups];
    for (sequence, label) in sequences.iter().zip(labels) {
        if let Some(own) = *label {
            let outside = (0..groups)
                .filter(|&g| g != own)
                .map(|g| distance(sequence, &means_of[g]))
                .fold(f64::INFINITY, f64::min);
            sums[own] += contrast(distance(sequence, &means_of[own]), outside);
        }
    }
    means(&sums, &sizes)
}

fn means(sums: &[f64], sizes: &[usize]) -> Vec<Option<f64>> {
    let single = sizes.len() < 2;
    sums.iter()
        .zip(sizes)
        .map(|(s, &n)| (!single && n > 0).then(|| s / n as f64))
        .collect()
}
