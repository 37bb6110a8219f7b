//! Groups of segments (primitives) and of primitives (behaviours), named and described.

use crate::embedding::Embedding;
use crate::error::Result;
use crate::primitive::{Behavior, Transitions};

use super::coherence::{coherence, simplified_coherence};
use super::levels::{SecondLevel, alternation, second_isomap};
use super::procedure::SegmentDistances;

/// A group of segments that are exemplars of one movement.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// `group-01` is the largest.
    pub name: String,
    /// Its segments, the most central first.
    pub segments: Vec<usize>,
    /// Mean silhouette in [-1, 1]; `None` when it is the only group.
    pub coherence: Option<f64>,
}

/// The second level.
#[derive(Debug, Clone, PartialEq)]
pub struct Behaviors {
    /// Behaviours with the names of their groups.
    pub items: Vec<Behavior>,
    /// The behaviour of each group.
    pub of_group: Vec<usize>,
    /// Share of the grouped segments in the largest behaviour: near 1, groups have been chained.
    pub largest_share: f64,
}

/// Names groups by size, largest first (ties by first appearance), and describes them. Returns the labels renumbered so.
pub(super) fn groups(
    labels: &[Option<usize>],
    distances: &SegmentDistances,
    sequences: &[Vec<f64>],
) -> (Vec<Option<usize>>, Vec<Group>) {
    let count = labels.iter().flatten().max().map_or(0, |m| m + 1);
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, label) in labels.iter().enumerate() {
        if let Some(g) = *label {
            members[g].push(i);
        }
    }
    members.sort_by_key(|m| (std::cmp::Reverse(m.len()), m[0]));
    let mut ordered = vec![None; labels.len()];
    for (g, segments) in members.iter().enumerate() {
        segments.iter().for_each(|&i| ordered[i] = Some(g));
    }
    let coherences = match distances {
        SegmentDistances::All(matrix) => coherence(matrix, &ordered, count),
        SegmentDistances::Nearest { .. } => simplified_coherence(sequences, &ordered, count),
    };
    let digits = count.to_string().len().max(2);
    let groups = members
        .into_iter()
        .zip(coherences)
        .enumerate()
        .map(|(g, (mut segments, coherence))| {
            central_first(&mut segments, sequences);
            Group {
                name: format!("group-{:0digits$}", g + 1),
                segments,
                coherence,
            }
        })
        .collect();
    (ordered, groups)
}

/// Orders segments by their distance from the group's mean sequence, ties by index.
fn central_first(segments: &mut [usize], sequences: &[Vec<f64>]) {
    let length = segments.first().map_or(0, |&s| sequences[s].len());
    let mut mean = vec![0.0; length];
    for &s in segments.iter() {
        mean.iter_mut()
            .zip(&sequences[s])
            .for_each(|(m, v)| *m += v);
    }
    let n = segments.len().max(1) as f64;
    let from_mean = |s: usize| -> f64 {
        let squares = mean
            .iter()
            .zip(&sequences[s])
            .map(|(m, v)| (m / n - v).powi(2));
        squares.sum()
    };
    let mut keyed: Vec<(f64, usize)> = segments.iter().map(|&s| (from_mean(s), s)).collect();
    keyed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    segments
        .iter_mut()
        .zip(keyed)
        .for_each(|(s, (_, k))| *s = k);
}

/// The second level of these groups; `size` is the neighbourhood and the smallest group of a second Isomap.
pub(super) fn behaviors(
    level: SecondLevel,
    transitions: &Transitions,
    embedding: &Embedding,
    successors: &[Option<usize>],
    labels: &[Option<usize>],
    groups: &[Group],
    size: (usize, usize),
) -> Result<Behaviors> {
    let of_group = match level {
        SecondLevel::Alternation => {
            let sizes: Vec<usize> = groups.iter().map(|g| g.segments.len()).collect();
            alternation(transitions, &sizes)
        }
        SecondLevel::Isomap => second_isomap(
            &embedding.coordinates,
            embedding.dimension,
            successors,
            labels,
            groups.len(),
            size.0,
            size.1,
        )?,
        SecondLevel::None => (0..groups.len()).collect(),
    };
    let count = of_group.iter().max().map_or(0, |m| m + 1);
    let digits = count.to_string().len().max(2);
    let mut merged = 0;
    let mut sizes = Vec::with_capacity(count);
    let items = (0..count)
        .map(|b| {
            let parts: Vec<&Group> = groups
                .iter()
                .zip(&of_group)
                .filter(|(_, of)| **of == b)
                .map(|(g, _)| g)
                .collect();
            sizes.push(parts.iter().map(|g| g.segments.len()).sum::<usize>());
            let name = match parts.as_slice() {
                [alone] => alone.name.clone(),
                _ => {
                    merged += 1;
                    format!("behavior-{merged:0digits$}")
                }
            };
            Behavior {
                name,
                primitives: parts.iter().map(|g| g.name.clone()).collect(),
            }
        })
        .collect();
    let all: usize = sizes.iter().sum();
    let largest = sizes.iter().max().copied().unwrap_or(0);
    Ok(Behaviors {
        items,
        of_group,
        largest_share: largest as f64 / all.max(1) as f64,
    })
}
