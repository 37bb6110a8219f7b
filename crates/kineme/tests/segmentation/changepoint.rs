//! Change points against an exact dynamic program.

use kineme::segmentation::changepoint::{self, ChangePoint, Model};
use kineme::segmentation::score::boundaries;
use kineme::segmentation::{Signal, Span};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::{RATE, check_cover, noise, sampled};

/// Residual of a piece about its mean or line, the slow way; in units of the mean variance.
fn residual(values: &[f64], dims: usize, start: usize, end: usize, model: Model) -> f64 {
    let n = (end - start) as f64;
    (0..dims)
        .map(|d| {
            let y: Vec<f64> = (start..end).map(|t| values[t * dims + d]).collect();
            let mean = y.iter().sum::<f64>() / n;
            let middle = 0.5 * (n - 1.0);
            let slope = match model {
                Model::Mean => 0.0,
                Model::Trend => {
                    let x = |t: usize| t as f64 - middle;
                    let along: f64 = y.iter().enumerate().map(|(t, v)| x(t) * v).sum();
                    along / (0..y.len()).map(|t| x(t) * x(t)).sum::<f64>()
                }
            };
            y.iter()
                .enumerate()
                .map(|(t, v)| (v - mean - slope * (t as f64 - middle)).powi(2))
                .sum::<f64>()
        })
        .sum()
}

/// The cuts of least cost by trying every last segment for every end.
fn least_cuts(values: &[f64], dims: usize, min: usize, penalty: f64, model: Model) -> Vec<usize> {
    let frames = values.len() / dims;
    let variance = residual(values, dims, 0, frames, Model::Mean) / values.len() as f64;
    let beta = penalty * dims as f64 * (frames as f64).ln();
    let mut best = vec![(f64::INFINITY, 0); frames + 1];
    best[0].0 = 0.0;
    for end in min..=frames {
        for start in 0..=end - min {
            let cost = best[start].0 + residual(values, dims, start, end, model) / variance + beta;
            if cost < best[end].0 {
                best[end] = (cost, start);
            }
        }
    }
    let mut cuts = Vec::new();
    let mut end = frames;
    while end > 0 {
        end = best[end].1;
        cuts.push(end);
    }
    cuts.reverse();
    cuts.remove(0);
    cuts
}

/// A walk of slopes and levels that change with this probability a frame, with some noise.
pub fn wandering(frames: usize, dims: usize, changes: f64, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let (mut level, mut slope) = (vec![0.0; dims], vec![0.0; dims]);
    let mut values = Vec::new();
    for _ in 0..frames {
        if rng.random_bool(changes) {
            for (l, s) in level.iter_mut().zip(&mut slope) {
                *l += rng.random_range(-2.0..2.0);
                *s = rng.random_range(-0.3..0.3);
            }
        }
        for (l, s) in level.iter_mut().zip(&slope) {
            *l += s;
            values.push(*l + rng.random_range(-0.2..0.2));
        }
    }
    values
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn pelt_equals_the_exact_program_and_is_symmetric_in_time(
        frames in 4usize..90, dims in 1usize..4, min in 2usize..12, strong in 1u32..8,
        changes in 0.02..0.5, trend: bool, seed: u64,
    ) {
        let model = if trend { Model::Trend } else { Model::Mean };
        let penalty = 0.02 * f64::from(strong * strong);
        let config = ChangePoint {
            model,
            penalty,
            min_secs: min as f64,
            ..ChangePoint::default()
        };
        let values = wandering(frames, dims, changes, seed);
        let segment = |values: &[f64]| {
            changepoint::segment(&Signal::new(values, dims, 1.0).unwrap(), &config).unwrap()
        };
        let spans = segment(&values);
        check_cover(&spans, frames);
        let expected = if frames < min {
            vec![]
        } else {
            least_cuts(&values, dims, min, penalty, model)
        };
        prop_assert_eq!(boundaries(&spans, frames), expected);

        let reversed: Vec<f64> = values.chunks(dims).rev().flatten().copied().collect();
        let mirrored: Vec<Span> = segment(&reversed)
            .iter()
            .rev()
            .map(|s| Span::movement(frames - s.end, frames - s.start))
            .collect();
        prop_assert_eq!(mirrored, spans);
    }
}

#[test]
fn pelt_is_exact_where_the_least_length_delays_pruning() {
    // Short recordings of spikes: a start beaten by a cut that no segment may use yet is still needed.
    for seed in 0..3000 {
        let values: Vec<f64> = noise(24, seed).iter().map(|v| (3.0 * v).powi(3)).collect();
        let (min, penalty) = (3 + seed as usize % 4, 0.05 + 0.1 * (seed % 7) as f64);
        for model in [Model::Mean, Model::Trend] {
            let config = ChangePoint {
                model,
                penalty,
                min_secs: min as f64,
                ..ChangePoint::default()
            };
            let spans = changepoint::segment(&Signal::new(&values, 1, 1.0).unwrap(), &config);
            let expected = least_cuts(&values, 1, min, penalty, model);
            assert_eq!(
                boundaries(&spans.unwrap(), 24),
                expected,
                "seed {seed}, {model:?}"
            );
        }
    }
}

#[test]
fn change_points_find_corners_and_ignore_shift_scale_and_rotation() {
    // A zigzag: slopes change every 80 frames.
    let corner = |t: f64| (t % 160.0 - 80.0).abs() / 80.0;
    let jitter = noise(2 * 480, 3);
    let values: Vec<f64> = (0..480)
        .flat_map(|t| [corner(t as f64), 0.5 * corner(t as f64 + 40.0)])
        .zip(&jitter)
        .map(|(v, j)| v + 0.01 * j)
        .collect();
    let config = ChangePoint {
        penalty: 0.05,
        ..ChangePoint::default()
    };
    let cut = |values: &[f64]| {
        let spans = changepoint::segment(&Signal::new(values, 2, RATE).unwrap(), &config).unwrap();
        boundaries(&spans, 480)
    };
    let found = cut(&values);
    let expected: Vec<usize> = (1..12).map(|k| 40 * k).collect();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    assert!(
        found
            .iter()
            .zip(&expected)
            .all(|(f, e)| f.abs_diff(*e) <= 4),
        "{found:?}"
    );
    let (s, c) = 0.7_f64.sin_cos();
    let other: Vec<f64> = values
        .chunks(2)
        .flat_map(|v| {
            [
                40.0 * (c * v[0] - s * v[1]) + 9.0,
                40.0 * (s * v[0] + c * v[1]) - 5.0,
            ]
        })
        .collect();
    assert_eq!(cut(&other), found);
    let still = vec![2.5; 960];
    assert!(cut(&still).is_empty());
}

#[test]
fn change_points_stay_when_the_rate_changes() {
    let path = |t: f64| {
        let slow = (t * 1.3 % 2.0 - 1.0).abs();
        [
            slow,
            0.6 * (t * 0.7).sin() + f64::from((3.0..5.0).contains(&t)),
        ]
    };
    let mut all = Vec::new();
    for rate_hz in [24.0, 30.0, 60.0, 120.0] {
        let values = sampled(12.0, rate_hz, path);
        let signal = Signal::new(&values, 2, rate_hz).unwrap();
        let spans = changepoint::segment(&signal, &ChangePoint::default()).unwrap();
        let cuts = boundaries(&spans, signal.frames());
        all.push(
            cuts.iter()
                .map(|c| *c as f64 / rate_hz)
                .collect::<Vec<f64>>(),
        );
    }
    assert!(all[0].len() >= 5, "{all:?}");
    for cuts in &all {
        assert_eq!(cuts.len(), all[0].len(), "{all:?}");
        assert!(
            cuts.iter().zip(&all[0]).all(|(a, b)| (a - b).abs() < 0.1),
            "{all:?}"
        );
    }
}
