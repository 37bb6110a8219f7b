//! Derivation on real people: the classes are hidden, groups are found, and only then compared with the classes.

use kineme::Motion;
use kineme::clustering::{Density, hdbscan};
use kineme::derivation::{Cut, Derivation, Derived, Segment, SegmentDistances, cut};
use kineme::embedding::{EmbedOptions, NeighbourGraph, SpatioTemporal, embed};
use kineme::math::distances::DistanceMatrix;
use kineme::math::statistics::{agreement, noise_as_singletons};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::kmeans::kmeans;
use crate::sets::{LabelledSet, Result};

/// Clips of a set as they are compared: feature sequences and all warping distances.
pub struct Clips<'a> {
    set: &'a LabelledSet,
    settings: Derivation,
    sequences: Vec<Vec<f64>>,
    distances: DistanceMatrix,
}

/// Agreement of found groups with the hidden classes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// Adjusted Rand index; an item without a group is a cluster of its own.
    pub ari: f64,
    /// Normalised mutual information, likewise.
    pub nmi: f64,
    /// Number of groups.
    pub groups: usize,
    /// Share of the items without a group.
    pub noise: f64,
}

impl Score {
    /// Compares found labels with the truth.
    pub fn of(labels: &[Option<usize>], truth: &[usize]) -> Self {
        let a = agreement(&noise_as_singletons(labels), truth);
        let noise = labels.iter().filter(|l| l.is_none()).count();
        Self {
            ari: a.ari,
            nmi: a.nmi,
            groups: labels.iter().flatten().max().map_or(0, |m| m + 1),
            noise: noise as f64 / labels.len().max(1) as f64,
        }
    }
}

/// In which order clips are strung into one performance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Not at all: every clip is a recording of its own.
    Separate,
    /// In random order.
    Random,
    /// The classes alphabetically, one clip of each a round, which clip drawn at random.
    Routine,
}

impl<'a> Clips<'a> {
    /// The clips of a set, with features of this `shape`.
    ///
    /// # Errors
    /// When the distances cannot be computed.
    pub fn new(set: &'a LabelledSet, shape: f64) -> Result<Self> {
        let mut settings = Derivation::new(Cut::Marks(Vec::new()));
        settings.features.shape = shape;
        let segments = cut(&set.motions, &Cut::Clips)?;
        let sequences = settings.sequences(&set.motions, &segments);
        let dims = kineme::derivation::feature_dims(set.motions[0].skeleton());
        let derived = settings.distances(&sequences, dims, &vec![None; segments.len()])?;
        let SegmentDistances::All(distances) = derived else {
            return Err("a set of labelled clips is small enough for all pairs".into());
        };
        Ok(Self {
            set,
            settings,
            sequences,
            distances,
        })
    }
    /// Groups of the clips strung in this order.
    ///
    /// # Errors
    /// When a step of the derivation fails.
    pub fn derive(&self, order: Order, seed: u64) -> Result<Derived> {
        self.group(self.distances.clone(), order, seed)
    }

    /// Groups in routine order with the distances permuted at random: what order alone gives.
    ///
    /// # Errors
    /// When a step of the derivation fails.
    pub fn derive_shuffled(&self, seed: u64) -> Result<Derived> {
        let mut upper = self.distances.upper().to_vec();
        upper.shuffle(&mut Pcg64::seed_from_u64(seed ^ 0x5eed));
        let shuffled = DistanceMatrix::from_upper(self.distances.len(), upper)?;
        self.group(shuffled, Order::Routine, seed)
    }

    fn group(&self, distances: DistanceMatrix, order: Order, seed: u64) -> Result<Derived> {
        let mut segments = cut(&self.set.motions, &Cut::Clips)?;
        for pair in self.order(order, seed).windows(2) {
            segments[pair[0]].successor = Some(pair[1]);
        }
        let distances = SegmentDistances::All(distances);
        let watch = &mut |_| {};
        Ok(self
            .settings
            .group_by(distances, &self.sequences, segments, watch)?)
    }

    /// Items in the order of a performance; empty where each stands alone.
    fn order(&self, order: Order, seed: u64) -> Vec<usize> {
        let mut random = Pcg64::seed_from_u64(seed);
        let n = self.set.labels.len();
        match order {
            Order::Separate => Vec::new(),
            Order::Random => {
                let mut items: Vec<usize> = (0..n).collect();
                items.shuffle(&mut random);
                items
            }
            Order::Routine => {
                let mut left: Vec<Vec<usize>> = vec![Vec::new(); self.set.classes.len()];
                for (i, &l) in self.set.labels.iter().enumerate() {
                    left[l].push(i);
                }
                let mut items = Vec::with_capacity(n);
                while items.len() < n {
                    for class in left.iter_mut().filter(|c| !c.is_empty()) {
                        items.push(class.swap_remove(random.random_range(0..class.len())));
                    }
                }
                items
            }
        }
    }

    /// The score of a derivation's primitives.
    pub fn score(&self, derived: &Derived) -> Score {
        Score::of(&derived.labels, &self.set.labels)
    }

    /// The score of its sweep-and-prune groups.
    pub fn score_sweep(&self, derived: &Derived) -> Score {
        Score::of(&derived.sweep.labels, &self.set.labels)
    }

    /// Baseline: HDBSCAN on the warping distances, smallest group `size`.
    ///
    /// # Errors
    /// When clustering refuses its settings.
    pub fn dtw_hdbscan(&self, size: usize) -> Result<Score> {
        let labels = hdbscan(&self.distances, &Density::of_size(size))?;
        Ok(Score::of(&labels, &self.set.labels))
    }

    /// Baseline: plain Isomap (K 8, six axes) and HDBSCAN.
    ///
    /// # Errors
    /// When a step refuses its settings.
    pub fn isomap_hdbscan(&self, size: usize) -> Result<Score> {
        let labels = isomap_hdbscan(&self.distances, size)?;
        Ok(Score::of(&labels, &self.set.labels))
    }

    /// Baseline: k-means on the same features, told the true number of classes.
    pub fn kmeans(&self, seed: u64) -> Score {
        let labels = kmeans(&self.sequences, self.set.classes.len(), seed);
        let labels: Vec<Option<usize>> = labels.into_iter().map(Some).collect();
        Score::of(&labels, &self.set.labels)
    }
}

/// Labels of a continuous recording at a constant rate.
#[derive(Debug, Clone)]
pub struct Annotation {
    /// Class of each step.
    pub labels: Vec<usize>,
    /// Steps a second.
    pub rate_hz: f64,
}

/// Frame-wise score of labelled segments of continuous recordings. A step in no segment counts with its whole gap as a
/// cluster of its own.
pub fn frame_score(
    segments: &[Segment],
    labels: &[Option<usize>],
    motions: &[Motion],
    truth: &[Annotation],
) -> Score {
    let mut classes = Vec::new();
    let mut found: Vec<usize> = Vec::new();
    let groups = labels.iter().flatten().max().map_or(0, |m| m + 1);
    let mut gap = groups + segments.len();
    let mut noise = 0;
    for (m, annotation) in truth.iter().enumerate() {
        let rate = motions[m].rate_hz();
        let mut inside = true;
        for (step, &class) in annotation.labels.iter().enumerate() {
            let frame = ((step as f64 + 0.5) / annotation.rate_hz * rate) as usize;
            let within = |s: &Segment| s.motion == m && s.frames.contains(&frame);
            let segment = segments.iter().position(within);
            gap += usize::from(segment.is_none() && inside);
            inside = segment.is_some();
            let label = segment.and_then(|s| labels[s]);
            noise += usize::from(label.is_none());
            found.push(label.or(segment.map(|s| groups + s)).unwrap_or(gap));
            classes.push(class);
        }
    }
    let a = agreement(&found, &classes);
    Score {
        ari: a.ari,
        nmi: a.nmi,
        groups,
        noise: noise as f64 / found.len().max(1) as f64,
    }
}

/// Frame-wise scores of a derivation from continuous recordings: of its primitives and of its behaviours.
pub fn frame_scores(derived: &Derived, motions: &[Motion], truth: &[Annotation]) -> (Score, Score) {
    let score = |labels: &[Option<usize>]| frame_score(&derived.segments, labels, motions, truth);
    let behavior = |l: &Option<usize>| l.map(|g| derived.behaviors.of_group[g]);
    let behaviors: Vec<Option<usize>> = derived.labels.iter().map(behavior).collect();
    (score(&derived.labels), score(&behaviors))
}

/// Labels of a derivation's segments by the baselines: warping distances and HDBSCAN, plain Isomap and HDBSCAN, and
/// k-means with `classes` clusters; smallest group `size`.
///
/// # Errors
/// When a step refuses its settings.
pub fn baselines(
    derived: &Derived,
    sequences: &[Vec<f64>],
    classes: usize,
    size: usize,
) -> Result<[Vec<Option<usize>>; 3]> {
    let SegmentDistances::All(distances) = &derived.distances else {
        return Err("baselines need the distances of all pairs".into());
    };
    let kmeans = kmeans(sequences, classes, 0);
    Ok([
        hdbscan(distances, &Density::of_size(size))?,
        isomap_hdbscan(distances, size)?,
        kmeans.into_iter().map(Some).collect(),
    ])
}

/// Plain Isomap (K 8, six axes) and HDBSCAN on its coordinates.
fn isomap_hdbscan(distances: &DistanceMatrix, size: usize) -> Result<Vec<Option<usize>>> {
    let none = vec![None; distances.len()];
    let graph = NeighbourGraph::segmented(distances, &none, &SpatioTemporal::isomap(8))?;
    let options = EmbedOptions {
        dimension: Some(6),
        ..EmbedOptions::default()
    };
    let (embedding, _) = embed(&graph, &options)?;
    let embedded = DistanceMatrix::euclidean(&embedding.coordinates, embedding.dimension)?;
    Ok(hdbscan(&embedded, &Density::of_size(size))?)
}
