//! How well the segments of a group belong together.

use crate::math::distances::DistanceMatrix;

/// Mean silhouette (Rousseeuw 1987) of each group over the segments' warping distances, in [-1, 1]:
/// `(b - a) / max(a, b)`, a the mean distance to the own group, b to the nearest other. `None` with one group only.
pub fn silhouettes(
    distances: &DistanceMatrix,
    labels: &[Option<usize>],
    groups: usize,
) -> Vec<Option<f64>> {
    let mut sizes = vec![0usize; groups];
    labels.iter().flatten().for_each(|&g| sizes[g] += 1);
    let mut sums = vec![0.0; groups];
    let mut row = vec![0.0; distances.len()];
    for (i, label) in labels.iter().enumerate() {
        let Some(own) = *label else { continue };
        distances.row_into(i, &mut row);
        let mut to = vec![0.0; groups];
        for (j, other) in labels.iter().enumerate() {
            if let Some(g) = other
                && i != j
            {
                to[*g] += row[j];
            }
        }
        let inside = to[own] / (sizes[own].max(2) - 1) as f64;
        let outside = (0..groups)
            .filter(|&g| g != own)
            .map(|g| to[g] / sizes[g].max(1) as f64)
            .fold(f64::INFINITY, f64::min);
        sums[own] += one(inside, outside);
    }
    means(&sums, &sizes)
}

/// The same from sequences alone, for too many segments to compare all pairs: distances are Euclidean, to the mean
/// sequence of each group (simplified silhouette, Hruschka et al. 2004).
pub fn simplified_silhouettes(
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
            sums[own] += one(distance(sequence, &means_of[own]), outside);
        }
    }
    means(&sums, &sizes)
}

fn one(inside: f64, outside: f64) -> f64 {
    if outside.is_finite() && inside.max(outside) > 0.0 {
        (outside - inside) / inside.max(outside)
    } else {
        0.0
    }
}

fn means(sums: &[f64], sizes: &[usize]) -> Vec<Option<f64>> {
    let single = sizes.len() < 2;
    sums.iter()
        .zip(sizes)
        .map(|(s, &n)| (!single && n > 0).then(|| s / n as f64))
        .collect()
}
