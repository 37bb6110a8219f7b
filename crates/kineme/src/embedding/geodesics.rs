//! Shortest paths through a neighbourhood graph: Dijkstra's method from every item, or from landmarks.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::graph::NeighbourGraph;
use crate::error::{Error, Result};
use crate::math::distances::DistanceMatrix;

/// Distances along the graph, infinite between components.
#[derive(Debug, Clone)]
pub enum Geodesics {
    /// Between all items.
    All(DistanceMatrix),
    /// From landmarks to all items: 8 bytes for each landmark and item.
    Landmarks(LandmarkDistances),
}

/// Geodesic distances from some items to all.
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkDistances {
    /// The landmarks, in the order of their choice.
    pub landmarks: Vec<usize>,
    /// `rows[l][i]`: from landmark `l` to item `i`.
    pub rows: Vec<Vec<f64>>,
}

impl Geodesics {
    /// The matrix of all pairs, unless only landmarks were followed.
    pub fn matrix(&self) -> Option<&DistanceMatrix> {
        match self {
            Geodesics::All(matrix) => Some(matrix),
            Geodesics::Landmarks(_) => None,
        }
    }
}

impl NeighbourGraph {
    /// Shortest paths between all items: 4 n^2 bytes; O(n (e + n log n)) steps, sources in parallel.
    pub fn geodesics(&self) -> DistanceMatrix {
        let mut matrix = DistanceMatrix::filled(self.len(), 0.0);
        matrix
            .upper_rows_mut()
            .into_par_iter()
            .enumerate()
            .for_each_init(
                || Dijkstra::new(self.len()),
                |search, (source, row)| {
                    search.run(self, source);
                    row.copy_from_slice(&search.distances[source + 1..]);
                },
            );
        matrix
    }

    /// Shortest paths from `count` landmarks, each the item farthest from those before it (max-min, de Silva and
    /// Tenenbaum 2004), beginning with the item farthest from item 0. Items out of reach count as farthest.
    ///
    /// # Errors
    /// Without landmarks or with more than there are items.
    pub fn landmark_geodesics(&self, count: usize) -> Result<LandmarkDistances> {
        let len = self.len();
        if count == 0 || count > len {
            return Err(Error::invalid(format!(
                "1 to {len} landmarks can be chosen, found {count}"
            )));
        }
        let farthest = |d: &[f64]| (0..len).max_by(|&a, &b| d[a].total_cmp(&d[b]).then(b.cmp(&a)));
        let mut search = Dijkstra::new(len);
        search.run(self, 0);
        let mut landmarks = Vec::with_capacity(count);
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count);
        let mut to_chosen = search.distances.clone();
        while landmarks.len() < count {
            let next = farthest(&to_chosen).unwrap_or(0);
            search.run(self, next);
            if landmarks.is_empty() {
                to_chosen.fill(f64::INFINITY);
            }
            landmarks.push(next);
            for (best, &d) in to_chosen.iter_mut().zip(&search.distances) {
                *best = best.min(d);
            }
            // Below every distance: no item is chosen twice, even among items at distance zero.
            to_chosen[next] = -1.0;
            rows.push(search.distances.clone());
        }
        Ok(LandmarkDistances { landmarks, rows })
    }
}

/// One search, its memory used again from source to source.
struct Dijkstra {
    distances: Vec<f64>,
    /// Keys are the bits of distances: for non-negative floats their order is the order of the numbers.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Dijkstra {
    fn new(len: usize) -> Self {
        Self {
            distances: vec![f64::INFINITY; len],
            queue: BinaryHeap::new(),
        }
    }

    fn run(&mut self, graph: &NeighbourGraph, source: usize) {
        self.distances.fill(f64::INFINITY);
        self.distances[source] = 0.0;
        self.queue.push(Reverse((0, source as u32)));
        while let Some(Reverse((key, item))) = self.queue.pop() {
            let reached = f64::from_bits(key);
            let item = item as usize;
            if reached > self.distances[item] {
                continue;
            }
            for (to, length) in graph.neighbours(item) {
                let through = reached + length;
                if through < self.distances[to] {
                    self.distances[to] = through;
                    self.queue.push(Reverse((through.to_bits(), to as u32)));
                }
            }
        }
    }
}
