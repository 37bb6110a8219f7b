//! k-means, as a baseline that is told the true number of classes.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Restarts; the one of the least inertia counts.
const RESTARTS: usize = 10;
/// Rounds of Lloyd's algorithm at most.
const ROUNDS: usize = 100;

/// Labels of `items` in `k` clusters: k-means++ seeding (Arthur and Vassilvitskii 2007), Lloyd's rounds, ten restarts.
pub fn kmeans(items: &[Vec<f64>], k: usize, seed: u64) -> Vec<usize> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut best: Option<(f64, Vec<usize>)> = None;
    for _ in 0..RESTARTS {
        let (inertia, labels) = once(items, k, &mut random);
        if best.as_ref().is_none_or(|(least, _)| inertia < *least) {
            best = Some((inertia, labels));
        }
    }
    best.map(|(_, labels)| labels).unwrap_or_default()
}

fn once(items: &[Vec<f64>], k: usize, random: &mut Pcg64) -> (f64, Vec<usize>) {
    let mut centres = vec![items[random.random_range(0..items.len())].clone()];
    let mut nearest: Vec<f64> = items.iter().map(|x| squared(x, &centres[0])).collect();
    while centres.len() < k {
        let total: f64 = nearest.iter().sum();
        let mut left = random.random::<f64>() * total;
        let chosen = nearest
            .iter()
            .position(|d| {
                left -= d;
                left <= 0.0
            })
            .unwrap_or(items.len() - 1);
        centres.push(items[chosen].clone());
        for (d, x) in nearest.iter_mut().zip(items) {
            *d = d.min(squared(x, &items[chosen]));
        }
    }
    let mut labels = vec![0; items.len()];
    for _ in 0..ROUNDS {
        let before = labels.clone();
        for (label, x) in labels.iter_mut().zip(items) {
            *label = closest(x, &centres).0;
        }
        if labels == before {
            break;
        }
        for (c, centre) in centres.iter_mut().enumerate() {
            let members: Vec<&Vec<f64>> = items
                .iter()
                .zip(&labels)
                .filter(|(_, l)| **l == c)
                .map(|(x, _)| x)
                .collect();
            if members.is_empty() {
                continue;
            }
            for (d, value) in centre.iter_mut().enumerate() {
                *value = members.iter().map(|m| m[d]).sum::<f64>() / members.len() as f64;
            }
        }
    }
    let inertia = items.iter().map(|x| closest(x, &centres).1).sum();
    (inertia, labels)
}

fn closest(x: &[f64], centres: &[Vec<f64>]) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (c, centre) in centres.iter().enumerate() {
        let d = squared(x, centre);
        if d < best.1 {
            best = (c, d);
        }
    }
    best
}

fn squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kineme::math::statistics::agreement;

    #[test]
    fn separate_blobs_are_found() {
        let items: Vec<Vec<f64>> = (0..30)
            .map(|i| vec![f64::from(i % 3) * 10.0 + f64::from(i) * 0.01, 1.0])
            .collect();
        let truth: Vec<usize> = (0..30).map(|i| i % 3).collect();
        assert_eq!(agreement(&kmeans(&items, 3, 0), &truth).ari, 1.0);
    }
}
