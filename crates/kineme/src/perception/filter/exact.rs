//! How well a moment fits the manifold itself, around each moment of each row: for bodies that perform a primitive and
//! do not merely resemble it.
//!
//! People differ from exemplars by several centimetres, and the emission allows for that; a body that carries out
//! f(p, phase) differs by millimetres. Told by the wide measure alone, its slow beginnings look like rest, and the way
//! from one movement into another like a movement. Between grid points a row's moment stands for its neighbourhood on
//! the manifold: a Gaussian, long along the tangents at it and thin across (tangent distance, Simard et al. 1993).

use nalgebra::{DMatrix, DVector};

use super::around::Around;
use super::features::Feature;
use super::going::Going;
use crate::error::Result;
use crate::math::eigen::principal;

/// Standard deviation across the manifold, metres: sensors, and what a controller lags. Postures alone are compared: who
/// goes from one movement into the next has no displacement of either, and the pace along a row says as much.
const ACROSS_M: f64 = 0.005;
/// Who stands still is displaced by so much in a window, metres (radians of the turn): sensors, and a body's sway.
const SWAY_M: f64 = 0.003;
/// Where postures jitter by so much, what the manifold itself tells counts half; the rest is what the wide measure tells.
const JITTER_M: f64 = 0.0016;
/// How much a squared distance counts, a second (see [`super::emission::Part`]).
const TRUST_PER_SEC: f64 = 50.0;
/// Movement that is not on the manifold is anywhere within so many deviations of the rows.
const BROAD: f64 = 20.0;
/// Directions in which the rows vary by less, in deviations, are all alike.
const ALIKE: f64 = 0.15;
/// States are first compared in so many directions, and in all where that leaves them within so much of the best,
/// logarithms a second.
const LEADING: usize = 8;
const FAR_PER_SEC: f64 = 600.0;
/// But for beginnings, a moment is worth comparing exactly if the wide measure, which knows displacements, has it this
/// near to its best, in shares of what a moment usually costs.
const WORTH: f64 = 0.5;
/// Who goes back along a movement by so many deviations from one look to the next does not carry it out.
const BACK: f64 = 0.3;
/// Neither does who goes on by less than this share of the pace, where that is so many deviations from one look to the
/// next.
const ONWARD: f64 = 0.5;
const TOLD: f64 = 0.05;
/// A movement that is broken off leaves the manifold faster than it is off it. Who goes on as he does is somewhere else
/// after so many seconds; what that is farther from where the row goes on than he is now counts by this share.
const AHEAD_SECS: f64 = 0.08;
const LEAVING: f64 = 0.5;
/// Movement that is not on the manifold goes straight on from one look to the next but for so much, deviations: who
/// leaves the manifold is sooner somewhere else than a broad Gaussian would have it.
const STRAIGHT: f64 = 16.0;

/// What may vary around the moments of the rows: vectors in the features' numbers, each as long as one deviation.
#[derive(Debug, Clone)]
pub(super) struct Tangents {
    /// Vectors of each state.
    pub count: usize,
    /// Of each state, count x dims; none where its primitive's parameters have no meaning.
    pub vectors: Vec<Option<Vec<f64>>>,
    /// Whether a state lies so near to a beginning that displacements are of what came before.
    pub beginning: Vec<bool>,
    /// How many of its first vector a movement goes on by a second at each state.
    pub pace: Vec<f64>,
}

/// The densities of moments around the rows' moments, against that of movement anywhere.
#[derive(Debug, Clone)]
pub(super) struct Exact {
    known: Vec<usize>,
    /// Numbers that tell displacements.
    displaced: Vec<usize>,
    mean: DVector<f64>,
    /// Directions x known, orthonormal: those in which the rows vary.
    basis: DMatrix<f64>,
    /// Variances of the rows along them.
    variances: DVector<f64>,
    whole: Around,
    /// The same in the first few directions, those in which rows vary most: no state is nearer in all than in these.
    leading: Around,
    /// Logarithm of each state's determinant; none of states that are not compared.
    log_dets: Vec<Option<f64>>,
    beginning: Vec<bool>,
    /// How far a movement goes on along the tangent of phase a second at each state, deviations.
    onward: Vec<f64>,
    /// Where a movement is [`AHEAD_SECS`] after each state if it goes on evenly; states x directions.
    later: Vec<f64>,
}

impl Exact {
    /// Of the rows' features (states x dims) without the unknown numbers; `still` tells which are of postures. `None`
    /// where nothing is known.
    ///
    /// # Errors
    /// When a decomposition fails.
    pub fn new(
        features: &[f64],
        tangents: &Tangents,
        still: &[bool],
        unknown: &[bool],
    ) -> Result<Option<Self>> {
        let dims = still.len();
        let hidden = |i: usize| unknown.get(i).copied().unwrap_or(false);
        let known: Vec<usize> = (0..dims).filter(|&i| still[i] && !hidden(i)).collect();
        if known.is_empty() {
            return Ok(None);
        }
        let scaled = |values: &[f64]| {
            DVector::from_iterator(known.len(), known.iter().map(|&i| values[i] / ACROSS_M))
        };
        let columns: Vec<DVector<f64>> = features.chunks_exact(dims).map(scaled).collect();
        let mut centred = DMatrix::from_columns(&columns);
        let mean = centred.column_mean();
        for mut column in centred.column_iter_mut() {
            column -= &mean;
        }
        let count = columns.len();
        let (mut variances, directions) = principal(&centred)?;
        variances.retain(|v| *v > ALIKE * ALIKE);
        if variances.is_empty() {
            return Ok(None);
        }
        let basis = directions.rows(0, variances.len()).into_owned();
        let places = &basis * centred;
        let mut exact = Self {
            whole: Around::of(variances.len(), tangents.count),
            leading: Around::of(variances.len().min(LEADING), tangents.count),
            variances: DVector::from_vec(variances),
            log_dets: Vec::with_capacity(count),
            onward: Vec::with_capacity(count),
            later: Vec::with_capacity(count * basis.nrows()),
            beginning: tangents.beginning.clone(),
            displaced: (0..dims).filter(|&i| !still[i] && !hidden(i)).collect(),
            known,
            mean,
            basis,
        };
        for (s, place) in places.column_iter().enumerate() {
            let vectors = tangents.vectors[s].as_deref();
            exact.push(place.as_slice(), vectors, tangents.pace[s], dims)?;
        }
        Ok(Some(exact))
    }

    /// What the displacements of a feature cost a second if the body stands still, jittering by this variance.
    pub fn moving(&self, feature: &Feature, jitter: f64) -> f64 {
        let squares = self.displaced.iter().map(|&i| feature.values[i].powi(2));
        let shaken = 2.0 * jitter;
        // Of two postures that jitter, the difference is so much though nothing moves; and as much again now and then, as
        // joints move many numbers at once.
        let moved = squares.sum::<f64>() - 2.0 * self.displaced.len() as f64 * shaken;
        let cost = 0.5 * TRUST_PER_SEC * moved.max(0.0) / (SWAY_M * SWAY_M + shaken);
        Self::told(jitter) * cost
    }

    /// How much of what is told counts where postures jitter by this variance, a share.
    pub fn told(jitter: f64) -> f64 {
        1.0 / (1.0 + jitter / (JITTER_M * JITTER_M))
    }

    fn push(
        &mut self,
        place: &[f64],
        vectors: Option<&[f64]>,
        pace: f64,
        dims: usize,
    ) -> Result<()> {
        let scaled = |v: &[f64]| {
            let own = self.known.iter().map(|&i| v[i] / ACROSS_M);
            (&self.basis * DVector::from_iterator(self.known.len(), own)).transpose()
        };
        let along = vectors.map(|v| {
            let rows: Vec<_> = v.chunks_exact(dims).map(scaled).collect();
            DMatrix::from_rows(&rows)
        });
        let directions = self.leading.directions;
        let tangent = along
            .as_ref()
            .map(|w| w.row(0).columns(0, directions).norm_squared());
        let squared = tangent.unwrap_or(0.0);
        self.onward.push(pace * squared / (1.0 + squared).sqrt());
        let velocity = |d: usize| along.as_ref().map_or(0.0, |w| pace * w[(0, d)]);
        let later = place.iter().enumerate();
        self.later
            .extend(later.map(|(d, x)| x + AHEAD_SECS * velocity(d)));
        self.leading.push(place, along.as_ref())?;
        self.log_dets.push(self.whole.push(place, along.as_ref())?);
        Ok(())
    }

    /// Logarithms of the densities a second around each state, less that of movement anywhere, of a body that goes on so
    /// and jitters by this variance. Of states that are far behind the best, bounds from above: those are told by the
    /// leading directions. Minus infinity of states along which the body went back, or hardly on, and, but for
    /// beginnings, of those that the wide measure (`wide`, of which `usual` is what a moment usually costs) has far from
    /// its best.
    ///
    /// Returns the same of movement that goes straight on; minus infinity where that is not known.
    pub fn fit(
        &self,
        feature: &Feature,
        (going, jitter): (Option<&Going>, f64),
        (wide, usual): (&[f64], f64),
        out: &mut Vec<f64>,
    ) -> f64 {
        let scaled = |values: &[f64]| {
            let known = self.known.iter().map(|&i| values[i] / ACROSS_M);
            DVector::from_iterator(self.known.len(), known)
        };
        let off = scaled(&feature.values) - &self.mean;
        let z = &self.basis * &off;
        let outside = (off.norm_squared() - z.norm_squared()).max(0.0);
        let beyond = BROAD * BROAD;
        // What no row moves need not move elsewhere either.
        let unmoved = (self.known.len() - z.len()) as f64;
        let mut broad = outside.min(outside / beyond + unmoved * beyond.ln());
        for (x, v) in z.iter().zip(self.variances.iter()) {
            broad += x * x / (v + beyond) + (v + beyond).ln();
        }
        // People move evenly whatever they do: where some of the primitives are theirs, going on evenly tells nothing.
        let surprise = going.and_then(|g| g.surprise.as_deref());
        let surprise = surprise.filter(|_| self.log_dets.iter().all(Option::is_some));
        let straight = surprise.map(|surprise| {
            let off = scaled(surprise);
            let within = (&self.basis * &off).norm_squared();
            let beside = (off.norm_squared() - within).max(0.0);
            let wide = STRAIGHT * STRAIGHT;
            let cost = within / wide + z.len() as f64 * wide.ln();
            let cost = cost + outside.min(beside / wide + unmoved * wide.ln());
            0.5 * TRUST_PER_SEC * (broad - cost)
        });
        let log = |squared: f64, log_det: f64| {
            0.5 * TRUST_PER_SEC * (broad - outside - squared - log_det)
        };
        let step = going.map(|g| (&self.basis * scaled(&g.step), g.secs));
        let ahead = step.as_ref().map(|(step, secs)| {
            let times = AHEAD_SECS / secs;
            // What jitters now does so once more in where it will be, and what jittered before does.
            let shaken = (1.0 + times) * (1.0 + times) + times * times;
            let doubt = 1.0 + jitter / (ACROSS_M * ACROSS_M) * shaken;
            (&z + step * times, doubt)
        });
        let z = z.as_slice();
        let leading = z.len().min(LEADING);
        let nearest = wide.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let worth = |s: usize| self.beginning[s] || wide[s] >= nearest - WORTH * usual;
        let stays = |s: usize| {
            step.as_ref().is_some_and(|(step, secs)| {
                let along = self.leading.along_phase(&step.as_slice()[..leading], s);
                let onward = secs * self.onward[s];
                along < -BACK || (onward > TOLD && along < ONWARD * onward)
            })
        };
        let bound = |(s, log_det): (usize, &Option<f64>)| match log_det {
            Some(d) if worth(s) && !stays(s) => log(self.leading.squared(&z[..leading], s), *d),
            _ => f64::NEG_INFINITY,
        };
        out.clear();
        out.extend(self.log_dets.iter().enumerate().map(bound));
        let leaving = |now: f64, s: usize| {
            ahead.as_ref().map_or(0.0, |(point, doubt)| {
                let place = &self.later[s * z.len()..(s + 1) * z.len()];
                let then = self.whole.apart(point.as_slice(), place, s) / doubt;
                LEAVING * (then - now).max(0.0)
            })
        };
        let whole = |s: usize| match self.log_dets[s] {
            Some(d) => {
                let now = self.whole.squared(z, s);
                log(now + leaving(now, s), d)
            }
            None => f64::NEG_INFINITY,
        };
        let likely = (0..out.len()).max_by(|&a, &b| out[a].total_cmp(&out[b]));
        let mut best = likely.map_or(f64::NEG_INFINITY, whole);
        for (s, own) in out.iter_mut().enumerate() {
            if *own > best - FAR_PER_SEC {
                *own = whole(s);
                best = best.max(*own);
            }
        }
        straight.unwrap_or(f64::NEG_INFINITY)
    }
}
