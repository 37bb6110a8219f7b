//! The neighbourhood graph: undirected edges between items and their lengths.

use crate::math::partition::UnionFind;
use crate::math::statistics::median;

/// No edge is shorter than this share of the median distance, or very large factors would make all paths equal.
const SHORTEST_SHARE: f64 = 1e-6;

/// An undirected edge of a graph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// One item.
    pub a: usize,
    /// The other, larger.
    pub b: usize,
    /// Its length, in the unit of the distances.
    pub length: f64,
}

/// A directed observation of an edge, before both directions are merged. Each direction is at most once `common`.
pub(super) struct Mark {
    pub from: usize,
    pub to: usize,
    pub distance: f64,
    pub common: bool,
    pub adjacent: bool,
}

/// An undirected graph over items with the lengths of its edges, in compressed rows.
#[derive(Debug, Clone)]
pub struct NeighbourGraph {
    offsets: Vec<usize>,
    targets: Vec<u32>,
    lengths: Vec<f64>,
    pub(super) common_edges: usize,
    /// How far a common temporal neighbour may be.
    pub(super) reach: f64,
    pub(super) novelty: f64,
    pub(super) labels: Vec<usize>,
    pub(super) bridges: Vec<Edge>,
}

impl NeighbourGraph {
    /// Merges the two directions of each edge, shortens and packs them.
    pub(super) fn from_marks(
        len: usize,
        mut marks: Vec<Mark>,
        c_ctn: f64,
        c_atn: f64,
        mutual: bool,
    ) -> Self {
        let pair = |m: &Mark| (m.from.min(m.to), m.from.max(m.to));
        marks.sort_by_key(|m| (pair(m), m.from));
        let mut merged: Vec<(Mark, bool)> = Vec::with_capacity(marks.len());
        for mark in marks {
            match merged.last_mut() {
                Some((edge, both)) if pair(edge) == pair(&mark) => {
                    *both |= edge.common && mark.common;
                    edge.common |= mark.common;
                    edge.adjacent |= mark.adjacent;
                }
                _ => merged.push((mark, false)),
            }
        }
        let raw: Vec<f64> = merged.iter().map(|(m, _)| m.distance).collect();
        let shortest = SHORTEST_SHARE * median(&raw).unwrap_or(0.0);
        let mut common_edges = 0;
        let edges: Vec<Edge> = merged
            .iter()
            .map(|(m, both)| {
                let common = if mutual { *both } else { m.common };
                common_edges += usize::from(common);
                let ctn = if common { c_ctn } else { 1.0 };
                let atn = if m.adjacent { c_atn } else { 1.0 };
                Edge::new(m.from, m.to, (m.distance / (ctn * atn)).max(shortest))
            })
            .collect();
        Self {
            common_edges,
            ..Self::from_edges(len, &edges)
        }
    }

    /// A graph of `len` items with exactly these edges, each named once.
    pub(super) fn from_edges(len: usize, edges: &[Edge]) -> Self {
        let mut offsets = vec![0; len + 1];
        let mut sets = UnionFind::new(len);
        for e in edges {
            offsets[e.a + 1] += 1;
            offsets[e.b + 1] += 1;
            sets.join(e.a, e.b);
        }
        for i in 0..len {
            offsets[i + 1] += offsets[i];
        }
        let mut free = offsets.clone();
        let mut targets = vec![0; 2 * edges.len()];
        let mut lengths = vec![0.0; 2 * edges.len()];
        for e in edges {
            for (from, to) in [(e.a, e.b), (e.b, e.a)] {
                targets[free[from]] = to as u32;
                lengths[free[from]] = e.length;
                free[from] += 1;
            }
        }
        Self {
            offsets,
            targets,
            lengths,
            common_edges: 0,
            reach: f64::INFINITY,
            novelty: f64::INFINITY,
            labels: sets.labels(),
            bridges: Vec::new(),
        }
    }

    /// The same but for other edges, and perhaps items.
    pub(super) fn with_edges(&self, len: usize, edges: &[Edge]) -> Self {
        Self {
            common_edges: self.common_edges,
            reach: self.reach,
            novelty: self.novelty,
            ..Self::from_edges(len, edges)
        }
    }

    /// The number of items.
    pub fn len(&self) -> usize {
        self.labels.len()
    }

    /// True without items.
    pub fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// The neighbours of an item and the lengths of the edges to them.
    ///
    /// # Panics
    /// When `i` is not below [`Self::len`].
    pub fn neighbours(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.offsets[i]..self.offsets[i + 1];
        let targets = self.targets[range.clone()].iter().map(|&t| t as usize);
        targets.zip(self.lengths[range].iter().copied())
    }

    /// Every edge once, by its smaller, then its larger item.
    pub fn edges(&self) -> Vec<Edge> {
        let mut edges: Vec<Edge> = (0..self.len())
            .flat_map(|a| self.neighbours(a).map(move |(b, d)| (a, b, d)))
            .filter(|(a, b, _)| a < b)
            .map(|(a, b, length)| Edge { a, b, length })
            .collect();
        edges.sort_by_key(|e| (e.a, e.b));
        edges
    }

    /// How many edges join common temporal neighbours.
    pub fn common_edges(&self) -> usize {
        self.common_edges
    }

    /// The connected component of every item, numbered in the order of first appearance.
    pub fn components(&self) -> &[usize] {
        &self.labels
    }

    /// A new item farther than this from all known ones is novel: the 99th percentile of nearest distances.
    pub fn novelty_threshold(&self) -> f64 {
        self.novelty
    }
}

impl Edge {
    pub(super) fn new(a: usize, b: usize, length: f64) -> Self {
        Self {
            a: a.min(b),
            b: a.max(b),
            length,
        }
    }
}
