//! [`Class`]: one primitive as the paper's classifier knows it: samples, their densities and envelopes.

use rayon::prelude::*;

use super::histogram::Histogram;
use super::intervals::{Envelope, Intervals, moments, not_before};
use crate::error::Result;
use crate::perception::parts::{Parts, Posture, Scope};
use crate::perception::rows::{MOST_DIMS, is_inside, lattice, own_places};
use crate::primitive::{Place, Primitive};

/// Samples of f: all parameters sampled at all ends of pieces of phase.
#[derive(Debug)]
pub(super) struct Samples {
    /// Parameters, samples x parameters.
    points: Vec<Vec<f64>>,
    /// Coordinates, phases x samples x coordinates.
    values: Vec<f32>,
    dims: usize,
}

impl Samples {
    /// Of a primitive: an even lattice of parameters inside the exemplars' hull, and the exemplars' own.
    pub fn of(
        primitive: &Primitive,
        parts: &Parts,
        across: &[usize; MOST_DIMS],
        pieces: usize,
    ) -> Result<Self> {
        let params = primitive.parameters().dims();
        let mut points = match params {
            0 => vec![Vec::new()],
            1..=MOST_DIMS => lattice(params, across[params - 1]),
            _ => Vec::new(),
        };
        points.retain(|p| is_inside(primitive, p));
        points.extend(own_places(primitive));
        let courses: Vec<Vec<Vec<f64>>> = points
            .par_iter()
            .map(|p| {
                let course = primitive.at(p)?;
                let place = |i: usize| parts.place(&course.pose(i as f64 / pieces as f64));
                Ok((0..=pieces).map(place).collect())
            })
            .collect::<Result<_>>()?;
        let rows = (0..=pieces).flat_map(|i| courses.iter().map(move |c| &c[i]));
        let values = rows.flatten().map(|&x| x as f32).collect();
        Ok(Self {
            points,
            values,
            dims: parts.dims(),
        })
    }

    fn phase(&self, i: usize) -> &[f32] {
        let size = self.points.len() * self.dims;
        &self.values[i * size..(i + 1) * size]
    }

    /// The samples of one coordinate, phase by phase.
    fn coordinate(&self, c: usize) -> Vec<Vec<f64>> {
        let size = self.points.len() * self.dims;
        let of = |row: &[f32]| {
            row.iter()
                .skip(c)
                .step_by(self.dims)
                .map(|&x| f64::from(x))
                .collect::<Vec<f64>>()
        };
        self.values.chunks_exact(size).map(of).collect()
    }

    /// The least and greatest value of each coordinate.
    pub fn bounds(&self) -> Vec<[f64; 2]> {
        let mut bounds = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.dims];
        for row in self.values.chunks_exact(self.dims) {
            for (b, x) in bounds.iter_mut().zip(row) {
                *b = [b[0].min(f64::from(*x)), b[1].max(f64::from(*x))];
            }
        }
        bounds
    }
}

/// One primitive.
#[derive(Debug)]
pub(super) struct Class {
    samples: Samples,
    pieces: usize,
    cyclic: bool,
    /// Coordinates that some primitive moves, those first that tell most about phase.
    order: Vec<Coordinate>,
}

/// One coordinate of a primitive.
#[derive(Debug)]
pub(super) struct Coordinate {
    /// Its place in a posture.
    pub at: usize,
    pub envelope: Envelope,
    pub histogram: Histogram,
    /// The logarithm of the range of the uniform density under "not this primitive".
    pub log_range: f64,
}

impl Class {
    pub fn new(samples: Samples, scope: &Scope, pieces: usize, cyclic: bool) -> Self {
        let delta = scope.tolerances.delta;
        let mut order: Vec<(f64, Coordinate)> = scope
            .moving
            .par_iter()
            .map(|&at| {
                let own = samples.coordinate(at);
                let least = |row: &Vec<f64>| row.iter().copied().fold(f64::INFINITY, f64::min);
                let most = |row: &Vec<f64>| row.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let envelope = Envelope {
                    low: own.iter().map(least).collect(),
                    high: own.iter().map(most).collect(),
                };
                let coordinate = Coordinate {
                    at,
                    histogram: Histogram::new(&own, delta),
                    log_range: scope.range(at).ln(),
                    envelope,
                };
                (told(&coordinate.envelope, delta), coordinate)
            })
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.at.cmp(&b.1.at)));
        Self {
            samples,
            pieces,
            cyclic,
            order: order.into_iter().map(|(_, c)| c).collect(),
        }
    }

    /// The coordinates in the order of the chain.
    pub fn chain(&self) -> &[Coordinate] {
        &self.order
    }

    /// The samples of one coordinate, phase by phase.
    pub fn samples(&self, at: usize) -> Vec<Vec<f64>> {
        self.samples.coordinate(at)
    }

    /// The logarithm of the density of postures in the order of time over that of the uniform density, and the phases
    /// that the last one may have; `None` where the primitive cannot produce them.
    pub fn judge(&self, window: &[&Posture], delta: f64) -> Option<(f64, Intervals)> {
        let mut log = 0.0;
        let mut phases = vec![(0.0, self.pieces as f64)];
        let mut found = Intervals::new();
        for (t, posture) in window.iter().enumerate() {
            if t > 0 {
                // A cycle may be anywhere after anywhere: its phase decreases where it begins anew.
                phases = match self.cyclic {
                    true => vec![(0.0, self.pieces as f64)],
                    false => not_before(&phases, self.pieces),
                };
            }
            for c in &self.order {
                let x = posture.place[c.at];
                if x.is_nan() {
                    continue;
                }
                c.envelope.attained(x, delta, &phases, &mut found);
                if found.is_empty() {
                    return None;
                }
                log += c.histogram.density(x, delta, &phases).ln() + c.log_range;
                std::mem::swap(&mut phases, &mut found);
            }
        }
        Some((log, phases))
    }

    /// How far a posture is from being possible at some phase, in tolerances, if it is less than `most`.
    pub fn distance(&self, posture: &Posture, delta: f64, most: f64) -> f64 {
        let mut least = most;
        for end in 0..=self.pieces {
            let mut farthest: f64 = 0.0;
            for c in &self.order {
                // `max` ignores the NaN of what was not seen.
                farthest = farthest.max(c.envelope.gap(posture.place[c.at], end) / delta);
                if farthest >= least {
                    break;
                }
            }
            least = least.min(farthest);
        }
        least
    }

    /// Phase as a uniform draw from the phases left. The chain has forgotten which parameters produced the postures;
    /// they are those of samples at these phases, each weighted by a Gaussian kernel of the tolerance's width on the
    /// coordinate of the last posture that is farthest off.
    pub fn place(&self, primitive: usize, phases: &Intervals, last: &Posture, delta: f64) -> Place {
        let (phase, variance) = moments(phases).unwrap_or((0.0, 0.0));
        let points = &self.samples.points;
        let mut least = vec![f64::INFINITY; points.len()];
        for at in some_of(phases) {
            let rows = self.samples.phase(at).chunks_exact(self.samples.dims);
            for (least, row) in least.iter_mut().zip(rows) {
                let gap = |c: &Coordinate| (f64::from(row[c.at]) - last.place[c.at]).abs();
                let farthest = self.order.iter().map(gap).fold(0.0, f64::max);
                *least = least.min(farthest);
            }
        }
        let nearest = least.iter().copied().fold(f64::INFINITY, f64::min);
        let kernel = |d: &f64| (0.5 * (nearest * nearest - d * d) / (delta * delta)).exp();
        let weights: Vec<f64> = least.iter().map(kernel).collect();
        let whole: f64 = weights.iter().sum();
        let mean = |of: &dyn Fn(&[f64]) -> f64| {
            let pairs = points.iter().zip(&weights);
            pairs.map(|(p, w)| w * of(p)).sum::<f64>() / whole
        };
        let params = points[0].len();
        let parameters: Vec<f64> = (0..params).map(|d| mean(&|p| p[d])).collect();
        let deviation = |d: usize| mean(&|p| (p[d] - parameters[d]).powi(2)).sqrt();
        let pieces = self.pieces as f64;
        Place {
            primitive,
            phase: phase / pieces,
            phase_deviation: variance.sqrt() / pieces,
            parameters_deviation: (0..params).map(deviation).collect(),
            parameters,
        }
    }
}

/// Sampled phases in a set, or next to it where it holds none; of many every so many.
fn some_of(phases: &Intervals) -> Vec<usize> {
    const MOST: usize = 16;
    let mut all: Vec<usize> = Vec::new();
    for &(from, to) in phases {
        let (a, b) = (from.ceil() as usize, to.floor() as usize);
        match a <= b {
            true => all.extend(a..=b),
            false => all.push((0.5 * (from + to)).round() as usize),
        }
    }
    all.dedup();
    let step = all.len().div_ceil(MOST).max(1);
    all.into_iter().step_by(step).collect()
}

/// How much a coordinate tells about phase: how far the middle of its envelope goes, over how wide the envelope is.
fn told(envelope: &Envelope, delta: f64) -> f64 {
    let pairs = || envelope.low.iter().zip(&envelope.high);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (l, h) in pairs() {
        let middle = 0.5 * (l + h);
        (low, high) = (low.min(middle), high.max(middle));
    }
    let width: f64 = pairs().map(|(l, h)| h - l).sum();
    (high - low) / (width / envelope.low.len() as f64 + 2.0 * delta)
}
