//! The filter at work on a stream.

use std::collections::VecDeque;

use super::chain::Kernel;
use super::emission::{Emission, Fit};
use super::features::{Feature, Recent};
use super::place::{Spread, place};
use super::recogniser::Filter;
use super::sight::Sight;
use super::track::Mass;
use crate::error::Result;
use crate::perception::parts::Guard;
use crate::primitive::{Listener, Observation, Observations, Posterior, Reading};

/// Emissions kept for patterns of unknown numbers that come back.
const PATTERNS: usize = 8;
/// Displacements count so much more at rest, where a body stays within half of what people differ by in movement.
const STILL: f64 = 4.0;
/// A longer time between two looks is taken for so much, seconds.
const LONGEST_SECS: f64 = 0.25;
/// Looks gone back over at a time.
const BLOCK: usize = 64;

/// A filter that listens.
pub(super) struct Stream<'a> {
    filter: &'a Filter<'a>,
    guard: Guard,
    sight: Sight<'a>,
    recent: Recent,
    patterns: Patterns<'a>,
    kernels: (f64, Vec<Kernel>),
    mass: Mass,
    /// When the filter last looked.
    looked: Option<f64>,
    fit: Fit,
    /// What was looked at within the lag, the latest last.
    lag: VecDeque<Look>,
    answer: Option<Reading>,
    lag_secs: f64,
}

/// One look: what was believed after it, what it said, and the time since the one before.
struct Look {
    secs: f64,
    dt: f64,
    mass: Mass,
    likelihood: Mass,
    pose: Vec<f64>,
}

/// The emission for what is known, and for displacements alone.
struct Pair {
    all: Emission,
    displacements: Emission,
}

struct Patterns<'a> {
    filter: &'a Filter<'a>,
    made: VecDeque<Pair>,
}

impl Patterns<'_> {
    /// The emissions when these numbers are unknown.
    fn of(&mut self, unknown: &[bool]) -> Result<(&Emission, &Emission)> {
        if !unknown.contains(&true) {
            return Ok((&self.filter.stream.emission, &self.filter.displacements));
        }
        let found = self.made.iter().position(|p| p.all.unknown == unknown);
        let at = match found {
            Some(at) => at,
            None => {
                let model = &self.filter.stream;
                let still = model.layout.still();
                let hidden: Vec<bool> = still.iter().zip(unknown).map(|(s, u)| *s || *u).collect();
                let pair = Pair {
                    all: model.without(unknown)?,
                    displacements: model.without(&hidden)?,
                };
                self.made.truncate(PATTERNS - 1);
                self.made.push_front(pair);
                0
            }
        };
        Ok((&self.made[at].all, &self.made[at].displacements))
    }
}

impl<'a> Stream<'a> {
    /// A filter that answers with so much hindsight.
    pub fn new(filter: &'a Filter<'a>, lag_secs: f64) -> Self {
        let model = &filter.stream;
        Self {
            guard: Guard::default(),
            sight: Sight::new(&model.layout, &model.bounds),
            recent: Recent::default(),
            patterns: Patterns {
                filter,
                made: VecDeque::new(),
            },
            kernels: (f64::NAN, Vec::new()),
            mass: filter.network.prior(&model.rows),
            looked: None,
            fit: Fit::default(),
            lag: VecDeque::new(),
            answer: None,
            lag_secs,
            filter,
        }
    }

    /// Answers for every frame of a motion, each with at least the hindsight asked for as far as the motion allows;
    /// without places. Looks are gone back over many at a time, which costs little more than once.
    pub fn all(&mut self, seen: &Observations) -> Result<Vec<Reading>> {
        let frames = seen.motion().frames();
        let mut readings: Vec<Option<Reading>> = vec![None; frames];
        let frame = |secs: f64| ((secs * seen.motion().rate_hz()).round() as usize).min(frames - 1);
        for f in 0..frames {
            self.take(&seen.at(f))?;
            let ends = f + 1 == frames;
            let latest = self.lag.back().map_or(0.0, |l| l.secs);
            if !ends && self.lag.len() < BLOCK {
                continue;
            }
            let masses = self.smoothed();
            for mass in masses {
                let Some(look) = self.lag.front() else { break };
                if !ends && latest - look.secs < self.lag_secs {
                    break;
                }
                readings[frame(look.secs)] = Some(self.filter.reading(&mass, None)?);
                self.lag.pop_front();
            }
        }
        let mut last = readings.iter().flatten().next().cloned();
        let filled = readings.into_iter().map(|r| {
            if r.is_some() {
                last = r;
            }
            last.clone()
        });
        Ok(filled.flatten().collect())
    }

    /// Takes an observation; whether it was looked at.
    fn take(&mut self, seen: &Observation<'_>) -> Result<bool> {
        self.guard.check(self.filter.vocabulary.body(), seen)?;
        let moment = self.sight.see(seen);
        let secs = seen.secs;
        self.recent.push(moment);
        let tick = 1.0 / self.filter.settings.clock_hz;
        // A frame in time is looked at though clocks differ in their last digits.
        let due = self.looked.is_none_or(|l| secs - l >= 0.98 * tick);
        let (true, Some(now), Some(then)) = (due, self.recent.now(), self.recent.then()) else {
            return Ok(false);
        };
        let feature = self.filter.stream.layout.feature(now, &then, None);
        // What lies further apart than displacements look back is no more evidence than that.
        let dt = self.looked.map_or(tick, |l| (secs - l).min(LONGEST_SECS));
        let look = self.look(&feature, secs, dt)?;
        self.looked = Some(secs);
        self.lag.push_back(look);
        Ok(true)
    }

    /// Takes a feature and believes what it says.
    fn look(&mut self, feature: &Feature, secs: f64, dt: f64) -> Result<Look> {
        let (all, displacements) = self.patterns.of(&feature.unknown)?;
        all.fit(feature, &mut self.fit);
        let rows = &self.filter.stream.rows;
        if self.looked.is_some() {
            if self.kernels.1.is_empty() || (self.kernels.0 - dt).abs() > 1e-6 {
                self.kernels = (dt, rows.iter().map(|r| Kernel::of(r, dt)).collect());
            }
            let network = &self.filter.network;
            self.mass = network.forward(rows, &self.kernels.1, &self.mass, dt);
        }
        // At rest the displacements are nothing, and the posture may be any: it fits as postures usually do.
        let posture = (all.usual_cost() - displacements.usual_cost()).max(0.0);
        let rest = dt * (STILL * displacements.fit_to_zero(feature) - posture);
        let none = dt * (self.fit.broad + self.filter.learned.unknown_per_sec);
        let likelihood = Mass::likelihood(&self.fit.states, dt, rest, none);
        self.mass.weigh(&likelihood);
        Ok(Look {
            secs,
            dt,
            mass: self.mass.clone(),
            likelihood,
            pose: self.sight.pose(),
        })
    }

    /// What is believed of each look within the lag, the oldest first, in the light of those after it.
    fn smoothed(&self) -> Vec<Mass> {
        let (network, rows) = (&self.filter.network, &self.filter.stream.rows);
        let mut smoothed = Vec::with_capacity(self.lag.len());
        let mut worth: Option<Mass> = None;
        for (k, look) in self.lag.iter().enumerate().rev() {
            let mut mass = look.mass.clone();
            if let Some(worth) = &worth {
                mass.weigh(worth);
            }
            smoothed.push(mass);
            if k == 0 {
                break;
            }
            let seen = match worth {
                None => look.likelihood.clone(),
                Some(mut worth) => {
                    worth.weigh(&look.likelihood);
                    worth
                }
            };
            let kernels: Vec<Kernel>;
            let kernels = match (self.kernels.0 - look.dt).abs() <= 1e-6 {
                true => &self.kernels.1,
                false => {
                    kernels = rows.iter().map(|r| Kernel::of(r, look.dt)).collect();
                    &kernels
                }
            };
            worth = Some(network.backward(rows, kernels, &seen, look.dt));
        }
        smoothed.reverse();
        smoothed
    }
}

impl Listener for Stream<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let looked = self.take(seen)?;
        if let (false, Some(answer)) = (looked, &self.answer) {
            return Ok(answer.clone());
        }
        let from = seen.secs - self.lag_secs;
        while self.lag.get(1).is_some_and(|l| l.secs <= from + 1e-9) {
            self.lag.pop_front();
        }
        let masses = self.smoothed();
        let mass = masses.first().unwrap_or(&self.mass);
        let pose = self.lag.front().map(|l| l.pose.as_slice());
        let reading = self.filter.reading(mass, pose)?;
        self.answer = Some(reading.clone());
        Ok(reading)
    }
}

impl Filter<'_> {
    /// What is thought when so much is believed of each state; where on the primitive, if the pose is given.
    fn reading(&self, mass: &Mass, pose: Option<&[f64]>) -> Result<Reading> {
        let rows = &self.stream.rows;
        let mut primitives = vec![0.0; self.vocabulary.primitives().len()];
        let mut rest = mass.rest;
        for (r, row) in rows.iter().enumerate() {
            let own = &mass.states[self.network.starts[r]..self.network.starts[r + 1]];
            let last = own.len() - 1;
            for (k, m) in own.iter().enumerate() {
                // Standing still before or after a movement is rest; its moments are the first and last, many times.
                let still = !row.cyclic
                    && ((row.progress[k] == 0.0 && row.progress[(k + 1).min(last)] == 0.0)
                        || (row.progress[k] == 1.0 && row.progress[k.saturating_sub(1)] == 1.0));
                match still {
                    true => rest += m,
                    false => primitives[row.primitive] += m,
                }
            }
        }
        let posterior = Posterior {
            primitives,
            rest,
            none: mass.none,
        };
        let place = match (posterior.leading().filter(|(_, p)| *p > 0.0), pose) {
            (Some((leading, _)), Some(pose)) => {
                let spread = Spread::of(rows, &self.network.starts, &mass.states, leading);
                let primitive = &self.vocabulary.primitives()[leading];
                spread
                    .map(|s| place(primitive, leading, &s, pose))
                    .transpose()?
            }
            _ => None,
        };
        Ok(Reading {
            novelty: 2.0 * posterior.none,
            posterior,
            place,
        })
    }
}
