//! The temperature by which costs become probabilities: how much the next person differs is believed, not known.

/// Steps, in deviations, at which the belief is summed up, to either side of its middle.
const STEPS: i32 = 6;
const STEP: f64 = 0.5;

/// What is believed of a temperature: its logarithm is distributed normally.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LogNormal {
    /// The geometric mean, above 0.
    pub mean: f64,
    /// The deviation of the natural logarithm; 0: it is known.
    pub spread: f64,
}

impl LogNormal {
    /// What is believed after something was seen that has these logarithms of likelihoods: Bayes' rule on a grid of
    /// temperatures, `tried`, that lie evenly on the logarithmic scale.
    pub fn after(
        self,
        tried: impl Iterator<Item = f64>,
        log_likelihood: impl Fn(f64) -> f64,
    ) -> Self {
        let log_posterior = |t: f64| {
            let off = (t / self.mean).ln() / self.spread;
            log_likelihood(t) - 0.5 * off * off
        };
        let all: Vec<(f64, f64)> = tried.map(|t| (t.ln(), log_posterior(t))).collect();
        let most = all.iter().map(|a| a.1).fold(f64::NEG_INFINITY, f64::max);
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            all.iter().map(|(log, p)| (p - most).exp() * of(*log)).sum()
        };
        let count = sum(&|_| 1.0);
        let mean = sum(&|log| log) / count;
        let variance = sum(&|log| (log - mean) * (log - mean)) / count;
        Self {
            mean: mean.exp(),
            spread: variance.sqrt(),
        }
    }

    /// The mean over what the temperature may be of probabilities that depend on it. Of wrong answers that one temperature
    /// would be sure of, some belief stays with the truth.
    pub fn mean_of(self, count: usize, shares: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
        let steps = if self.spread > 0.0 { STEPS } else { 0 };
        let mut mean = vec![0.0; count];
        let mut all = 0.0;
        for z in (-steps..=steps).map(|k| STEP * f64::from(k)) {
            let density = (-0.5 * z * z).exp();
            let temperature = self.mean * (self.spread * z).exp();
            for (mean, share) in mean.iter_mut().zip(shares(temperature)) {
                *mean += density * share;
            }
            all += density;
        }
        for m in &mut mean {
            *m /= all;
        }
        mean
    }
}
