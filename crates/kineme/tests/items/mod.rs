//! Items to embed, and how values are compared.
#![allow(dead_code, reason = "every test file uses its part")]

use kineme::embedding::{NeighbourGraph, SpatioTemporal};
use kineme::math::distances::DistanceMatrix;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::Value;

/// Holds a value to what it should be, within a tolerance relative to numbers above 1.
pub fn check(what: &str, found: f64, expected: f64, tolerance: f64) {
    let scale = expected.abs().max(1.0);
    assert!(
        (found - expected).abs() <= tolerance * scale,
        "{what}: {found}, expected {expected}"
    );
}

/// Points in a box, from a seed.
pub fn cloud(len: usize, dimension: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(seed);
    (0..len * dimension)
        .map(|_| random.random_range(-1.0..1.0))
        .collect()
}

/// One chain over all items.
pub fn chain(len: usize) -> Vec<Option<usize>> {
    (0..len).map(|i| (i + 1 < len).then_some(i + 1)).collect()
}

/// Distances of points and their plain Isomap graph.
pub fn plain(points: &[f64], dimension: usize, k: usize) -> (DistanceMatrix, NeighbourGraph) {
    let distances = DistanceMatrix::euclidean(points, dimension).unwrap();
    let none = vec![None; distances.len()];
    let graph = NeighbourGraph::segmented(&distances, &none, &SpatioTemporal::isomap(k)).unwrap();
    (distances, graph)
}

/// A number of a JSON object.
pub fn at(value: &Value, key: &str) -> f64 {
    value[key].as_f64().expect("a number")
}
