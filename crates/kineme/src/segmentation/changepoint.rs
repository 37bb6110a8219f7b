//! Segmentation by change points: the cuts of least total cost, found exactly by PELT (Killick, Fearnhead and
//! Eckley 2012).
//!
//! Minimises `sum cost(segment) + penalty * segments`. A segment's cost is the sum of squared residuals about its
//! mean or its straight line, in units of the mean variance of a feature: it does not change when features are
//! shifted, rotated into one another, or all scaled alike.

use super::signal::{Signal, above_zero, at_least};
use super::spans::Span;
use crate::error::Result;

/// What a segment is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Model {
    /// A constant: cuts fall where the mean changes (Gaussian with known variance).
    Mean,
    /// A straight line in time: cuts fall where level or slope change.
    #[default]
    Trend,
}

/// Settings of the change-point segmenter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangePoint {
    /// What a segment is compared with.
    pub model: Model,
    /// `c` in the penalty `c * dims * ln(independent frames)` of each segment.
    ///
    /// As residuals are measured by the variance of the movement, not of its noise, it is below the 1 to 3 that
    /// are customary for white noise.
    pub penalty: f64,
    /// How many frames a second count as independent evidence, hertz; a recording sampled faster than that
    /// (bodies move below some 6 Hz) is cut as if it were not.
    pub independent_hz: f64,
    /// The shortest segment, seconds (and at least 2 frames, so that a line is determined).
    pub min_secs: f64,
}

impl Default for ChangePoint {
    fn default() -> Self {
        Self {
            model: Model::Trend,
            penalty: 0.3,
            independent_hz: 12.0,
            min_secs: 0.2,
        }
    }
}

/// Movements between change points; together they cover the recording. Rests are not told apart.
///
/// Features may be any numbers of like units, such as the leading principal components of a posture. Time is
/// linear in the frames when changes keep coming, quadratic when there are none; exact in either case.
///
/// # Errors
/// When a setting is out of range.
pub fn segment(features: &Signal, config: &ChangePoint) -> Result<Vec<Span>> {
    above_zero("penalty", config.penalty)?;
    above_zero("independent_hz", config.independent_hz)?;
    at_least("min_secs", config.min_secs, 0.0)?;
    let frames = features.frames();
    let min = features.frames_in(config.min_secs).max(2);
    // Instead of weighing each frame's residual less, each segment pays as much more.
    let weight = (config.independent_hz / features.rate_hz()).min(1.0);
    let independent = (weight * frames as f64).max(2.0);
    let beta = config.penalty * features.dims() as f64 * independent.ln() / weight;
    let moments = Moments::new(features, config.model);
    let mut spans = Vec::new();
    let mut end = frames;
    let previous = pelt(&moments, frames, min, beta);
    while end > 0 {
        spans.push(Span::movement(previous[end], end));
        end = previous[end];
    }
    spans.reverse();
    Ok(spans)
}

/// For each end of a segment the best start of it; every segment has `min` frames unless there are fewer in all.
fn pelt(moments: &Moments, frames: usize, min: usize, beta: f64) -> Vec<usize> {
    let mut best = vec![f64::INFINITY; frames + 1];
    let mut previous = vec![0; frames + 1];
    // Each segment pays beta, so the first starts with one less: n segments pay n - 1 times.
    best[0] = -beta;
    if frames < 2 * min {
        return previous;
    }
    // Candidate starts with, for those proved useless, the end from which on they are.
    let mut starts: Vec<(usize, usize)> = vec![(0, usize::MAX)];
    let mut costs = Vec::new();
    for end in min..=frames {
        if end >= 2 * min {
            starts.push((end - min, usize::MAX));
        }
        starts.retain(|&(_, until)| end < until);
        costs.clear();
        costs.extend(starts.iter().map(|&(s, _)| best[s] + moments.cost(s, end)));
        for (&(s, _), &cost) in starts.iter().zip(&costs) {
            if cost + beta < best[end] {
                best[end] = cost + beta;
                previous[end] = s;
            }
        }
        // A start that is worse than cutting here stays worse for every later end, but a cut here may be
        // used only once its segment has `min` frames.
        for (start, &cost) in starts.iter_mut().zip(&costs) {
            if cost > best[end] && start.1 == usize::MAX {
                start.1 = end + min;
            }
        }
    }
    previous
}

/// Running sums from which a segment's cost follows in time proportional to the dimensions alone.
struct Moments {
    model: Model,
    dims: usize,
    /// Sums of squares over all features.
    squares: Vec<f64>,
    /// Sums of each feature, and of it times the frame number, `[frame][dim]`.
    sums: Vec<f64>,
    ramps: Vec<f64>,
    /// One over the mean variance of a feature.
    scale: f64,
}

impl Moments {
    fn new(features: &Signal, model: Model) -> Self {
        let (frames, dims) = (features.frames(), features.dims());
        // About the mean: less is lost when large sums are subtracted.
        let mut mean = vec![0.0; dims];
        for t in 0..frames {
            for (m, v) in mean.iter_mut().zip(features.frame(t)) {
                *m += v / frames as f64;
            }
        }
        let mut squares = vec![0.0; frames + 1];
        let mut sums = vec![0.0; (frames + 1) * dims];
        let mut ramps = vec![0.0; (frames + 1) * dims];
        for t in 0..frames {
            squares[t + 1] = squares[t];
            for (d, (v, m)) in features.frame(t).iter().zip(&mean).enumerate() {
                let (y, now, next) = (v - m, t * dims + d, (t + 1) * dims + d);
                squares[t + 1] += y * y;
                sums[next] = sums[now] + y;
                ramps[next] = ramps[now] + y * t as f64;
            }
        }
        let variance = squares[frames] / (frames * dims) as f64;
        Self {
            model,
            dims,
            squares,
            sums,
            ramps,
            scale: if variance > 0.0 { 1.0 / variance } else { 0.0 },
        }
    }

    /// The cost of the frames `start..end`, which are at least two.
    fn cost(&self, start: usize, end: usize) -> f64 {
        let n = (end - start) as f64;
        let (a, b) = (start * self.dims, end * self.dims);
        let sums = self.sums[b..b + self.dims]
            .iter()
            .zip(&self.sums[a..a + self.dims]);
        let mut residual = self.squares[end] - self.squares[start];
        match self.model {
            Model::Mean => {
                for (y1, y0) in sums {
                    residual -= (y1 - y0) * (y1 - y0) / n;
                }
            }
            Model::Trend => {
                let middle = start as f64 + 0.5 * (n - 1.0);
                let spread = n * (n * n - 1.0) / 12.0;
                let ramps = self.ramps[b..b + self.dims]
                    .iter()
                    .zip(&self.ramps[a..a + self.dims]);
                for ((y1, y0), (r1, r0)) in sums.zip(ramps) {
                    let sum = y1 - y0;
                    let tilt = r1 - r0 - middle * sum;
                    residual -= sum * sum / n + tilt * tilt / spread;
                }
            }
        }
        residual.max(0.0) * self.scale
    }
}
