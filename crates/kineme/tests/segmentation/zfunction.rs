//! Activity and its thresholds.

use std::f64::consts::{PI, TAU};

use kineme::segmentation::zfunction::{self, Threshold, ZFunction};
use kineme::segmentation::{Signal, movements};

use crate::{RATE, check_cover, noise, sampled};

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
