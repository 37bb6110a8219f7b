//! The segmented form: each item is a segment, drawn to those that are followed or preceded alike.

use rayon::prelude::*;

use super::components;
use super::graph::{Edge, Mark, NeighbourGraph};
use crate::error::{Error, Result};
use crate::math::distances::{DistanceMatrix, Neighbours};
use crate::math::statistics::{median, quantile};

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
    /// When both hold as far as both segments have a predecessor and a successor, and they share at least one side.
    Known,
}

impl TemporalRule {
    /// Whether the rule holds; `None` for a side that one of the two segments lacks.
    pub(super) fn holds(self, forward: Option<bool>, backward: Option<bool>) -> bool {
        let (next, before) = (forward == Some(true), backward == Some(true));
        match self {
            TemporalRule::Forward => next,
            TemporalRule::Backward => before,
            TemporalRule::Both => next && before,
            TemporalRule::Either => next || before,
            TemporalRule::Known => {
                (next || before) && forward != Some(false) && backward != Some(false)
            }
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
    /// How many nearest may be common temporal neighbours, and count as near for their predecessors and successors;
    /// `None` for K. Those beyond K are joined only where the rule holds.
    pub temporal_neighbours: Option<usize>,
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
            temporal_neighbours: None,
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
        if self.neighbours == 0 || self.temporal_neighbours == Some(0) {
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
        let wide = options.temporal_neighbours.unwrap_or(options.neighbours);
        let near = distances.nearest(wide.max(options.neighbours));
        let nearest = nearest_distances(&near);
        let reach = options
            .radius
            .zip(median(&nearest))
            .map_or(f64::INFINITY, |(r, m)| r * m);
        let near_in_time = near.truncated(wide);
        let follow =
            |x: Option<usize>, y: Option<usize>| x.zip(y).map(|(x, y)| near_in_time.contains(x, y));
        let mut marks: Vec<Mark> = (0..len)
            .into_par_iter()
            .flat_map_iter(|x| {
                let ranked = near.of(x).iter().enumerate();
                ranked.map(move |(rank, &(y, d))| (rank, x, y, d))
            })
            .map(|(rank, x, y, distance)| {
                let common = rank < wide
                    && distance <= reach
                    && options.rule.holds(
                        follow(successors[x], successors[y]),
                        follow(previous[x], previous[y]),
                    );
                let mark = Mark {
                    from: x,
                    to: y,
                    distance,
                    common,
                    adjacent: successors[x] == Some(y) || successors[y] == Some(x),
                };
                (rank, mark)
            })
            .filter(|(rank, mark)| *rank < options.neighbours || mark.common)
            .map(|(_, mark)| mark)
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
