//! Scales from data to pixels, and the round numbers to write at an axis.

/// A linear map of an interval of data to an interval of pixels.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    from: [f64; 2],
    to: [f64; 2],
}

impl Scale {
    /// Maps `from` to `to`; an empty interval of data is widened about its middle.
    pub fn new(from: [f64; 2], to: [f64; 2]) -> Self {
        let [low, high] = from;
        // Far from zero, half a unit would vanish in the rounding.
        let half = 0.5_f64.max(1e-6 * low.abs());
        let from = if high > low {
            from
        } else {
            [low - half, high + half]
        };
        Self { from, to }
    }

    /// The pixel of a value.
    pub fn at(&self, value: f64) -> f64 {
        let share = (value - self.from[0]) / (self.from[1] - self.from[0]);
        self.to[0] + share * (self.to[1] - self.to[0])
    }

    /// About `count` round values inside the data's interval, with the decimals that tell them apart.
    pub fn ticks(&self, count: usize) -> Vec<(f64, String)> {
        let [low, high] = self.from;
        let step = round_step((high - low) / count.max(1) as f64);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last)
            .take(4 * count.max(1))
            .map(|k| {
                let value = k as f64 * step;
                (value, format!("{value:.decimals$}"))
            })
            .collect()
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is no less than `step`.
pub fn round_step(step: f64) -> f64 {
    if step.is_nan() || step <= 0.0 || step.is_infinite() {
        return 1.0;
    }
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|candidate| *candidate >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// The least and the greatest of the finite values; `None` without one.
pub fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values
        .filter(|v| v.is_finite())
        .fold(None, |found, v| match found {
            None => Some([v, v]),
            Some([low, high]) => Some([f64::min(low, v), f64::max(high, v)]),
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        for (from, expected) in [
            ([0.0, 1.0], vec!["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]),
            ([3.0, 61.0], vec!["20", "40", "60"]),
            (
                [-0.013, 0.012],
                vec!["-0.010", "-0.005", "0.000", "0.005", "0.010"],
            ),
        ] {
            let scale = Scale::new(from, [0.0, 100.0]);
            let labels: Vec<String> = scale.ticks(5).into_iter().map(|(_, l)| l).collect();
            assert_eq!(labels, expected, "{from:?}");
        }
    }

    #[test]
    fn an_empty_interval_lands_in_the_middle() {
        assert_eq!(Scale::new([2.0, 2.0], [0.0, 10.0]).at(2.0), 5.0);
    }
}
