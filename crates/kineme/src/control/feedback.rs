//! [`Feedback`]: what a body that is not where it was told to be does to the flow.
//!
//! Where a joint is clearly neither where it is told to be nor on the way there, the flow yields: it takes over a share
//! of the deviation, smoothly, and gives it back as smoothly when the deviation is gone (a complementary filter between
//! the flow's posture and the measured one; the return is that of a critically damped spring). Meanwhile it slows down.
//!
//! The loop through the robot is stable whatever the robot's lag: the flow's answer to a deviation is at most the share,
//! at any frequency, so that the loop's gain is below one as long as the robot answers its command with less than one
//! over the share (small-gain theorem; Desoer and Vidyasagar 1975, chapter 3). Lag itself is no deviation: a joint that
//! is somewhere between what was asked of it in the last moments is on its way.

use std::collections::VecDeque;

use super::state::Moving;
use crate::error::{Error, Result};

/// How many commands of the last moments are kept at most.
const MOST_KEPT: usize = 16;
/// A critically damped spring has lost 95 % of its way when its rate times the time is this.
const SETTLED: f64 = 4.74;
/// What is left of a deviation below this (radians, a second) is nothing.
const NOTHING: f64 = 1e-12;
/// Seconds in which the flow changes its speed.
const SPEED_SECS: f64 = 0.1;

/// How the flow answers a body that is not where it was told to be.
///
/// It adds at most `share * most_rad * (4.74 / return_secs)^2` rad/s^2 to what the flows do (28 with the defaults), and
/// 7.5 a second times a joint's speed where the flow slows down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feedback {
    /// The share of a deviation that the flow takes over, in [0, 1). With 1 the posture would be followed wherever it
    /// goes, and lag or gravity would carry it away; with 0 nothing is learned of disturbances.
    pub share: f64,
    /// Deviation that is ordinary, radians a coordinate: what servos leave.
    pub tolerance_rad: f64,
    /// Deviations beyond this count as this, radians a coordinate.
    pub most_rad: f64,
    /// Seconds by which a body may lag behind.
    pub lag_secs: f64,
    /// Seconds in which the flow gives back what it took over.
    pub return_secs: f64,
    /// Deviation at which a behaviour goes at half its pace, radians: u = 1 / (1 + (e / e0)^2).
    pub slowing_rad: f64,
    /// The least share of its pace, in (0, 1]: no deviation makes it stall.
    pub slowest: f64,
}

impl Default for Feedback {
    fn default() -> Self {
        Self {
            share: 0.2,
            tolerance_rad: 0.08,
            most_rad: 1.0,
            lag_secs: 0.1,
            return_secs: 0.4,
            slowing_rad: 0.3,
            slowest: 0.25,
        }
    }
}

impl Feedback {
    pub(super) fn check(&self) -> Result<()> {
        let positive = [
            ("tolerance_rad", self.tolerance_rad),
            ("most_rad", self.most_rad),
            ("return_secs", self.return_secs),
            ("slowing_rad", self.slowing_rad),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::invalid(format!(
                    "{name} must be positive, found {value}"
                )));
            }
        }
        let slows = self.slowest > 0.0 && self.slowest <= 1.0;
        if !(slows && (0.0..1.0).contains(&self.share)) {
            return Err(Error::invalid(format!(
                "feedback takes a share in [0, 1) and slows to a share in (0, 1], found {} and {}",
                self.share, self.slowest
            )));
        }
        if !(0.0..=1.0).contains(&self.lag_secs) {
            return Err(Error::invalid(format!(
                "a body lags by 0 to 1 s, found {}",
                self.lag_secs
            )));
        }
        Ok(())
    }

    /// The next share of its pace of a flow that goes at `speed` while joints deviate by `deviation` radians.
    pub(super) fn speed(&self, speed: f64, deviation: f64, secs: f64) -> f64 {
        let e = deviation / self.slowing_rad;
        let wanted = (1.0 / (1.0 + e * e)).max(self.slowest);
        let next = speed + (wanted - speed) * (1.0 - (-secs / SPEED_SECS).exp());
        if (1.0 - next).abs() < NOTHING {
            1.0
        } else {
            next
        }
    }
}

/// What the flow has taken over of deviations.
#[derive(Debug, Clone)]
pub(super) struct Yielding {
    settings: Feedback,
    secs: f64,
    /// Every how many ticks a command is kept, for how many ticks.
    every: u64,
    ticks: u64,
    asked: VecDeque<Vec<f64>>,
    /// How far each coordinate is from what was asked of it, radians; beyond what is ordinary, with its sign.
    pub deviations: Vec<f64>,
    taken: Vec<f64>,
    velocities: Vec<f64>,
    at_rest: bool,
}

impl Yielding {
    pub fn new(settings: Feedback, rate_hz: f64, dof: usize) -> Self {
        let window = (settings.lag_secs * rate_hz).ceil();
        Self {
            settings,
            secs: 1.0 / rate_hz,
            every: (window / (MOST_KEPT - 1) as f64).ceil().max(1.0) as u64,
            ticks: 0,
            asked: VecDeque::with_capacity(MOST_KEPT + 1),
            deviations: vec![0.0; dof],
            taken: vec![0.0; dof],
            velocities: vec![0.0; dof],
            at_rest: true,
        }
    }

    /// Compares a measured posture with what was asked in the last moments, `asked` last of all; without one, nothing
    /// deviates.
    pub fn feel(&mut self, asked: &[f64], measured: Option<&[f64]>) {
        let keep = (self.settings.lag_secs / self.secs / self.every as f64).ceil() as usize + 1;
        if self.ticks.is_multiple_of(self.every) {
            let mut kept = if self.asked.len() >= keep {
                self.asked.pop_front().unwrap_or_default()
            } else {
                Vec::new()
            };
            kept.clear();
            kept.extend(asked.iter().zip(&self.taken).map(|(a, x)| a - x));
            self.asked.push_back(kept);
        }
        self.ticks += 1;
        let Some(measured) = measured else {
            self.deviations.fill(0.0);
            return;
        };
        for (c, deviation) in self.deviations.iter_mut().enumerate() {
            let now = asked[c] - self.taken[c];
            let (mut low, mut high) = (now, now);
            for row in &self.asked {
                low = low.min(row[c]);
                high = high.max(row[c]);
            }
            let tolerance = self.settings.tolerance_rad;
            let beyond = (measured[c] - high - tolerance).max(0.0)
                + (measured[c] - low + tolerance).min(0.0);
            let most = self.settings.most_rad;
            *deviation = beyond.clamp(-most, most);
        }
    }

    /// A tick on: the share of the deviations draws what is taken over.
    pub fn advance(&mut self) {
        let drawn = self.deviations.iter().any(|d| *d != 0.0);
        if self.at_rest && !drawn {
            return;
        }
        let (rate, t) = (SETTLED / self.settings.return_secs, self.secs);
        let decay = (-rate * t).exp();
        self.at_rest = !drawn;
        let state = self.taken.iter_mut().zip(&mut self.velocities);
        for ((x, v), deviation) in state.zip(&self.deviations) {
            let goal = self.settings.share * deviation;
            let (y, slope) = (*x - goal, *v + rate * (*x - goal));
            *x = goal + (y + slope * t) * decay;
            *v = (slope - rate * (y + slope * t)) * decay;
            self.at_rest &= x.abs() < NOTHING && v.abs() < NOTHING;
        }
        if self.at_rest {
            self.taken.fill(0.0);
            self.velocities.fill(0.0);
        }
    }

    /// Adds what is taken over.
    pub fn add(&self, to: &mut Moving) {
        if self.at_rest {
            return;
        }
        let taken = self.taken.iter().zip(&self.velocities);
        let sums = to.values.iter_mut().zip(&mut to.velocities);
        for ((value, velocity), (x, v)) in sums.zip(taken) {
            *value += x;
            *velocity += v;
        }
    }
}
