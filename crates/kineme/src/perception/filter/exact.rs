//! How well a moment fits the manifold itself, around each moment of each row: for bodies that perform a primitive and
//! do not merely resemble it.
//!
//! People differ from exemplars by several centimetres, and the emission allows for that; a body that carries out
//! f(p, phase) differs by millimetres. Told by the wide measure alone, its slow beginnings look like rest, and the way
//! from one movement into another like a movement. Between grid points a row's moment stands for its neighbourhood on
//! the manifold: a Gaussian, long along the tangents at it and thin across (tangent distance, Simard et al. 1993).

use nalgebra::{DMatrix, DVector};

use super::features::Feature;
use crate::error::{Error, Result};
use crate::math::eigen::principal;

/// Standard deviation across the manifold, metres: sensors, and what a controller lags. Postures alone are compared: who
/// goes from one movement into the next has no displacement of either, and the pace along a row says as much.
const ACROSS_M: f64 = 0.005;
/// Who stands still is displaced by so much in a window, metres (radians of the turn): sensors, and a body's sway.
const SWAY_M: f64 = 0.003;
/// How much a squared distance counts, a second (see [`super::emission::Part`]).
const TRUST_PER_SEC: f64 = 36.0;
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
const ONWARD: f64 = 0.1;
const TOLD: f64 = 0.1;

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
}

/// Neighbourhoods of states: spheres that are long along the tangents.
#[derive(Debug, Clone)]
struct Around {
    directions: usize,
    /// Tangents of each state.
    count: usize,
    /// Of each state: its place, and `count` vectors whose products with a residual take their squares off its length;
    /// states x (1 + count) x directions.
    states: Vec<f64>,
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

    /// What the displacements of a feature cost a second if the body stands still.
    pub fn moving(&self, feature: &Feature) -> f64 {
        let squares = self.displaced.iter().map(|&i| feature.values[i].powi(2));
        0.5 * TRUST_PER_SEC * squares.sum::<f64>() / (SWAY_M * SWAY_M)
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
        self.leading.push(place, along.as_ref())?;
        self.log_dets.push(self.whole.push(place, along.as_ref())?);
        Ok(())
    }

    /// Logarithms of the densities a second around each state, less that of movement anywhere. Of states that are far
    /// behind the best, bounds from above: those are told by the leading directions. Minus infinity of states along which
    /// the body went back, or hardly on, since a moment `before` (and so many seconds ago), and, but for beginnings, of
    /// those that the wide measure (`wide`, of which `usual` is what a moment usually costs) has far from its best.
    pub fn fit(
        &self,
        feature: &Feature,
        before: Option<(&Feature, f64)>,
        (wide, usual): (&[f64], f64),
        out: &mut Vec<f64>,
    ) {
        let values = self.known.iter().map(|&i| feature.values[i] / ACROSS_M);
        let off = DVector::from_iterator(self.known.len(), values) - &self.mean;
        let z = &self.basis * &off;
        let outside = (off.norm_squared() - z.norm_squared()).max(0.0);
        let beyond = BROAD * BROAD;
        // What no row moves need not move elsewhere either.
        let elsewhere = (self.known.len() - z.len()) as f64 * beyond.ln();
        let mut broad = outside.min(outside / beyond + elsewhere);
        for (x, v) in z.iter().zip(self.variances.iter()) {
            broad += x * x / (v + beyond) + (v + beyond).ln();
        }
        let z = z.as_slice();
        let leading = z.len().min(LEADING);
        let log = |squared: f64, log_det: f64| {
            0.5 * TRUST_PER_SEC * (broad - outside - squared - log_det)
        };
        let before = before.filter(|(b, _)| b.unknown == feature.unknown);
        let gone = before.map(|(b, dt)| {
            let steps = self.known.iter().map(|&i| feature.values[i] - b.values[i]);
            let steps = DVector::from_iterator(self.known.len(), steps.map(|d| d / ACROSS_M));
            (self.basis.rows(0, leading) * steps, dt)
        });
        let nearest = wide.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let worth = |s: usize| self.beginning[s] || wide[s] >= nearest - WORTH * usual;
        let stays = |s: usize| {
            gone.as_ref().is_some_and(|(gone, dt)| {
                let along = self.leading.along_phase(gone.as_slice(), s);
                let onward = dt * self.onward[s];
                along < -BACK || (onward > TOLD && along < ONWARD * onward)
            })
        };
        let bound = |(s, log_det): (usize, &Option<f64>)| match log_det {
            Some(d) if worth(s) && !stays(s) => log(self.leading.squared(&z[..leading], s), *d),
            _ => f64::NEG_INFINITY,
        };
        out.clear();
        out.extend(self.log_dets.iter().enumerate().map(bound));
        let whole = |s: usize| match self.log_dets[s] {
            Some(d) => log(self.whole.squared(z, s), d),
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
    }
}

impl Around {
    fn of(directions: usize, count: usize) -> Self {
        Self {
            directions,
            count,
            states: Vec::new(),
        }
    }

    /// Takes a state at a place, with vectors (count x directions) along which it is long; none: only its place.
    /// Returns the logarithm of its determinant.
    fn push(&mut self, place: &[f64], along: Option<&DMatrix<f64>>) -> Result<Option<f64>> {
        self.states.extend_from_slice(&place[..self.directions]);
        let Some(along) = along else {
            let nothing = std::iter::repeat_n(0.0, self.count * self.directions);
            self.states.extend(nothing);
            return Ok(None);
        };
        let w = along.columns(0, self.directions);
        let inner = DMatrix::identity(self.count, self.count) + w * w.transpose();
        let none = || Error::invalid("tangents that are no numbers");
        let l = inner.cholesky().ok_or_else(none)?.l();
        let u = l.solve_lower_triangular(&w).ok_or_else(none)?;
        self.states.extend_from_slice(u.transpose().as_slice());
        Ok(Some(2.0 * l.diagonal().iter().map(|d| d.ln()).sum::<f64>()))
    }

    /// How far a step goes along a state's tangent of phase.
    fn along_phase(&self, step: &[f64], state: usize) -> f64 {
        let d = self.directions;
        let first = state * (1 + self.count) * d + d;
        let tangent = &self.states[first..first + d];
        step.iter().zip(tangent).map(|(x, u)| x * u).sum()
    }

    /// The squared distance of a point to a state.
    fn squared(&self, point: &[f64], state: usize) -> f64 {
        let (d, size) = (self.directions, (1 + self.count) * self.directions);
        let (place, vectors) = self.states[state * size..(state + 1) * size].split_at(d);
        let apart = |(x, y): (&f64, &f64)| (x - y) * (x - y);
        let mut squared: f64 = point.iter().zip(place).map(apart).sum();
        for u in vectors.chunks_exact(d) {
            let residuals = point.iter().zip(place).zip(u);
            let along: f64 = residuals.map(|((x, y), u)| (x - y) * u).sum();
            squared -= along * along;
        }
        squared
    }
}
