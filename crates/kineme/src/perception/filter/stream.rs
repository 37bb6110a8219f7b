//! The filter at work on a stream.

use std::collections::VecDeque;
use std::sync::Arc;

use super::emission::Fit;
use super::exact::Exact;
use super::features::{Feature, Recent};
use super::going::Looks;
use super::manner::{Belief, Manifold, Steps, likelihood};
use super::patterns::Known;
use super::recogniser::Filter;
use super::rows::Row;
use super::sight::Sight;
use super::steady::Steady;
use super::track::Mass;
use crate::error::Result;
use crate::perception::parts::Guard;
use crate::primitive::{Listener, Observation, Observations, Reading};

/// Displacements count so much more at rest, where a body stays within half of what people differ by in movement.
const STILL: f64 = 4.0;
/// Displacements vary by so many times the jitter of postures: two of these err, hands, which tell most, jitter more than
/// the mean, and what is averaged errs alike for some looks.
const SHAKEN: f64 = 8.0;
/// Among people, so many times what a moment costs that fits as well as any does is taken off unknown movement a second:
/// beginning a movement has its price at once, and evidence that counts little would be late to pay it.
const STRANGE: f64 = 2.4;
/// Bodies that carry primitives out are looked at so many times as often: they begin and end at a moment, which people
/// do not.
const OFTENER: f64 = 4.0;
/// A longer time between two looks is taken for so much, seconds.
const LONGEST_SECS: f64 = 0.25;
/// Looks gone back over at a time.
const BLOCK: usize = 64;

/// A filter that listens.
pub(super) struct Stream<'a> {
    filter: &'a Filter<'a>,
    guard: Guard,
    sight: Sight<'a>,
    steady: Steady,
    recent: Recent,
    /// What postures are compared by as long as the same numbers are unknown.
    known: Option<Arc<Known>>,
    steps: Option<Steps>,
    /// States of a body that stands still.
    still: Vec<usize>,
    belief: Belief,
    /// What the filter last looked at, and when.
    looks: Looks,
    looked: Option<f64>,
    fit: Fit,
    exact: Vec<f64>,
    /// What was looked at within the lag, the latest last.
    lag: VecDeque<Look>,
    /// What is believed now of the looks within the lag, the oldest first.
    hindsight: Vec<Mass>,
    answer: Option<Reading>,
    lag_secs: f64,
}

/// One look: what was believed after it, what it said, and the time since the one before.
struct Look {
    secs: f64,
    dt: f64,
    belief: Belief,
    likelihood: Belief,
    pose: Vec<f64>,
}

impl<'a> Stream<'a> {
    /// A filter that answers with so much hindsight.
    pub fn new(filter: &'a Filter<'a>, lag_secs: f64) -> Self {
        let model = &filter.stream;
        Self {
            guard: Guard::default(),
            sight: Sight::new(model),
            steady: Steady::default(),
            recent: Recent::default(),
            known: None,
            steps: None,
            still: still(&model.rows, &filter.network.starts),
            belief: Belief::prior(filter.network.prior(&model.rows), filter.patterns.exact()),
            looks: Looks::default(),
            looked: None,
            fit: Fit::default(),
            exact: Vec::new(),
            lag: VecDeque::new(),
            hindsight: Vec::new(),
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
        // A frame that was not looked at is answered as the look nearest in time.
        let looked: Vec<usize> = (0..frames).filter(|&f| readings[f].is_some()).collect();
        let nearest = |f: usize| {
            let after = looked.partition_point(|&l| l < f);
            let beside = [after.checked_sub(1), Some(after)].into_iter().flatten();
            let looks = beside.filter_map(|k| looked.get(k).copied());
            looks.min_by_key(|&l| l.abs_diff(f))
        };
        let answer = |f: usize| readings[nearest(f)?].clone();
        Ok((0..frames).filter_map(answer).collect())
    }

    /// Takes an observation; whether it was looked at.
    fn take(&mut self, seen: &Observation<'_>) -> Result<bool> {
        self.guard.check(self.filter.vocabulary.body(), seen)?;
        let mut moment = self.sight.see(seen);
        // Among people alone jitter is not asked: they differ by more than that.
        if self.belief.exact.is_some() {
            moment = self.steady.take(moment);
        }
        let secs = seen.secs;
        self.recent.push(moment);
        let oftener = match self.belief.exact {
            Some(_) => OFTENER,
            None => 1.0,
        };
        let tick = 1.0 / (self.filter.settings.clock_hz * oftener);
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
        let known = match self.known.take() {
            Some(known) if known.all.unknown == feature.unknown => known,
            _ => self
                .filter
                .patterns
                .of(&self.filter.stream, &feature.unknown)?,
        };
        self.known = Some(Arc::clone(&known));
        let Known {
            all,
            displacements,
            exact,
        } = &*known;
        all.fit(feature, &mut self.fit);
        if self.looked.is_some() {
            let both = self.belief.exact.is_some();
            let kept = self.steps.take();
            let kept = kept.filter(|k| (k.secs - dt).abs() <= 1e-6);
            let steps = kept.unwrap_or_else(|| Steps::of(self.filter, dt, both));
            self.belief = self.belief.forward(self.filter, &steps);
            self.steps = Some(steps);
        }
        // At rest the displacements are nothing, and the posture may be any: it fits as postures usually do.
        let posture = (all.usual_cost() - displacements.usual_cost()).max(0.0);
        let jitter = self.steady.jitter();
        let rest = dt * (displacements.fit_to_zero(feature, STILL, SHAKEN * jitter) - posture);
        let unknown = self.filter.learned.unknown_per_sec;
        let unknown = match self.filter.stream.lasting {
            None => unknown,
            Some(share) => share * unknown - STRANGE * all.usual_cost(),
        };
        let none = dt * (self.fit.broad + unknown);
        let mut exactly = None;
        if let Some(exact) = exact {
            let wide = (self.fit.states.as_slice(), all.usual_cost());
            let going = self.looks.take(feature, dt);
            let straight = exact.fit(feature, (going.as_ref(), jitter), wide, &mut self.exact);
            let told = Exact::told(jitter);
            for (log, alike) in self.exact.iter_mut().zip(&self.fit.states) {
                *log = match *log {
                    // Where sensors say little, they rule out nothing.
                    f64::NEG_INFINITY if told > 0.5 => f64::NEG_INFINITY,
                    f64::NEG_INFINITY => *alike,
                    log => told * (log + self.fit.broad) + (1.0 - told) * alike,
                };
            }
            // Who stands where movements begin or end stands there exactly, and does not move. It is one of these places
            // all the time, not another at every look: the best fit counts, and not their mean.
            let fits = self.still.iter().map(|&s| self.exact[s]);
            let best = fits.fold(f64::NEG_INFINITY, f64::max);
            let standing = dt * (best - exact.moving(feature, jitter));
            let none = none + dt * (told * straight).max(0.0);
            exactly = Some(Manifold {
                states: &self.exact,
                standing,
                none,
            });
        }
        let mut likelihood = likelihood(&self.fit.states, exactly, dt, rest, none);
        if likelihood.exact.is_none() && self.belief.exact.is_some() {
            // What is known does not tell the manners apart.
            likelihood.exact = Some(likelihood.alike.clone());
        }
        self.belief.weigh(&likelihood);
        Ok(Look {
            secs,
            dt,
            belief: self.belief.clone(),
            likelihood,
            pose: self.sight.pose(),
        })
    }

    /// What is believed of each look within the lag, the oldest first, in the light of those after it.
    fn smoothed(&self) -> Vec<Mass> {
        let mut smoothed = Vec::with_capacity(self.lag.len());
        let mut worth: Option<Belief> = None;
        for (k, look) in self.lag.iter().enumerate().rev() {
            let mut belief = look.belief.clone();
            if let Some(worth) = &worth {
                belief.weigh(worth);
            }
            smoothed.push(belief.whole());
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
            let kept = self.steps.as_ref();
            let made: Steps;
            let steps = match kept.filter(|k| (k.secs - look.dt).abs() <= 1e-6) {
                Some(kept) => kept,
                None => {
                    made = Steps::of(self.filter, look.dt, look.belief.exact.is_some());
                    &made
                }
            };
            worth = Some(seen.backward(self.filter, steps));
        }
        smoothed.reverse();
        smoothed
    }
}

impl Listener for Stream<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let looked = self.take(seen)?;
        // The look nearest to the moment that is asked for; those before it are of no use any more.
        let from = seen.secs - self.lag_secs;
        let apart = |look: &Look| (look.secs - from).abs();
        let mut passed = 0;
        while self.lag.len() > 1 && apart(&self.lag[1]) <= apart(&self.lag[0]) + 1e-9 {
            self.lag.pop_front();
            passed += 1;
        }
        if looked {
            self.hindsight = self.smoothed();
        } else {
            self.hindsight.drain(..passed);
        }
        if let (false, 0, Some(answer)) = (looked, passed, &self.answer) {
            return Ok(answer.clone());
        }
        let pose = self.lag.front().map(|l| l.pose.as_slice());
        let reading = match self.hindsight.first() {
            Some(mass) => self.filter.reading(mass, pose)?,
            None => self.filter.reading(&self.belief.clone().whole(), pose)?,
        };
        self.answer = Some(reading.clone());
        Ok(reading)
    }
}

/// States of a body that stands still before a movement or after it.
fn still(rows: &[Row], starts: &[usize]) -> Vec<usize> {
    let mut still = Vec::new();
    for (row, start) in rows.iter().zip(starts) {
        let stands = (0..row.progress.len()).filter(|&k| row.stands(k));
        still.extend(stands.map(|k| start + k));
    }
    still
}
