//! The encoder on a stream: a decision at a time, as far behind as its horizon is long.

use nalgebra::Vector3;

use super::chains::{FAR, shares};
use super::cost::Block;
use super::encoder::Encoder;
use super::paths::{Chains, EffectorPaths, Places};
use super::settings::SAMPLES;
use super::track::Tracker;
use crate::error::{Error, Result};
use crate::primitive::{
    Listener, Observation, Observations, Place, Posterior, Reading, Recogniser, Recognition,
    Vocabulary,
};

/// How long before a decision the heading is looked at, in widths of its mean.
const HEADING_WIDTHS: f64 = 3.5;
/// A gap after which a stream begins anew, seconds.
const GAP_SECS: f64 = 1.0;
/// Decisions over which novelty is told.
const NOVELTY_DECISIONS: f64 = 5.0;

impl Recogniser for Encoder<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.vocabulary
    }

    /// Answers about the moment a horizon ago; the paper's method is followed by hypotheses here, too.
    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(Stream::new(self))
    }

    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        if **seen.motion().skeleton() != **self.vocabulary.body() {
            return Err(Error::invalid(format!(
                "`{}` is a motion of the body `{}`, the vocabulary is of `{}`",
                seen.motion().name(),
                seen.motion().skeleton().name(),
                self.vocabulary.body().name()
            )));
        }
        self.recognised(seen)
    }
}

/// A stream of postures of the vocabulary's body.
struct Stream<'a> {
    encoder: &'a Encoder<'a>,
    tracker: Tracker<'a>,
    /// Recent places and their times.
    heard: Vec<(f64, Places)>,
    /// When the next decision's part begins.
    start_secs: f64,
    reading: Reading,
    novelty: f64,
    /// A soft minimum over summed costs that matches that over means.
    temperature: f64,
}

impl<'a> Stream<'a> {
    fn new(encoder: &'a Encoder<'a>) -> Self {
        let s = &encoder.settings;
        let cells: usize = encoder.rows.iter().map(|r| r.cells()).sum();
        let mean = cells as f64 / encoder.rows.len() as f64;
        let decisions = (mean / s.cells(1.0, SAMPLES)).max(1.0);
        Self {
            tracker: Tracker::new(&encoder.rows, s, encoder.rejection.limit, false),
            encoder,
            heard: Vec::new(),
            start_secs: f64::NEG_INFINITY,
            reading: Reading {
                posterior: Posterior {
                    primitives: vec![0.0; encoder.vocabulary.primitives().len()],
                    rest: 0.0,
                    none: 1.0,
                },
                place: None,
                novelty: 0.0,
            },
            novelty: 0.0,
            temperature: encoder.rejection.temperature * decisions,
        }
    }

    /// Where things were at a time, linear between what was heard.
    fn places(&self, secs: f64) -> Places {
        let after = self.heard.partition_point(|(t, _)| *t < secs);
        let after = after.min(self.heard.len() - 1);
        let before = after.saturating_sub(1);
        let ((t0, a), (t1, b)) = (&self.heard[before], &self.heard[after]);
        let share = ((secs - t0) / (t1 - t0).max(1e-12)).clamp(0.0, 1.0);
        let between = |a: &Vector3<f64>, b: &Vector3<f64>| a.lerp(b, share);
        Places {
            shoulders: a
                .shoulders
                .zip(b.shoulders)
                .map(|([l0, r0], [l1, r1])| [between(&l0, &l1), between(&r0, &r1)]),
            effectors: a
                .effectors
                .iter()
                .zip(&b.effectors)
                .map(|(a, b)| match share {
                    0.0 => *a,
                    1.0 => *b,
                    _ => Some(between(a.as_ref()?, b.as_ref()?)),
                })
                .collect(),
        }
    }

    /// The decision about what began at `start_secs`.
    fn decide(&mut self) -> Result<()> {
        let s = &self.encoder.settings;
        let step = s.cell_secs();
        let first = self.heard[0].0;
        let margin = (HEADING_WIDTHS * s.heading_secs).min(self.start_secs - first);
        let lead = (margin / step).floor().max(0.0) as usize;
        let ahead = s.cells(1.0, s.horizon()) as usize;
        let grid = (0..=lead + ahead).map(|k| {
            let from_start = k as f64 - lead as f64;
            self.places(self.start_secs + from_start * step)
        });
        let paths = EffectorPaths::seen(1.0 / step, &s.effectors, grid.collect(), s.heading_secs)?;
        let every = s.cells(1.0, 1) as usize;
        let scale = s.reach_m.map_or(1.0, |r| self.encoder.body_reach_m() / r);
        let instants: Vec<Vec<_>> = (0..=s.horizon())
            .map(|k| {
                paths
                    .at(lead + k * every)
                    .iter()
                    .map(|p| p.map(|p| p * scale))
                    .collect()
            })
            .collect();
        let block = Block::new(&instants, SAMPLES);
        let still = self.encoder.is_still(&block, self.encoder.body_reach_m());
        self.tracker.step(&block, still, |row| row.unit_m);
        self.read(&block);
        Ok(())
    }

    fn read(&mut self, block: &Block) {
        let primitives = self.encoder.vocabulary.primitives().len();
        let (mut costs, rest, none) = self.tracker.standing(primitives);
        costs.extend([rest, none]);
        let mut all = shares(&costs, self.temperature);
        let none = all.pop().unwrap_or(1.0);
        let rest = all.pop().unwrap_or(0.0);
        let posterior = Posterior {
            primitives: all,
            rest,
            none,
        };
        if !block.is_blind() {
            let paid = self.tracker.last_cost() / self.encoder.rejection.limit;
            self.novelty += (paid - self.novelty) / NOVELTY_DECISIONS;
        }
        let leading = posterior.leading().filter(|(_, p)| *p > 0.0);
        self.reading = Reading {
            place: leading.map(|(k, _)| self.place(k)),
            novelty: self.novelty,
            posterior,
        };
    }

    /// Where a primitive is: the mean over its hypotheses, as likely as they are.
    fn place(&self, primitive: usize) -> Place {
        let known = &self.encoder.vocabulary.primitives()[primitive];
        let own = || {
            let rows = self.encoder.rows.iter().zip(self.tracker.reached());
            rows.filter(|(row, _)| row.primitive == primitive)
        };
        let least = own().flat_map(|(_, r)| r).copied().fold(FAR, f64::min);
        let dims = known.parameters().dims();
        let (mut all, mut turn) = (0.0, [0.0; 2]);
        let mut first = vec![0.0; dims + 1];
        let mut second = vec![0.0; dims + 1];
        for (row, reached) in own() {
            for (phase, cost) in row.phases.iter().zip(reached) {
                if *cost >= FAR {
                    continue;
                }
                let weight = (-(cost - least) / self.temperature.min(0.1)).exp();
                let values = [phase].into_iter().chain(known.point(row.exemplar));
                for ((f, s), v) in first.iter_mut().zip(&mut second).zip(values) {
                    *f += weight * v;
                    *s += weight * v * v;
                }
                let angle = std::f64::consts::TAU * phase;
                turn[0] += weight * angle.cos();
                turn[1] += weight * angle.sin();
                all += weight;
            }
        }
        let all = f64::max(all, 1e-12);
        let mean: Vec<f64> = first.iter().map(|f| f / all).collect();
        let pairs = second.iter().zip(&mean);
        let deviation: Vec<f64> = pairs
            .map(|(s, m)| (s / all - m * m).max(0.0).sqrt())
            .collect();
        let (mut phase, mut phase_deviation) = (mean[0], deviation[0]);
        if known.is_cyclic() {
            let length = (turn[0].hypot(turn[1]) / all).clamp(1e-9, 1.0);
            phase = (turn[1].atan2(turn[0]) / std::f64::consts::TAU).rem_euclid(1.0);
            // Of directions (Mardia 1972).
            phase_deviation = (-2.0 * length.ln()).max(0.0).sqrt() / std::f64::consts::TAU;
        }
        Place {
            primitive,
            phase,
            phase_deviation,
            parameters: mean[1..].to_vec(),
            parameters_deviation: deviation[1..].to_vec(),
        }
    }
}

impl Listener for Stream<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let encoder = self.encoder;
        let (body, s) = (encoder.vocabulary.body(), &encoder.settings);
        if seen.pose.len() != body.dof() || seen.pose.iter().any(|v| !v.is_finite()) {
            return Err(Error::invalid(format!(
                "{} coordinates, or some not finite, are no posture of the body `{}`, which has {}",
                seen.pose.len(),
                body.name(),
                body.dof()
            )));
        }
        let last = self.heard.last().map(|(t, _)| *t);
        if !seen.secs.is_finite() || last.is_some_and(|t| seen.secs <= t) {
            return Err(Error::invalid(format!(
                "a posture at {} s is not later than the one before",
                seen.secs
            )));
        }
        if last.is_none_or(|t| seen.secs - t > GAP_SECS) {
            *self = Self::new(encoder);
            self.start_secs = seen.secs;
        }
        let places = Chains::of(body, &s.effectors)?.observed(seen);
        self.heard.push((seen.secs, places));
        let horizon = s.horizon() as f64 * s.sample_secs();
        while seen.secs + 1e-9 >= self.start_secs + horizon {
            self.decide()?;
            self.start_secs += s.decision_secs;
        }
        let oldest = self.start_secs - HEADING_WIDTHS * s.heading_secs - s.decision_secs;
        let stale = self
            .heard
            .partition_point(|(t, _)| *t < oldest)
            .saturating_sub(1);
        self.heard.drain(..stale);
        Ok(self.reading.clone())
    }
}
