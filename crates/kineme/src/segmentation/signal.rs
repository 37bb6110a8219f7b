//! [`Signal`]: what segmenters see.

use crate::error::{Error, Result};

/// Frames `start..end`, inside the room.
pub(super) type Frames = (usize, usize);

/// Numbers sampled at a constant rate: `values[frame * dims + dim]`, at least one frame, all finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal<'a> {
    values: &'a [f64],
    dims: usize,
    rate_hz: f64,
}

impl<'a> Signal<'a> {
    /// Takes row-major frames of `dims` numbers, sampled at `rate_hz`.
    ///
    /// # Errors
    /// Without a frame, with `dims` 0 or no divisor of the length, with a rate that is not positive, or with a
    /// number that is not finite.
    pub fn new(values: &'a [f64], dims: usize, rate_hz: f64) -> Result<Self> {
        if dims == 0 || values.is_empty() || !values.len().is_multiple_of(dims) {
            return Err(Error::invalid(format!(
                "a signal needs at least one frame of {dims} numbers each, found {} numbers",
                values.len()
            )));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Error::invalid(format!(
                "a signal needs a positive rate, found {rate_hz} Hz"
            )));
        }
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return Err(Error::invalid(format!(
                "a signal needs finite numbers, found {} in frame {}",
                values[i],
                i / dims
            )));
        }
        Ok(Self {
            values,
            dims,
            rate_hz,
        })
    }

    /// How many frames there are.
    pub fn frames(&self) -> usize {
        self.values.len() / self.dims
    }

    /// Numbers a frame.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// Frames a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The numbers of one frame.
    ///
    /// # Panics
    /// When there is no such frame.
    pub fn frame(&self, frame: usize) -> &'a [f64] {
        &self.values[frame * self.dims..(frame + 1) * self.dims]
    }

    /// All numbers, frame by frame.
    pub fn values(&self) -> &'a [f64] {
        self.values
    }

    /// A duration in frames, rounded; one frame more than there are stands for all that is longer.
    pub(super) fn frames_in(&self, secs: f64) -> usize {
        ((secs * self.rate_hz).round() as usize).min(self.frames() + 1)
    }

    /// Half of a centred window of this duration, in whole frames, so that the window is `2 h + 1` frames.
    pub(super) fn half_window(&self, secs: f64) -> usize {
        ((0.5 * secs * self.rate_hz).round() as usize).min(self.frames())
    }
}

/// Centred moving average over `2 half + 1` frames of `dims` numbers each.
///
/// Near an end the window shrinks on both sides alike: a straight line stays what it is, an extreme in place.
pub(super) fn moving_average(values: &[f64], dims: usize, half: usize) -> Vec<f64> {
    let frames = values.len() / dims;
    let mut out = Vec::with_capacity(values.len());
    for t in 0..frames {
        let h = half.min(t).min(frames - 1 - t);
        let window = &values[(t - h) * dims..(t + h + 1) * dims];
        out.extend(
            (0..dims)
                .map(|d| window.iter().skip(d).step_by(dims).sum::<f64>() / (2 * h + 1) as f64),
        );
    }
    out
}

/// Rates of change a second: the slope of the least-squares line over `2 half + 1` frames (at least three).
///
/// This is Savitzky and Golay's (1964) derivative filter of order 2; at the ends the line is fitted to the
/// frames there are. A single frame does not move.
pub(super) fn derivative(signal: &Signal, half: usize) -> Vec<f64> {
    let (frames, dims) = (signal.frames(), signal.dims());
    let half = half.max(1);
    let mut out = vec![0.0; frames * dims];
    for (t, slopes) in out.chunks_exact_mut(dims).enumerate() {
        let (start, end) = (t.saturating_sub(half), (t + half + 1).min(frames));
        let middle = 0.5 * (start + end - 1) as f64;
        let mut squares = 0.0;
        for k in start..end {
            let x = k as f64 - middle;
            squares += x * x;
            for (slope, v) in slopes.iter_mut().zip(signal.frame(k)) {
                *slope += x * v;
            }
        }
        if squares > 0.0 {
            for slope in slopes {
                *slope *= signal.rate_hz() / squares;
            }
        }
    }
    out
}

/// The maximal runs of true, as half-open ranges.
pub(super) fn runs(flags: &[bool]) -> Vec<Frames> {
    let mut out = Vec::new();
    let mut start = None;
    for (t, flag) in flags.iter().copied().chain([false]).enumerate() {
        match (flag, start) {
            (true, None) => start = Some(t),
            (false, Some(s)) => {
                out.push((s, t));
                start = None;
            }
            _ => {}
        }
    }
    out
}

/// Refuses a setting below `least` or not finite.
pub(super) fn at_least(name: &str, value: f64, least: f64) -> Result<()> {
    if value.is_finite() && value >= least {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "{name} must be at least {least}, found {value}"
    )))
}

/// Refuses a setting that is not positive and finite.
pub(super) fn above_zero(name: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "{name} must be above 0, found {value}"
    )))
}
