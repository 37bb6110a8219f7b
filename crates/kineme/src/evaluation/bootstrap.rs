//! Intervals by resampling: what would have been measured on other clips of the same kind.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::error::{Error, Result};
use crate::math::statistics::quantile;

/// How intervals are drawn: the percentile bootstrap (Efron 1979).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bootstrap {
    /// How many collections are drawn, at least 1.
    pub draws: usize,
    /// Seed of the draws; the same seed and number of items give the same collections.
    pub seed: u64,
    /// The share of draws inside the interval, between 0 and 1.
    pub level: f64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self {
            draws: 2000,
            seed: 0,
            level: 0.95,
        }
    }
}

/// A measured value and its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value on all items.
    pub value: f64,
    /// The lower end of the interval.
    pub low: f64,
    /// The upper end of the interval.
    pub high: f64,
}

impl Bootstrap {
    /// Statistics of `items` items with their intervals. `statistics` is told how often each item is in a collection:
    /// once each in the true one. Draws in which a statistic is undefined are passed over for it.
    ///
    /// # Errors
    /// Without items or draws, or when the level is not between 0 and 1.
    pub fn estimates<const N: usize>(
        &self,
        items: usize,
        statistics: impl Fn(&[u32]) -> [Option<f64>; N],
    ) -> Result<[Option<Estimate>; N]> {
        self.check(items)?;
        let values = statistics(&vec![1; items]);
        let mut drawn: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(self.draws));
        let mut random = Pcg64::seed_from_u64(self.seed);
        let mut counts = vec![0; items];
        for _ in 0..self.draws {
            counts.fill(0);
            for _ in 0..items {
                counts[random.random_range(0..items)] += 1;
            }
            for (all, one) in drawn.iter_mut().zip(statistics(&counts)) {
                all.extend(one);
            }
        }
        let tail = (1.0 - self.level) / 2.0;
        let mut estimates = [None; N];
        for ((estimate, value), drawn) in estimates.iter_mut().zip(values).zip(&drawn) {
            *estimate = value.map(|value| Estimate {
                value,
                low: quantile(drawn, tail).unwrap_or(value),
                high: quantile(drawn, 1.0 - tail).unwrap_or(value),
            });
        }
        Ok(estimates)
    }

    /// # Errors
    /// Where nothing can be drawn of so many items.
    pub(super) fn check(&self, items: usize) -> Result<()> {
        if items == 0 || self.draws == 0 || !(self.level > 0.0 && self.level < 1.0) {
            return Err(Error::invalid(format!(
                "intervals need items, draws and a level between 0 and 1, found {items} items, {} draws, level {}",
                self.draws, self.level
            )));
        }
        Ok(())
    }
}
