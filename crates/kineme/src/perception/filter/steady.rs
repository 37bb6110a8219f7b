//! How much whatever sees a body jitters, and postures that are averaged over the last moments as far as it does.

use std::collections::VecDeque;

use super::features::Moment;

/// Jitter is a mean over about so many seconds.
const MEMORY_SECS: f64 = 0.5;
/// Points of a body change their velocity by so much a second, metres a second: what is beyond that is jitter.
const ACCELERATION: f64 = 15.0;
/// The variance of a second difference of independent values, each of variance one.
const SECOND_DIFFERENCE: f64 = 6.0;
/// Postures are averaged until they jitter by no more than this, metres, over no longer than so many seconds.
const STEADY_M: f64 = 0.001;
const AVERAGED_SECS: f64 = 0.1;
/// A straight line through the moments tells where the body is this far from their middle to the latest: there it would
/// be on time, and jitter most.
const ONWARD: f64 = 0.75;

/// The last moments of a stream, and how they jitter.
#[derive(Debug, Clone, Default)]
pub(super) struct Steady {
    moments: VecDeque<Moment>,
    /// Mean square of what is no movement of a body, a number, square metres; and for how long that was looked at.
    jitter: f64,
    lasted_secs: f64,
    /// What averaging leaves of it, a share.
    left: f64,
}

impl Steady {
    /// The variance of what a posture's numbers still jitter by, as far as it has shown, square metres.
    pub fn jitter(&self) -> f64 {
        self.jitter * self.left
    }

    /// A moment as the last ones have it, if these jitter; those that lack other numbers are forgotten.
    pub fn take(&mut self, mut moment: Moment) -> Moment {
        let latest = self.moments.back();
        if latest.is_some_and(|l| l.unknown != moment.unknown) {
            self.moments.clear();
        }
        self.moments.push_back(moment.clone());
        self.remember();
        let from = moment.secs - AVERAGED_SECS;
        while self.moments.len() > 3 && self.moments[0].secs < from {
            self.moments.pop_front();
        }
        let weights = self.weights(from);
        self.left = weights.iter().map(|w| w * w).sum();
        if weights.len() > 1 {
            let first = self.moments.len() - weights.len();
            moment.posture.fill(0.0);
            for (m, w) in self.moments.range(first..).zip(&weights) {
                for (sum, v) in moment.posture.iter_mut().zip(&m.posture) {
                    *sum += w * v;
                }
            }
        }
        moment
    }

    /// Weights of the last moments, as few as leave little enough jitter, of those from some second on.
    fn weights(&self, from: f64) -> Vec<f64> {
        let mut weights = vec![1.0];
        let mut left = 1.0;
        let since = |m: &&Moment| m.secs >= from;
        let most = self.moments.iter().rev().take_while(since).count();
        for count in 2..=most {
            if self.jitter * left <= STEADY_M * STEADY_M {
                break;
            }
            let last = self.moments.range(self.moments.len() - count..);
            weights = line(&last.map(|m| m.secs).collect::<Vec<f64>>());
            left = weights.iter().map(|w| w * w).sum();
        }
        weights
    }

    /// Takes note of how the latest three moments jitter.
    fn remember(&mut self) {
        let mut last = self.moments.iter().rev();
        let (Some(c), Some(b), Some(a)) = (last.next(), last.next(), last.next()) else {
            return;
        };
        let (before, secs) = (b.secs - a.secs, c.secs - b.secs);
        let (mut squares, mut count) = (0.0, 0.0);
        for i in 0..c.posture.len() {
            if c.unknown.get(i).copied().unwrap_or(false) {
                continue;
            }
            let [a, b, c] = [a, b, c].map(|m| m.posture[i]);
            let surprise = c - b - (b - a) * secs / before;
            squares += surprise * surprise;
            count += 1.0;
        }
        if count == 0.0 {
            return;
        }
        let moved = ACCELERATION * secs * secs;
        let jitter = (squares / count - moved * moved).max(0.0) / SECOND_DIFFERENCE;
        // At first the mean is of all there was.
        self.lasted_secs += secs;
        let share = (secs / self.lasted_secs).max(1.0 - (-secs / MEMORY_SECS).exp());
        self.jitter += share * (jitter - self.jitter);
    }
}

/// What values at these seconds, two or more, count where their regression line is read off.
fn line(secs: &[f64]) -> Vec<f64> {
    let count = secs.len() as f64;
    let middle = secs.iter().sum::<f64>() / count;
    let spread: f64 = secs.iter().map(|t| (t - middle) * (t - middle)).sum();
    let at = ONWARD * (secs[secs.len() - 1] - middle);
    let weight = |t: &f64| 1.0 / count + at * (t - middle) / spread;
    secs.iter().map(weight).collect()
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    /// What is left of a number that is so at each second, seen so often, and of how it jitters.
    fn after(rate_hz: f64, secs: f64, mut value: impl FnMut(f64) -> f64) -> (Steady, Vec<f64>) {
        let mut steady = Steady::default();
        let take = |k: usize| {
            let secs = k as f64 / rate_hz;
            let moment = Moment {
                secs,
                posture: vec![value(secs), f64::NAN],
                unknown: vec![false, true],
                root: None,
            };
            steady.take(moment).posture[0]
        };
        let taken = (0..(secs * rate_hz) as usize).map(take).collect();
        (steady, taken)
    }

    #[test]
    fn what_a_body_does_is_no_jitter_and_stays_as_it_is_whatever_the_rate() {
        for rate_hz in [15.0, 30.0, 120.0, 240.0] {
            // A hand that goes to and fro once a second, .3 m to either side: 12 m/s2 at its turns.
            let swing = |t: f64| 0.3 * (std::f64::consts::TAU * t).sin();
            let (steady, taken) = after(rate_hz, 3.0, swing);
            assert!(steady.jitter() == 0.0, "{rate_hz} Hz: {}", steady.jitter());
            for (k, x) in taken.iter().enumerate() {
                assert_eq!(*x, swing(k as f64 / rate_hz), "{rate_hz} Hz");
            }
        }
    }

    #[test]
    fn noise_shows_as_jitter_of_its_variance_and_is_averaged_away() {
        let mut random = Pcg64::seed_from_u64(1);
        for sigma in [0.002, 0.01] {
            // Uniform noise of this deviation.
            let (mut jitter, mut left, mut seen) = (0.0, 0.0, 0.0);
            let runs = 40;
            for _ in 0..runs {
                let noise = |_: f64| sigma * 12f64.sqrt() * (random.random::<f64>() - 0.5);
                let (steady, taken) = after(120.0, 3.0, noise);
                jitter += steady.jitter / f64::from(runs);
                left += steady.jitter() / f64::from(runs);
                let late = &taken[120..];
                seen += late.iter().map(|x| x * x).sum::<f64>() / late.len() as f64;
            }
            seen /= f64::from(runs);
            for (what, ratio, range) in [
                ("jitter", jitter / (sigma * sigma), 0.8..1.2),
                ("what is left of it", left / jitter, 0.0..0.35),
                ("what is said to be left of it", left / seen, 0.7..1.3),
            ] {
                assert!(range.contains(&ratio), "{sigma}: {what} {ratio}");
            }
        }
    }

    #[test]
    fn who_moves_evenly_is_seen_hardly_late() {
        let mut random = Pcg64::seed_from_u64(2);
        let noisy = |t: f64| 2.0 * t + 0.01 * (random.random::<f64>() - 0.5);
        let (_, taken) = after(120.0, 3.0, noisy);
        let late = taken.iter().enumerate().skip(120);
        let lag = late.map(|(k, x)| k as f64 / 120.0 - x / 2.0);
        let mean = lag.sum::<f64>() / (taken.len() - 120) as f64;
        assert!((0.0..0.015).contains(&mean), "{mean} s");
    }
}
