//! Registration of exemplars to phase: laws of warps, known warps recovered, rests at the ends.

use kineme::alignment::{
    Band, LocalCost, Registration, Trim, Warp, align, align_sloped, resample, resting_ends,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

mod items;
use items::{check, cloud};

const SQUARED: LocalCost = LocalCost::SquaredEuclidean;

/// A smooth movement of `dims` numbers, at a place in [0, 1] of its own time.
fn movement(place: f64, dims: usize) -> Vec<f64> {
    (0..dims)
        .map(|d| {
            let d = d as f64;
            (3.0 * place + 0.7 * d).sin() + 0.4 * (7.0 * place + 1.3 * d).cos()
        })
        .collect()
}

/// The movement with its time bent: even for 0, strictly rising for bends below 1 in size.
fn bent(bend: f64, frames: usize, dims: usize) -> Vec<f64> {
    (0..frames)
        .flat_map(|f| movement(bend_of(f as f64 / (frames - 1) as f64, bend), dims))
        .collect()
}

fn bend_of(place: f64, bend: f64) -> f64 {
    place + bend * (std::f64::consts::TAU * place).sin() / std::f64::consts::TAU
}

/// A smooth random warp with the least slope well above 0.
fn random_warp(knots: usize, seed: u64) -> Warp {
    let mut random = Pcg64::seed_from_u64(seed);
    let steps: Vec<f64> = (1..knots).map(|_| random.random_range(0.2..2.0)).collect();
    let sum: f64 = steps.iter().sum();
    let mut places = vec![0.0];
    for step in &steps[..knots - 2] {
        places.push(places[places.len() - 1] + step / sum);
    }
    places.push(1.0);
    Warp::new(places).expect("rising places")
}

/// The cheapest path of limited slope by trying all: `run` counts single steps in a row, its sign says of which.
fn exhaustive(a: &[f64], b: &[f64], i: usize, j: usize, run: i64, limit: i64) -> f64 {
    let here = (a[i] - b[j]).powi(2);
    if (i, j) == (a.len() - 1, b.len() - 1) {
        return here;
    }
    let mut best = f64::INFINITY;
    let (down, right) = (i + 1 < a.len(), j + 1 < b.len());
    if down && right {
        best = exhaustive(a, b, i + 1, j + 1, 0, limit);
    }
    if down && (0..limit).contains(&run) {
        best = best.min(exhaustive(a, b, i + 1, j, run + 1, limit));
    }
    if right && (0..limit).contains(&-run) {
        best = best.min(exhaustive(a, b, i, j + 1, run - 1, limit));
    }
    here + best
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn sloped_paths_equal_exhaustive_search(n in 1usize..=6, m in 1usize..=6, run in 0i64..=3, seed: u64) {
        let (a, b) = (cloud(n, 1, seed), cloud(m, 1, !seed));
        let slope = run as f64 + 1.0;
        let expected = exhaustive(&a, &b, 0, 0, 0, run).sqrt();
        match align_sloped(&a, &b, 1, Band::Full, SQUARED, slope) {
            Ok(found) => prop_assert!((found.distance - expected).abs() < 1e-12),
            Err(error) => prop_assert!(error.is_invalid() && expected.is_infinite()),
        }
    }

    #[test]
    fn sloped_paths_keep_their_slope_add_up_and_cost_no_less(
        n in 8usize..30, more in 0usize..6, run in 1usize..4, seed: u64,
    ) {
        let m = n + more;
        let (a, b) = (cloud(n, 2, seed), cloud(m, 2, !seed));
        let slope = run as f64 + 1.0;
        let found = align_sloped(&a, &b, 2, Band::Slanted(6), SQUARED, slope).unwrap();
        let mut single = (0, 0);
        for w in found.path.windows(2) {
            single = match (w[1].0 - w[0].0, w[1].1 - w[0].1) {
                (1, 1) => (0, 0),
                (1, 0) => (single.0 + 1, single.1),
                (0, 1) => (single.0, single.1 + 1),
                other => panic!("a step of {other:?}"),
            };
            prop_assert!(single.0 <= run && single.1 <= run && single.0 * single.1 == 0);
        }
        let sum: f64 = found.path.iter().map(|&(i, j)| {
            (a[2 * i] - b[2 * j]).powi(2) + (a[2 * i + 1] - b[2 * j + 1]).powi(2)
        }).sum();
        prop_assert!((sum.sqrt() - found.distance).abs() < 1e-9);
        let plain = align(&a, &b, 2, Band::Slanted(6), SQUARED).unwrap();
        prop_assert!(plain.distance <= found.distance);
        let turned = align_sloped(&b, &a, 2, Band::Slanted(6), SQUARED, slope).unwrap();
        prop_assert!((turned.distance - found.distance).abs() < 1e-9);
    }

    #[test]
    fn warps_rise_and_are_inverted(knots in 2usize..40, seed: u64, phase in 0.0..1.0f64) {
        let warp = random_warp(knots, seed);
        let place = warp.place(phase);
        prop_assert!((0.0..=1.0).contains(&place));
        prop_assert!(warp.slope(phase) > 0.0);
        prop_assert!((warp.phase(place) - phase).abs() < 1e-9);
        prop_assert!(warp.place(phase + 1e-3) > place || phase + 1e-3 > 1.0);
        // The slope is the derivative, from both sides of a knot.
        let knot = ((phase * (knots - 1) as f64).round() / (knots - 1) as f64).clamp(1e-6, 1.0 - 1e-6);
        for at in [phase.clamp(1e-6, 1.0 - 1e-6), knot] {
            let slope = (warp.place(at + 1e-7) - warp.place(at - 1e-7)) / 2e-7;
            prop_assert!((slope - warp.slope(at)).abs() < 1e-3, "{} and {}", slope, warp.slope(at));
        }
        let floor = warp.places().windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
        prop_assert!(warp.slope(phase) >= 0.5 * floor * (knots - 1) as f64 - 1e-9);
    }

    #[test]
    fn registration_gives_rising_warps_with_the_identity_as_mean(count in 1usize..6, seed: u64) {
        let mut random = Pcg64::seed_from_u64(seed);
        let sequences: Vec<Vec<f64>> = (0..count)
            .map(|_| bent(random.random_range(-0.5..0.5), random.random_range(20..60), 3))
            .collect();
        let views: Vec<&[f64]> = sequences.iter().map(Vec::as_slice).collect();
        let found = Registration::default().register(&views, 3).unwrap();
        for k in 0..64 {
            let mean = found.warps.iter().map(|w| w.places()[k]).sum::<f64>() / count as f64;
            prop_assert!((mean - k as f64 / 63.0).abs() < 1e-12);
        }
        for warp in &found.warps {
            prop_assert!(warp.places().windows(2).all(|w| (w[1] - w[0]) * 63.0 >= 0.2 - 1e-12));
            prop_assert_eq!((warp.places()[0], warp.places()[63]), (0.0, 1.0));
        }
    }
}

#[test]
fn a_plateau_swallows_no_more_than_the_slope_allows() {
    // One sequence waits in the middle, the other does not.
    let ramp = |t: f64| t.clamp(0.0, 1.0);
    let a: Vec<f64> = (0..40).map(|t| ramp(f64::from(t) / 39.0)).collect();
    let b: Vec<f64> = (0..40)
        .map(|t| ramp(f64::from(t) / 12.0) * 0.5 + ramp((f64::from(t) - 27.0) / 12.0) * 0.5)
        .collect();
    let longest = |path: &[(usize, usize)]| {
        (0..40)
            .map(|i| path.iter().filter(|p| p.0 == i).count())
            .max()
    };
    let plain = align(&a, &b, 1, Band::Full, SQUARED).unwrap();
    let sloped = align_sloped(&a, &b, 1, Band::Full, SQUARED, 3.0).unwrap();
    assert!(longest(&plain.path) > Some(10));
    assert_eq!(longest(&sloped.path), Some(3));
}

#[test]
fn equal_sequences_are_registered_by_the_identity() {
    let same = bent(0.3, 50, 4);
    let found = Registration::default()
        .register(&[&same, &same, &same], 4)
        .unwrap();
    for warp in &found.warps {
        for (k, place) in warp.places().iter().enumerate() {
            check("place", *place, k as f64 / 63.0, 1e-12);
        }
    }
    assert!(found.costs.iter().all(|c| *c < 1e-12), "{:?}", found.costs);
    assert_eq!(found.rounds, 0);
    // So is what does not move at all.
    let still = vec![2.0; 30];
    let found = Registration::default()
        .register(&[&still, &still[..12]], 3)
        .unwrap();
    check("still", found.warps[1].place(0.3), 0.3, 1e-12);
    assert_eq!(found.costs, [0.0, 0.0]);
}

#[test]
fn a_known_warp_is_recovered() {
    let settings = Registration::default();
    for bend in [-0.6, -0.3, 0.2, 0.5] {
        let reference = bent(0.0, settings.knots, 4);
        for frames in [40, 64, 200] {
            let sequence = bent(bend, frames, 4);
            let found = settings.register_to(&reference, &sequence, 4).unwrap();
            for k in 0..=100 {
                let place = f64::from(k) / 100.0;
                // At this place of the bent sequence the movement is as far as the straight one at that phase.
                let error = found.warp.phase(place) - bend_of(place, bend);
                assert!(
                    error.abs() < 1.3 / 63.0,
                    "bend {bend}, {frames} frames, place {place}: {error}"
                );
            }
            assert!(found.cost < 0.05, "bend {bend}: cost {}", found.cost);
        }
    }
}

#[test]
fn a_group_with_bent_times_comes_together_and_its_mean_runs_evenly() {
    let bends = [-0.5, -0.2, 0.0, 0.3, 0.4];
    let sequences: Vec<Vec<f64>> = bends.iter().map(|&b| bent(b, 50, 4)).collect();
    let views: Vec<&[f64]> = sequences.iter().map(Vec::as_slice).collect();
    let settings = Registration::default();
    let rough = Registration {
        rounds: 0,
        ..settings.clone()
    };
    let even: Vec<f64> = (0..64).map(|k| f64::from(k) / 63.0).collect();
    let found = settings.register(&views, 4).unwrap();
    let first = rough.register(&views, 4).unwrap();
    let total = |costs: &[f64]| costs.iter().map(|c| c * c).sum::<f64>();
    assert!(
        total(&found.costs) <= total(&first.costs),
        "refinement costs nothing"
    );
    assert!(found.rounds > 0 && first.rounds == 0);
    let unwarped = resample(&sequences[0], 4, &even);
    let apart: f64 = found
        .mean
        .iter()
        .zip(&unwarped)
        .map(|(x, y)| (x - y).powi(2))
        .sum();
    assert!(found.costs[0] < 0.2 * (apart / 64.0).sqrt());
    // A member is registered to the mean as it is in the group.
    for (sequence, warp) in views.iter().zip(&found.warps) {
        let again = settings.register_to(&found.mean, sequence, 4).unwrap();
        for (x, y) in again.warp.places().iter().zip(warp.places()) {
            assert!((x - y).abs() < 0.02, "{x} and {y}");
        }
    }
}

#[test]
fn neither_order_nor_threads_change_a_bit() {
    let bends = [-0.5, -0.2, 0.1, 0.3, 0.45, 0.0, -0.31];
    let sequences: Vec<Vec<f64>> = bends
        .iter()
        .enumerate()
        .map(|(i, &b)| bent(b, 40 + i, 3))
        .collect();
    let run = |order: &[usize], threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let views: Vec<&[f64]> = order.iter().map(|&i| sequences[i].as_slice()).collect();
        pool.install(|| Registration::default().register(&views, 3).unwrap())
    };
    let order = [0, 1, 2, 3, 4, 5, 6];
    let one = run(&order, 1);
    assert_eq!(one, run(&order, 3));
    let shuffled = [4, 2, 6, 0, 5, 1, 3];
    let other = run(&shuffled, 2);
    assert_eq!(one.mean, other.mean);
    assert_eq!(one.medoid, shuffled[other.medoid]);
    for (k, &i) in shuffled.iter().enumerate() {
        assert_eq!(
            (&one.warps[i], one.costs[i]),
            (&other.warps[k], other.costs[k])
        );
    }
}

#[test]
fn closed_warps_go_round_smoothly() {
    let places: Vec<f64> = (0..=16)
        .map(|k| bend_of(f64::from(k) / 16.0, 0.5))
        .collect();
    let warp = Warp::closed(places).unwrap();
    for phase in [0.0, 0.13, 0.5, 0.99] {
        check(
            "turned",
            warp.place(phase + 2.0),
            warp.place(phase) + 2.0,
            1e-12,
        );
        check(
            "inverse",
            warp.phase(warp.place(phase - 1.0)),
            phase - 1.0,
            1e-9,
        );
    }
    assert_eq!(warp.slope(0.0), warp.slope(1.0));
    let slope = (warp.place(1e-6) - warp.place(-1e-6)) / 2e-6;
    check("slope", slope, warp.slope(0.0), 1e-4);
    assert!(warp.is_closed() && !Warp::identity(5).is_closed());
}

#[test]
fn resampling_takes_places_between_the_ends() {
    let sequence = [0.0, 10.0, 1.0, 20.0, 2.0, 40.0];
    let found = resample(&sequence, 2, &[-1.0, 0.0, 0.25, 0.5, 0.75, 1.0, 7.0]);
    let expected = [
        0.0, 10.0, 0.0, 10.0, 0.5, 15.0, 1.0, 20.0, 1.5, 30.0, 2.0, 40.0, 2.0, 40.0,
    ];
    assert_eq!(found, expected);
    assert_eq!(resample(&sequence[..2], 2, &[0.4]), [0.0, 10.0]);
    assert!(resample(&[], 2, &[0.4]).is_empty() && resample(&sequence, 0, &[0.4]).is_empty());
}

/// A reach of `secs` with rests around it, minimum jerk (Flash and Hogan 1985), on one of two points.
fn reach(before: f64, secs: f64, after: f64, rate: f64, noise: f64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(3);
    let frames = ((before + secs + after) * rate).round() as usize + 1;
    (0..frames)
        .flat_map(|f| {
            let s = ((f as f64 / rate - before) / secs).clamp(0.0, 1.0);
            let x = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
            let mut jitter = || noise * random.random_range(-1.0..1.0);
            [
                0.6 * x + jitter(),
                0.2 * x + jitter(),
                1.0 + jitter(),
                jitter(),
                jitter(),
                jitter(),
            ]
        })
        .collect()
}

#[test]
fn rests_at_the_ends_are_cut_and_movements_are_not() {
    let trim = Trim::default();
    for (before, secs, after, rate, noise) in [
        (1.0, 0.8, 2.0, 120.0, 0.0),
        (1.0, 0.8, 2.0, 120.0, 0.0003),
        (0.5, 1.5, 0.4, 30.0, 0.0005),
        (0.0, 1.0, 0.0, 60.0, 0.0),
        (0.0, 6.0, 0.0, 60.0, 0.0),
        (0.0, 2.0, 1.0, 30.0, 0.0),
    ] {
        let sequence = reach(before, secs, after, rate, noise);
        let left = resting_ends(&sequence, 6, rate, &trim);
        let (start, end) = (left.start as f64 / rate, (left.end - 1) as f64 / rate);
        let what = format!("{before} {secs} {after} {rate}: {start} to {end}");
        // The slow beginning of a reach may go with the rest before it, no more than 15 % of its time.
        assert!(start <= before + 0.15 * secs, "{what}");
        assert!(end >= before + secs - 0.15 * secs, "{what}");
        assert!(
            start >= before - trim.margin_secs - trim.smooth_secs - 1.5 / rate || start == 0.0,
            "{what}"
        );
        assert!(
            end <= before + secs + trim.margin_secs + trim.smooth_secs + 1.5 / rate,
            "{what}"
        );
        if noise == 0.0 && before == 0.0 {
            assert_eq!(left.start, 0, "moves from the first frame: {what}");
        }
        if noise == 0.0 && after == 0.0 {
            assert_eq!(
                left.end,
                sequence.len() / 6,
                "moves to the last frame: {what}"
            );
        }
    }
    assert_eq!(resting_ends(&[1.0; 60], 6, 30.0, &trim), 0..10);
    assert_eq!(resting_ends(&[], 6, 30.0, &trim), 0..0);
    assert_eq!(resting_ends(&[1.0; 60], 0, 30.0, &trim), 0..0);
    // One jump in a long rest leaves the few frames that are wanted, at either end too.
    for at in [1, 50, 99] {
        let jump: Vec<f64> = (0..100).map(|f| if f < at { 0.0 } else { 1.0 }).collect();
        let short = Trim {
            margin_secs: 0.0,
            smooth_secs: 0.0,
            ..trim
        };
        let left = resting_ends(&jump, 1, 30.0, &short);
        assert_eq!(left.len(), 8, "{at}: {left:?}");
        assert!(
            left.contains(&(at - 1)) && left.contains(&at),
            "{at}: {left:?}"
        );
    }
}

#[test]
fn refuses_what_cannot_be_registered() {
    let default = Registration::default();
    let good = bent(0.0, 20, 2);
    for settings in [
        Registration {
            knots: 3,
            ..default.clone()
        },
        Registration {
            slope: 0.5,
            ..default.clone()
        },
        Registration {
            slope: f64::NAN,
            ..default.clone()
        },
        Registration {
            band: -0.1,
            ..default.clone()
        },
        Registration {
            velocity: f64::INFINITY,
            ..default.clone()
        },
        Registration {
            tolerance: f64::NAN,
            ..default.clone()
        },
    ] {
        let found = settings.register(&[&good, &good], 2);
        assert!(found.is_err_and(|e| e.is_invalid()), "{settings:?}");
    }
    let odd = vec![1.0; 7];
    let broken = vec![f64::NAN; 8];
    let far = vec![1e200; 8];
    for sequences in [
        vec![],
        vec![&good[..], &odd],
        vec![&good, &broken],
        vec![&good, &far],
        vec![&good, &[]],
    ] {
        assert!(
            default
                .register(&sequences, 2)
                .is_err_and(|e| e.is_invalid())
        );
    }
    assert!(default.register(&[&good], 0).is_err());
    assert!(
        default.register_to(&good, &good, 2).is_err(),
        "20 frames are not 64 knots"
    );
    for places in [
        vec![],
        vec![0.0],
        vec![0.0, 0.9],
        vec![0.1, 1.0],
        vec![0.0, 0.5, 0.5, 1.0],
        vec![0.0, f64::NAN, 1.0],
    ] {
        assert!(
            Warp::new(places.clone()).is_err_and(|e| e.is_invalid()),
            "{places:?}"
        );
    }
}
