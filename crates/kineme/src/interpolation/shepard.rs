//! Inverse distance weighting (Shepard 1968).

use super::kernel::distance_squared;

/// Below this distance a query is the point itself.
pub(super) const COINCIDENT: f64 = 1e-12;

/// The squared distances to the `points` (`n` x `dims`) into `squared`, and which is nearest.
fn distances(points: &[f64], p: &[f64], squared: &mut [f64]) -> (usize, f64) {
    let mut nearest = (0, f64::INFINITY);
    for (i, (d, point)) in squared
        .iter_mut()
        .zip(points.chunks_exact(p.len()))
        .enumerate()
    {
        *d = distance_squared(p, point);
        if *d < nearest.1 {
            nearest = (i, *d);
        }
    }
    nearest
}

/// The weights of distinct `points` at `p` (at least one dimension); returns the nearest, and whether `p` is that point.
pub(super) fn weights(points: &[f64], power: f64, p: &[f64], weights: &mut [f64]) -> (usize, bool) {
    let (nearest, least) = distances(points, p, weights);
    if least < COINCIDENT * COINCIDENT {
        weights.fill(0.0);
        weights[nearest] = 1.0;
        return (nearest, true);
    }
    let mut sum = 0.0;
    for w in weights.iter_mut() {
        // Distances over the least one: no power overflows, and the nearest has 1.
        let ratio = least / *w;
        *w = if power == 2.0 {
            ratio
        } else {
            ratio.powf(0.5 * power)
        };
        sum += *w;
    }
    for w in weights.iter_mut() {
        *w /= sum;
    }
    (nearest, false)
}

/// The weights as in [`weights`], and their gradient (`n` x `dims`, row-major); zero at a point itself, which is the limit
/// for powers above 1.
pub(super) fn weights_and_gradient(
    points: &[f64],
    power: f64,
    p: &[f64],
    weights: &mut [f64],
    gradient: &mut [f64],
) {
    let (nearest, coincident) = self::weights(points, power, p, weights);
    gradient.fill(0.0);
    if coincident {
        return;
    }
    let dims = p.len();
    let row = |i: usize| &points[i * dims..(i + 1) * dims];
    let squared = |i: usize| distance_squared(p, row(i));
    // d ln d_i^-power / dp, less that of the nearest: near a point that one is huge and would cancel.
    let least = squared(nearest);
    for i in (0..weights.len()).filter(|&i| i != nearest) {
        let d = squared(i);
        for l in 0..dims {
            let near = (p[l] - row(nearest)[l]) / least;
            gradient[i * dims + l] = -power * ((p[l] - row(i)[l]) / d - near);
        }
    }
    for l in 0..dims {
        let mean: f64 = (0..weights.len())
            .filter(|&i| i != nearest)
            .map(|i| weights[i] * gradient[i * dims + l])
            .sum();
        for (i, w) in weights.iter().enumerate() {
            gradient[i * dims + l] = w * (gradient[i * dims + l] - mean);
        }
    }
}
