//! Nonparametric univariate densities over any interval of phase, from sums made once (paper, Fig. 6).

use super::intervals::Intervals;
use crate::math::statistics::quantile;

/// Bins at most.
const MOST_BINS: usize = 64;

/// Counts of one coordinate's samples by value and phase, summed over both so that any rectangle is four of them.
#[derive(Debug, Clone)]
pub(super) struct Histogram {
    origin: f64,
    width: f64,
    bins: usize,
    /// Samples at each end of a piece.
    samples: usize,
    /// Counts before a phase and below a bin, (phases + 1) x (bins + 1).
    sums: Vec<u32>,
}

impl Histogram {
    /// Of samples, one slice a phase. Bins have the width of Freedman and Diaconis (1981), but at least `delta`.
    pub fn new(phases: &[Vec<f64>], delta: f64) -> Self {
        let all: Vec<f64> = phases.iter().flatten().copied().collect();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for &x in &all {
            (low, high) = (low.min(x), high.max(x));
        }
        let quartile = |q| quantile(&all, q).unwrap_or(0.0);
        let spread = quartile(0.75) - quartile(0.25);
        let width = (2.0 * spread / (all.len() as f64).cbrt())
            .max(delta)
            .max((high - low) / MOST_BINS as f64);
        let bins = (((high - low) / width) as usize + 1).min(MOST_BINS);
        let row = bins + 1;
        let mut histogram = Self {
            origin: low,
            width,
            bins,
            samples: phases[0].len(),
            sums: vec![0; (phases.len() + 1) * row],
        };
        for (i, samples) in phases.iter().enumerate() {
            let mut counts = vec![0u32; bins];
            for &x in samples {
                counts[histogram.bin(x)] += 1;
            }
            let mut below = 0;
            for (b, count) in counts.iter().enumerate() {
                below += count;
                let before = histogram.sums[i * row + b + 1];
                histogram.sums[(i + 1) * row + b + 1] = before + below;
            }
        }
        histogram
    }

    fn bin(&self, x: f64) -> usize {
        (((x - self.origin) / self.width).max(0.0) as usize).min(self.bins - 1)
    }

    /// The density at `x`, 1/rad, of samples whose phase lies in `within`: their share in the bins that meet the
    /// tolerance about x, over the width of these. Where the envelope says that the value is attained, but by no
    /// sample, one sample's worth.
    pub fn density(&self, x: f64, delta: f64, within: &Intervals) -> f64 {
        let (first, last) = (self.bin(x - delta), self.bin(x + delta));
        let (count, all) = self.count(within, first, last);
        let width = self.width * (last + 1 - first) as f64;
        f64::from(count.max(1)) / (all * width)
    }

    /// The ends of all bins, one more than bins, and the density in each, 1/rad, of samples whose phase lies in
    /// `within`: the histogram itself, of which [`Self::density`] reads a few bins.
    pub fn bars(&self, within: &Intervals) -> (Vec<f64>, Vec<f64>) {
        let edge = |b: usize| self.origin + self.width * b as f64;
        let density = |b: usize| {
            let (count, all) = self.count(within, b, b);
            f64::from(count) / (all * self.width)
        };
        (
            (0..=self.bins).map(edge).collect(),
            (0..self.bins).map(density).collect(),
        )
    }

    /// How many samples whose phase lies in `within` are in these bins, and how many there are in all.
    fn count(&self, within: &Intervals, first: usize, last: usize) -> (u32, f64) {
        let row = self.bins + 1;
        let phases = self.sums.len() / row - 1;
        let (mut count, mut columns) = (0u32, 0usize);
        let mut until = 0;
        for &(from, to) in within {
            // Phases sampled in the interval; the nearest one where it holds none.
            let (mut a, mut b) = (from.ceil() as usize, to.floor() as usize + 1);
            if a >= b {
                a = (0.5 * (from + to)).round() as usize;
                b = a + 1;
            }
            let (a, b) = (a.max(until), b.min(phases));
            if a >= b {
                continue;
            }
            until = b;
            columns += b - a;
            let at = |i: usize, q: usize| self.sums[i * row + q];
            count += at(b, last + 1) + at(a, first) - at(a, last + 1) - at(b, first);
        }
        (count, (columns.max(1) * self.samples) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_is_the_share_of_samples_over_the_width() {
        // At phase i, samples i, i + 0.1, ... i + 0.9.
        let phases: Vec<Vec<f64>> = (0..5)
            .map(|i| (0..10).map(|k| f64::from(i) + 0.1 * f64::from(k)).collect())
            .collect();
        let histogram = Histogram::new(&phases, 0.5);
        let width = histogram.width;
        for (x, delta, within) in [
            (2.3, 0.01, vec![(0.0, 4.0)]),
            (2.3, 0.5, vec![(1.0, 3.0)]),
            (2.3, 0.5, vec![(0.0, 1.2), (3.0, 4.0)]),
            (2.3, 0.5, vec![(2.2, 2.4)]),
            (9.0, 0.5, vec![(0.0, 4.0)]),
        ] {
            let (first, last) = (histogram.bin(x - delta), histogram.bin(x + delta));
            let inside = |i: usize| {
                let t = i as f64;
                within
                    .iter()
                    .any(|&(a, b)| (a <= t && t <= b) || (b - a < 0.5 && i == 2))
            };
            let seen: Vec<f64> = (0..5)
                .filter(|&i| inside(i))
                .flat_map(|i| phases[i].clone())
                .collect();
            let count = seen
                .iter()
                .filter(|&&v| (first..=last).contains(&histogram.bin(v)));
            let share = count.count().max(1) as f64 / seen.len() as f64;
            let expected = share / (width * (last + 1 - first) as f64);
            let found = histogram.density(x, delta, &within);
            assert!((found - expected).abs() < 1e-12, "{x} {delta} {within:?}");
        }
    }
}
