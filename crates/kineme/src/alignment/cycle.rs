//! One whole cycle cut out of a periodic sequence, beginning at the same event as those of the others.

use rayon::prelude::*;

use super::dtw::{frames_of, squared_distance};
use super::period::{period, vertex};
use super::warp::{push_frame, uniform};
use crate::error::{Error, Result};
use crate::math::statistics::median;

/// Phases at which cycles are compared.
const PHASES: usize = 32;
/// How far the length of a cycle may be from the period, and a beginning from the event, as a share of it.
const SLACK: f64 = 0.15;
/// Lengths and beginnings tried within that, on either side.
const TRIALS: usize = 8;
/// Beginnings tried in a period when the best closing cycle is looked for.
const BEGINNINGS: usize = 16;

/// One cycle of a sequence: a stretch of it whose end meets its beginning, read from a given point onward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// First frame of the stretch, with a fraction.
    pub start: f64,
    /// Its length in frames, with a fraction; the last frame is the first again.
    pub frames: f64,
    /// Where in the stretch phase 0 is, as a share of it, in [0, 1): 0 unless the sequence is too short for
    /// a whole cycle that begins at the wanted event.
    pub shift: f64,
    /// Distance of its two ends as a share of what its frames stray from their mean: how badly it closes.
    pub gap: f64,
    /// Distance from the reference, root mean square over phases of the Euclidean distance of frames, in the unit of
    /// the features; 0 without a reference.
    pub cost: f64,
}

impl Cycle {
    /// The frame of the sequence, with a fraction, at a phase in [0, 1].
    pub fn frame(&self, phase: f64) -> f64 {
        self.start + self.frames * self.place(phase)
    }

    /// Where in the stretch a phase lies, in [0, 1]; phase 1 without a shift is its end.
    fn place(&self, phase: f64) -> f64 {
        let place = phase.clamp(0.0, 1.0) + self.shift;
        if place > 1.0 { place - 1.0 } else { place }
    }

    /// The cycle at evenly spaced phases from 0 to 1, row-major, linear between frames, the gap between
    /// its ends spread evenly over it: the last frame is the first.
    ///
    /// # Errors
    /// As for [`align`](super::align); with fewer than two phases, or when the cycle is not within the sequence.
    pub fn sample(&self, sequence: &[f64], dims: usize, phases: usize) -> Result<Vec<f64>> {
        let last = (frames_of(sequence, dims)? - 1) as f64;
        if phases < 2 || !(self.start >= 0.0 && self.start + self.frames <= last + 1e-9) {
            return Err(Error::invalid(format!(
                "no {phases} frames of a cycle from frame {} to {} in a sequence of {} frames",
                self.start,
                self.start + self.frames,
                last + 1.0
            )));
        }
        Ok(self.closed(sequence, dims, phases))
    }

    fn closed(&self, sequence: &[f64], dims: usize, phases: usize) -> Vec<f64> {
        let mut ends = Vec::with_capacity(2 * dims);
        push_frame(sequence, dims, self.start, &mut ends);
        push_frame(sequence, dims, self.start + self.frames, &mut ends);
        let (first, last) = ends.split_at(dims);
        let mut out = Vec::with_capacity(phases * dims);
        for phase in uniform(phases) {
            let place = self.place(phase);
            let begun = out.len();
            push_frame(sequence, dims, self.start + self.frames * place, &mut out);
            for (v, (a, b)) in out[begun..].iter_mut().zip(first.iter().zip(last)) {
                *v -= (b - a) * (place - 0.5);
            }
        }
        out
    }
}

/// The cycle of a sequence (row-major, `dims` numbers a frame) that closes best, about `period` frames long.
///
/// With a reference (one cycle, at evenly spaced phases, both ends the same) it begins where the reference does:
/// the phase is found by circular correlation, so that a walk cut at the other foot is half a cycle away and is
/// brought into step. Of the whole cycles that begin there the one is taken that closes and fits best;
/// where the sequence holds none, the best closing one is read round its end ([`Cycle::shift`]).
///
/// # Errors
/// As for [`align`](super::align); when the period is not at least 2 frames, or the reference not of two frames or more.
pub fn cycle(
    sequence: &[f64],
    dims: usize,
    period: f64,
    reference: Option<&[f64]>,
) -> Result<Cycle> {
    let frames = frames_of(sequence, dims)?;
    if !period.is_finite() || period < 2.0 || frames < 3 {
        return Err(Error::invalid(format!(
            "a cycle needs a period of at least 2 frames and 3 frames to cut from, found {period} and {frames}"
        )));
    }
    let cutter = Cutter {
        sequence,
        dims,
        last: (frames - 1) as f64,
        period: period.min((frames - 1) as f64),
    };
    let free = cutter.best_closing();
    let Some(reference) = reference else {
        return Ok(free);
    };
    if frames_of(reference, dims)? < 2 {
        return Err(Error::invalid("a reference cycle needs at least 2 frames"));
    }
    let whole = Cycle {
        start: 0.0,
        frames: (reference.len() / dims - 1) as f64,
        shift: 0.0,
        gap: 0.0,
        cost: 0.0,
    };
    Ok(cutter.in_step(free, &whole.closed(reference, dims, PHASES + 1)))
}

/// One cycle of each sequence of a group, all beginning at the same event; `None` when the group is not cyclic.
///
/// `declared` says whether it is; otherwise it is when [`period`] finds more than half of the sequences periodic.
/// A sequence without a period of its own (one cycle only, or too uneven) is taken to have the group's in
/// seconds, or where nobody has one is a cycle as it stands. The event is the beginning of the medoid cycle, the one with
/// the least sum of distances to the others at the best relative phase.
///
/// # Errors
/// As for [`cycle`]; when there is not one rate (hertz) for each sequence.
pub fn cycles(
    sequences: &[&[f64]],
    dims: usize,
    rates_hz: &[f64],
    declared: Option<bool>,
) -> Result<Option<Vec<Cycle>>> {
    if rates_hz.len() != sequences.len() {
        return Err(Error::invalid(format!(
            "{} sequences need as many rates, found {}",
            sequences.len(),
            rates_hz.len()
        )));
    }
    if declared == Some(false) || sequences.is_empty() {
        return Ok(None);
    }
    let found: Vec<Option<f64>> = sequences
        .par_iter()
        .zip(rates_hz)
        .map(|(s, &rate)| Ok(period(s, dims, rate)?.map(|p| p.frames / rate)))
        .collect::<Result<_>>()?;
    let secs: Vec<f64> = found.iter().copied().flatten().collect();
    if declared.is_none() && 2 * secs.len() <= sequences.len() {
        return Ok(None);
    }
    let common = median(&secs);
    let periods: Vec<f64> = sequences
        .iter()
        .zip(rates_hz)
        .zip(&found)
        .map(|((s, rate), own)| match (own, common) {
            // Two cycles of the others may be one of this one when its sides differ; it is two all the same.
            (Some(own), Some(common)) => rate * own / (own / common).round().max(1.0),
            (None, Some(common)) => rate * common,
            _ => (s.len() / dims) as f64 - 1.0,
        })
        .collect();
    let cut = |reference: Option<&[f64]>| -> Result<Vec<Cycle>> {
        sequences
            .par_iter()
            .zip(&periods)
            .map(|(s, &p)| cycle(s, dims, p, reference))
            .collect()
    };
    let free = cut(None)?;
    let sampled: Vec<Vec<f64>> = free
        .iter()
        .zip(sequences)
        .map(|(c, s)| c.closed(s, dims, PHASES + 1))
        .collect();
    let medoid = medoid(&sampled, dims);
    cut(Some(&sampled[medoid])).map(Some)
}

/// The cycle nearest to all others at the best relative phase; of equally near ones the one whose
/// numbers come first, so that the order of the cycles does not matter.
fn medoid(cycles: &[Vec<f64>], dims: usize) -> usize {
    let sums: Vec<f64> = cycles
        .par_iter()
        .map(|a| {
            let mut distances: Vec<f64> = cycles.iter().map(|b| best_shift(a, b, dims).1).collect();
            distances.sort_unstable_by(f64::total_cmp);
            distances.iter().sum()
        })
        .collect();
    let numbers = |a: &[f64], b: &[f64]| {
        let mut pairs = a.iter().zip(b).map(|(x, y)| x.total_cmp(y));
        pairs
            .find(|o| o.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    };
    (0..cycles.len())
        .min_by(|&i, &j| {
            let near = sums[i].total_cmp(&sums[j]);
            near.then_with(|| numbers(&cycles[i], &cycles[j]))
        })
        .unwrap_or(0)
}

/// The share of a cycle by which `b` must be read later to fit `a` best, and the squared distance then, a phase.
/// Both hold [`PHASES`] + 1 frames, the last as the first.
fn best_shift(a: &[f64], b: &[f64], dims: usize) -> (f64, f64) {
    let row = |k: usize| (k % PHASES) * dims..(k % PHASES + 1) * dims;
    let sums: Vec<f64> = (0..PHASES)
        .map(|shift| {
            (0..PHASES)
                .map(|k| squared_distance(&a[row(k)], &b[row(k + shift)]))
                .sum::<f64>()
                / PHASES as f64
        })
        .collect();
    let best = (0..PHASES)
        .min_by(|&i, &j| sums[i].total_cmp(&sums[j]))
        .unwrap_or(0);
    let (before, after) = (
        sums[(best + PHASES - 1) % PHASES],
        sums[(best + 1) % PHASES],
    );
    let shift = (best as f64 + vertex(before, sums[best], after)) / PHASES as f64;
    // The remainder of a number just below 0 rounds to 1.
    let shift = shift.rem_euclid(1.0);
    (if shift < 1.0 { shift } else { 0.0 }, sums[best])
}

/// Looks for cycles in one sequence.
struct Cutter<'a> {
    sequence: &'a [f64],
    dims: usize,
    last: f64,
    period: f64,
}

impl Cutter<'_> {
    /// The cycle from `start`, `frames` long, with its gap: its ends compared over a few frames to either side,
    /// as meeting postures are not enough, they must also move alike.
    fn candidate(&self, start: f64, frames: f64) -> Cycle {
        let (mut gap, mut count) = (0.0, 0.0);
        let mut ends = Vec::with_capacity(2 * self.dims);
        for k in -2i32..=2 {
            let aside = f64::from(k) * self.period / PHASES as f64;
            if start + aside < 0.0 || start + frames + aside > self.last {
                continue;
            }
            ends.clear();
            push_frame(self.sequence, self.dims, start + aside, &mut ends);
            push_frame(self.sequence, self.dims, start + frames + aside, &mut ends);
            let (a, b) = ends.split_at(self.dims);
            gap += squared_distance(a, b);
            count += 1.0;
        }
        Cycle {
            start,
            frames,
            shift: 0.0,
            gap: gap / f64::max(count, 1.0),
            cost: 0.0,
        }
    }

    /// Lengths tried, as multiples of the period.
    fn lengths(&self) -> impl Iterator<Item = f64> {
        let period = self.period;
        let last = self.last;
        trials()
            .map(move |t| period * (1.0 + SLACK * t))
            .map(move |l| l.min(last))
    }

    fn best_closing(&self) -> Cycle {
        let mut best: Option<Cycle> = None;
        for frames in self.lengths() {
            let room = self.last - frames;
            let count = (room / self.period * BEGINNINGS as f64).ceil() as usize;
            for i in 0..=count {
                let found = self.candidate(room * i as f64 / count.max(1) as f64, frames);
                if best.is_none_or(|b| found.gap < b.gap) {
                    best = Some(found);
                }
            }
        }
        let best = best.unwrap_or_else(|| self.candidate(0.0, self.period.min(self.last)));
        let own = best.closed(self.sequence, self.dims, PHASES + 1);
        self.rated(best, &own, None)
    }

    /// The cycle in step with a reference of [`PHASES`] + 1 frames.
    fn in_step(&self, free: Cycle, reference: &[f64]) -> Cycle {
        let own = free.closed(self.sequence, self.dims, PHASES + 1);
        let (shift, _) = best_shift(reference, &own, self.dims);
        let mut best: Option<(f64, Cycle)> = None;
        let first = free.start + shift * free.frames;
        let turns = (first / free.frames).ceil() as i64;
        let mut event = first - turns as f64 * free.frames;
        while event <= self.last {
            for aside in trials() {
                let start = event + aside * SLACK * free.frames;
                for frames in self.lengths() {
                    if start < 0.0 || start + frames > self.last {
                        continue;
                    }
                    let found = self.candidate(start, frames);
                    if best.is_some_and(|(b, _)| found.gap >= b) {
                        continue;
                    }
                    let cost = self.cost(&found, reference);
                    let both = cost * cost + found.gap;
                    if best.is_none_or(|(b, _)| both < b) {
                        best = Some((both, found));
                    }
                }
            }
            event += free.frames;
        }
        let turned = Cycle {
            shift,
            ..self.candidate(free.start, free.frames)
        };
        let best = match best {
            // A cycle cut far from the event only because the sequence ends is worse than one read round the end.
            Some((_, found))
                if self.cost(&found, reference) <= 1.25 * self.cost(&turned, reference) =>
            {
                found
            }
            _ => turned,
        };
        self.rated(best, &own, Some(reference))
    }

    fn cost(&self, cycle: &Cycle, reference: &[f64]) -> f64 {
        let own = cycle.closed(self.sequence, self.dims, PHASES + 1);
        (squared_distance(&own, reference) / (PHASES + 1) as f64).sqrt()
    }

    /// The cycle with its gap relative to its motion and its distance from the reference.
    fn rated(&self, cycle: Cycle, own: &[f64], reference: Option<&[f64]>) -> Cycle {
        let frames = (own.len() / self.dims) as f64;
        let motion = super::registration::spread(own, self.dims) / frames;
        Cycle {
            gap: if motion > 0.0 {
                (cycle.gap / motion).sqrt()
            } else {
                0.0
            },
            cost: reference.map_or(0.0, |r| self.cost(&cycle, r)),
            ..cycle
        }
    }
}

/// Evenly spaced numbers from -1 to 1, 0 among them.
fn trials() -> impl Iterator<Item = f64> {
    (0..=2 * TRIALS).map(|k| k as f64 / TRIALS as f64 - 1.0)
}
