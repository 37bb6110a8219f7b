//! Coordinates from geodesics: against other libraries, landmarks, components, new items.

mod items;
mod oracles;

use items::{at, chain, check, cloud, plain};
use kineme::embedding::{
    Disconnected, EmbedOptions, Geodesics, NeighbourGraph, NewItem, SpatioTemporal, classical_mds,
    embed, residual_variance,
};
use kineme::math::distances::DistanceMatrix;
use oracles::{numbers, oracle};

#[test]
fn swiss_roll_equals_scikit_learn() {
    let Some(file) = oracle("isomap.json") else {
        return;
    };
    let roll = &file["swiss_roll"];
    let (_, graph) = plain(&numbers(&roll["points"]), 3, 8);
    assert_eq!(graph.edges().len() as f64, at(roll, "edges_undirected"));
    let options = EmbedOptions {
        dimension: Some(5),
        ..EmbedOptions::default()
    };
    let (embedding, geodesics) = embed(&graph, &options).unwrap();
    let matrix = geodesics.matrix().unwrap();
    let expected = &roll["geodesic"];
    let sum: f64 = matrix.upper().iter().sum();
    let squares: f64 = matrix.upper().iter().map(|d| d * d).sum();
    check("sum", sum, at(expected, "sum_upper"), 1e-6);
    check("squares", squares, at(expected, "sum_squares_upper"), 1e-6);
    let samples = numbers(&expected["samples"]);
    for s in samples.chunks(3) {
        let (i, j) = (s[0] as usize, s[1] as usize);
        check("geodesic", matrix.get(i, j), s[2], 1e-6);
    }
    let values = numbers(&roll["eigenvalues_top8"]);
    for (found, expected) in embedding.eigenvalues.iter().zip(&values) {
        check("eigenvalue", *found, *expected, 1e-6);
    }
    let positive = 0.5 * squares / 200.0 * 2.0 - at(roll, "eigenvalues_negative_sum");
    let negative = -at(roll, "eigenvalues_negative_sum");
    let share = negative / (positive + negative);
    check("negative share", embedding.negative_share, share, 1e-6);
    for d in 1..=5 {
        let key = d.to_string();
        let expected = at(&roll["residual_variance_upper"], &key);
        check(
            "residual",
            embedding.residual_variance[d - 1],
            expected,
            1e-6,
        );
        let distances = numbers(&roll["embedding_distances"][&key]);
        for (s, expected) in samples.chunks(3).zip(distances) {
            let (a, b) = (
                embedding.point(s[0] as usize),
                embedding.point(s[1] as usize),
            );
            let squares: f64 = (0..d).map(|k| (a[k] - b[k]).powi(2)).sum();
            check("embedded distance", squares.sqrt(), expected, 1e-6);
        }
    }
}

#[test]
fn classical_scaling_equals_numpy() {
    let Some(file) = oracle("pca_mds.json") else {
        return;
    };
    let points = numbers(&file["points"]);
    let distances = DistanceMatrix::euclidean(&points, 6).unwrap();
    let found = classical_mds(&distances, 6).unwrap();
    for (found, expected) in found
        .eigenvalues
        .iter()
        .zip(numbers(&file["mds_eigenvalues"]))
    {
        check("eigenvalue", *found, expected, 1e-8);
    }
    let city = DistanceMatrix::from_fn(25, |i, j| {
        (0..6)
            .map(|d| (points[i * 6 + d] - points[j * 6 + d]).abs())
            .sum()
    })
    .unwrap();
    let values = numbers(&file["cityblock"]["eigenvalues"]);
    let found = classical_mds(&city, 25).unwrap();
    for (found, expected) in found.eigenvalues.iter().zip(&values) {
        check("city block eigenvalue", *found, *expected, 1e-8);
    }
    let negative: f64 = values.iter().map(|v| (-v).max(0.0)).sum();
    let all: f64 = values.iter().map(|v| v.abs()).sum();
    check("share", found.negative_share, negative / all, 1e-8);
}

#[test]
fn euclidean_distances_are_reproduced() {
    // The larger set goes through the iterative eigenpairs.
    for (len, dimension) in [(3, 1), (40, 3), (1100, 4)] {
        let distances = DistanceMatrix::euclidean(&cloud(len, dimension, 1), dimension).unwrap();
        let found = classical_mds(&distances, dimension + 2).unwrap();
        assert_eq!(found.dimension, dimension);
        let again = DistanceMatrix::euclidean(&found.coordinates, dimension).unwrap();
        for (a, b) in again.upper().iter().zip(distances.upper()) {
            check("distance", *a, *b, 1e-9);
        }
        assert!(found.negative_share < 1e-9, "{}", found.negative_share);
        let residual = residual_variance(&distances, &found.coordinates, dimension).unwrap();
        assert!(residual[dimension - 1] < 1e-9);
    }
}

/// Equally spaced items on a circle, by the length of the shorter arc: double eigenvalues and negative ones, known
/// from the discrete Fourier transform of the squares.
#[test]
fn iterative_eigenpairs_find_double_eigenvalues() {
    let len = 1201usize;
    let arc = |i: usize, j: usize| {
        let steps = i.abs_diff(j);
        steps.min(len - steps) as f64
    };
    let circle = DistanceMatrix::from_fn(len, arc).unwrap();
    let found = classical_mds(&circle, 8).unwrap();
    let mut spectrum: Vec<f64> = (1..len)
        .map(|f| {
            let turn = std::f64::consts::TAU * f as f64 / len as f64;
            let terms = (0..len).map(|s| arc(0, s).powi(2) * (turn * s as f64).cos());
            -0.5 * terms.sum::<f64>()
        })
        .collect();
    spectrum.sort_unstable_by(|a, b| b.total_cmp(a));
    for (found, expected) in found.eigenvalues.iter().zip(&spectrum) {
        check("eigenvalue", *found, *expected, 1e-9);
    }
    let negative: f64 = spectrum.iter().map(|v| (-v).max(0.0)).sum();
    let all: f64 = spectrum.iter().map(|v| v.abs()).sum();
    let share = negative / all;
    assert!(
        (found.negative_share - share).abs() < 0.005,
        "{} for {share}",
        found.negative_share
    );
}

/// Four clusters of items on a line, far apart, each one connected.
fn four_parts() -> (DistanceMatrix, NeighbourGraph) {
    let mut points = Vec::new();
    for (offset, size) in [(0.0, 6), (100.0, 12), (250.0, 9), (260.0, 5)] {
        points.extend((0..size).map(|i| offset + f64::from(i) * 0.5));
    }
    plain(&points, 1, 2)
}

#[test]
fn components_are_joined_by_the_shortest_edges() {
    let (_, graph) = four_parts();
    let (embedding, geodesics) = embed(&graph, &EmbedOptions::default()).unwrap();
    let mut lengths: Vec<f64> = embedding.synthetic_edges.iter().map(|e| e.length).collect();
    lengths.sort_unstable_by(f64::total_cmp);
    assert_eq!(lengths, [6.0, 97.5, 144.5]);
    assert_eq!(embedding.components.iter().max(), Some(&3));
    // On a line the geodesics are the distances themselves.
    check("ends", geodesics.matrix().unwrap().get(0, 31), 262.0, 1e-12);
    assert_eq!(embedding.dimension, 1);
}

#[test]
fn components_are_taken_alone_or_apart_when_asked() {
    let (_, graph) = four_parts();
    let of = |disconnected| EmbedOptions {
        disconnected,
        ..EmbedOptions::default()
    };
    let (largest, geodesics) = embed(&graph, &of(Disconnected::Largest)).unwrap();
    assert_eq!(largest.items, (6..18).collect::<Vec<_>>());
    assert_eq!(largest.coordinates.len(), 12 * largest.dimension);
    assert_eq!(geodesics.matrix().unwrap().len(), 12);
    let (apart, geodesics) = embed(&graph, &of(Disconnected::Separate)).unwrap();
    assert!(apart.synthetic_edges.is_empty() && apart.items.len() == 32);
    assert!(geodesics.matrix().unwrap().get(0, 31).is_infinite());
    let x: Vec<f64> = (0..32).map(|i| apart.point(i)[0]).collect();
    for (items, extent) in [(0..6, 2.5), (6..18, 5.5), (18..27, 4.0), (27..32, 2.0)] {
        let ends = items.clone().map(|i| x[i]);
        let low = ends.clone().fold(f64::MAX, f64::min);
        let high = ends.fold(f64::MIN, f64::max);
        check("extent", high - low, extent, 1e-9);
        let inside = |i: &usize| x[*i] > low - 5.0 && x[*i] < high + 5.0;
        assert_eq!((0..32).filter(inside).count(), items.len());
    }
    let landmarks = EmbedOptions {
        landmarks: Some(20),
        ..of(Disconnected::Separate)
    };
    assert!(embed(&graph, &landmarks).unwrap_err().is_unsupported());
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

#[test]
fn all_items_as_landmarks_equal_classical_scaling() {
    let (_, graph) = plain(&ring(90), 2, 5);
    let of = |landmarks| EmbedOptions {
        dimension: Some(4),
        landmarks,
        ..EmbedOptions::default()
    };
    let (all, _) = embed(&graph, &of(None)).unwrap();
    let (marked, geodesics) = embed(&graph, &of(Some(90))).unwrap();
    assert!(geodesics.matrix().is_none() && all.landmarks.is_none());
    let mut landmarks = marked.landmarks.clone().unwrap();
    landmarks.sort_unstable();
    assert_eq!(landmarks, all.items);
    for (a, b) in marked.coordinates.iter().zip(&all.coordinates) {
        check("coordinate", *a, *b, 1e-8);
    }
    let (few, _) = embed(&graph, &of(Some(40))).unwrap();
    let spread = |e: &kineme::embedding::Embedding| {
        let d = DistanceMatrix::euclidean(&e.coordinates, 4).unwrap();
        d.upper().to_vec()
    };
    for (a, b) in spread(&few).iter().zip(spread(&all)) {
        assert!((a - b).abs() < 0.4, "{a} {b}");
    }
}

#[test]
fn a_training_item_placed_again_returns_to_its_coordinates() {
    let points = ring(90);
    let distances = DistanceMatrix::euclidean(&points, 2).unwrap();
    let next = chain(90);
    let options = SpatioTemporal {
        neighbours: 5,
        c_ctn: 10.0,
        ..SpatioTemporal::default()
    };
    let graph = NeighbourGraph::segmented(&distances, &next, &options).unwrap();
    let row = |i: usize| -> Vec<f64> { (0..90).map(|j| distances.get(i, j)).collect() };
    for landmarks in [None, Some(30)] {
        let embed_options = EmbedOptions {
            dimension: Some(2),
            landmarks,
            ..EmbedOptions::default()
        };
        let (embedding, geodesics) = embed(&graph, &embed_options).unwrap();
        for i in [1, 44, 88] {
            let (own, before, after) = (row(i), row(i - 1), row(i + 1));
            let item = NewItem {
                distances: &own,
                previous: Some(&before),
                next: Some(&after),
            };
            let links = graph.links(&item, &next, &options).unwrap();
            let placed = embedding.place(&geodesics, &links).unwrap();
            assert!(!placed.novel);
            for (a, b) in placed.coordinates.iter().zip(embedding.point(i)) {
                check("coordinate", *a, *b, 1e-9);
            }
        }
        let far = vec![50.0; 90];
        let item = NewItem {
            distances: &far,
            previous: None,
            next: None,
        };
        let links = graph.links(&item, &next, &options).unwrap();
        assert!(embedding.place(&geodesics, &links).unwrap().novel);
    }
}

#[test]
fn a_new_item_between_two_lies_between_them() {
    // On a line geodesics are exact, so is the place.
    let points: Vec<f64> = (0..21).map(f64::from).collect();
    let (_, graph) = plain(&points, 1, 2);
    let own: Vec<f64> = points.iter().map(|p| (p - 8.3).abs()).collect();
    let item = NewItem {
        distances: &own,
        previous: None,
        next: None,
    };
    let links = graph
        .links(&item, &[None; 21], &SpatioTemporal::isomap(2))
        .unwrap();
    for landmarks in [None, Some(12)] {
        let options = EmbedOptions {
            landmarks,
            ..EmbedOptions::default()
        };
        let (embedding, geodesics) = embed(&graph, &options).unwrap();
        let placed = embedding.place(&geodesics, &links).unwrap();
        let (a, b) = (embedding.point(8)[0], embedding.point(9)[0]);
        check("place", placed.coordinates[0], a + 0.3 * (b - a), 1e-9);
    }
}

#[test]
fn landmarks_are_distinct_even_where_items_coincide() {
    let points = [vec![0.0; 6], vec![1.0; 6]].concat();
    let (_, graph) = plain(&points, 1, 3);
    let mut chosen = graph.joined().landmark_geodesics(12).unwrap().landmarks;
    chosen.sort_unstable();
    assert_eq!(chosen, (0..12).collect::<Vec<_>>());
}

#[test]
fn two_threads_give_the_bits_of_one() {
    let points = ring(1300);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let (_, graph) = plain(&points, 2, 6);
            let (embedding, geodesics) = embed(&graph, &EmbedOptions::default()).unwrap();
            let Geodesics::All(matrix) = geodesics else {
                panic!("all items");
            };
            (embedding, matrix)
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn spectra_without_a_second_axis_are_served() {
    // Above 1,000 items the iterative method meets a space that is exhausted at once.
    for len in [4, 1050] {
        let same = DistanceMatrix::from_fn(len, |_, _| 0.0).unwrap();
        let found = classical_mds(&same, 3).unwrap();
        assert_eq!(found.coordinates, vec![0.0; len]);
        let simplex = DistanceMatrix::from_fn(len, |_, _| 1.0).unwrap();
        for value in classical_mds(&simplex, 3).unwrap().eigenvalues {
            check("eigenvalue", value, 0.5, 1e-12);
        }
    }
}
