//! [`Attention`]: from readings of every moment to what is worth an answer.

use crate::error::{Error, Result};
use crate::primitive::Reading;

/// Rounding of times that is no time.
const ROUNDING_SECS: f64 = 1e-9;

/// When a movement counts as noticed.
///
/// A filter's answers of single moments change their mind; whoever answers with a movement of their own wants few false
/// alarms and little delay. Hence a threshold that must be held for a while, and a lower one to let go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attention {
    /// A movement is noticed when it is so probable ...
    pub notice: f64,
    /// ... for so long, seconds, ...
    pub sustain_secs: f64,
    /// ... and is over when it is less probable than this ...
    pub release: f64,
    /// ... for so long, seconds.
    pub linger_secs: f64,
}

impl Default for Attention {
    fn default() -> Self {
        Self {
            notice: 0.6,
            sustain_secs: 0.1,
            release: 0.3,
            linger_secs: 0.2,
        }
    }
}

impl Attention {
    pub(super) fn check(&self) -> Result<()> {
        for (name, value) in [("notice", self.notice), ("release", self.release)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::invalid(format!(
                    "{name} is a probability in [0, 1], found {value}"
                )));
            }
        }
        if self.release > self.notice {
            return Err(Error::invalid(format!(
                "what is noticed at {} cannot be over at {}",
                self.notice, self.release
            )));
        }
        for (name, secs) in [
            ("sustain_secs", self.sustain_secs),
            ("linger_secs", self.linger_secs),
        ] {
            if !(secs.is_finite() && secs >= 0.0) {
                return Err(Error::invalid(format!(
                    "{name} must be 0 or more, found {secs}"
                )));
            }
        }
        Ok(())
    }
}

/// Attention at work on a stream of readings.
#[derive(Debug, Clone)]
pub(super) struct Attending {
    attention: Attention,
    /// What leads, and since when it has been probable enough without a break.
    candidate: Option<(usize, f64)>,
    /// What is noticed, and since when it has been too improbable, if it is.
    noticed: Option<(usize, Option<f64>)>,
}

impl Attending {
    pub fn new(attention: Attention) -> Self {
        Self {
            attention,
            candidate: None,
            noticed: None,
        }
    }

    /// Takes the reading of a moment; the primitive that is noticed now.
    pub fn attend(&mut self, secs: f64, reading: &Reading) -> Option<usize> {
        let asked = self.attention;
        let probable = &reading.posterior.primitives;
        let leading = reading.posterior.leading();
        self.candidate = match (leading, self.candidate) {
            (Some((k, p)), Some((before, since))) if p >= asked.notice && k == before => {
                Some((k, since))
            }
            (Some((k, p)), _) if p >= asked.notice => Some((k, secs)),
            _ => None,
        };
        if let Some((k, over)) = &mut self.noticed {
            *over = match (*over, probable[*k] < asked.release) {
                (_, false) => None,
                (None, true) => Some(secs),
                (since, true) => since,
            };
            if over.is_some_and(|since| secs - since >= asked.linger_secs - ROUNDING_SECS) {
                self.noticed = None;
            }
        }
        if let Some((k, since)) = self.candidate
            && secs - since >= asked.sustain_secs - ROUNDING_SECS
            && self.noticed.is_none_or(|(now, _)| now != k)
        {
            self.noticed = Some((k, None));
        }
        self.noticed.map(|(k, _)| k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitive::Posterior;

    fn reading(probable: [f64; 2]) -> Reading {
        Reading {
            posterior: Posterior {
                primitives: probable.to_vec(),
                rest: 0.0,
                none: 1.0 - probable[0] - probable[1],
            },
            place: None,
            novelty: 0.0,
        }
    }

    #[test]
    fn what_lasts_is_noticed_and_what_flickers_is_not() {
        let (a, b, no) = ([0.9, 0.0], [0.0, 0.9], [0.1, 0.1]);
        let weak = [0.4, 0.1];
        type Case<'a> = (&'a [[f64; 2]], &'a [Option<usize>]);
        // Readings at 10 a second, and what is noticed.
        let cases: [Case; 5] = [
            (&[a, no, a, no, b, a], &[None; 6]),
            (&[a, a, a], &[None, Some(0), Some(0)]),
            // Held by the lower threshold; let go after a while below it.
            (
                &[a, a, weak, no, weak, no, no, no],
                &[
                    None,
                    Some(0),
                    Some(0),
                    Some(0),
                    Some(0),
                    Some(0),
                    Some(0),
                    None,
                ],
            ),
            // Another movement that lasts takes over at once.
            (&[a, a, b, b], &[None, Some(0), Some(0), Some(1)]),
            (&[weak; 6], &[None; 6]),
        ];
        for (readings, wanted) in cases {
            let mut attending = Attending::new(Attention::default());
            for (k, (seen, wanted)) in readings.iter().zip(wanted).enumerate() {
                let secs = k as f64 / 10.0;
                assert_eq!(attending.attend(secs, &reading(*seen)), *wanted, "{k}");
            }
        }
    }
}
