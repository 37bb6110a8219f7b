//! Clustering against other libraries, against brute force, and by its laws.

mod oracles;

use kineme::clustering::{
    Density, SweepAndPrune, Width, hdbscan, hdbscan_judged, mean_silhouette, silhouettes,
    sweep_and_prune,
};
use kineme::math::distances::{DistanceMatrix, Neighbours};
use kineme::math::local_scale::{locally_scaled, locally_scaled_lists};
use kineme::math::partition::{UnionFind, renumbered};
use oracles::{numbers, oracle};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const SETS: [(&str, usize); 2] = [("blobs_3d", 3), ("moons_2d", 2)];

fn expected(row: &serde_json::Value) -> Vec<Option<usize>> {
    let labels = row["labels"].as_array().expect("labels");
    let label = |l: &serde_json::Value| usize::try_from(l.as_i64().expect("a number")).ok();
    renumbered(&labels.iter().map(label).collect::<Vec<_>>())
}

fn fixed(width: f64, min_cluster_size: usize) -> SweepAndPrune {
    SweepAndPrune {
        width: Width::Fixed(width),
        min_cluster_size,
        seed: 0,
    }
}

#[test]
fn hdbscan_equals_scikit_learn() {
    let Some(file) = oracle("cluster.json") else {
        return;
    };
    for (name, dimension) in SETS {
        let points = numbers(&file[name]["points"]);
        let distances = DistanceMatrix::euclidean(&points, dimension).unwrap();
        for row in file[name]["hdbscan"].as_array().expect("rows") {
            let size = |key: &str| row[key].as_u64().expect("a size") as usize;
            let density = Density {
                min_cluster_size: size("min_cluster_size"),
                min_samples: size("min_samples"),
                ..Density::default()
            };
            let labels = hdbscan(&distances, &density).unwrap();
            let truth = expected(row);
            // An item exactly as near to two groups joins either or none, as the order of equal edges has it.
            let torn = torn(&distances, density.min_samples, &truth);
            assert!(
                torn.len() * 16 <= labels.len(),
                "{name} {density:?}: {torn:?}"
            );
            let kept = |labels: &[Option<usize>]| -> Vec<Option<usize>> {
                let sure = (0..labels.len()).filter(|i| !torn.contains(i));
                renumbered(&sure.map(|i| labels[i]).collect::<Vec<_>>())
            };
            assert_eq!(kept(&labels), kept(&truth), "{name} {density:?}");
        }
    }
}

/// Items whose least mutual reachability is reached with members of two groups.
fn torn(distances: &DistanceMatrix, samples: usize, labels: &[Option<usize>]) -> Vec<usize> {
    let len = distances.len();
    let core: Vec<f64> = (0..len)
        .map(|i| {
            let mut row: Vec<f64> = (0..len).map(|j| distances.get(i, j)).collect();
            row.sort_unstable_by(f64::total_cmp);
            row[samples - 1]
        })
        .collect();
    let reach = |i: usize, j: usize| distances.get(i, j).max(core[i]).max(core[j]);
    (0..len)
        .filter(|&i| {
            let others = (0..len).filter(|&j| j != i);
            let least = others.clone().map(|j| reach(i, j)).fold(f64::MAX, f64::min);
            let mut groups = others
                .filter(|&j| reach(i, j) <= least * (1.0 + 1e-12))
                .filter_map(|j| labels[j]);
            let first = groups.next();
            groups.any(|g| Some(g) != first)
        })
        .collect()
}

#[test]
fn sweep_equals_single_linkage_of_scipy() {
    let Some(file) = oracle("cluster.json") else {
        return;
    };
    for (name, dimension) in SETS {
        let points = numbers(&file[name]["points"]);
        for row in file[name]["single_linkage_chebyshev"]
            .as_array()
            .expect("rows")
        {
            let width = row["eps"].as_f64().expect("a width");
            let found = sweep_and_prune(&points, dimension, &fixed(width, 1)).unwrap();
            assert_eq!(found.labels, expected(row), "{name} at {width}");
        }
    }
}

/// Every pair looked at, nothing sorted.
fn brute_force(points: &[f64], dimension: usize, width: f64) -> Vec<Option<usize>> {
    let rows: Vec<&[f64]> = points.chunks(dimension).collect();
    let mut sets = UnionFind::new(rows.len());
    for i in 0..rows.len() {
        for j in 0..i {
            if rows[i]
                .iter()
                .zip(rows[j])
                .all(|(a, b)| (a - b).abs() <= width)
            {
                sets.join(i, j);
            }
        }
    }
    sets.labels().into_iter().map(Some).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn sweep_equals_brute_force(
        (dimension, points) in (1usize..5).prop_flat_map(|d| {
            // A coarse grid, so that boxes often touch exactly.
            let value = (-8i32..8).prop_map(|v| f64::from(v) * 0.5);
            (Just(d), prop::collection::vec(value, 0..40).prop_map(move |mut v| {
                v.truncate(v.len() / d * d);
                v
            }))
        }),
        width in 0usize..4,
    ) {
        let width = width as f64 * 0.5;
        let found = sweep_and_prune(&points, dimension, &fixed(width, 1)).unwrap();
        prop_assert_eq!(found.labels, brute_force(&points, dimension, width));
    }
}

/// Gaussian-like blobs of `size` points around corners of a cube, one after the other.
fn blobs(count: usize, size: usize, spread: f64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(5);
    let mut points = Vec::new();
    for blob in 0..count {
        for _ in 0..size {
            for axis in 0..3 {
                let middle = f64::from((blob >> axis & 1) as u8) * 10.0;
                let noise: f64 = (0..4).map(|_| random.random_range(-1.0..1.0)).sum();
                points.push(middle + spread * noise);
            }
        }
    }
    points
}

#[test]
fn blobs_far_apart_are_found_and_strays_stay_noise() {
    let mut points = blobs(6, 30, 0.4);
    points.extend([40.0, 0.0, 0.0, 0.0, -40.0, 5.0]);
    let mut truth: Vec<Option<usize>> = (0..180).map(|i| Some(i / 30)).collect();
    truth.extend([None, None]);
    let found = sweep_and_prune(&points, 3, &SweepAndPrune::default()).unwrap();
    assert_eq!(found.labels, truth);
    assert!(found.stability > 0.95, "{}", found.stability);
    let distances = DistanceMatrix::euclidean(&points, 3).unwrap();
    let labels = hdbscan(&distances, &Density::default()).unwrap();
    assert_eq!(labels[180..], [None, None]);
    let of = |blob: usize| labels[blob * 30..(blob + 1) * 30].iter().flatten();
    for blob in 0..6 {
        assert!(
            of(blob).all(|l| *l == blob) && of(blob).count() > 20,
            "{blob}"
        );
    }
}

#[test]
fn stability_falls_where_there_are_no_groups() {
    let mut random = Pcg64::seed_from_u64(8);
    let cloud: Vec<f64> = (0..600).map(|_| random.random_range(0.0..1.0)).collect();
    let found = sweep_and_prune(&cloud, 3, &SweepAndPrune::default()).unwrap();
    assert!(found.stability < 0.8, "{}", found.stability);
}

#[test]
fn grouping_does_not_depend_on_scale_or_threads() {
    let points = blobs(4, 25, 0.5);
    let scaled: Vec<f64> = points.iter().map(|v| v * 4096.0).collect();
    let options = SweepAndPrune::default();
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let two = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap();
    let first = one.install(|| sweep_and_prune(&points, 3, &options).unwrap());
    let second = two.install(|| sweep_and_prune(&points, 3, &options).unwrap());
    assert_eq!(first, second);
    let larger = sweep_and_prune(&scaled, 3, &options).unwrap();
    assert_eq!(larger.labels, first.labels);
    let of = |points: &[f64]| {
        let distances = DistanceMatrix::euclidean(points, 3).unwrap();
        hdbscan(&distances, &Density::default()).unwrap()
    };
    assert_eq!(of(&points), of(&scaled));
}

#[test]
fn duplicates_infinite_distances_and_tiny_input_are_served() {
    let mut points = vec![0.0; 8];
    points.extend([5.0; 8]);
    let two = [vec![Some(0); 8], vec![Some(1); 8]].concat();
    let distances = DistanceMatrix::euclidean(&points, 1).unwrap();
    assert_eq!(hdbscan(&distances, &Density::default()).unwrap(), two);
    let apart = DistanceMatrix::from_fn(16, |i, j| {
        if (i < 8) == (j < 8) {
            1.0 + 0.1 * i.abs_diff(j) as f64
        } else {
            f64::INFINITY
        }
    })
    .unwrap();
    assert_eq!(hdbscan(&apart, &Density::default()).unwrap(), two);
    for len in 0..5 {
        let few = DistanceMatrix::from_fn(len, |_, _| 1.0).unwrap();
        let smallest = Density {
            min_cluster_size: 2,
            min_samples: 50,
            ..Density::default()
        };
        assert_eq!(hdbscan(&few, &Density::default()).unwrap(), vec![None; len]);
        assert_eq!(hdbscan(&few, &smallest).unwrap(), vec![None; len]);
        let points = vec![1.0; len];
        let found = sweep_and_prune(&points, 1, &SweepAndPrune::default()).unwrap();
        assert_eq!(found.labels.len(), len);
    }
}

#[test]
fn broken_input_is_refused() {
    let distances = DistanceMatrix::euclidean(&[0.0, 1.0, 2.0], 1).unwrap();
    let of = |min_cluster_size, min_samples| Density {
        min_cluster_size,
        min_samples,
        ..Density::default()
    };
    let results = [
        ("group of one", hdbscan(&distances, &of(1, 1)).err()),
        ("no samples", hdbscan(&distances, &of(2, 0)).err()),
        (
            "negative width",
            sweep_and_prune(&[0.0], 1, &fixed(-1.0, 1)).err(),
        ),
        (
            "groups of none",
            sweep_and_prune(&[0.0], 1, &fixed(1.0, 0)).err(),
        ),
        (
            "not a number",
            sweep_and_prune(&[f64::NAN], 1, &fixed(1.0, 1)).err(),
        ),
        (
            "half a point",
            sweep_and_prune(&[0.0], 2, &fixed(1.0, 1)).err(),
        ),
        (
            "negative distance",
            DistanceMatrix::from_upper(2, vec![-1.0]).err(),
        ),
        (
            "missing distance",
            DistanceMatrix::from_upper(3, vec![1.0]).err(),
        ),
    ];
    for (what, error) in results {
        assert!(error.is_some_and(|e| e.is_invalid()), "{what}");
    }
}

/// Points of three tight pairs of blobs: two levels of groups.
fn pairs_of_blobs() -> (Vec<f64>, Vec<usize>) {
    let mut points = Vec::new();
    let mut truth = Vec::new();
    for pair in 0..3 {
        for half in 0..2 {
            for i in 0..12 {
                let (dx, dy) = (f64::from(i % 4) * 0.1, f64::from(i / 4) * 0.1);
                points.extend([f64::from(pair) * 40.0 + f64::from(half) * 4.0 + dx, dy]);
                truth.push((pair * 2 + half) as usize);
            }
        }
    }
    (points, truth)
}

#[test]
fn silhouettes_are_those_of_the_definition() {
    // Two items at 0 and 1, two at 10 and 12, one without a group.
    let points = [0.0, 1.0, 10.0, 12.0, 5.0];
    let distances = DistanceMatrix::euclidean(&points, 1).unwrap();
    let labels = [Some(0), Some(0), Some(1), Some(1), None];
    let expected = [
        (11.0 - 1.0) / 11.0,
        (10.0 - 1.0) / 10.0,
        (9.5 - 2.0) / 9.5,
        (11.5 - 2.0) / 11.5,
    ];
    let found = silhouettes(&distances, &labels);
    for (f, e) in found.iter().zip(expected) {
        assert!((f.unwrap() - e).abs() < 1e-12, "{f:?} {e}");
    }
    assert_eq!(found[4], None);
    let mean = expected.iter().sum::<f64>() / 5.0;
    assert!((mean_silhouette(&distances, &labels) - mean).abs() < 1e-12);
    assert_eq!(mean_silhouette(&distances, &[Some(0); 5]), -1.0);
    // Alone in its group: neither near nor far.
    let alone = [Some(0), Some(0), Some(0), Some(1), None];
    assert_eq!(silhouettes(&distances, &alone)[3], Some(0.0));
}

#[test]
fn judged_groups_are_never_judged_worse_than_unlimited_ones() {
    for seed in 0..12 {
        let points: Vec<f64> = {
            let mut random = Pcg64::seed_from_u64(seed);
            (0..160)
                .map(|i| f64::from(i % 5) * 3.0 + random.random::<f64>() * (1.0 + f64::from(i % 3)))
                .collect()
        };
        let distances = DistanceMatrix::euclidean(&points, 2).unwrap();
        let density = Density::of_size(5);
        let plain = hdbscan(&distances, &density).unwrap();
        let judged = hdbscan_judged(&distances, &density).unwrap();
        let quality = |labels: &[Option<usize>]| mean_silhouette(&distances, labels);
        assert!(quality(&judged) >= quality(&plain) - 1e-12, "seed {seed}");
    }
}

#[test]
fn a_limit_parts_large_groups() {
    let (points, truth) = pairs_of_blobs();
    let distances = DistanceMatrix::euclidean(&points, 2).unwrap();
    let limited = Density {
        max_cluster_size: Some(15),
        ..Density::of_size(5)
    };
    let labels = hdbscan(&distances, &limited).unwrap();
    let truth: Vec<Option<usize>> = truth.into_iter().map(Some).collect();
    assert_eq!(labels, truth);
}

#[test]
fn local_scaling_makes_groups_of_unlike_density_alike() {
    // The same grid, once a hundred times larger: after scaling both look the same.
    let grid = |i: usize, step: f64, x: f64| [x + (i % 3) as f64 * step, (i / 3) as f64 * step];
    let points: Vec<f64> = (0..9)
        .flat_map(|i| grid(i, 1.0, 0.0))
        .chain((0..9).flat_map(|i| grid(i, 100.0, 1e5)))
        .collect();
    let distances = DistanceMatrix::euclidean(&points, 2).unwrap();
    let scaled = locally_scaled(&distances, 3).unwrap();
    for i in 0..9 {
        for j in 0..9 {
            assert!(
                (scaled.get(i, j) - scaled.get(9 + i, 9 + j)).abs() < 1e-9,
                "{i} {j}"
            );
        }
    }
    let all = Neighbours::nearest(&distances, 17);
    let lists = locally_scaled_lists(&all, 3).unwrap();
    for i in 0..18 {
        for &(j, d) in lists.of(i) {
            assert!((d - scaled.get(i, j)).abs() < 1e-9, "{i} {j}");
        }
    }
    assert!(locally_scaled(&distances, 0).is_err());
    // Duplicates have no scale of their own and make nothing infinite.
    let same = DistanceMatrix::from_fn(6, |_, _| 0.0).unwrap();
    assert_eq!(locally_scaled(&same, 3).unwrap().get(0, 5), 0.0);
}
