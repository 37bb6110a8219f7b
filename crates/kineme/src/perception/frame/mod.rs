//! [`Frame`]: the exact density of a few postures under each primitive; primitives, rest and none compete.
//!
//! The model (reading of section V-A without its approximation): a primitive's parameters p are uniform and held, its
//! phases τ do not decrease, and each coordinate is f(p, τ) with an error uniform within a tolerance. What the paper
//! writes as a chain of univariate conditional densities is, on a lattice of cells over (p, τ), one weighted count of
//! the cells that explain the postures, whatever the order of joints: the chain telescopes.

mod cells;
mod chain;
mod conditional;
mod listener;
mod settings;
mod tree;

pub use conditional::Patch;
pub use settings::FrameSettings;

use cells::Cells;
use chain::{Explained, Shape};
use listener::FrameListener;
use tree::{Query, Tree};

use super::parts::{Parts, Scope, Tolerances, same_body, widened};
use super::spans::whole;
use crate::error::Result;
use crate::primitive::{
    Listener, Observation, Observations, Recogniser, Recognition, Vocabulary, readings,
};

/// Boxes of each primitive that are looked at to tell how new a posture is that lies in none.
const NOVELTY_VISITS: usize = 160;

/// The exact frame classifier: posterior over primitives, rest and none from the last few postures.
///
/// **What is compared.** Joint coordinates part by part of the body, a part being the joints of one role: the angles of
/// hinges, the rotation vectors of balls under the name nearest to the vocabulary's postures, the summed rotation
/// vectors of a chain of vertebrae. Coordinates that no primitive moves are compared with one value and a wider
/// tolerance and say nothing within it.
///
/// **Density.** A cell explains a posture of which all parts lie within the tolerance of the cell's box. A part's
/// density is a mixture: within tolerance with probability 1 - fault rate, anywhere in its range otherwise, and at most
/// `faults` parts are at fault at once. A part that was not seen has factor 1, its marginal (boxes count as wide as the
/// tolerance alone, so it is the marginal but for the cells' own width). The background, none, is uniform over
/// the ranges; rest is a posture in the first or last piece of phase of a primitive that is no cycle, all primitives
/// counting alike, and one that stays there over all n postures.
///
/// **Novelty** is how far the latest posture is from the nearest cell, in tolerances, by the part that is farthest off
/// (faults forgiven); beyond 1 an upper bound, from a search of bounded length.
///
/// **What the posterior means.** With a tolerance far below the ranges of a dozen joints and more, any cell that
/// explains a posture outweighs the background: between known and unknown the answer is a test of support, and close
/// to 0 or 1. Between primitives, and between them and rest, it is graded: each counts by the share of its cells that
/// explain the postures.
#[derive(Debug)]
pub struct Frame<'v> {
    vocabulary: &'v Vocabulary,
    settings: FrameSettings,
    scope: Scope,
    /// The coordinates compared with boxes, the most discriminative first.
    columns: Vec<usize>,
    classes: Vec<Class>,
    /// Of each part: the logarithm of its density within tolerance over the background's.
    log_within: Vec<f64>,
    /// Of each part: its density at fault over that within tolerance.
    at_fault: Vec<f64>,
}

/// A primitive as it is searched.
#[derive(Debug)]
struct Class {
    shape: Shape,
    tree: Tree,
    params: usize,
    points: Vec<f64>,
    reach: Vec<f64>,
    /// What each of its cells weighs in the density of rest: those of the first and last piece.
    rest_weight: f64,
}

/// What explains one posture.
#[derive(Debug, Clone)]
struct Moment {
    /// Cells of each class, with their densities relative to all parts seen being within tolerance.
    classes: Vec<Explained>,
    /// The logarithm of the latter over the background's.
    log_within: f64,
    /// Distance from the nearest cell, in tolerances.
    novelty: f64,
}

impl<'v> Frame<'v> {
    /// Cuts every primitive of the vocabulary into cells and makes their trees.
    ///
    /// # Errors
    /// When a setting is out of its range, or the body has more than 64 parts.
    pub fn new(vocabulary: &'v Vocabulary, settings: &FrameSettings) -> Result<Self> {
        settings.check()?;
        let parts = Parts::of(vocabulary.body())?;
        let cut = |p| Cells::of(p, &parts, &settings.patches, settings.pieces);
        let cells: Vec<Cells> = vocabulary
            .primitives()
            .iter()
            .map(cut)
            .collect::<Result<_>>()?;
        let tolerances = Tolerances {
            delta: widened(vocabulary, settings.delta_rad, settings.residual),
            constant: settings.constant_rad,
            limits: settings.limits_rad,
        };
        let scope = Scope::new(parts, cells.iter().map(Cells::bounds), tolerances);
        let mut columns = scope.moving.clone();
        columns.sort_by(|&a, &b| {
            let by_extent = scope.extent(b).total_cmp(&scope.extent(a));
            by_extent.then(a.cmp(&b))
        });
        let part_of: Vec<usize> = columns.iter().map(|&c| scope.parts.part_of(c)).collect();
        let open = cells.iter().filter(|c| !c.cyclic).count();
        let classes = cells.into_iter().map(|c| Class {
            shape: Shape {
                rows: c.rows,
                pieces: c.pieces,
                cyclic: c.cyclic,
            },
            tree: Tree::new(&c, &columns, &part_of, tolerances.delta, settings.faults),
            params: c.params,
            rest_weight: match c.cyclic {
                true => 0.0,
                false => 1.0 / (open * 2 * c.rows) as f64,
            },
            points: c.points,
            reach: c.reach,
        });
        let classes = classes.collect();
        let (log_within, at_fault) = mixture(&scope, &columns, settings);
        Ok(Self {
            vocabulary,
            settings: settings.clone(),
            scope,
            columns,
            classes,
            log_within,
            at_fault,
        })
    }

    /// Half width of "equals" for this vocabulary, radians: the setting, or what its leave-one-out error asks for.
    pub fn delta_rad(&self) -> f64 {
        self.scope.tolerances.delta
    }

    fn moment(&self, seen: &Observation<'_>) -> Moment {
        let posture = self.scope.posture(seen);
        let query = Query {
            at: self
                .columns
                .iter()
                .map(|&c| posture.place[c] as f32)
                .collect(),
            gaps: posture.constant_gap.iter().map(|&g| g as f32).collect(),
        };
        let explained = |class: &Class| {
            let hits = class.tree.hits(&query);
            let density = |hit: &tree::Hit| (hit.cell, self.density(hit.outside));
            hits.iter().map(density).collect()
        };
        let classes = self.classes.iter().map(explained).collect();
        let distances = self
            .classes
            .iter()
            .map(|c| c.tree.nearest(&query, NOVELTY_VISITS));
        let novelty = distances.fold(f32::INFINITY, f32::min);
        let known = self.log_within.iter().zip(&posture.seen);
        Moment {
            classes,
            log_within: known.filter(|(_, seen)| **seen).map(|(l, _)| l).sum(),
            novelty: f64::from(novelty),
        }
    }

    /// The density of a posture with these parts at fault, relative to none being so.
    fn density(&self, outside: u64) -> f64 {
        let mut density = 1.0;
        let mut rest = outside;
        while rest != 0 {
            density *= self.at_fault[rest.trailing_zeros() as usize];
            rest &= rest - 1;
        }
        density
    }
}

/// Of each part the logarithm of the mixture's density within tolerance over the background's, and the share of the
/// former that is left at fault.
fn mixture(scope: &Scope, columns: &[usize], settings: &FrameSettings) -> (Vec<f64>, Vec<f64>) {
    // Without faults the density is the box alone.
    let rate = match settings.faults {
        0 => 0.0,
        _ => settings.fault_rate,
    };
    let mut volumes = vec![1.0; scope.parts.count()];
    for &c in columns {
        let share = 2.0 * scope.tolerances.delta / scope.range(c);
        volumes[scope.parts.part_of(c)] *= share.min(1.0);
    }
    let within = |v: &f64| (1.0 - rate) / v + rate;
    (
        volumes.iter().map(|v| within(v).ln()).collect(),
        volumes.iter().map(|v| rate / within(v)).collect(),
    )
}

impl Recogniser for Frame<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.vocabulary
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(FrameListener::new(self))
    }

    /// The mean of the frames' answers, each counting as much as it is not at rest; the motion is at rest as far as its
    /// liveliest frame is.
    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        same_body(self.vocabulary, seen.motion().skeleton())?;
        let readings = readings(self, seen)?;
        let rate = seen.motion().rate_hz();
        Ok(whole(&readings, rate, self.settings.dwell_secs, false))
    }
}
