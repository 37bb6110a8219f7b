//! Neighbourhoods of the rows' moments on the manifold: spheres that are long along the tangents.

use nalgebra::DMatrix;

use crate::error::{Error, Result};

/// Neighbourhoods of states: spheres that are long along the tangents.
#[derive(Debug, Clone)]
pub(super) struct Around {
    pub directions: usize,
    /// Tangents of each state.
    count: usize,
    /// Of each state: its place, and `count` vectors whose products with a residual take their squares off its length;
    /// states x (1 + count) x directions.
    states: Vec<f64>,
}

impl Around {
    pub fn of(directions: usize, count: usize) -> Self {
        Self {
            directions,
            count,
            states: Vec::new(),
        }
    }

    /// Takes a state at a place, with vectors (count x directions) along which it is long; none: only its place.
    /// Returns the logarithm of its determinant.
    pub fn push(&mut self, place: &[f64], along: Option<&DMatrix<f64>>) -> Result<Option<f64>> {
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
    pub fn along_phase(&self, step: &[f64], state: usize) -> f64 {
        let d = self.directions;
        let first = state * (1 + self.count) * d + d;
        let tangent = &self.states[first..first + d];
        let step = &step[..d];
        sum(d, |i| step[i] * tangent[i])
    }

    /// The squared distance of a point to a state.
    pub fn squared(&self, point: &[f64], state: usize) -> f64 {
        let first = state * (1 + self.count) * self.directions;
        self.apart(point, &self.states[first..first + self.directions], state)
    }

    /// The squared distance of a point to a place, long along the tangents of a state.
    pub fn apart(&self, point: &[f64], place: &[f64], state: usize) -> f64 {
        let (d, size) = (self.directions, (1 + self.count) * self.directions);
        let vectors = &self.states[state * size + d..(state + 1) * size];
        let (point, place) = (&point[..d], &place[..d]);
        let off = |i: usize| point[i] - place[i];
        let mut squared = sum(d, |i| off(i) * off(i));
        for u in vectors.chunks_exact(d) {
            let along = sum(d, |i| off(i) * u[i]);
            squared -= along * along;
        }
        squared
    }
}

/// The sum of so many terms, four at a time: one sum would wait for each addition before the next.
#[inline]
fn sum(count: usize, term: impl Fn(usize) -> f64) -> f64 {
    let mut lanes = [0.0; 4];
    let whole = count - count % 4;
    for first in (0..whole).step_by(4) {
        for (lane, sum) in lanes.iter_mut().enumerate() {
            *sum += term(first + lane);
        }
    }
    lanes.iter().sum::<f64>() + (whole..count).map(term).sum::<f64>()
}
