//! Registration: the exemplars of a group are brought to one clock, the phase.
//!
//! Registration curves after Kovar and Gleicher (2003), for any number of exemplars: all are aligned to the medoid,
//! then in turn to the mean of what has been aligned (Procrustes' method in time), until the mean stays.

use rayon::prelude::*;

use super::centre::centred;
use super::dtw::{Band, LocalCost, frames_of, squared_distance};
use super::pairs::{Sequences, pair_distances};
use super::slope::align_sloped;
use super::smooth::Smoother;
use super::warp::{Warp, resample, uniform};
use crate::error::{Error, Result};

/// Every how manieth knot serves to find the medoid, which needs all pairs.
const MEDOID_STRIDE: usize = 2;

/// Settings of registration.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    /// Evenly spaced phases at which sequences are compared and warps have their knots; at least 4.
    pub knots: usize,
    /// How far a warp may stray from even time, as a share of the movement, in [0, 1].
    pub band: f64,
    /// The steepest local slope of a warping path, at least 1; one over it is the least.
    pub slope: f64,
    /// Rounds of refinement after the alignment to the medoid; 0 for none.
    pub rounds: usize,
    /// Refinement ends when the mean changes by less than this share of its own motion (root mean square).
    pub tolerance: f64,
    /// Weight of the velocities beside the positions, which count 1 (Keogh and Pazzani's 2001 derivative warping in
    /// part, so that plateaus do not hold the path); velocities are scaled to the size of the positions.
    pub velocity: f64,
    /// The sequences are whole cycles, whose last frame is the first again: warps are closed, the mean too.
    pub cyclic: bool,
}

impl Default for Registration {
    fn default() -> Self {
        Self {
            knots: 64,
            band: 0.15,
            slope: 3.0,
            rounds: 5,
            tolerance: 1e-3,
            velocity: 0.1,
            cyclic: false,
        }
    }
}

/// One sequence registered to a mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Aligned {
    /// From phase to the place in the sequence.
    pub warp: Warp,
    /// Distance from the mean at equal phase: root mean square over the knots of the Euclidean distance of two
    /// frames, in the unit of the features.
    pub cost: f64,
}

/// A group of sequences registered to their common mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Registered {
    /// The sequence with the least sum of warping distances to all others.
    pub medoid: usize,
    /// One for each sequence; at every knot the mean of their places is the phase, and between knots their slope
    /// is at least 0.2.
    pub warps: Vec<Warp>,
    /// The distance of each sequence from the mean, as [`Aligned::cost`].
    pub costs: Vec<f64>,
    /// The mean of the registered sequences, `knots` frames.
    pub mean: Vec<f64>,
    /// Rounds of refinement that were kept.
    pub rounds: usize,
}

impl Registration {
    /// Registers sequences (row-major, `dims` numbers a frame, each of its own length) to their mean.
    ///
    /// The result for each sequence depends on the set of the others but not on their order, to the last bit.
    /// The work grows with the square of the number of sequences (the medoid) times `knots^2 * band * dims`.
    ///
    /// # Errors
    /// Without a sequence, when one is none (as for [`align`](super::align)), when a setting is out of its range,
    /// or when the band has no path of the wanted slope.
    pub fn register(&self, sequences: &[&[f64]], dims: usize) -> Result<Registered> {
        let smoother = self.smoother()?;
        if sequences.is_empty() {
            return Err(Error::invalid("registration needs at least one sequence"));
        }
        let even = uniform(self.knots);
        let mut members = Vec::with_capacity(sequences.len());
        for (place, sequence) in sequences.iter().enumerate() {
            frames_of(sequence, dims)?;
            let uniform = resample(sequence, dims, &even);
            members.push(Member {
                place,
                sequence,
                uniform,
            });
        }
        // Sums depend on their order in the last bit: one order for all.
        members.sort_by(|a, b| lexicographic(&a.uniform, &b.uniform));
        let medoid = self.medoid(&members, dims)?;
        let aim = members[medoid].uniform.clone();
        let mut best = self.round(&members, dims, &smoother, &aim, None)?;
        let mut rounds = 0;
        while rounds < self.rounds {
            let next = self.round(&members, dims, &smoother, &best.mean, Some(&best))?;
            if next.total >= best.total {
                break;
            }
            let change = relative_change(&best.mean, &next.mean, dims);
            (best, rounds) = (next, rounds + 1);
            if change < self.tolerance {
                break;
            }
        }
        let mut order: Vec<usize> = (0..members.len()).collect();
        order.sort_by_key(|&i| members[i].place);
        Ok(Registered {
            medoid: members[medoid].place,
            warps: order.iter().map(|&i| best.warps[i].clone()).collect(),
            costs: order.iter().map(|&i| best.costs[i]).collect(),
            mean: best.mean,
            rounds,
        })
    }

    /// Registers one more sequence to a mean that [`Self::register`] gave.
    ///
    /// # Errors
    /// When the reference has not `knots` frames; else as for [`Self::register`].
    pub fn register_to(&self, reference: &[f64], sequence: &[f64], dims: usize) -> Result<Aligned> {
        let smoother = self.smoother()?;
        let frames = frames_of(reference, dims)?;
        frames_of(sequence, dims)?;
        if frames != self.knots {
            return Err(Error::invalid(format!(
                "the reference needs {} frames, one a knot, found {frames}",
                self.knots
            )));
        }
        let aim = Aim::new(self, reference, dims);
        let even = resample(sequence, dims, &uniform(self.knots));
        let warp = aim.align(&even, &smoother)?;
        let cost = cost(reference, &resample(sequence, dims, warp.places()), dims);
        Ok(Aligned { warp, cost })
    }

    /// Checks the settings and prepares what all warps share.
    fn smoother(&self) -> Result<Smoother> {
        let at_least_0 = |v: f64| v.is_finite() && v >= 0.0;
        if self.knots < 4 {
            return Err(Error::invalid(format!(
                "registration needs at least 4 knots, found {}",
                self.knots
            )));
        }
        for (name, value) in [
            ("band", self.band),
            ("tolerance", self.tolerance),
            ("velocity", self.velocity),
        ] {
            if !at_least_0(value) {
                return Err(Error::invalid(format!(
                    "the {name} of a registration must be at least 0, found {value}"
                )));
            }
        }
        Smoother::new(self.knots, self.cyclic)
    }

    fn medoid(&self, members: &[Member], dims: usize) -> Result<usize> {
        let frames = self.knots.div_ceil(MEDOID_STRIDE);
        let mut values = Vec::with_capacity(members.len() * frames * dims);
        for member in members {
            let knots = member.uniform.chunks_exact(dims);
            values.extend(knots.step_by(MEDOID_STRIDE).flatten());
        }
        let sequences = Sequences::new(&values, frames, dims)?;
        let distances = pair_distances(&sequences, Band::radius(self.band, frames));
        let sums = distances
            .chunks_exact(members.len())
            .map(|row| row.iter().sum::<f64>());
        let least = sums.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        Ok(least.map_or(0, |(i, _)| i))
    }

    /// Aligns all to `aim`; where a member's warp of the round before fits the aim better, it keeps that.
    fn round(
        &self,
        members: &[Member],
        dims: usize,
        smoother: &Smoother,
        aim: &[f64],
        before: Option<&Round>,
    ) -> Result<Round> {
        let target = Aim::new(self, aim, dims);
        let warps: Vec<Warp> = members
            .par_iter()
            .enumerate()
            .map(|(i, member)| {
                let warp = target.align(&member.uniform, smoother)?;
                let fit =
                    |w: &Warp| squared_distance(aim, &resample(member.sequence, dims, w.places()));
                Ok(match before {
                    Some(before) if fit(&before.warps[i]) <= fit(&warp) => before.warps[i].clone(),
                    _ => warp,
                })
            })
            .collect::<Result<_>>()?;
        Round::new(members, dims, self, centred(&warps, self.cyclic)?)
    }
}

/// A sequence of the group.
struct Member<'a> {
    /// Where it was in the list.
    place: usize,
    sequence: &'a [f64],
    /// It at even time, one frame a knot.
    uniform: Vec<f64>,
}

/// Where a round of refinement stands.
struct Round {
    warps: Vec<Warp>,
    mean: Vec<f64>,
    costs: Vec<f64>,
    /// Sum of the squared costs.
    total: f64,
}

impl Round {
    fn new(
        members: &[Member],
        dims: usize,
        settings: &Registration,
        warps: Vec<Warp>,
    ) -> Result<Self> {
        let warped: Vec<Vec<f64>> = members
            .par_iter()
            .zip(&warps)
            .map(|(m, w)| resample(m.sequence, dims, w.places()))
            .collect();
        let mut mean = vec![0.0; settings.knots * dims];
        for sequence in &warped {
            for (sum, v) in mean.iter_mut().zip(sequence) {
                *sum += v;
            }
        }
        for sum in &mut mean {
            *sum /= members.len() as f64;
        }
        if settings.cyclic {
            let (first, rest) = mean.split_at_mut(dims);
            let start = rest.len() - dims;
            for (a, b) in first.iter_mut().zip(&mut rest[start..]) {
                *a = 0.5 * (*a + *b);
                *b = *a;
            }
        }
        let costs: Vec<f64> = warped.par_iter().map(|w| cost(&mean, w, dims)).collect();
        let total: f64 = costs.iter().map(|c| c * c).sum();
        if !total.is_finite() {
            return Err(Error::invalid(
                "the sequences lie so far apart that their distance overflows",
            ));
        }
        Ok(Self {
            warps,
            mean,
            costs,
            total,
        })
    }
}

/// What sequences are aligned to: the reference with its velocities.
struct Aim<'a> {
    settings: &'a Registration,
    dims: usize,
    /// Factor of the velocities, a knot of time being the unit.
    scale: f64,
    /// Positions and scaled velocities.
    values: Vec<f64>,
}

impl<'a> Aim<'a> {
    fn new(settings: &'a Registration, reference: &[f64], dims: usize) -> Self {
        let rates = velocities(reference, dims, settings.cyclic);
        let speed: f64 = rates.iter().map(|v| v * v).sum();
        let scale = if speed > 0.0 {
            (settings.velocity * spread(reference, dims) / speed).sqrt()
        } else {
            0.0
        };
        Self {
            settings,
            dims,
            scale,
            values: joined(reference, &rates, dims, scale),
        }
    }

    /// The warp of a sequence given at even time, one frame a knot.
    fn align(&self, even: &[f64], smoother: &Smoother) -> Result<Warp> {
        let rates = velocities(even, self.dims, self.settings.cyclic);
        let values = joined(even, &rates, self.dims, self.scale);
        let path = align_sloped(
            &self.values,
            &values,
            2 * self.dims,
            Band::Slanted(Band::radius(self.settings.band, self.settings.knots)),
            LocalCost::SquaredEuclidean,
            self.settings.slope,
        )?
        .path;
        smoother.warp(&path)
    }
}

/// Central differences a knot; one-sided at open ends, around the end of a cycle.
fn velocities(values: &[f64], dims: usize, cyclic: bool) -> Vec<f64> {
    let last = values.len() / dims - 1;
    let mut out = Vec::with_capacity(values.len());
    for k in 0..=last {
        let (a, b, span) = if cyclic && (k == 0 || k == last) {
            (last - 1, 1, 2)
        } else {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            (a, b, b - a)
        };
        let (x, y) = (
            &values[a * dims..(a + 1) * dims],
            &values[b * dims..(b + 1) * dims],
        );
        out.extend(x.iter().zip(y).map(|(x, y)| (y - x) / span as f64));
    }
    out
}

/// Frames of positions followed by scaled velocities.
fn joined(values: &[f64], rates: &[f64], dims: usize, scale: f64) -> Vec<f64> {
    let mut out = Vec::with_capacity(2 * values.len());
    for (frame, rate) in values.chunks_exact(dims).zip(rates.chunks_exact(dims)) {
        out.extend_from_slice(frame);
        out.extend(rate.iter().map(|v| v * scale));
    }
    out
}

/// Sum of the squared distances of the frames from their mean.
pub(super) fn spread(values: &[f64], dims: usize) -> f64 {
    let count = (values.len() / dims) as f64;
    let mut mean = vec![0.0; dims];
    for frame in values.chunks_exact(dims) {
        for (m, v) in mean.iter_mut().zip(frame) {
            *m += v / count;
        }
    }
    let frames = values.chunks_exact(dims);
    frames.map(|f| squared_distance(f, &mean)).sum()
}

fn cost(mean: &[f64], warped: &[f64], dims: usize) -> f64 {
    (squared_distance(mean, warped) / (mean.len() / dims) as f64).sqrt()
}

fn relative_change(before: &[f64], after: &[f64], dims: usize) -> f64 {
    let motion = spread(after, dims);
    if motion > 0.0 {
        (squared_distance(before, after) / motion).sqrt()
    } else {
        0.0
    }
}

fn lexicographic(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    let mut pairs = a.iter().zip(b);
    pairs
        .find_map(|(x, y)| Some(x.total_cmp(y)).filter(|o| o.is_ne()))
        .unwrap_or(std::cmp::Ordering::Equal)
}
