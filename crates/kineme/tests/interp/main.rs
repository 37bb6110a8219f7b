//! Interpolation weights: reference values, laws, degenerate points.

#[path = "../oracles/mod.rs"]
mod oracles;

mod degenerate;
mod hull;
mod laws;
mod reference;

use kineme::interpolation::{Interpolator, Kernel, Method, Tail};
use rand::RngExt;
use rand_pcg::Pcg64;

/// `n` x `dims` numbers in [0, 1).
fn uniform(seed: u64, n: usize, dims: usize) -> Vec<f64> {
    let mut rng = Pcg64::new(u128::from(seed), 0x5851_f42d);
    (0..n * dims).map(|_| rng.random()).collect()
}

/// `n` points in the unit cube that keep apart, so that tolerances speak of the method and not of its condition.
fn scattered(seed: u64, n: usize, dims: usize) -> Vec<f64> {
    let apart = 0.35 * (n as f64).powf(-1.0 / dims as f64);
    let mut points: Vec<f64> = Vec::new();
    for candidate in uniform(seed, 400 * n, dims).chunks(dims) {
        let far = |q: &[f64]| {
            let squared: f64 = q.iter().zip(candidate).map(|(a, b)| (a - b).powi(2)).sum();
            squared.sqrt() >= apart
        };
        if points.len() < n * dims && points.chunks(dims).all(far) {
            points.extend(candidate);
        }
    }
    assert_eq!(points.len(), n * dims, "candidates enough");
    points
}

fn cardinal(kernel: Kernel, tail: Tail, nugget: f64) -> Method {
    Method::Cardinal {
        kernel,
        tail,
        nugget,
    }
}

/// Wendland's kernel with its support.
fn wendland(support: f64) -> Kernel {
    Kernel::Wendland { support }
}

/// Methods of every kind that is solvable for points in general position.
fn methods() -> Vec<Method> {
    let mut all = vec![
        Method::Shepard { power: 2.0 },
        Method::Shepard { power: 3.5 },
    ];
    for tail in [Tail::None, Tail::LeastSquares, Tail::Augmented] {
        for nugget in [0.0, 0.1] {
            all.push(cardinal(wendland(0.8), tail, nugget));
        }
    }
    for kernel in [Kernel::Linear, Kernel::Cubic, Kernel::ThinPlate] {
        all.push(cardinal(kernel, Tail::Augmented, 0.0));
    }
    all
}

/// The weights at `p`.
fn weights(interpolator: &Interpolator, p: &[f64]) -> Vec<f64> {
    let mut w = vec![f64::NAN; interpolator.len()];
    interpolator.weights(p, &mut w);
    w
}

/// The values (n x columns) blended at `p`.
fn blend(interpolator: &Interpolator, p: &[f64], values: &[f64], columns: usize) -> Vec<f64> {
    let mut sum = vec![0.0; columns];
    for (w, row) in weights(interpolator, p).iter().zip(values.chunks(columns)) {
        for (s, v) in sum.iter_mut().zip(row) {
            *s += w * v;
        }
    }
    sum
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(x, y)| (x - y).abs())
        .fold(0.0, f64::max)
}
