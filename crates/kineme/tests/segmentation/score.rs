//! Marks made by hand, and scores of boundaries.

use kineme::segmentation::score::{random_score, score};
use kineme::segmentation::{Span, clips, marks};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

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
