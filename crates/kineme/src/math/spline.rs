//! Interpolating cubic splines.

use crate::error::{Error, Result};

/// A cubic spline through knots, twice continuously differentiable, at rest (zero slope) at both ends.
#[derive(Debug, Clone, PartialEq)]
pub struct ClampedSpline {
    times: Vec<f64>,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl ClampedSpline {
    /// The spline through `(times, values)`; times in seconds, strictly rising.
    ///
    /// # Errors
    /// Without knots, with unequal lengths, with times that do not rise or numbers that are not finite.
    pub fn new(times: &[f64], values: &[f64]) -> Result<Self> {
        if times.is_empty() || times.len() != values.len() {
            return Err(Error::invalid(format!(
                "a spline needs one value a knot and at least one knot, found {} times and {} values",
                times.len(),
                values.len()
            )));
        }
        if let Some(i) = (1..times.len())
            .find(|&i| times[i].partial_cmp(&times[i - 1]) != Some(std::cmp::Ordering::Greater))
        {
            return Err(Error::invalid(format!(
                "times of keys must rise, found {} after {}",
                times[i],
                times[i - 1]
            )));
        }
        if times.iter().chain(values).any(|v| !v.is_finite()) {
            return Err(Error::invalid("a spline needs finite knots"));
        }
        Ok(Self {
            times: times.to_vec(),
            values: values.to_vec(),
            slopes: clamped_slopes(times, values),
        })
    }

    /// The value at time `t`; before the first and after the last knot, theirs.
    pub fn at(&self, t: f64) -> f64 {
        let last = self.times.len() - 1;
        if t <= self.times[0] {
            return self.values[0];
        }
        if t >= self.times[last] {
            return self.values[last];
        }
        let i = self.times.partition_point(|&k| k <= t) - 1;
        let h = self.times[i + 1] - self.times[i];
        let s = (t - self.times[i]) / h;
        let (s2, s3) = (s * s, s * s * s);
        // Cubic Hermite basis.
        self.values[i] * (2.0 * s3 - 3.0 * s2 + 1.0)
            + self.values[i + 1] * (3.0 * s2 - 2.0 * s3)
            + h * self.slopes[i] * (s3 - 2.0 * s2 + s)
            + h * self.slopes[i + 1] * (s3 - s2)
    }
}

/// Slopes at the knots from the tridiagonal system of continuous second derivatives, zero at both ends (Thomas algorithm).
fn clamped_slopes(t: &[f64], y: &[f64]) -> Vec<f64> {
    let n = t.len();
    let mut slopes = vec![0.0; n];
    if n < 3 {
        return slopes;
    }
    let mut upper = vec![0.0; n];
    for i in 1..n - 1 {
        let (h0, h1) = (t[i] - t[i - 1], t[i + 1] - t[i]);
        let right = 3.0 * (h1 * (y[i] - y[i - 1]) / h0 + h0 * (y[i + 1] - y[i]) / h1);
        let diagonal = 2.0 * (h0 + h1) - h1 * upper[i - 1];
        upper[i] = h0 / diagonal;
        slopes[i] = (right - h1 * slopes[i - 1]) / diagonal;
    }
    for i in (1..n - 1).rev() {
        slopes[i] -= upper[i] * slopes[i + 1];
    }
    slopes
}
