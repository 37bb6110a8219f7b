//! [`FrameListener`]: the last postures, and what is thought of them together.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use super::chain::{Explained, hold};
use super::{Class, Frame, Moment};
use crate::error::Result;
use crate::perception::parts::Guard;
use crate::primitive::{Listener, Observation, Place, Posterior, Reading};

/// A frame classifier at work on a stream.
pub(super) struct FrameListener<'a> {
    frame: &'a Frame<'a>,
    guard: Guard,
    /// As many as the n postures span, the latest last.
    moments: VecDeque<Moment>,
}

impl<'a> FrameListener<'a> {
    pub fn new(frame: &'a Frame<'a>) -> Self {
        Self {
            frame,
            guard: Guard::default(),
            moments: VecDeque::new(),
        }
    }
}

impl Listener for FrameListener<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        self.guard.check(self.frame.vocabulary.body(), seen)?;
        let (n, stride) = (self.frame.settings.n, self.frame.settings.stride);
        if self.moments.len() > (n - 1) * stride {
            self.moments.pop_front();
        }
        self.moments.push_back(self.frame.moment(seen));
        let last = self.moments.len() - 1;
        // At the beginning of a stream fewer postures have to do.
        let window: Vec<&Moment> = (0..n.min(last / stride + 1))
            .rev()
            .map(|back| &self.moments[last - back * stride])
            .collect();
        Ok(self.frame.reading(&window))
    }
}

impl Frame<'_> {
    /// What is thought of postures in the order of time.
    fn reading(&self, window: &[&Moment]) -> Reading {
        let log_within: f64 = window.iter().map(|m| m.log_within).sum();
        let alphas: Vec<Explained> = self
            .classes
            .iter()
            .enumerate()
            .map(|(k, class)| {
                let first = class.shape.begin(&window[0].classes[k]);
                window[1..]
                    .iter()
                    .fold(first, |alpha, m| class.shape.advance(&alpha, &m.classes[k]))
            })
            .collect();
        let mass = |e: &Explained| e.iter().map(|(_, v)| v).sum::<f64>();
        let rest: f64 = self
            .classes
            .iter()
            .enumerate()
            .map(|(k, class)| class.rest_weight * mass(&class.rest(window, k)))
            .sum();

        // Logarithms of prior times density, all over the density of the background.
        let mut logs: Vec<f64> = alphas.iter().map(|a| mass(a).ln() + log_within).collect();
        logs.push((self.settings.prior_rest * rest).ln() + log_within);
        logs.push(self.settings.prior_none.ln());
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares: Vec<f64> = logs.iter().map(|l| (l - most).exp()).collect();
        let sum: f64 = shares.iter().sum();
        let count = self.classes.len();
        let posterior = Posterior {
            primitives: shares[..count].iter().map(|s| s / sum).collect(),
            rest: shares[count] / sum,
            none: shares[count + 1] / sum,
        };
        let place = posterior
            .leading()
            .and_then(|(k, _)| self.classes[k].place(k, &alphas[k]));
        Reading {
            posterior,
            place,
            novelty: window[window.len() - 1].novelty,
        }
    }
}

impl Class {
    /// The cells of the first and last piece that explain all postures.
    fn rest(&self, window: &[&Moment], class: usize) -> Explained {
        if self.rest_weight == 0.0 {
            return Vec::new();
        }
        let pieces = self.shape.pieces as u32;
        let ends = |m: &Moment| -> Explained {
            let at_end = |c: &u32| [0, pieces - 1].contains(&(c % pieces));
            let cells = m.classes[class].iter();
            cells.filter(|(c, _)| at_end(c)).copied().collect()
        };
        let first = ends(window[0]);
        window[1..]
            .iter()
            .fold(first, |held, m| hold(&held, &ends(m)))
    }

    /// Mean and deviation of phase and parameters over the cells, each uniform within; the mean phase of a cycle is
    /// that of directions.
    fn place(&self, primitive: usize, alpha: &Explained) -> Option<Place> {
        let sum: f64 = alpha.iter().map(|(_, a)| a).sum();
        if sum <= 0.0 {
            return None;
        }
        let pieces = self.shape.pieces as u32;
        let phase_of = |c: u32| (f64::from(c % pieces) + 0.5) / f64::from(pieces);
        let mean =
            |of: &dyn Fn(u32) -> f64| alpha.iter().map(|&(c, a)| a * of(c)).sum::<f64>() / sum;
        let phase = if self.shape.cyclic {
            let sine = mean(&|c| (TAU * phase_of(c)).sin());
            let cosine = mean(&|c| (TAU * phase_of(c)).cos());
            (sine.atan2(cosine) / TAU).rem_euclid(1.0)
        } else {
            mean(&phase_of)
        };
        let away = |c: u32| {
            let d = phase_of(c) - phase;
            if self.shape.cyclic { d - d.round() } else { d }
        };
        let within = 1.0 / (12.0 * f64::from(pieces).powi(2));
        let row = |c: u32, d: usize| (c / pieces) as usize * self.params + d;
        let parameters: Vec<f64> = (0..self.params)
            .map(|d| mean(&|c| self.points[row(c, d)]))
            .collect();
        let deviation = |d: usize| {
            let square = mean(&|c| {
                let gap = self.points[row(c, d)] - parameters[d];
                gap * gap + self.reach[row(c, d)].powi(2) / 3.0
            });
            square.sqrt()
        };
        Some(Place {
            primitive,
            phase,
            phase_deviation: (mean(&|c| away(c).powi(2)) + within).sqrt(),
            parameters_deviation: (0..self.params).map(deviation).collect(),
            parameters,
        })
    }
}
