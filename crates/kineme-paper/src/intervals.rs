//! Means over classes of clips, with intervals.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Draws of the bootstrap.
const DRAWS: usize = 2000;

/// A mean with the interval in which it lies in 95 of 100 resampled collections of clips.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The mean over classes of the means over their clips.
    pub mean: f64,
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// The mean over classes of the means over clips (`classes[c]` holds one value a clip; empty classes are passed over),
/// with the percentile bootstrap (Efron 1979) over clips inside their classes, seeded.
pub fn interval(classes: &[Vec<f64>]) -> Interval {
    let filled: Vec<&[f64]> = classes
        .iter()
        .map(Vec::as_slice)
        .filter(|c| !c.is_empty())
        .collect();
    let of_means = |means: Vec<f64>| means.iter().sum::<f64>() / means.len().max(1) as f64;
    let mean = of_means(filled.iter().map(|c| average(c)).collect());
    let mut random = Pcg64::seed_from_u64(0);
    let mut draws: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let drawn = |clips: &&[f64]| -> f64 {
                let sum: f64 = (0..clips.len())
                    .map(|_| clips[random.random_range(0..clips.len())])
                    .sum();
                sum / clips.len() as f64
            };
            of_means(filled.iter().map(drawn).collect())
        })
        .collect();
    draws.sort_by(f64::total_cmp);
    let at = |share: f64| draws[(share * (DRAWS - 1) as f64).round() as usize];
    Interval {
        mean,
        low: at(0.025),
        high: at(0.975),
    }
}

/// The mean of values; 0 without any.
pub fn average(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
