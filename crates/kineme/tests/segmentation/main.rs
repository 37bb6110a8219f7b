//! Segmenters: analytic movements with known cuts, laws, and an exact dynamic program.

mod changepoint;
mod choice;
mod pendulum;
mod score;
mod zfunction;

use kineme::segmentation::pendulum::Limb;
use kineme::segmentation::score::boundaries;
use kineme::segmentation::{Signal, Span};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const RATE: f64 = 120.0;

/// Samples a path of the time in seconds.
fn sampled<const D: usize>(secs: f64, rate_hz: f64, path: impl Fn(f64) -> [f64; D]) -> Vec<f64> {
    let frames = (secs * rate_hz).round() as usize;
    (0..frames).flat_map(|t| path(t as f64 / rate_hz)).collect()
}

/// The centroid of a chain of two links of half a metre, hanging from the origin, at this angle.
fn chain(angle: f64) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    let (s2, c2) = (1.3 * angle).sin_cos();
    // Joints: root, elbow, tip.
    let elbow = [0.5 * s, 0.0, -0.5 * c];
    let tip = [elbow[0] + 0.5 * s2, 0.0, elbow[2] - 0.5 * c2];
    [0, 1, 2].map(|k| (elbow[k] + tip[k]) / 3.0)
}

fn limb(values: &[f64], dims: usize) -> Limb<'_> {
    Limb {
        bob: Signal::new(values, dims, RATE).unwrap(),
        length: 1.0,
    }
}

fn noise(count: usize, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| rng.random_range(-1.0..1.0)).collect()
}

/// Spans are in order, without overlap or gap, and cover all frames.
fn check_cover(spans: &[Span], frames: usize) {
    let mut last = 0;
    for span in spans {
        assert_eq!(span.start, last, "{spans:?}");
        assert!(span.end > span.start);
        last = span.end;
    }
    assert_eq!(last, frames);
}

/// The cuts lie at these times in seconds, to a frame.
fn check_cuts(spans: &[Span], frames: usize, expected_secs: &[f64]) {
    let found = boundaries(spans, frames);
    let expected: Vec<f64> = expected_secs.iter().map(|s| s * RATE).collect();
    assert_eq!(found.len(), expected.len(), "{found:?} for {expected:?}");
    for (f, e) in found.iter().zip(&expected) {
        assert!((*f as f64 - e).abs() <= 1.0, "{found:?} for {expected:?}");
    }
}
