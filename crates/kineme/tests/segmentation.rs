//! Segmenters: analytic movements with known cuts, laws, and an exact dynamic program.

use std::f64::consts::{PI, TAU};

use kineme::segmentation::changepoint::{self, ChangePoint, Model};
use kineme::segmentation::pendulum::{self, Limb, Pendulum};
use kineme::segmentation::score::{boundaries, random_score, score};
use kineme::segmentation::zfunction::{self, Threshold, ZFunction};
use kineme::segmentation::{
    Segmenter, Signal, Span, SpanKind, Views, clips, duration, marks, movements,
};
use proptest::prelude::*;
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

fn swings(values: &[f64], dims: usize) -> Vec<Span> {
    pendulum::segment(&[limb(values, dims)], &Pendulum::default()).unwrap()
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

#[test]
fn pendulum_cuts_at_the_reversals_of_a_chain() {
    // Reversals at the extremes of the sine: a quarter period in, then every half.
    for (amplitude, period) in [(0.5, 1.0), (0.9, 0.8), (0.3, 0.65), (1.2, 1.7)] {
        let values = sampled(4.0 * period, RATE, |t| {
            chain(amplitude * (TAU * t / period).sin())
        });
        let expected: Vec<f64> = (0..8).map(|k| period * (0.25 + 0.5 * k as f64)).collect();
        let spans = swings(&values, 3);
        check_cover(&spans, values.len() / 3);
        check_cuts(&spans, values.len() / 3, &expected);
    }
}

#[test]
fn pendulum_finds_reversals_to_a_fraction_of_a_frame() {
    let period = 1.013;
    let values = sampled(3.0, RATE, |t| chain(0.6 * (TAU * t / period).sin()));
    let cuts = pendulum::cuts(&[limb(&values, 3)], &Pendulum::default()).unwrap();
    assert!(cuts.len() >= 5);
    for (k, cut) in cuts.iter().enumerate() {
        let expected = RATE * period * (0.25 + 0.5 * k as f64);
        assert!(
            (cut.time_frames - expected).abs() < 0.3,
            "{cut:?} for {expected}"
        );
        assert!(cut.frame.abs_diff(expected.round() as usize) <= 1);
        assert!(cut.swing > 0.1);
    }
}

/// Strokes of a second, each on in the same direction so that the distance from a start only grows, and holds.
fn held(hold_secs: f64) -> Vec<f64> {
    let cycle = 1.0 + hold_secs;
    sampled(4.0 * cycle, RATE, |t| {
        let (step, inside) = ((t / cycle).floor(), (t % cycle).min(1.0));
        let x = step + 0.5 * (1.0 - (PI * inside).cos());
        [0.8 * x, 0.1 * x, 0.0]
    })
}

#[test]
fn a_hold_is_a_rest_between_two_movements() {
    let values = held(1.0);
    let frames = values.len() / 3;
    let spans = swings(&values, 3);
    check_cover(&spans, frames);
    assert_eq!(movements(&spans).count(), 4, "{spans:?}");
    let rests: Vec<&Span> = spans.iter().filter(|s| s.kind == SpanKind::Rest).collect();
    for (k, rest) in rests.iter().filter(|r| r.start > 20).enumerate() {
        // The second half of each cycle of two seconds, and the slow ends of the strokes around it.
        let middle = (rest.start + rest.end) as f64 / 2.0 / RATE;
        let expected = 2.0 * k as f64 + 1.5;
        if rest.end < frames {
            assert!((middle - expected).abs() < 0.05, "{middle} for {expected}");
        }
        assert!(rest.len() as f64 / RATE >= 0.9);
    }
    assert!(movements(&spans).all(|s| (0.6..1.05).contains(&(s.len() as f64 / RATE))));
    // Without splitting at rests all four would be one.
    let no_rests = Pendulum {
        rest_speed: 0.0,
        ..Pendulum::default()
    };
    let one = pendulum::segment(&[limb(&values, 3)], &no_rests).unwrap();
    assert_eq!(one, [Span::movement(0, frames)]);
}

#[test]
fn a_short_pause_at_the_turn_is_cut_in_its_middle() {
    // 0.2 s at the extreme: too short for a rest.
    let values = sampled(1.2, RATE, |t| {
        let phase = if t < 0.5 { t } else { (t - 0.2).max(0.5) };
        chain(-0.6 * (TAU * phase).cos())
    });
    // The bob is slow for longer than it stands, so ask for a longer rest.
    let config = Pendulum {
        rest_secs: 0.6,
        ..Pendulum::default()
    };
    let spans = pendulum::segment(&[limb(&values, 3)], &config).unwrap();
    check_cuts(&spans, values.len() / 3, &[0.6]);
}

#[test]
fn what_stands_still_or_fidgets_is_one_rest() {
    let still = sampled(2.0, RATE, |_| [0.3, 0.1]);
    let fidget = sampled(2.0, RATE, |t| [0.04 * (TAU * 3.0 * t).sin(), 0.0]);
    for values in [still, fidget] {
        assert_eq!(swings(&values, 2), [Span::rest(0, values.len() / 2)]);
    }
    assert_eq!(swings(&[1.0, 2.0], 2), [Span::rest(0, 1)], "a single frame");
}

#[test]
fn a_circle_falls_into_halves() {
    let values = sampled(4.0, RATE, |t| [0.4 * (PI * t).cos(), 0.4 * (PI * t).sin()]);
    // Two seconds a turn; the last half has no successor to confirm its end.
    check_cuts(&swings(&values, 2), values.len() / 2, &[1.0, 2.0, 3.0]);
}

#[test]
fn pendulum_ignores_where_the_limb_is_how_it_is_turned_and_its_units() {
    let values = sampled(5.0, RATE, |t| {
        chain(0.7 * (TAU * t).sin() + 0.3 * (TAU * 0.37 * t).sin())
    });
    let expected = swings(&values, 3);
    assert!(expected.len() > 6);
    let turn = kineme::math::rotation::exp(&nalgebra::Vector3::new(0.3, -1.1, 0.7));
    let moved: Vec<f64> = values
        .chunks(3)
        .flat_map(|p| {
            let v = turn * nalgebra::Vector3::from_row_slice(p)
                + nalgebra::Vector3::new(9.0, -4.0, 2.0);
            [v.x, v.y, v.z]
        })
        .collect();
    assert_eq!(swings(&moved, 3), expected);
    let inches: Vec<f64> = values.iter().map(|v| v / 0.0254).collect();
    let long = Limb {
        bob: Signal::new(&inches, 3, RATE).unwrap(),
        length: 1.0 / 0.0254,
    };
    assert_eq!(
        pendulum::segment(&[long], &Pendulum::default()).unwrap(),
        expected
    );
}

#[test]
fn a_recoil_belongs_to_its_swing() {
    // A stroke of one limb length and back again by 0.08: too little for a swing of its own, or 0.3: enough.
    for (recoil, count) in [(0.08, 1), (0.3, 2)] {
        let values = sampled(1.3, RATE, |t| {
            let ease = |u: f64| 0.5 * (1.0 - (PI * u.clamp(0.0, 1.0)).cos());
            [ease(t) - recoil * ease((t - 1.0) / 0.3)]
        });
        let config = Pendulum {
            rest_secs: 1.0,
            ..Pendulum::default()
        };
        let spans = pendulum::segment(&[limb(&values, 1)], &config).unwrap();
        assert_eq!(movements(&spans).count(), count, "{recoil}: {spans:?}");
    }
}

#[test]
fn of_two_cuts_too_near_the_lesser_one_goes() {
    // Up by 1, down by 0.2 within a tenth of a second, up by 0.6, and down at leisure.
    let places = [(0.0, 0.0), (0.5, 1.0), (0.6, 0.8), (0.9, 1.4), (1.5, 0.0)];
    let values = sampled(1.5, RATE, |t| {
        let k = places.partition_point(|p| p.0 <= t).min(4);
        let ((t0, x0), (t1, x1)) = (places[k - 1], places[k]);
        [x0 + (x1 - x0) * 0.5 * (1.0 - (PI * (t - t0) / (t1 - t0)).cos())]
    });
    let config = Pendulum {
        rest_secs: 1.0,
        smooth_secs: 0.0,
        ..Pendulum::default()
    };
    let spans = |min_secs| {
        pendulum::segment(&[limb(&values, 1)], &Pendulum { min_secs, ..config }).unwrap()
    };
    check_cuts(&spans(0.05), values.len(), &[0.5, 0.6, 0.9]);
    check_cuts(&spans(0.15), values.len(), &[0.5, 0.9]);
}

#[test]
fn cuts_of_limbs_near_in_time_become_one() {
    let swing = |delay: f64| sampled(4.0, RATE, move |t| chain(0.6 * (TAU * (t - delay)).sin()));
    let first = swing(0.0);
    for (delay, merged) in [(0.05, true), (0.2, false)] {
        let second = swing(delay);
        let limbs = [limb(&first, 3), limb(&second, 3)];
        let cuts = pendulum::cuts(&limbs, &Pendulum::default()).unwrap();
        let spans = pendulum::segment(&limbs, &Pendulum::default()).unwrap();
        check_cover(&spans, first.len() / 3);
        assert_eq!(spans.len(), cuts.len() + 1);
        if merged {
            assert!((7..=9).contains(&cuts.len()), "{cuts:?}");
            let between = RATE * (0.25 + 0.5 * delay);
            assert!(
                (cuts[0].time_frames - between).abs() <= 1.5,
                "{:?}",
                cuts[0]
            );
        } else {
            assert!(cuts.len() >= 14, "{cuts:?}");
            assert!(cuts.iter().any(|c| c.limb == 0) && cuts.iter().any(|c| c.limb == 1));
        }
    }
}

#[test]
fn a_limb_at_rest_is_no_rest_while_another_moves() {
    let moving = sampled(4.0, RATE, |t| chain(0.6 * (TAU * t).sin()));
    let still = sampled(4.0, RATE, |_| chain(0.2));
    let config = Pendulum::default();
    let both = pendulum::segment(&[limb(&still, 3), limb(&moving, 3)], &config).unwrap();
    assert_eq!(both, swings(&moving, 3));
}

/// What is tested, an activity, and the movements in it.
type ActivityCase = (&'static str, Vec<f64>, Vec<(usize, usize)>);

fn activity_table() -> Vec<ActivityCase> {
    let build = |parts: &[(f64, usize)]| -> Vec<f64> {
        let values = parts.iter().flat_map(|&(v, n)| std::iter::repeat_n(v, n));
        values.collect()
    };
    // At 100 Hz: on 1, off 0.5, hold 5 frames, least 20 frames, longest 100 frames.
    vec![
        ("nothing moves", build(&[(0.0, 50)]), vec![]),
        (
            "below on is no movement",
            build(&[(0.0, 30), (0.9, 40), (0.0, 30)]),
            vec![],
        ),
        (
            "starts at the last low frame, ends at the first",
            build(&[(0.0, 30), (0.7, 5), (2.0, 30), (0.7, 5), (0.1, 30)]),
            vec![(29, 70)],
        ),
        (
            "a dip shorter than the hold does not end it",
            build(&[(0.0, 30), (2.0, 20), (0.1, 4), (2.0, 20), (0.1, 30)]),
            vec![(29, 74)],
        ),
        (
            "a dip as long as the hold ends it",
            build(&[(0.0, 30), (2.0, 25), (0.1, 5), (2.0, 25), (0.1, 30)]),
            vec![(29, 55), (59, 85)],
        ),
        (
            "above off it goes on",
            build(&[(0.0, 30), (2.0, 20), (0.6, 30), (2.0, 20), (0.1, 30)]),
            vec![(29, 100)],
        ),
        (
            "what is too short is rest",
            build(&[(0.0, 30), (2.0, 18), (0.1, 10), (2.0, 19), (0.1, 30)]),
            vec![(57, 77)],
        ),
        (
            "moving from the first frame to the last",
            build(&[(2.0, 60)]),
            vec![(0, 60)],
        ),
        (
            "what is too long is cut where a raised threshold cuts it",
            build(&[(0.0, 30), (2.0, 60), (0.6, 10), (2.0, 60), (0.1, 30)]),
            vec![(29, 90), (99, 160)],
        ),
        (
            "what is too long and cannot be cut stays",
            build(&[(0.0, 30), (9.0, 150), (0.1, 30)]),
            vec![(29, 180)],
        ),
    ]
}

#[test]
fn activity_is_cut_with_hysteresis() {
    let config = ZFunction {
        threshold: Threshold::Fixed(1.0),
        off_share: 0.5,
        max_secs: 1.0,
        ..ZFunction::default()
    };
    for (what, z, expected) in activity_table() {
        let spans = zfunction::segment_activity(&z, 100.0, &config).unwrap();
        check_cover(&spans, z.len());
        let found: Vec<(usize, usize)> = movements(&spans).map(|s| (s.start, s.end)).collect();
        assert_eq!(found, expected, "{what}");
    }
}

#[test]
fn a_movement_must_reach_its_peak() {
    let z: Vec<f64> = [0.0, 2.0, 0.0, 4.0, 0.0]
        .iter()
        .flat_map(|v| [*v; 40])
        .collect();
    for (peak_share, count) in [(1.0, 2), (2.0, 2), (3.0, 1), (5.0, 0)] {
        let config = ZFunction {
            threshold: Threshold::Fixed(1.0),
            peak_share,
            ..ZFunction::default()
        };
        let spans = zfunction::segment_activity(&z, 100.0, &config).unwrap();
        assert_eq!(movements(&spans).count(), count, "{peak_share}");
    }
}

#[test]
fn activity_is_the_weighted_sum_of_squared_rates() {
    // Straight lines of known slope: the derivative is exact, at the ends too.
    let values = sampled(1.0, RATE, |t| [1.0 + 2.0 * t, -3.0 * t]);
    let signal = Signal::new(&values, 2, RATE).unwrap();
    for (weights, expected) in [(vec![], 13.0), (vec![1.0, 0.5], 8.5), (vec![0.0, 0.0], 0.0)] {
        for z in zfunction::activity(&signal, &weights, 0.075).unwrap() {
            assert!((z - expected).abs() < 1e-9, "{z} for {expected}");
        }
    }
    // A sine: mean of the squared rate, less what smoothing takes.
    let values = sampled(4.0, RATE, |t| [0.5 * (TAU * t).sin()]);
    let z = zfunction::activity(&Signal::new(&values, 1, RATE).unwrap(), &[], 0.05).unwrap();
    let mean = z.iter().sum::<f64>() / z.len() as f64;
    assert!((mean / (0.5 * PI * PI) - 1.0).abs() < 0.02, "{mean}");
}

#[test]
fn activity_grows_with_the_square_of_the_speed() {
    let values = noise(3 * 200, 1);
    let slow = zfunction::activity(&Signal::new(&values, 3, 60.0).unwrap(), &[], 0.08).unwrap();
    for a in [0.5, 2.0, 3.7] {
        let signal = Signal::new(&values, 3, 60.0 * a).unwrap();
        let fast = zfunction::activity(&signal, &[], 0.08 / a).unwrap();
        for (f, s) in fast.iter().zip(&slow) {
            assert!(
                (f - a * a * s).abs() <= 1e-9 * a * a * s.abs(),
                "{f} for {a}^2 {s}"
            );
        }
    }
}

#[test]
fn thresholds_follow_the_recording() {
    // Rest at 1e-4, movement at 4, half of each: the split lies between, relative thresholds scale with z.
    let z: Vec<f64> = (0..400)
        .map(|t| if t % 100 < 50 { 1e-4 } else { 4.0 } * (1.0 + 0.1 * (t as f64).sin()))
        .collect();
    let split = zfunction::on_threshold(&z, Threshold::Otsu(1.0));
    assert!((1.2e-4..3.5).contains(&split), "{split}");
    let scaled: Vec<f64> = z.iter().map(|v| 7.0 * v).collect();
    for threshold in [Threshold::Otsu(1.0), Threshold::Share(0.15)] {
        let (a, b) = (
            zfunction::on_threshold(&z, threshold),
            zfunction::on_threshold(&scaled, threshold),
        );
        assert!((b / a - 7.0).abs() < 1e-9, "{threshold:?}");
        let config = ZFunction {
            threshold,
            ..ZFunction::default()
        };
        let spans = zfunction::segment_activity(&z, 100.0, &config).unwrap();
        assert_eq!(movements(&spans).count(), 4, "{threshold:?}");
    }
    // A recording that rests most of the time still has movements.
    let rare: Vec<f64> = (0..1000)
        .map(|t| f64::from((400..440).contains(&t)))
        .collect();
    let spans = zfunction::segment_activity(&rare, 100.0, &ZFunction::default()).unwrap();
    assert_eq!(movements(&spans).count(), 1);
}

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
fn wandering(frames: usize, dims: usize, changes: f64, seed: u64) -> Vec<f64> {
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

    #[test]
    fn matching_is_the_largest_there_is(seed: u64, tolerance in 0usize..6) {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut draw = || {
            let mut v: Vec<usize> = (0..rng.random_range(0..6)).map(|_| rng.random_range(1..25)).collect();
            v.sort_unstable();
            v.dedup();
            v
        };
        let (found, reference) = (draw(), draw());
        fn most(found: &[usize], free: &[usize], tolerance: usize) -> usize {
            let Some((first, others)) = found.split_first() else {
                return 0;
            };
            let mut best = most(others, free, tolerance);
            for k in 0..free.len() {
                if free[k].abs_diff(*first) <= tolerance {
                    let mut left = free.to_vec();
                    left.remove(k);
                    best = best.max(1 + most(others, &left, tolerance));
                }
            }
            best
        }
        let pairs = most(&found, &reference, tolerance) as f64;
        let got = score(&found, &reference, tolerance);
        if !found.is_empty() {
            prop_assert!((got.precision - pairs / found.len() as f64).abs() < 1e-12);
        }
        if !reference.is_empty() {
            prop_assert!((got.recall - pairs / reference.len() as f64).abs() < 1e-12);
        }
        prop_assert!(got.f1 >= 0.0 && got.f1 <= 1.0);
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

#[test]
fn a_wanted_duration_is_reached() {
    // Strokes of half a second with a smaller, faster beat upon them.
    let values = sampled(16.0, RATE, |t| {
        chain(0.7 * (TAU * t).sin() + 0.25 * (TAU * 2.9 * t).sin())
    });
    let bob = [limb(&values, 3)];
    let short = duration::pendulum(&bob, &Pendulum::default(), 0.2).unwrap();
    let long = duration::pendulum(&bob, &Pendulum::default(), 0.5).unwrap();
    assert!(
        (short.median_secs.unwrap() / 0.2).ln().abs() < 0.3,
        "{:?}",
        short.median_secs
    );
    assert!(
        (long.median_secs.unwrap() / 0.5).ln().abs() < 0.1,
        "{:?}",
        long.median_secs
    );
    assert!(long.scale > short.scale);

    let features = wandering(2000, 3, 0.08, 5);
    let features = Signal::new(&features, 3, 100.0).unwrap();
    for target in [0.25, 0.5, 1.0, 2.0] {
        let got = duration::changepoint(&features, &ChangePoint::default(), target).unwrap();
        check_cover(&got.spans, 2000);
        let reached = got.median_secs.unwrap();
        assert!(
            (reached / target).ln().abs() < 0.3,
            "{reached} for {target}"
        );
    }

    // Bumps of activity of one second whose width depends on the threshold.
    let angles = sampled(20.0, RATE, |t| [t + 0.9 * (TAU * t).sin() / TAU]);
    let angles = Signal::new(&angles, 1, RATE).unwrap();
    for target in [0.45, 0.6] {
        let got = duration::zfunction(&angles, &[], &ZFunction::default(), target).unwrap();
        let reached = got.median_secs.unwrap();
        assert!(
            (reached / target).ln().abs() < 0.15,
            "{reached} for {target}"
        );
    }
    // What cannot be reached is told.
    let still = vec![0.0; 300];
    let still = Signal::new(&still, 1, RATE).unwrap();
    let none = duration::zfunction(&still, &[], &ZFunction::default(), 0.5).unwrap();
    assert_eq!(none.median_secs, None);
    assert_eq!(none.spans, [Span::rest(0, 300)]);
}

#[test]
fn marks_become_frames_or_are_refused() {
    let got = marks(
        &[(1.0, 1.5), (-0.2, 0.5), (0.5, 1.0), (1.9, 7.0)],
        200,
        100.0,
    )
    .unwrap();
    let expected = [(0, 50), (50, 100), (100, 150), (190, 200)];
    assert_eq!(got, expected.map(|(s, e)| Span::movement(s, e)));
    for (what, bad, rate_hz) in [
        ("backwards", vec![(1.0, 0.5)], 100.0),
        ("overlap", vec![(0.0, 1.0), (0.9, 1.5)], 100.0),
        ("the same twice", vec![(0.0, 1.0), (0.0, 1.0)], 100.0),
        ("outside", vec![(3.0, 4.0)], 100.0),
        ("before", vec![(-2.0, -1.0)], 100.0),
        ("shorter than a frame", vec![(0.101, 0.102)], 100.0),
        ("no number", vec![(f64::NAN, 1.0)], 100.0),
        ("no rate", vec![(0.0, 1.0)], 0.0),
    ] {
        assert!(marks(&bad, 200, rate_hz).is_err(), "{what}");
    }
    assert_eq!(clips(9), [Span::movement(0, 9)]);
    assert!(clips(0).is_empty());
}

#[test]
fn chance_is_scored_as_chance() {
    let reference: Vec<usize> = (1..10).map(|k| 100 * k).collect();
    assert_eq!(score(&reference, &reference, 0).f1, 1.0);
    assert_eq!(score(&[], &[], 3).f1, 1.0);
    assert_eq!(score(&[], &reference, 3).f1, 0.0);
    // Two found boundaries may not share one reference.
    assert_eq!(score(&[99, 101], &[100], 2).precision, 0.5);
    // Few cuts, far apart: the chance of a hit is the share of frames within the tolerance.
    let random = random_score(9, &reference, 1000, 10, 400, 7);
    let share = 9.0 * 21.0 / 999.0;
    assert!(
        (random.precision - share).abs() < 0.03,
        "{random:?} for {share}"
    );
    assert_eq!(random, random_score(9, &reference, 1000, 10, 400, 7));
    assert_ne!(random, random_score(9, &reference, 1000, 10, 400, 8));
    // As many cuts as frames hit everything.
    assert_eq!(random_score(999, &reference, 1000, 0, 1, 0).recall, 1.0);
}

#[test]
fn a_segmenter_takes_the_view_that_it_needs() {
    let values = sampled(4.0, RATE, |t| chain(0.6 * (TAU * t).sin()));
    let frames = values.len() / 3;
    let limbs = [limb(&values, 3)];
    let signal = limbs[0].bob;
    let views = Views {
        limbs: &limbs,
        angles: Some(signal),
        features: Some(signal),
        ..Views::new(frames, RATE)
    };
    for name in ["pendulum", "zfunction", "changepoint", "clips"] {
        let segmenter = Segmenter::named(name).unwrap();
        assert_eq!(segmenter.name(), name);
        let got = segmenter.segment(&views, None).unwrap();
        check_cover(&got.spans, frames);
        assert_eq!(got.scale, 1.0);
        let empty = segmenter.segment(&Views::new(frames, RATE), None);
        assert_eq!(empty.is_err(), name != "clips");
        let other = Views {
            frames: frames + 1,
            ..views
        };
        assert_eq!(segmenter.segment(&other, None).is_err(), name != "clips");
        if name != "clips" {
            assert!(segmenter.segment(&views, Some(0.0)).is_err(), "{name}");
            assert!(
                segmenter
                    .segment(&views, Some(0.4))
                    .unwrap()
                    .median_secs
                    .is_some()
            );
        }
    }
    assert_eq!(Segmenter::default().name(), "pendulum");
    assert!(Segmenter::named("pendulums").unwrap_err().is_unknown_name());
}

#[test]
fn settings_out_of_range_are_refused() {
    let values = noise(60, 2);
    let signal = Signal::new(&values, 2, RATE).unwrap();
    let limb = Limb {
        bob: signal,
        length: 1.0,
    };
    let p = Pendulum::default();
    let bad_length = Limb {
        length: 0.0,
        ..limb
    };
    assert!(pendulum::segment(&[], &p).is_err());
    assert!(pendulum::segment(&[bad_length], &p).is_err());
    for bad in [
        Pendulum {
            min_swing: 0.0,
            ..p
        },
        Pendulum { fall: -1.0, ..p },
        Pendulum {
            fall_share: 1.0,
            ..p
        },
        Pendulum {
            min_secs: f64::NAN,
            ..p
        },
        Pendulum {
            rest_secs: -1.0,
            ..p
        },
    ] {
        assert!(pendulum::segment(&[limb], &bad).is_err(), "{bad:?}");
    }
    // Durations beyond all measure are odd but no error: nothing is that long.
    let endless = Pendulum {
        min_secs: 1e300,
        rest_secs: 1e300,
        merge_secs: 1e300,
        smooth_secs: 1e300,
        ..p
    };
    assert_eq!(
        pendulum::segment(&[limb], &endless).unwrap(),
        [Span::rest(0, 30)]
    );
    let endless = ChangePoint {
        min_secs: 1e300,
        ..ChangePoint::default()
    };
    assert_eq!(
        changepoint::segment(&signal, &endless).unwrap(),
        [Span::movement(0, 30)]
    );
    let z = ZFunction::default();
    for bad in [
        ZFunction {
            threshold: Threshold::Share(0.0),
            ..z
        },
        ZFunction {
            off_share: 1.5,
            ..z
        },
        ZFunction { max_secs: 0.1, ..z },
        ZFunction {
            smooth_secs: -0.1,
            ..z
        },
    ] {
        assert!(zfunction::segment(&signal, &[], &bad).is_err(), "{bad:?}");
    }
    assert!(zfunction::segment(&signal, &[1.0], &z).is_err());
    assert!(zfunction::segment(&signal, &[1.0, -1.0], &z).is_err());
    let c = ChangePoint {
        penalty: 0.0,
        ..ChangePoint::default()
    };
    assert!(changepoint::segment(&signal, &c).is_err());
    for (values, dims, rate_hz) in [
        (vec![], 1, 1.0),
        (vec![1.0], 0, 1.0),
        (vec![1.0; 3], 2, 1.0),
        (vec![1.0], 1, 0.0),
        (vec![f64::INFINITY], 1, 1.0),
    ] {
        assert!(Signal::new(&values, dims, rate_hz).is_err());
    }
}
