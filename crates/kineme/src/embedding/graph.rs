//! The neighbourhood graph of segments, shortened where neighbours share their future or past.

use rayon::prelude::*;

use super::components;
use crate::error::{Error, Result};
use crate::math::distances::{DistanceMatrix, Neighbours};
use crate::math::partition::UnionFind;
use crate::math::statistics::{median, quantile};

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

/// Distances as a graph may be given them.
#[derive(Debug, Clone, Copy)]
pub enum Distances<'a> {
    /// Of all pairs: up to about 8,000 items.
    Dense(&'a DistanceMatrix),
    /// Of the nearest candidates alone; an item and its successor must be candidates, one of the other.
    Sparse(&'a Neighbours),
}

impl<'a> From<&'a DistanceMatrix> for Distances<'a> {
    fn from(matrix: &'a DistanceMatrix) -> Self {
        Distances::Dense(matrix)
    }
}

impl<'a> From<&'a Neighbours> for Distances<'a> {
    fn from(candidates: &'a Neighbours) -> Self {
        Distances::Sparse(candidates)
    }
}

impl Distances<'_> {
    fn len(&self) -> usize {
        match self {
            Distances::Dense(matrix) => matrix.len(),
            Distances::Sparse(candidates) => candidates.len(),
        }
    }

    fn between(&self, a: usize, b: usize) -> Option<f64> {
        match self {
            Distances::Dense(matrix) => Some(matrix.get(a, b)).filter(|d| d.is_finite()),
            Distances::Sparse(candidates) => candidates.distance(a, b),
        }
    }

    fn nearest(&self, k: usize) -> Neighbours {
        match self {
            Distances::Dense(matrix) => Neighbours::nearest(matrix, k),
            Distances::Sparse(candidates) => candidates.truncated(k),
        }
    }
}

/// When a neighbour `y` of `x` is a common temporal neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TemporalRule {
    /// When next(y) is a neighbour of next(x).
    Forward,
    /// When previous(y) is a neighbour of previous(x).
    Backward,
    /// When both hold.
    Both,
    /// When at least one holds.
    Either,
}

impl TemporalRule {
    pub(super) fn holds(self, forward: bool, backward: bool) -> bool {
        match self {
            TemporalRule::Forward => forward,
            TemporalRule::Backward => backward,
            TemporalRule::Both => forward && backward,
            TemporalRule::Either => forward || backward,
        }
    }
}

/// The segmented form of spatio-temporal Isomap: how neighbours are found and drawn together.
///
/// An edge of distance D becomes `D / (c_ctn^[common temporal neighbours] * c_atn^[adjacent in time])`.
/// Infinite `c_ctn` would collapse all that share their course; 1 is plain Isomap.
#[derive(Debug, Clone, PartialEq)]
pub struct SpatioTemporal {
    /// K, the size of a neighbourhood: about half the smallest group worth finding (3 for strokes of one recording,
    /// 8 for collections of clips). At least 1.
    pub neighbours: usize,
    /// Divisor of edges between common temporal neighbours, 1 or more; 10 to 100 are useful.
    pub c_ctn: f64,
    /// Divisor of edges between items adjacent in one recording, 1 or more; 1 is neutral.
    pub c_atn: f64,
    /// What makes a neighbour a common temporal one.
    pub rule: TemporalRule,
    /// Whether the rule must hold in both directions, not in either.
    pub mutual: bool,
    /// Common temporal neighbours lie within this many median nearest distances; `None` for anywhere.
    pub radius: Option<f64>,
    /// Whether adjacent items are joined even where they are not near.
    pub chain: bool,
}

impl Default for SpatioTemporal {
    fn default() -> Self {
        Self {
            neighbours: 8,
            c_ctn: 100.0,
            c_atn: 1.0,
            rule: TemporalRule::Forward,
            mutual: false,
            radius: None,
            chain: true,
        }
    }
}

impl SpatioTemporal {
    /// Plain Isomap (Tenenbaum, de Silva and Langford 2000) on `neighbours` neighbours: time is ignored.
    pub fn isomap(neighbours: usize) -> Self {
        Self {
            neighbours,
            c_ctn: 1.0,
            chain: false,
            ..Self::default()
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        if self.neighbours == 0 {
            return Err(Error::invalid("a neighbourhood needs at least 1 neighbour"));
        }
        check_factors(self.c_ctn, self.c_atn, self.radius)
    }
}

pub(super) fn check_factors(c_ctn: f64, c_atn: f64, radius: Option<f64>) -> Result<()> {
    for (name, c) in [("c_ctn", c_ctn), ("c_atn", c_atn)] {
        if !(c.is_finite() && c >= 1.0) {
            return Err(Error::invalid(format!("{name} is 1 or more, found {c}")));
        }
    }
    match radius {
        Some(r) if !(r.is_finite() && r > 0.0) => {
            Err(Error::invalid(format!("a radius is positive, found {r}")))
        }
        _ => Ok(()),
    }
}

/// A directed observation of an edge, before both directions are merged.
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
    /// The graph of segments: each joined with its K nearest and, where `chain` says so, with its successor.
    ///
    /// `successors[i]` is the item that follows `i` inside one true recording, if any.
    ///
    /// # Errors
    /// With fewer than two items, with successors that are no chains, with factors below 1, or when the distance of
    /// an item to its successor is not known.
    pub fn segmented<'a>(
        distances: impl Into<Distances<'a>>,
        successors: &[Option<usize>],
        options: &SpatioTemporal,
    ) -> Result<Self> {
        let distances = distances.into();
        options.check()?;
        let len = distances.len();
        let previous = predecessors(successors, len)?;
        let near = distances.nearest(options.neighbours);
        let nearest = nearest_distances(&near);
        let reach = options
            .radius
            .zip(median(&nearest))
            .map_or(f64::INFINITY, |(r, m)| r * m);
        let follow =
            |x: Option<usize>, y: Option<usize>| x.zip(y).is_some_and(|(x, y)| near.contains(x, y));
        let mut marks: Vec<Mark> = (0..len)
            .into_par_iter()
            .flat_map_iter(|x| near.of(x).iter().map(move |&(y, d)| (x, y, d)))
            .map(|(x, y, distance)| Mark {
                from: x,
                to: y,
                distance,
                common: distance <= reach
                    && options.rule.holds(
                        follow(successors[x], successors[y]),
                        follow(previous[x], previous[y]),
                    ),
                adjacent: successors[x] == Some(y) || successors[y] == Some(x),
            })
            .collect();
        if options.chain {
            for (x, next) in successors.iter().enumerate() {
                let Some(y) = *next else { continue };
                let distance = distances.between(x, y).ok_or_else(|| {
                    Error::invalid(format!(
                        "item {y} follows {x}, but their distance is not given or infinite"
                    ))
                })?;
                marks.push(Mark {
                    from: x,
                    to: y,
                    distance,
                    common: false,
                    adjacent: true,
                });
            }
        }
        let (c_ctn, c_atn) = (options.c_ctn, options.c_atn);
        let mut graph = Self::from_marks(len, marks, c_ctn, c_atn, options.mutual);
        graph.reach = reach;
        graph.novelty = quantile(&nearest, 0.99).unwrap_or(f64::INFINITY);
        if graph.labels.iter().any(|l| *l > 0) {
            graph.bridges = match distances {
                Distances::Dense(matrix) => components::bridges_of_matrix(matrix, &graph.labels),
                Distances::Sparse(candidates) => {
                    let edges = (0..len).flat_map(|a| {
                        let pair = move |&(b, d): &(usize, f64)| Edge::new(a, b, d);
                        candidates.of(a).iter().map(pair)
                    });
                    components::bridges_of_edges(edges.collect(), &graph.labels)
                }
            };
        }
        Ok(graph)
    }

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
                    *both |= edge.from != mark.from && edge.common && mark.common;
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

/// The distance of each item that has a neighbour to its nearest one.
pub(super) fn nearest_distances(near: &Neighbours) -> Vec<f64> {
    (0..near.len())
        .filter_map(|i| near.of(i).first().map(|n| n.1))
        .collect()
}

/// The item before each one, from the item after each one.
fn predecessors(successors: &[Option<usize>], len: usize) -> Result<Vec<Option<usize>>> {
    if len < 2 || successors.len() != len {
        return Err(Error::invalid(format!(
            "a graph needs two items or more and a successor or none for each, found {len} and {}",
            successors.len()
        )));
    }
    let mut previous = vec![None; len];
    for (x, next) in successors.iter().enumerate() {
        let Some(y) = *next else { continue };
        if y >= len || y == x || previous[y].is_some() {
            return Err(Error::invalid(format!(
                "successors form chains over {len} items, but {y} is said to follow {x}"
            )));
        }
        previous[y] = Some(x);
    }
    Ok(previous)
}
