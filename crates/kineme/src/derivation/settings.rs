//! The settings of a derivation, and what is chosen where they leave it open.

use crate::embedding::TemporalRule;

use super::features::Features;
use super::levels::SecondLevel;
use super::segments::Cut;

/// How segments become groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Clustering {
    /// HDBSCAN on the geodesics.
    #[default]
    Hdbscan,
    /// Sweep-and-prune on the embedding, as the paper has it.
    SweepAndPrune,
}

/// The settings of a derivation.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivation {
    /// Where segments come from.
    pub cut: Cut,
    /// What they are compared by.
    pub features: Features,
    /// K, the size of a neighbourhood; `None`: from 3 for strokes that a segmenter found, growing with their number; 8 for clips and marks.
    pub neighbours: Option<usize>,
    /// How many nearest may be common temporal neighbours; `None`: K for strokes, twice K for clips and marks.
    pub temporal_neighbours: Option<usize>,
    /// What makes a neighbour a common temporal one; `None`: the successor for strokes, for clips and marks both sides
    /// as far as both segments have them.
    pub rule: Option<TemporalRule>,
    /// Distances are scaled by those to the nearest of this rank, 0 for plain distances; `None`: plain for strokes, by the
    /// fifth for clips and marks, which come from many people.
    pub local_scale: Option<usize>,
    /// The smallest group; `None`: from 3 for strokes, growing with their number; 5 for clips and marks.
    pub min_group: Option<usize>,
    /// Divisor of distances between common temporal neighbours.
    pub c_ctn: f64,
    /// How the embedded segments are grouped.
    pub clustering: Clustering,
    /// How groups are joined to behaviours.
    pub second_level: SecondLevel,
    /// Seed of every random choice.
    pub seed: u64,
}

impl Derivation {
    /// The defaults for segments that come from `cut`.
    pub fn new(cut: Cut) -> Self {
        Self {
            cut,
            features: Features::default(),
            neighbours: None,
            temporal_neighbours: None,
            rule: None,
            local_scale: None,
            min_group: None,
            c_ctn: 100.0,
            clustering: Clustering::default(),
            second_level: SecondLevel::default(),
            seed: 0,
        }
    }

    /// What applies to a number of segments: what is given, else what the kind of segments and their number suggest.
    ///
    /// K and the smallest group of strokes grow with the binary logarithm of their number, less 4, from 3 upward: a
    /// recording of a hundred strokes has groups of three worth finding, an archive of thousands has better ones.
    pub fn neighbourhood(&self, segments: usize) -> Neighbourhood {
        let strokes = matches!(self.cut, Cut::Segmenter { .. });
        let grown = (segments.max(1).ilog2() as usize).saturating_sub(4).max(3);
        let neighbours = self.neighbours.unwrap_or(if strokes { grown } else { 8 });
        let (sides, rule, scale, group) = if strokes {
            (1, TemporalRule::Forward, 0, grown)
        } else {
            (2, TemporalRule::Known, 5, 5)
        };
        Neighbourhood {
            neighbours,
            temporal_neighbours: self.temporal_neighbours.unwrap_or(sides * neighbours),
            rule: self.rule.unwrap_or(rule),
            local_scale: self.local_scale.unwrap_or(scale),
            min_group: self.min_group.unwrap_or(group),
        }
    }
}

/// The settings of a derivation that depend on its segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Neighbourhood {
    /// K, the size of a neighbourhood.
    pub neighbours: usize,
    /// How many nearest may be common temporal neighbours.
    pub temporal_neighbours: usize,
    /// What makes a neighbour a common temporal one.
    pub rule: TemporalRule,
    /// The rank of the neighbour that distances are scaled by; 0 for plain distances.
    pub local_scale: usize,
    /// The smallest group.
    pub min_group: usize,
}
