//! The procedure end to end, every step of it kept for whoever wants to look.

use rayon::prelude::*;

use crate::alignment::{
    Band, LocalCost, Nearest, RecallGoal, Sequences, distance, nearest_to_recall, pair_distances,
};
use crate::clustering::{IntervalClusters, SweepAndPrune, sweep_and_prune};
use crate::embedding::{EmbedOptions, Embedding, NeighbourGraph, SpatioTemporal, embed};
use crate::error::{Error, Result};
use crate::math::distances::{DistanceMatrix, Neighbours};
use crate::math::local_scale::{locally_scaled, locally_scaled_lists};
use crate::math::partition::renumbered;
use crate::motion::Motion;
use crate::primitive::Transitions;

use super::features::dims;
use super::groups::{Behaviors, Group, behaviors, groups};
use super::levels::{density_groups, transitions};
use super::segments::{Segment, cut};
use super::settings::{Clustering, Derivation, Neighbourhood};

/// Above this many segments only the nearest of each are warped.
const ALL_PAIRS: usize = 1_500;

/// A step of the procedure, for those who watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Cutting motions into segments.
    Segmentation,
    /// Warping distances between segments.
    Distances,
    /// Neighbourhood graph, geodesics, scaling.
    Embedding,
    /// Groups, behaviours, coherence.
    Clustering,
}

impl Stage {
    /// The stage's name.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Segmentation => "segmentation",
            Stage::Distances => "distances",
            Stage::Embedding => "embedding",
            Stage::Clustering => "clustering",
        }
    }
}

/// Warping distances between segments.
#[derive(Debug, Clone, PartialEq)]
pub enum SegmentDistances {
    /// Of all pairs.
    All(DistanceMatrix),
    /// Of the nearest of each.
    Nearest {
        /// The distances.
        lists: Neighbours,
        /// The share of true nearest neighbours found, measured on a sample.
        recall: f64,
        /// Candidates a segment that were warped.
        candidates: usize,
    },
}

/// All that a derivation found.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// The settings that applied.
    pub neighbourhood: Neighbourhood,
    /// The segments.
    pub segments: Vec<Segment>,
    /// Warping distances between them.
    pub distances: SegmentDistances,
    /// Their coordinates.
    pub embedding: Embedding,
    /// The group of each segment; `None` for noise.
    pub labels: Vec<Option<usize>>,
    /// The groups, largest first.
    pub groups: Vec<Group>,
    /// The second level.
    pub behaviors: Behaviors,
    /// Successions of groups.
    pub transitions: Transitions,
    /// Sweep-and-prune beside the default: its groups, width and stability.
    pub sweep: IntervalClusters,
    /// What a reader of the result should know.
    pub notes: Vec<String>,
}

impl Derivation {
    /// Derives primitives from motions of one body. `watch` hears of every stage as it begins.
    ///
    /// # Errors
    /// With fewer than two segments, motions of different bodies, or settings that a step refuses.
    pub fn run(&self, motions: &[Motion], watch: &mut dyn FnMut(Stage)) -> Result<Derived> {
        let body = motions
            .first()
            .ok_or_else(|| Error::invalid("a derivation needs at least one motion"))?
            .skeleton();
        if let Some(m) = motions.iter().find(|m| **m.skeleton() != **body) {
            return Err(Error::invalid(format!(
                "motions must be of one body, but `{}` is of `{}`, not of `{}`",
                m.name(),
                m.skeleton().name(),
                body.name()
            )));
        }
        watch(Stage::Segmentation);
        let segments = cut(motions, &self.cut)?;
        if segments.len() < 2 {
            return Err(Error::unsupported(format!(
                "{} segments found in {} motions: a vocabulary needs at least two; give more motion or another segmenter",
                segments.len(),
                motions.len()
            )));
        }
        let sequences = self.sequences(motions, &segments);
        self.group(&sequences, dims(body), segments, watch)
    }

    /// Feature sequences of segments, each [`Features::frames`](super::Features::frames) x [`feature_dims`](super::feature_dims).
    pub fn sequences(&self, motions: &[Motion], segments: &[Segment]) -> Vec<Vec<f64>> {
        let mut of_motion: Vec<Vec<usize>> = vec![Vec::new(); motions.len()];
        for (i, s) in segments.iter().enumerate() {
            of_motion[s.motion].push(i);
        }
        let cut: Vec<Vec<(usize, Vec<f64>)>> = motions
            .par_iter()
            .zip(&of_motion)
            .map(|(motion, items)| {
                let all = if items.is_empty() {
                    Vec::new()
                } else {
                    self.features.of(motion)
                };
                let dims = dims(motion.skeleton());
                let one = |&i: &usize| {
                    let range = segments[i].frames.clone();
                    (i, self.features.segment(&all, dims, range))
                };
                items.iter().map(one).collect()
            })
            .collect();
        let mut sequences = vec![Vec::new(); segments.len()];
        for (i, sequence) in cut.into_iter().flatten() {
            sequences[i] = sequence;
        }
        sequences
    }

    /// From feature sequences to groups: everything after the cut.
    ///
    /// # Errors
    /// When a step refuses its settings.
    pub fn group(
        &self,
        sequences: &[Vec<f64>],
        dims: usize,
        segments: Vec<Segment>,
        watch: &mut dyn FnMut(Stage),
    ) -> Result<Derived> {
        watch(Stage::Distances);
        let successors: Vec<Option<usize>> = segments.iter().map(|s| s.successor).collect();
        let distances = self.distances(sequences, dims, &successors)?;
        self.group_by(distances, sequences, segments, watch)
    }

    /// From distances to groups: spatio-temporal Isomap, clustering, the second level.
    ///
    /// # Errors
    /// When a step refuses its settings.
    pub fn group_by(
        &self,
        distances: SegmentDistances,
        sequences: &[Vec<f64>],
        segments: Vec<Segment>,
        watch: &mut dyn FnMut(Stage),
    ) -> Result<Derived> {
        let around = self.neighbourhood(segments.len());
        let mut notes = Vec::new();
        if let SegmentDistances::Nearest {
            recall, candidates, ..
        } = &distances
        {
            notes.push(format!(
                "{} segments: only the {candidates} nearest of each by resampled distance were warped; recall of the true neighbours {recall:.3}",
                segments.len()
            ));
        }
        watch(Stage::Embedding);
        let successors: Vec<Option<usize>> = segments.iter().map(|s| s.successor).collect();
        let options = SpatioTemporal {
            neighbours: around.neighbours,
            temporal_neighbours: Some(around.temporal_neighbours),
            c_ctn: self.c_ctn,
            rule: around.rule,
            ..SpatioTemporal::default()
        };
        let graph = match (&distances, around.local_scale) {
            (SegmentDistances::All(matrix), 0) => {
                NeighbourGraph::segmented(matrix, &successors, &options)?
            }
            (SegmentDistances::All(matrix), k) => {
                NeighbourGraph::segmented(&locally_scaled(matrix, k)?, &successors, &options)?
            }
            (SegmentDistances::Nearest { lists, .. }, 0) => {
                NeighbourGraph::segmented(lists, &successors, &options)?
            }
            (SegmentDistances::Nearest { lists, .. }, k) => {
                let scaled = locally_scaled_lists(lists, k)?;
                NeighbourGraph::segmented(&scaled, &successors, &options)?
            }
        };
        let (embedding, geodesics) = embed(&graph, &EmbedOptions::default())?;
        if !embedding.synthetic_edges.is_empty() {
            notes.push(format!(
                "the graph of neighbours fell into {} parts, which were joined where they are nearest; how far apart \
                 they lie in the embedding says little",
                1 + embedding.components.iter().max().unwrap_or(&0)
            ));
        }
        watch(Stage::Clustering);
        let sweep = sweep_and_prune(
            &embedding.coordinates,
            embedding.dimension,
            &SweepAndPrune {
                min_cluster_size: around.min_group,
                seed: self.seed,
                ..SweepAndPrune::default()
            },
        )?;
        let found = match self.clustering {
            Clustering::SweepAndPrune => sweep.labels.clone(),
            Clustering::Hdbscan => {
                if geodesics.matrix().is_none() {
                    notes.push(format!(
                        "{} segments: HDBSCAN ran on the landmark embedding instead of the geodesics",
                        segments.len()
                    ));
                }
                density_groups(&embedding, &geodesics, around.min_group)?
            }
        };
        let (labels, groups) = groups(&renumbered(&found), &distances, sequences);
        let transitions = transitions(&segments, &labels, groups.len());
        let behaviors = behaviors(
            self.second_level,
            &transitions,
            &embedding,
            &successors,
            &labels,
            &groups,
            (around.neighbours, around.min_group),
        )?;
        let merged = behaviors.items.iter().any(|b| b.primitives.len() > 1);
        if behaviors.largest_share > 0.5 && merged {
            notes.push(format!(
                "one behaviour holds {:.0} % of the grouped segments: alternation may have chained impure primitives",
                100.0 * behaviors.largest_share
            ));
        }
        Ok(Derived {
            neighbourhood: around,
            segments,
            distances,
            embedding,
            labels,
            groups,
            behaviors,
            transitions,
            sweep,
            notes,
        })
    }

    /// Warping distances between feature sequences: of all pairs up to 1,500 segments, above of the nearest of each.
    ///
    /// # Errors
    /// When sequences have not the settings' length.
    pub fn distances(
        &self,
        sequences: &[Vec<f64>],
        dims: usize,
        successors: &[Option<usize>],
    ) -> Result<SegmentDistances> {
        let frames = self.features.frames;
        let packed = Sequences::new(&sequences.concat(), frames, dims)?;
        let radius = Band::radius(self.features.band, frames);
        let n = sequences.len();
        if n <= ALL_PAIRS {
            let square = pair_distances(&packed, radius);
            let upper = (0..n).flat_map(|i| square[i * n + i + 1..(i + 1) * n].iter().copied());
            let matrix = DistanceMatrix::from_upper(n, upper.collect())?;
            return Ok(SegmentDistances::All(matrix));
        }
        let reached = nearest_to_recall(
            &packed,
            &Nearest::with_radius(radius),
            &RecallGoal {
                neighbours: self.neighbourhood(n).temporal_neighbours,
                seed: self.seed,
                ..RecallGoal::default()
            },
        )?;
        let mut lists = reached.lists;
        // Segments adjacent in a recording are joined however far apart, so their distances must be known too.
        let adjacent: Vec<(usize, usize, f64)> = successors
            .par_iter()
            .enumerate()
            .filter_map(|(i, next)| Some((i, (*next)?)))
            .map(|(i, j)| {
                let band = Band::Parallel(radius);
                let d = distance(
                    &sequences[i],
                    &sequences[j],
                    dims,
                    band,
                    LocalCost::SquaredEuclidean,
                )?;
                Ok((i, j, d))
            })
            .collect::<Result<_>>()?;
        for (i, j, d) in adjacent {
            if lists[i].iter().all(|(k, _)| *k != j) {
                lists[i].push((j, d));
                lists[j].push((i, d));
            }
        }
        Ok(SegmentDistances::Nearest {
            lists: Neighbours::new(lists)?,
            recall: reached.recall,
            candidates: reached.candidates,
        })
    }
}
