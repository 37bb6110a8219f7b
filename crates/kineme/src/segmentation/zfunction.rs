//! Segmentation by activity: the z-function of Pomplun and Mataric (2000) and Fod, Mataric and Jenkins (2002).
//!
//! `z(t) = sum_j w_j (d theta_j / dt)^2` is high in movements and low in the pauses between them. A
//! movement runs from the last frame below `off` before z reaches `on` to the first frame of the next pause.

use super::signal::{Frames, Signal, above_zero, at_least, derivative, moving_average};
use super::spans::{Span, covering};
use crate::error::{Error, Result};
use crate::math::statistics::quantile;

/// Where a movement begins and ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// `on` is this share of the recording's 90th percentile of z.
    Share(f64),
    /// `on` is this multiple of the value that best splits log z into two classes (Otsu 1979).
    Otsu(f64),
    /// `on` is this value of z, in its units.
    Fixed(f64),
}

/// Settings of the z-function segmenter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZFunction {
    /// Where z must rise to for a movement to begin.
    pub threshold: Threshold,
    /// Where z must fall to for it to end, as a share of `on`, in (0, 1]: the hysteresis against chatter.
    pub off_share: f64,
    /// What a movement must reach at its height, as a multiple of `on`; 1 asks for nothing more.
    pub peak_share: f64,
    /// How long z must stay low to end a movement, seconds.
    pub hold_secs: f64,
    /// The shortest movement, seconds; shorter ones count as rest.
    pub min_secs: f64,
    /// Longer movements (seconds) are cut again with `off` raised by a quarter, up to six times.
    pub max_secs: f64,
    /// The window of derivative and of smoothing, seconds; 0.05 to 0.1 is customary.
    pub smooth_secs: f64,
}

impl Default for ZFunction {
    fn default() -> Self {
        Self {
            threshold: Threshold::Share(0.15),
            off_share: 0.5,
            peak_share: 1.0,
            hold_secs: 0.05,
            min_secs: 0.2,
            max_secs: 4.0,
            smooth_secs: 0.075,
        }
    }
}

/// Movements of joint coordinates (`angles`, radians), and rests elsewhere; together they cover the recording.
///
/// `weights` has one number a coordinate, such as `1 / range^2`, so that a rolling wrist does not rule; empty
/// means 1 for each. A recording that never moves is one rest.
///
/// # Errors
/// When weights are of another number, negative or not finite, or a setting is out of range.
pub fn segment(angles: &Signal, weights: &[f64], config: &ZFunction) -> Result<Vec<Span>> {
    let z = activity(angles, weights, config.smooth_secs)?;
    segment_activity(&z, angles.rate_hz(), config)
}

/// The activity z(t), one number a frame, in weighted squared radians a second squared.
///
/// Derivative and z itself are smoothed over `smooth_secs`. Played `a` times as fast (with the window
/// shorter by as much), z is `a^2` times as high.
///
/// # Errors
/// When weights are of another number, negative or not finite, or `smooth_secs` is negative.
pub fn activity(angles: &Signal, weights: &[f64], smooth_secs: f64) -> Result<Vec<f64>> {
    if !weights.is_empty() && weights.len() != angles.dims() {
        return Err(Error::invalid(format!(
            "the z-function needs one weight a coordinate, found {} for {}",
            weights.len(),
            angles.dims()
        )));
    }
    if let Some(w) = weights.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
        return Err(Error::invalid(format!(
            "weights of the z-function must not be negative, found {w}"
        )));
    }
    at_least("smooth_secs", smooth_secs, 0.0)?;
    let half = angles.half_window(smooth_secs);
    let z: Vec<f64> = derivative(angles, half)
        .chunks_exact(angles.dims())
        .map(|rates| match weights {
            [] => rates.iter().map(|v| v * v).sum(),
            _ => rates.iter().zip(weights).map(|(v, w)| w * v * v).sum(),
        })
        .collect();
    Ok(moving_average(&z, 1, half))
}

/// [`segment`] on an activity that is known already, sampled at `rate_hz`.
///
/// # Errors
/// When a setting is out of range.
pub fn segment_activity(z: &[f64], rate_hz: f64, config: &ZFunction) -> Result<Vec<Span>> {
    check(config)?;
    // One frame more or less is a matter of rounding the duration, not of the movement.
    let frames_in = |secs: f64| (secs * rate_hz).round() as usize;
    let on = on_threshold(z, config.threshold);
    let rules = Rules {
        peak: on * config.peak_share,
        hold: frames_in(config.hold_secs).max(1),
        min: frames_in(config.min_secs).max(1),
        max: frames_in(config.max_secs).max(1),
    };
    let mut moving = Vec::new();
    if on > 0.0 {
        rules.cut(z, 0, on, on * config.off_share, 6, &mut moving);
    }
    Ok(covering(&moving, z.len()))
}

/// The value that z must reach for a movement to begin; 0 when nothing moves.
pub fn on_threshold(z: &[f64], threshold: Threshold) -> f64 {
    match threshold {
        Threshold::Fixed(on) => on,
        Threshold::Otsu(factor) => factor * otsu(z),
        Threshold::Share(share) => {
            let high = quantile(z, 0.9).unwrap_or(0.0);
            // A recording that mostly rests has its movements above that percentile.
            let high = if high > 0.0 {
                high
            } else {
                z.iter().copied().fold(0.0, f64::max)
            };
            share * high
        }
    }
}

/// The split of log z with the greatest variance between its two sides, half-way between their edges.
fn otsu(z: &[f64]) -> f64 {
    let highest = z.iter().copied().fold(0.0, f64::max);
    if highest <= 0.0 {
        return 0.0;
    }
    // Frames that stand quite still would otherwise lie at minus infinity.
    let mut logs: Vec<f64> = z.iter().map(|v| v.max(1e-9 * highest).ln()).collect();
    logs.sort_unstable_by(f64::total_cmp);
    let count = logs.len() as f64;
    let total: f64 = logs.iter().sum();
    let mut below = 0.0;
    let mut best = (0.0, highest.ln());
    for k in 1..logs.len() {
        below += logs[k - 1];
        let n = k as f64;
        let difference = below / n - (total - below) / (count - n);
        let between = n * (count - n) * difference * difference;
        if between > best.0 && logs[k] > logs[k - 1] {
            best = (between, 0.5 * (logs[k] + logs[k - 1]));
        }
    }
    best.1.exp()
}

/// The hysteresis, in frames.
struct Rules {
    peak: f64,
    hold: usize,
    min: usize,
    max: usize,
}

impl Rules {
    /// Appends the movements of `z`, whose first frame is `first`; long ones are cut again while `depth` lasts.
    fn cut(&self, z: &[f64], first: usize, on: f64, off: f64, depth: usize, out: &mut Vec<Frames>) {
        for (s, e) in self.movements(z, on, off) {
            let before = out.len();
            if e - s > self.max && depth > 0 {
                let off = off * 1.25;
                self.cut(&z[s..e], first + s, on.max(off), off, depth - 1, out);
            }
            // What falls apart into nothing was one movement after all.
            if out.len() == before {
                out.push((first + s, first + e));
            }
        }
    }

    /// One pass of the hysteresis.
    fn movements(&self, z: &[f64], on: f64, off: f64) -> Vec<Frames> {
        let mut out = Vec::new();
        // Where the next movement may begin at the earliest, and the last frame at or below `off`.
        let mut low = 0;
        let mut begun: Option<usize> = None;
        let mut low_since: Option<usize> = None;
        let mut close = |s: usize, e: usize| {
            let highest = z[s..e].iter().copied().fold(0.0, f64::max);
            if e - s >= self.min && highest >= self.peak {
                out.push((s, e));
            }
        };
        for (t, &v) in z.iter().enumerate() {
            let is_low = v <= off;
            match begun {
                None => {
                    if is_low {
                        low = t;
                    }
                    if v >= on {
                        begun = Some(low);
                        low_since = None;
                    }
                }
                Some(s) if is_low => {
                    let since = *low_since.get_or_insert(t);
                    if t + 1 - since >= self.hold {
                        close(s, since);
                        (begun, low_since, low) = (None, None, t);
                    }
                }
                Some(_) => low_since = None,
            }
        }
        if let Some(s) = begun {
            close(s, z.len());
        }
        out
    }
}

fn check(config: &ZFunction) -> Result<()> {
    match config.threshold {
        Threshold::Share(v) | Threshold::Otsu(v) | Threshold::Fixed(v) => {
            above_zero("threshold", v)?;
        }
    }
    above_zero("off_share", config.off_share)?;
    if config.off_share > 1.0 {
        return Err(Error::invalid(format!(
            "off_share must not exceed 1, found {}",
            config.off_share
        )));
    }
    at_least("peak_share", config.peak_share, 0.0)?;
    at_least("hold_secs", config.hold_secs, 0.0)?;
    at_least("min_secs", config.min_secs, 0.0)?;
    at_least("max_secs", config.max_secs, config.min_secs)
}
