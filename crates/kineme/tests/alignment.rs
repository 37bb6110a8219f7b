//! Time warping: laws, exhaustive search, reference values, and the fast paths against the plain one.

use std::path::PathBuf;

use kineme::alignment::{
    Band, LocalCost, Nearest, RecallGoal, Sequences, align, distance, distances_to_query,
    nearest_neighbours, nearest_to_recall, pair_distances, recall,
};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const SQUARED: LocalCost = LocalCost::SquaredEuclidean;

fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| rng.random_range(-1.0..1.0)).collect()
}

/// Smooth sequences in a few families, each sequence with its own pace and size.
fn family(items: usize, frames: usize, dims: usize, families: usize, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let shapes: Vec<(f64, f64)> = (0..families * dims)
        .map(|_| (rng.random_range(0.2..1.0), rng.random_range(0.0..6.0)))
        .collect();
    let mut values = Vec::new();
    for i in 0..items {
        let shape = &shapes[i % families * dims..][..dims];
        let (pace, size) = (rng.random_range(-0.3..0.3), rng.random_range(0.8..1.2));
        for t in 0..frames {
            let u = t as f64 / (frames - 1) as f64;
            let u = u + pace * u * (1.0 - u);
            values.extend(
                shape
                    .iter()
                    .map(|(a, p)| 3.0 + a * size * (6.0 * u + p).sin()),
            );
        }
    }
    values
}

fn oracles() -> Option<PathBuf> {
    let data = std::env::var_os("KINEME_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let folder = data.join("../oracles");
    folder.is_dir().then_some(folder)
}

fn check(what: &str, found: f64, expected: f64, relative: f64) {
    let error = (found - expected).abs() / expected.abs().max(1e-12);
    assert!(error <= relative, "{what}: {found} in place of {expected}");
}

/// The cheapest path by trying all of them.
fn exhaustive(a: &[f64], b: &[f64], dims: usize, i: usize, j: usize) -> f64 {
    let cost: f64 = (0..dims)
        .map(|d| (a[i * dims + d] - b[j * dims + d]).powi(2))
        .sum();
    let before = match (i, j) {
        (0, 0) => 0.0,
        (0, _) => exhaustive(a, b, dims, 0, j - 1),
        (_, 0) => exhaustive(a, b, dims, i - 1, 0),
        _ => exhaustive(a, b, dims, i - 1, j)
            .min(exhaustive(a, b, dims, i, j - 1))
            .min(exhaustive(a, b, dims, i - 1, j - 1)),
    };
    before + cost
}

#[test]
fn agrees_with_the_reference_values() {
    let Some(folder) = oracles() else {
        eprintln!("skipped: no reference values");
        return;
    };
    let text = std::fs::read_to_string(folder.join("dtw.json")).unwrap();
    let all: serde_json::Value = serde_json::from_str(&text).unwrap();
    let flat = |v: &serde_json::Value| -> Vec<f64> {
        let rows = v.as_array().unwrap().iter();
        rows.flat_map(|r| r.as_array().unwrap())
            .map(|x| x.as_f64().unwrap())
            .collect()
    };
    let pairs = all["pairs"].as_array().unwrap();
    assert!(pairs.len() >= 20);
    for pair in pairs {
        let (a, b) = (flat(&pair["a"]), flat(&pair["b"]));
        let dims = pair["a"][0].as_array().unwrap().len();
        let radius = pair["radius"].as_u64().unwrap() as usize;
        let longest = a.len().max(b.len()) / dims;
        assert_eq!(Band::radius(0.1, longest), radius);
        for (key, band, cost) in [
            ("full_sqrt_of_squared", Band::Full, SQUARED),
            (
                "sakoe_chiba_sqrt_of_squared",
                Band::Parallel(radius),
                SQUARED,
            ),
            ("full_sum_of_euclidean", Band::Full, LocalCost::Euclidean),
        ] {
            let expected = pair[key].as_f64().unwrap();
            check(
                key,
                distance(&a, &b, dims, band, cost).unwrap(),
                expected,
                1e-9,
            );
        }
        if let Some(path) = pair["path"].as_array() {
            let path: Vec<(usize, usize)> = path
                .iter()
                .map(|p| {
                    (
                        p[0].as_u64().unwrap() as usize,
                        p[1].as_u64().unwrap() as usize,
                    )
                })
                .collect();
            assert_eq!(align(&a, &b, dims, Band::Full, SQUARED).unwrap().path, path);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn equals_exhaustive_search(n in 1usize..=6, m in 1usize..=6, dims in 1usize..=3, seed: u64) {
        let (a, b) = (random(n * dims, seed), random(m * dims, !seed));
        let expected = exhaustive(&a, &b, dims, n - 1, m - 1).sqrt();
        let found = distance(&a, &b, dims, Band::Full, SQUARED).unwrap();
        prop_assert!((found - expected).abs() < 1e-12);
    }

    #[test]
    fn is_symmetric_and_wider_bands_never_cost_more(
        n in 1usize..30, m in 1usize..30, radius in 0usize..8, seed: u64,
    ) {
        let (a, b) = (random(n * 2, seed), random(m * 2, !seed));
        for band in [Band::Parallel, Band::Slanted] {
            for cost in [SQUARED, LocalCost::Euclidean] {
                let narrow = distance(&a, &b, 2, band(radius), cost).unwrap();
                let wide = distance(&a, &b, 2, band(radius + 1), cost).unwrap();
                let full = distance(&a, &b, 2, Band::Full, cost).unwrap();
                prop_assert!(narrow.is_finite(), "{:?} leaves no path", band(radius));
                prop_assert!(full <= wide && wide <= narrow);
                prop_assert_eq!(distance(&b, &a, 2, band(radius), cost).unwrap(), narrow);
                prop_assert_eq!(distance(&a, &b, 2, band(60), cost).unwrap(), full);
            }
        }
    }

    #[test]
    fn paths_step_by_one_stay_in_the_band_and_add_up(
        n in 1usize..30, m in 1usize..30, radius in 0usize..6, seed: u64,
    ) {
        let (a, b) = (random(n * 2, seed), random(m * 2, !seed));
        for band in [Band::Full, Band::Parallel(radius), Band::Slanted(radius)] {
            let found = align(&a, &b, 2, band, LocalCost::Euclidean).unwrap();
            prop_assert_eq!(found.path[0], (0, 0));
            prop_assert_eq!(*found.path.last().unwrap(), (n - 1, m - 1));
            for w in found.path.windows(2) {
                let step = (w[1].0 - w[0].0, w[1].1 - w[0].1);
                prop_assert!(matches!(step, (1, 0) | (0, 1) | (1, 1)));
            }
            for &(i, j) in &found.path {
                let (i, j) = (i as i64, j as i64);
                let (p, q, r) = (n as i64 - 1, m as i64 - 1, radius as i64);
                let inside = match band {
                    Band::Full => true,
                    Band::Parallel(_) => {
                        -r - (p - q).max(0) <= j - i && j - i <= (q - p).max(0) + r
                    }
                    Band::Slanted(_) => {
                        let r = if p == q { r } else { r.max(1) };
                        p == 0 || q == 0 || (i * q - j * p).abs() <= r * p.max(q)
                    }
                };
                prop_assert!(inside, "({}, {}) outside of {:?}", i, j, band);
            }
            let sum: f64 = found
                .path
                .iter()
                .map(|&(i, j)| (a[2 * i] - b[2 * j]).hypot(a[2 * i + 1] - b[2 * j + 1]))
                .sum();
            prop_assert!((sum - found.distance).abs() < 1e-9);
        }
    }
}

#[test]
fn a_sequence_is_at_no_distance_from_itself_or_a_slower_copy() {
    let a = random(20 * 3, 5);
    let doubled: Vec<f64> = a.chunks(3).flat_map(|f| [f, f].concat()).collect();
    let same = align(&a, &a, 3, Band::Full, SQUARED).unwrap();
    assert_eq!(same.distance, 0.0);
    assert!(same.path.iter().all(|(i, j)| i == j));
    let slanted = distance(&a, &doubled, 3, Band::Slanted(1), SQUARED).unwrap();
    assert_eq!(slanted, 0.0);
    // With radius 0 the diagonal is all there is.
    let b = random(20 * 3, 6);
    let plain: f64 = a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum();
    let diagonal = distance(&a, &b, 3, Band::Parallel(0), SQUARED).unwrap();
    check("diagonal", diagonal, plain.sqrt(), 1e-12);
}

#[test]
fn radius_is_the_share_rounded_up() {
    for (share, frames, radius) in [
        (0.15, 32, 5),
        (0.1, 60, 6),
        (0.1, 30, 3),
        (0.1, 31, 4),
        (0.0, 9, 0),
    ] {
        assert_eq!(Band::radius(share, frames), radius, "{share} of {frames}");
    }
}

#[test]
fn refuses_what_is_no_sequence() {
    for (a, dims) in [
        (vec![], 1),
        (vec![1.0; 3], 2),
        (vec![1.0], 0),
        (vec![f64::NAN], 1),
    ] {
        assert!(distance(&a, &[1.0, 2.0], dims, Band::Full, SQUARED).is_err());
        assert!(align(&[1.0, 2.0], &a, dims, Band::Full, SQUARED).is_err());
    }
    for (values, frames, dims) in [
        (vec![1.0; 3], 2, 1),
        (vec![1.0], 0, 1),
        (vec![1.0], 1, 0),
        (vec![f64::INFINITY], 1, 1),
        (vec![1e300, -1e300], 1, 1),
    ] {
        assert!(Sequences::new(&values, frames, dims).is_err());
    }
    let (low, high) = ([-1e200; 4], [1e200; 4]);
    assert!(align(&low, &high, 1, Band::Parallel(1), SQUARED).is_err());
    let two = Sequences::new(&[0.0, 1.0], 1, 1).unwrap();
    assert!(distances_to_query(&two, &[0.0, 1.0], 0).is_err());
    assert!(distances_to_query(&two, &[f64::NAN], 0).is_err());
    let mut none = Nearest::with_radius(1);
    none.candidates = 0;
    assert!(nearest_neighbours(&two, &none).is_err());
}

#[test]
fn all_pairs_equal_the_plain_distance() {
    // Numbers of items around a multiple of the block, bands from none to all, one frame, odd dimensions.
    for (items, frames, dims, radius) in [
        (1, 4, 2, 1),
        (7, 1, 3, 0),
        (8, 9, 1, 0),
        (9, 12, 5, 2),
        (19, 17, 6, usize::MAX),
        (3, 10, 4, 3),
    ] {
        let values = family(items, frames.max(2), dims, 2, 3);
        let values = &values[..items * frames * dims];
        let sequences = Sequences::new(values, frames, dims).unwrap();
        let matrix = pair_distances(&sequences, radius);
        let size = frames * dims;
        for (i, a) in values.chunks(size).enumerate() {
            let row = distances_to_query(&sequences, a, radius).unwrap();
            for (j, b) in values.chunks(size).enumerate() {
                let plain = distance(a, b, dims, Band::Parallel(radius), SQUARED).unwrap();
                let fast = matrix[i * items + j];
                // Nearly equal sequences leave nothing but the rounding of the numbers themselves.
                let error = (fast - plain).abs() / plain.max(0.1);
                assert!(error < 1e-5, "{items} items, {i} {j}: {fast} for {plain}");
                assert_eq!(fast, matrix[j * items + i]);
                assert_eq!(fast, row[j], "a query is measured as a member is");
            }
        }
    }
    assert!(pair_distances(&Sequences::new(&[], 3, 2).unwrap(), 1).is_empty());
}

#[test]
fn a_common_offset_costs_no_precision() {
    let values = family(12, 16, 4, 3, 8);
    let far: Vec<f64> = values.iter().map(|v| v + 1000.0).collect();
    let near = pair_distances(&Sequences::new(&values, 16, 4).unwrap(), 2);
    let far = pair_distances(&Sequences::new(&far, 16, 4).unwrap(), 2);
    for (a, b) in near.iter().zip(&far) {
        assert!((a - b).abs() <= 1e-5 * a.max(0.1), "{a} and {b}");
    }
}

#[test]
fn neighbour_lists_are_sorted_symmetric_and_hold_the_pair_distances() {
    let (items, frames, dims) = (90, 12, 3);
    let sequences = Sequences::new(&family(items, frames, dims, 6, 4), frames, dims).unwrap();
    let matrix = pair_distances(&sequences, 2);
    let mut config = Nearest::with_radius(2);
    config.candidates = 9;
    let lists = nearest_neighbours(&sequences, &config).unwrap();
    for (i, list) in lists.iter().enumerate() {
        assert!(list.len() >= 9, "at least the own candidates");
        assert!(list.windows(2).all(|w| (w[0].1, w[0].0) < (w[1].1, w[1].0)));
        for &(j, d) in list {
            assert_ne!(i, j);
            assert_eq!(d, matrix[i * items + j]);
            assert!(lists[j].contains(&(i, d)));
        }
    }
    // With every other sequence a candidate nothing is missing.
    config.candidates = items;
    let all = nearest_neighbours(&sequences, &config).unwrap();
    assert!(all.iter().all(|l| l.len() == items - 1));
    assert_eq!(recall(&sequences, &all, 2, &RecallGoal::default()), 1.0);
}

#[test]
fn recall_counts_the_true_nearest_and_the_goal_is_reached() {
    let (items, frames, dims) = (120, 12, 3);
    let sequences = Sequences::new(&random(items * frames * dims, 4), frames, dims).unwrap();
    let goal = RecallGoal {
        neighbours: 5,
        sample: 40,
        ..RecallGoal::default()
    };
    let mut config = Nearest::with_radius(2);
    config.candidates = 2;
    let few = nearest_neighbours(&sequences, &config).unwrap();
    let low = recall(&sequences, &few, 2, &goal);
    assert!(low > 0.0 && low < 0.9, "noise hides its neighbours: {low}");
    let reached = nearest_to_recall(&sequences, &config, &goal).unwrap();
    assert!(reached.recall >= 0.99 && reached.candidates > 2);
    assert_eq!(recall(&sequences, &reached.lists, 2, &goal), reached.recall);
    // Lists robbed of their nearest miss exactly one of five.
    config.candidates = items;
    let mut lists = nearest_neighbours(&sequences, &config).unwrap();
    for list in &mut lists {
        list.remove(0);
    }
    let whole = RecallGoal {
        sample: items,
        ..goal
    };
    check(
        "one missing",
        recall(&sequences, &lists, 2, &whole),
        0.8,
        1e-12,
    );
}

#[test]
fn threads_do_not_change_a_bit() {
    let sequences = Sequences::new(&family(150, 10, 4, 5, 2), 10, 4).unwrap();
    let mut config = Nearest::with_radius(2);
    config.candidates = 12;
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            (
                pair_distances(&sequences, 2),
                nearest_to_recall(&sequences, &config, &RecallGoal::default()).unwrap(),
            )
        })
    };
    assert_eq!(run(1), run(2));
}
