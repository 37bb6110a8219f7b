//! The second level: behaviours from sequences of primitives.

use crate::clustering::{Density, hdbscan_judged};
use crate::embedding::{EmbedOptions, Embedding, Geodesics, NeighbourGraph, SpatioTemporal, embed};
use crate::error::Result;
use crate::math::distances::DistanceMatrix;
use crate::math::partition::UnionFind;
use crate::primitive::Transitions;

use super::segments::Segment;

/// How primitives are joined to behaviours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SecondLevel {
    /// Primitives that alternate become one behaviour: each follows the other at least twice, and after at least a
    /// quarter of the smaller one's segments.
    #[default]
    Alternation,
    /// A second spatio-temporal Isomap over the positions of the segments in the first (Jenkins and Mataric 2004).
    Isomap,
    /// None: every primitive is a behaviour.
    None,
}

/// Times that each of two primitives must follow the other to alternate.
const ALTERNATIONS: u32 = 2;
/// ... as a share of the smaller one's segments, too: chance successions between large groups do not chain them.
const ALTERNATION_SHARE: f64 = 0.25;

/// Successions of groups inside true recordings: segments that follow one another directly, both in a group.
pub fn transitions(segments: &[Segment], labels: &[Option<usize>], groups: usize) -> Transitions {
    let mut transitions = Transitions::none(groups);
    for (i, segment) in segments.iter().enumerate() {
        let next = segment.successor.and_then(|n| labels[n]);
        if let (Some(a), Some(b)) = (labels[i], next) {
            transitions.counts[a * groups + b] += 1;
        }
    }
    transitions
}

/// The behaviour of each group of these sizes, numbered in the order of the groups: connected components of alternating
/// groups.
pub fn alternation(transitions: &Transitions, sizes: &[usize]) -> Vec<usize> {
    let n = transitions.n;
    let mut components = UnionFind::new(n);
    for a in 0..n {
        for b in a + 1..n {
            let both_ways = transitions.count(a, b).min(transitions.count(b, a));
            let enough = ALTERNATION_SHARE * sizes[a].min(sizes[b]) as f64;
            if both_ways >= ALTERNATIONS && f64::from(both_ways) >= enough {
                components.join(a, b);
            }
        }
    }
    components.labels()
}

/// The behaviour of each group by a second spatio-temporal Isomap: segments are described by their place in the first
/// embedding (`coordinates`, row-major in `dimension` columns), drawn together with `c_ctn`, clustered, and each group
/// joins the cluster that most of its segments lie in.
///
/// # Errors
/// When the embedding refuses its input.
pub fn second_isomap(
    coordinates: &[f64],
    dimension: usize,
    successors: &[Option<usize>],
    labels: &[Option<usize>],
    groups: usize,
    neighbours: usize,
    min_size: usize,
) -> Result<Vec<usize>> {
    let distances = DistanceMatrix::euclidean(coordinates, dimension)?;
    let options = SpatioTemporal {
        neighbours,
        c_ctn: 100.0,
        ..SpatioTemporal::default()
    };
    let graph = NeighbourGraph::segmented(&distances, successors, &options)?;
    let (embedding, geodesics) = embed(&graph, &EmbedOptions::default())?;
    let clusters = density_groups(&embedding, &geodesics, min_size)?;
    let found = clusters.iter().flatten().max().map_or(0, |m| m + 1);
    let mut joined = UnionFind::new(groups + found);
    for g in 0..groups {
        let mut votes = vec![0usize; found];
        let members = labels.iter().zip(&clusters).filter(|(l, _)| **l == Some(g));
        let mut size = 0;
        for (_, cluster) in members {
            size += 1;
            if let Some(c) = cluster {
                votes[*c] += 1;
            }
        }
        let most = (0..found).max_by_key(|&c| (votes[c], std::cmp::Reverse(c)));
        if let Some(c) = most.filter(|&c| 2 * votes[c] > size) {
            joined.join(g, groups + c);
        }
    }
    let all: Vec<Option<usize>> = joined.labels()[..groups].iter().map(|&l| Some(l)).collect();
    Ok(crate::math::partition::renumbered(&all)
        .into_iter()
        .flatten()
        .collect())
}

/// HDBSCAN on the geodesics, or on the embedding's coordinates where only landmarks were followed.
///
/// # Errors
/// When clustering refuses its settings.
pub(super) fn density_groups(
    embedding: &Embedding,
    geodesics: &Geodesics,
    min_size: usize,
) -> Result<Vec<Option<usize>>> {
    let density = Density::of_size(min_size);
    match geodesics {
        Geodesics::All(matrix) => hdbscan_judged(matrix, &density),
        Geodesics::Landmarks(_) => {
            let matrix = DistanceMatrix::euclidean(&embedding.coordinates, embedding.dimension)?;
            hdbscan_judged(&matrix, &density)
        }
    }
}
