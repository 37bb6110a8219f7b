//! Graphs in several parts, and the edges that would join them.

use super::graph::{Edge, NeighbourGraph};
use crate::math::distances::DistanceMatrix;
use crate::math::partition::UnionFind;

/// What becomes of a graph in several connected components. Nothing is dropped silently: the embedding names them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Disconnected {
    /// Joined by the shortest edges between components (a minimum spanning tree over them), reported as synthetic.
    #[default]
    Connect,
    /// Only the largest is embedded.
    Largest,
    /// Each is embedded alone; they stand side by side along the first axis.
    Separate,
}

/// The edges of a minimum spanning tree over components, by Prim's method on items: steps inside a component are free.
pub(super) fn bridges_of_matrix(distances: &DistanceMatrix, labels: &[usize]) -> Vec<Edge> {
    let len = labels.len();
    let mut row = vec![0.0; len];
    let mut members = vec![Vec::new(); labels.iter().max().map_or(0, |m| m + 1)];
    for (i, &label) in labels.iter().enumerate() {
        members[label].push(i);
    }
    // The nearest reached item of every item that is not reached yet.
    let mut nearest = vec![(f64::INFINITY, usize::MAX); len];
    let mut reached = vec![false; members.len()];
    let mut bridges = Vec::new();
    let mut component = 0;
    loop {
        reached[component] = true;
        for &i in &members[component] {
            distances.row_into(i, &mut row);
            for (best, &d) in nearest.iter_mut().zip(&row) {
                if d < best.0 {
                    *best = (d, i);
                }
            }
        }
        let open = (0..len).filter(|&j| !reached[labels[j]] && nearest[j].0.is_finite());
        let Some(j) = open.min_by(|&a, &b| nearest[a].0.total_cmp(&nearest[b].0)) else {
            return bridges;
        };
        bridges.push(Edge::new(nearest[j].1, j, nearest[j].0));
        component = labels[j];
    }
}

/// The edges of a minimum spanning forest over components, from candidates, by Kruskal's method.
pub(super) fn bridges_of_edges(mut candidates: Vec<Edge>, labels: &[usize]) -> Vec<Edge> {
    candidates.sort_by(|p, q| {
        let ends = (p.a, p.b).cmp(&(q.a, q.b));
        p.length.total_cmp(&q.length).then(ends)
    });
    let mut sets = UnionFind::new(labels.iter().max().map_or(0, |m| m + 1));
    candidates.retain(|e| sets.join(labels[e.a], labels[e.b]));
    candidates
}

impl NeighbourGraph {
    /// The edges that join the components by a minimum spanning tree; none in a connected graph. Where only candidate
    /// distances were given they may not suffice to join everything.
    pub fn bridges(&self) -> &[Edge] {
        &self.bridges
    }

    /// The graph with its bridges built in.
    pub fn joined(&self) -> Self {
        let mut edges = self.edges();
        edges.extend(&self.bridges);
        self.with_edges(self.len(), &edges)
    }

    /// The items of the largest component; of equal ones, the first.
    pub(super) fn largest_component(&self) -> Vec<usize> {
        let of = |c: usize| (0..self.len()).filter(move |&i| self.labels[i] == c);
        let mut sizes = vec![0usize; self.labels.iter().max().map_or(0, |m| m + 1)];
        for &label in &self.labels {
            sizes[label] += 1;
        }
        let largest = (0..sizes.len()).max_by_key(|&c| (sizes[c], std::cmp::Reverse(c)));
        largest.map_or_else(Vec::new, |c| of(c).collect())
    }

    /// The graph of some items and the edges among them; item `r` of it is `items[r]` of this one.
    pub(super) fn restricted(&self, items: &[usize]) -> Self {
        let mut place = vec![None; self.len()];
        for (r, &i) in items.iter().enumerate() {
            place[i] = Some(r);
        }
        let inside = |e: &Edge| Some(Edge::new(place[e.a]?, place[e.b]?, e.length));
        let edges: Vec<Edge> = self.edges().iter().filter_map(inside).collect();
        self.with_edges(items.len(), &edges)
    }
}
