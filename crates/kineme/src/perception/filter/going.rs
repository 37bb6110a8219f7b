//! How a body goes on: what the last looks tell of its velocity, and how much whatever sees it jitters.

use super::features::Feature;

/// Jitter is a mean over about so many seconds.
const MEMORY_SECS: f64 = 0.5;
/// Points of a body change their velocity by so much a second, metres a second: what is beyond that is jitter.
const ACCELERATION: f64 = 15.0;
/// The variance of a second difference of independent values, each of variance one.
const SECOND_DIFFERENCE: f64 = 6.0;

/// How the numbers of a feature went on since the look before.
#[derive(Debug, Clone)]
pub(super) struct Going {
    /// Seconds since then.
    pub secs: f64,
    /// How far each number went.
    pub step: Vec<f64>,
    /// What of this is not explained by the velocity until then; nothing where that is not known.
    pub surprise: Option<Vec<f64>>,
}

/// What is kept of the last looks.
#[derive(Debug, Clone)]
pub(super) struct Looks {
    /// Numbers of postures.
    postures: Vec<usize>,
    latest: Option<Feature>,
    /// How the latest look went on from the one before it.
    step: Option<(Vec<f64>, f64)>,
    /// Mean square of what is no movement of a body, a number, square metres; and for how long that was looked at.
    jitter: f64,
    lasted_secs: f64,
}

impl Looks {
    /// None so far. `still` tells which numbers are of postures.
    pub fn new(still: &[bool]) -> Self {
        Self {
            postures: (0..still.len()).filter(|&i| still[i]).collect(),
            latest: None,
            step: None,
            jitter: 0.0,
            lasted_secs: 0.0,
        }
    }

    /// The variance of the jitter of a posture's numbers, as far as it has shown, square metres.
    pub fn jitter(&self) -> f64 {
        self.jitter
    }

    /// How a feature goes on from the latest one, so many seconds before; nothing where they lack different numbers.
    pub fn take(&mut self, feature: &Feature, secs: f64) -> Option<Going> {
        let latest = self.latest.replace(feature.clone());
        let earlier = self.step.take();
        let latest = latest.filter(|l| l.unknown == feature.unknown)?;
        let pairs = feature.values.iter().zip(&latest.values);
        let step: Vec<f64> = pairs.map(|(now, then)| now - then).collect();
        let surprise = earlier.map(|(before, lasted)| {
            let pairs = step.iter().zip(&before);
            let surprise = pairs.map(|(now, then)| now - then * secs / lasted);
            surprise.collect::<Vec<f64>>()
        });
        if let Some(surprise) = &surprise {
            self.remember(surprise, feature, secs);
        }
        self.step = Some((step.clone(), secs));
        Some(Going {
            secs,
            step,
            surprise,
        })
    }

    fn remember(&mut self, surprise: &[f64], feature: &Feature, secs: f64) {
        let hidden = |i: usize| feature.unknown.get(i).copied().unwrap_or(false);
        let known = self.postures.iter().filter(|i| !hidden(**i));
        let count = known.clone().count().max(1) as f64;
        let squares: f64 = known.map(|&i| surprise[i] * surprise[i]).sum();
        let moved = ACCELERATION * secs * secs;
        let jitter = (squares / count - moved * moved).max(0.0) / SECOND_DIFFERENCE;
        // At first the mean is of all there was.
        self.lasted_secs += secs;
        let share = (secs / self.lasted_secs).max(1.0 - (-secs / MEMORY_SECS).exp());
        self.jitter += share * (jitter - self.jitter);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    fn after(rate_hz: f64, secs: f64, mut value: impl FnMut(f64) -> f64) -> (Looks, Option<Going>) {
        let mut looks = Looks::new(&[true, false]);
        let mut going = None;
        for k in 0..(secs * rate_hz) as usize {
            let t = k as f64 / rate_hz;
            let feature = Feature {
                values: vec![value(t), 100.0 * t * t * t],
                unknown: vec![false, false],
            };
            going = looks.take(&feature, 1.0 / rate_hz);
        }
        (looks, going)
    }

    #[test]
    fn what_a_body_does_is_no_jitter_whatever_the_rate() {
        for rate_hz in [15.0, 30.0, 120.0, 240.0] {
            // A hand that goes to and fro once a second, .3 m to either side: 12 m/s2 at its turns.
            let swing = |t: f64| 0.3 * (std::f64::consts::TAU * t).sin();
            let (looks, _) = after(rate_hz, 3.0, swing);
            assert!(looks.jitter() == 0.0, "{rate_hz} Hz: {}", looks.jitter());
        }
    }

    #[test]
    fn noise_shows_as_jitter_of_its_variance() {
        let mut random = Pcg64::seed_from_u64(1);
        for sigma in [0.002, 0.01] {
            // Uniform noise of this deviation.
            let mut jitter = 0.0;
            let runs = 40;
            for _ in 0..runs {
                let noise = |_: f64| sigma * 12f64.sqrt() * (random.random::<f64>() - 0.5);
                jitter += after(120.0, 3.0, noise).0.jitter() / f64::from(runs);
            }
            let ratio = jitter / (sigma * sigma);
            assert!((0.8..1.2).contains(&ratio), "{sigma}: {ratio}");
        }
    }

    #[test]
    fn a_constant_velocity_is_no_surprise() {
        let (_, going) = after(60.0, 1.0, |t| 2.0 * t);
        let going = going.unwrap();
        assert!((going.step[0] - 2.0 / 60.0).abs() < 1e-12);
        assert!(going.surprise.unwrap()[0].abs() < 1e-12);
    }
}
