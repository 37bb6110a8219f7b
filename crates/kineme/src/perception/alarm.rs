//! [`Alarm`]: when to act on a stream. Readings of single moments change their mind often; whoever answers them moves.

use super::checked::positive;
use crate::error::{Error, Result};
use crate::primitive::Posterior;

/// When a primitive is announced, and for how long.
#[derive(Debug, Clone, PartialEq)]
pub struct AlarmSettings {
    /// Belief is the mean probability of the past, each moment counting less the longer ago it was: a third after so
    /// many seconds. A primitive that is certain from now on is announced `-ln(1 - raise)` times as much later.
    pub memory_secs: f64,
    /// A primitive is announced once it is believed so much, in (0, 1).
    pub raise: f64,
    /// It stays announced until it is believed less than so much, in (0, `raise`], or another one is announced.
    pub release: f64,
}

impl Default for AlarmSettings {
    fn default() -> Self {
        Self {
            memory_secs: 0.1,
            raise: 0.5,
            release: 0.2,
        }
    }
}

/// Announces primitives that were probable for long enough, and holds on to them through moments of doubt (hysteresis).
#[derive(Debug, Clone)]
pub struct Alarm {
    settings: AlarmSettings,
    belief: Vec<f64>,
    announced: Option<usize>,
    heard_secs: Option<f64>,
}

impl Alarm {
    /// An alarm that has heard nothing of a vocabulary of so many primitives.
    ///
    /// # Errors
    /// When a setting is out of its range.
    pub fn new(primitives: usize, settings: &AlarmSettings) -> Result<Self> {
        let AlarmSettings {
            memory_secs,
            raise,
            release,
        } = *settings;
        positive(&[("memory_secs", memory_secs)])?;
        if !(0.0 < release && release <= raise && raise < 1.0) {
            return Err(Error::invalid(format!(
                "an alarm needs 0 < release <= raise < 1, found release {release} and raise {raise}"
            )));
        }
        Ok(Self {
            settings: settings.clone(),
            belief: vec![0.0; primitives],
            announced: None,
            heard_secs: None,
        })
    }

    /// Takes what a recogniser thinks at a time (seconds, later than the one before) and tells which primitive is
    /// announced now.
    ///
    /// # Errors
    /// When the time is not later than the one before, or the posterior is of another vocabulary.
    pub fn hear(&mut self, secs: f64, posterior: &Posterior) -> Result<Option<usize>> {
        if posterior.primitives.len() != self.belief.len() {
            return Err(Error::invalid(format!(
                "an alarm for {} primitives heard of {}",
                self.belief.len(),
                posterior.primitives.len()
            )));
        }
        if !secs.is_finite() || self.heard_secs.is_some_and(|before| secs <= before) {
            return Err(Error::invalid(format!(
                "an alarm hears one moment after the other, found {secs} s after {:?}",
                self.heard_secs
            )));
        }
        // The first moment has lasted no time yet.
        let dt = self.heard_secs.map_or(0.0, |before| secs - before);
        self.heard_secs = Some(secs);
        let share = 1.0 - (-dt / self.settings.memory_secs).exp();
        for (belief, p) in self.belief.iter_mut().zip(&posterior.primitives) {
            *belief += share * (p - *belief);
        }
        let mut most = None;
        for (k, &belief) in self.belief.iter().enumerate() {
            if most.is_none_or(|(_, other)| belief > other) {
                most = Some((k, belief));
            }
        }
        let raised = most.filter(|(_, belief)| *belief >= self.settings.raise);
        let held = self
            .announced
            .filter(|&k| self.belief[k] >= self.settings.release);
        self.announced = raised.map(|(k, _)| k).or(held);
        Ok(self.announced)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 60.0;

    /// What is announced frame by frame when the first of two primitives has these probabilities.
    fn heard(first: &[f64], settings: &AlarmSettings) -> Vec<Option<usize>> {
        let mut alarm = Alarm::new(2, settings).expect("an alarm");
        let of = |(f, &p): (usize, &f64)| {
            let posterior = Posterior {
                primitives: vec![p, 0.0],
                rest: 1.0 - p,
                none: 0.0,
            };
            alarm
                .hear(f as f64 / RATE_HZ, &posterior)
                .expect("a moment")
        };
        first.iter().enumerate().map(of).collect()
    }

    fn run(p: f64, secs: f64) -> Vec<f64> {
        vec![p; (secs * RATE_HZ).round() as usize]
    }

    #[test]
    fn what_is_certain_is_announced_after_the_time_that_the_settings_tell() {
        let settings = AlarmSettings::default();
        let expected = -settings.memory_secs * (1.0 - settings.raise).ln();
        let told = heard(&run(1.0, 2.0), &settings);
        let first = told.iter().position(Option::is_some).expect("announced");
        assert!((first as f64 / RATE_HZ - expected).abs() < 1.5 / RATE_HZ);
        assert!(told[first..].iter().all(|a| *a == Some(0)));
    }

    #[test]
    fn a_moment_raises_no_alarm_and_a_moment_of_doubt_ends_none() {
        let settings = AlarmSettings::default();
        let needed = -settings.memory_secs * (1.0 - settings.raise).ln();
        let flashes: Vec<f64> = (0..10)
            .flat_map(|_| [run(1.0, 0.5 * needed), run(0.0, 0.4)].concat())
            .collect();
        assert!(heard(&flashes, &settings).iter().all(Option::is_none));
        let doubted = [run(1.0, 1.0), run(0.0, 0.1), run(1.0, 0.5)].concat();
        let told = heard(&doubted, &settings);
        assert!(told[60..].iter().all(|a| *a == Some(0)));
        let ended = heard(&[run(1.0, 1.0), run(0.0, 1.0)].concat(), &settings);
        assert_eq!(ended.last(), Some(&None));
    }

    #[test]
    fn impossible_settings_and_moments_are_refused() {
        for (memory_secs, raise, release) in [
            (0.0, 0.6, 0.3),
            (0.3, 1.0, 0.3),
            (0.3, 0.3, 0.6),
            (0.3, 0.6, 0.0),
        ] {
            let settings = AlarmSettings {
                memory_secs,
                raise,
                release,
            };
            assert!(Alarm::new(2, &settings).is_err(), "{settings:?}");
        }
        let posterior = |n: usize| Posterior {
            primitives: vec![0.0; n],
            rest: 1.0,
            none: 0.0,
        };
        let mut alarm = Alarm::new(2, &AlarmSettings::default()).expect("an alarm");
        assert!(alarm.hear(0.0, &posterior(2)).is_ok());
        assert!(alarm.hear(0.0, &posterior(2)).is_err());
        assert!(alarm.hear(1.0, &posterior(3)).is_err());
    }
}
