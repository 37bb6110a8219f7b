//! Spatio-temporal Isomap of segments: against other libraries, against plain algorithms, and by its laws.

mod items;
mod oracles;

use items::{at, chain, check, cloud, plain};
use kineme::embedding::{
    Distances, EmbedOptions, NeighbourGraph, SpatioTemporal, TemporalRule, embed,
};
use kineme::math::distances::{DistanceMatrix, Neighbours};
use oracles::{numbers, oracle};
use proptest::prelude::*;

#[test]
fn components_and_their_geodesics_equal_scipy() {
    let Some(file) = oracle("isomap.json") else {
        return;
    };
    let three = &file["three_components"];
    let (_, graph) = plain(&numbers(&three["points"]), 3, 8);
    let labels: Vec<f64> = graph.components().iter().map(|&l| l as f64).collect();
    assert_eq!(labels, numbers(&three["labels_by_first_appearance"]));
    let matrix = graph.geodesics();
    for part in three["components"].as_array().expect("components") {
        for s in numbers(&part["samples"]).chunks(3) {
            let (i, j) = (s[0] as usize, s[1] as usize);
            check("geodesic", matrix.get(i, j), s[2], 1e-6);
        }
        let items: Vec<usize> = numbers(&part["points"])
            .iter()
            .map(|i| *i as usize)
            .collect();
        let sum: f64 = matrix.subset(&items).upper().iter().sum();
        check("sum", sum, at(part, "sum_upper"), 1e-6);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn geodesics_equal_floyd_warshall(seed in 0u64..1000, k in 1usize..6, chained: bool) {
        let len = 40;
        let distances = DistanceMatrix::euclidean(&cloud(len, 2, seed), 2).unwrap();
        let options = SpatioTemporal { neighbours: k, chain: chained, ..SpatioTemporal::default() };
        let graph = NeighbourGraph::segmented(&distances, &chain(len), &options).unwrap();
        let mut plain = vec![vec![f64::INFINITY; len]; len];
        for e in graph.edges() {
            plain[e.a][e.b] = e.length;
            plain[e.b][e.a] = e.length;
        }
        for (i, row) in plain.iter_mut().enumerate() {
            row[i] = 0.0;
        }
        for via in 0..len {
            let onwards = plain[via].clone();
            for row in &mut plain {
                let there = row[via];
                for (best, onward) in row.iter_mut().zip(&onwards) {
                    *best = best.min(there + onward);
                }
            }
        }
        let found = graph.geodesics();
        for (i, row) in plain.iter().enumerate() {
            for (j, &b) in row.iter().enumerate() {
                let a = found.get(i, j);
                prop_assert!(a == b || (a - b).abs() < 1e-12, "{i} {j}: {a} {b}");
                for via in 0..len {
                    prop_assert!(a <= found.get(i, via) + found.get(via, j) + 1e-12);
                }
            }
        }
    }

    /// The rule written out over all pairs.
    #[test]
    fn common_temporal_neighbours_follow_the_rule(
        seed in 0u64..1000,
        k in 1usize..6,
        wide in 1usize..9,
        mutual: bool,
        rule in prop::sample::select(vec![
            TemporalRule::Forward, TemporalRule::Backward, TemporalRule::Both, TemporalRule::Either,
            TemporalRule::Known,
        ]),
    ) {
        let len = 30;
        let distances = DistanceMatrix::euclidean(&cloud(len, 2, seed), 2).unwrap();
        // Three recordings of ten.
        let next: Vec<Option<usize>> = (0..len).map(|i| (i % 10 != 9).then_some(i + 1)).collect();
        let before: Vec<Option<usize>> = (0..len).map(|i| (i % 10 != 0).then(|| i - 1)).collect();
        let options = SpatioTemporal { neighbours: k, temporal_neighbours: Some(wide), c_ctn: 7.0, c_atn: 3.0, rule, mutual, ..SpatioTemporal::default() };
        let graph = NeighbourGraph::segmented(&distances, &next, &options).unwrap();
        let among = |i: usize, j: usize, k: usize| {
            let closer = (0..len).filter(|&m| m != i && distances.get(i, m) < distances.get(i, j));
            i != j && closer.count() < k
        };
        let near = |i: usize, j: usize| among(i, j, k) || common_of(&among, &next, &before, rule, wide, i, j);
        let common = |i: usize, j: usize| common_of(&among, &next, &before, rule, wide, i, j);
        let mut expected = Vec::new();
        for (i, following) in next.iter().enumerate() {
            for j in i + 1..len {
                let adjacent = *following == Some(j);
                if !(near(i, j) || near(j, i) || adjacent) {
                    continue;
                }
                let ctn = if mutual { common(i, j) && common(j, i) } else { common(i, j) || common(j, i) };
                let divisor = if ctn { 7.0 } else { 1.0 } * if adjacent { 3.0 } else { 1.0 };
                expected.push((i, j, distances.get(i, j) / divisor));
            }
        }
        let found: Vec<(usize, usize, f64)> =
            graph.edges().iter().map(|e| (e.a, e.b, e.length)).collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn candidates_that_name_all_give_the_dense_graph(seed in 0u64..1000, k in 1usize..5) {
        let distances = DistanceMatrix::euclidean(&cloud(25, 2, seed), 2).unwrap();
        let all = Neighbours::nearest(&distances, 24);
        let options = SpatioTemporal { neighbours: k, chain: false, ..SpatioTemporal::default() };
        let dense = NeighbourGraph::segmented(&distances, &chain(25), &options).unwrap();
        let sparse = NeighbourGraph::segmented(Distances::Sparse(&all), &chain(25), &options).unwrap();
        prop_assert_eq!(dense.edges(), sparse.edges());
        let sum = |g: &NeighbourGraph| g.bridges().iter().map(|e| e.length).sum::<f64>();
        prop_assert!((sum(&dense) - sum(&sparse)).abs() < 1e-12);
        prop_assert_eq!(dense.bridges().len(), sparse.bridges().len());
    }
}

#[test]
fn factors_of_one_without_chain_are_plain_isomap() {
    let points = cloud(80, 3, 3);
    let (distances, graph) = plain(&points, 3, 6);
    let options = SpatioTemporal {
        neighbours: 6,
        c_ctn: 1.0,
        chain: false,
        ..SpatioTemporal::default()
    };
    let timed = NeighbourGraph::segmented(&distances, &chain(80), &options).unwrap();
    assert!(timed.common_edges() > 0 && graph.common_edges() == 0);
    assert_eq!(timed.geodesics(), graph.geodesics());
}

/// A ring with noise: a connected manifold whose geodesics are not Euclidean.
fn ring(len: usize) -> Vec<f64> {
    let noise = cloud(len, 2, 9);
    (0..len)
        .flat_map(|i| {
            let turn = std::f64::consts::TAU * i as f64 / len as f64;
            [
                turn.cos() + 0.05 * noise[2 * i],
                turn.sin() + 0.05 * noise[2 * i + 1],
            ]
        })
        .collect()
}

/// A routine of movements in a fixed order is repeated; two movements look alike but are followed by others.
#[test]
fn movements_alike_in_form_part_by_what_follows_them() {
    let middles = [[0.0, 0.0], [4.0, 0.0], [0.2, 0.0], [0.0, 4.0], [4.0, 4.0]];
    let noise = cloud(100, 2, 4);
    let points: Vec<f64> = (0..100)
        .flat_map(|i| {
            let m = middles[i % 5];
            [m[0] + 0.2 * noise[2 * i], m[1] + 0.2 * noise[2 * i + 1]]
        })
        .collect();
    let distances = DistanceMatrix::euclidean(&points, 2).unwrap();
    let ratio = |c_ctn: f64| {
        let options = SpatioTemporal {
            neighbours: 15,
            c_ctn,
            ..SpatioTemporal::default()
        };
        let graph = NeighbourGraph::segmented(&distances, &chain(100), &options).unwrap();
        let geodesics = graph.geodesics();
        let mean = |a: usize, b: usize| {
            let pairs = (0..20).flat_map(|r| (0..20).map(move |s| (5 * r + a, 5 * s + b)));
            let lengths: Vec<f64> = pairs
                .filter(|(i, j)| i != j)
                .map(|(i, j)| geodesics.get(i, j))
                .collect();
            lengths.iter().sum::<f64>() / lengths.len() as f64
        };
        mean(0, 2) / mean(0, 0).max(mean(2, 2))
    };
    let (plain, drawn) = (ratio(1.0), ratio(1e3));
    assert!(plain < 2.5, "{plain}");
    assert!(drawn > 5.0 * plain, "{drawn} after {plain}");
}

#[test]
fn huge_factors_leave_every_edge_a_length() {
    let distances = DistanceMatrix::euclidean(&ring(60), 2).unwrap();
    let options = SpatioTemporal {
        c_ctn: 1e12,
        ..SpatioTemporal::default()
    };
    let graph = NeighbourGraph::segmented(&distances, &chain(60), &options).unwrap();
    let shortest = graph
        .edges()
        .iter()
        .map(|e| e.length)
        .fold(f64::MAX, f64::min);
    assert!(shortest > 1e-8, "{shortest}");
}

#[test]
fn broken_input_is_refused() {
    let distances = DistanceMatrix::euclidean(&cloud(5, 2, 1), 2).unwrap();
    let build = |next: &[Option<usize>], options: &SpatioTemporal| {
        NeighbourGraph::segmented(&distances, next, options)
    };
    let good = SpatioTemporal::isomap(2);
    let with = |change: fn(&mut SpatioTemporal)| {
        let mut options = good.clone();
        change(&mut options);
        build(&[None; 5], &options).err()
    };
    let sparse = Neighbours::new(vec![vec![(1, 1.0)], vec![], vec![]]).unwrap();
    let unknown =
        NeighbourGraph::segmented(&sparse, &[None, Some(2), None], &SpatioTemporal::default());
    let graph = build(&[None; 5], &good).unwrap();
    let options = |dimension, landmarks| EmbedOptions {
        dimension,
        landmarks,
        ..EmbedOptions::default()
    };
    let results = [
        ("too few successors", build(&[None; 4], &good).err()),
        (
            "own successor",
            build(&[Some(0), None, None, None, None], &good).err(),
        ),
        (
            "two before one",
            build(&[Some(2), Some(2), None, None, None], &good).err(),
        ),
        (
            "no such successor",
            build(&[Some(5), None, None, None, None], &good).err(),
        ),
        ("no neighbours", with(|o| o.neighbours = 0)),
        ("small factor", with(|o| o.c_ctn = 0.5)),
        ("factor not a number", with(|o| o.c_atn = f64::NAN)),
        ("radius of nothing", with(|o| o.radius = Some(0.0))),
        ("unknown distance to the successor", unknown.err()),
        ("no dimension", embed(&graph, &options(Some(0), None)).err()),
        ("no landmarks", embed(&graph, &options(None, Some(0))).err()),
        (
            "too many landmarks",
            embed(&graph, &options(None, Some(6))).err(),
        ),
        (
            "itself a neighbour",
            Neighbours::new(vec![vec![(0, 1.0)]]).err(),
        ),
        (
            "named twice",
            Neighbours::new(vec![vec![(1, 1.0), (1, 2.0)], vec![]]).err(),
        ),
    ];
    for (what, error) in results {
        assert!(error.is_some_and(|e| e.is_invalid()), "{what}");
    }
}

/// Whether `j` is a common temporal neighbour of `i`, from the words of the rule.
fn common_of(
    among: &dyn Fn(usize, usize, usize) -> bool,
    next: &[Option<usize>],
    before: &[Option<usize>],
    rule: TemporalRule,
    wide: usize,
    i: usize,
    j: usize,
) -> bool {
    let side = |list: &[Option<usize>]| list[i].zip(list[j]).map(|(a, b)| among(a, b, wide));
    let (forward, backward) = (side(next), side(before));
    let (f, b) = (forward.unwrap_or(false), backward.unwrap_or(false));
    among(i, j, wide)
        && match rule {
            TemporalRule::Forward => f,
            TemporalRule::Backward => b,
            TemporalRule::Both => f && b,
            TemporalRule::Either => f || b,
            TemporalRule::Known => {
                (f || forward.is_none()) && (b || backward.is_none()) && (f || b)
            }
        }
}
