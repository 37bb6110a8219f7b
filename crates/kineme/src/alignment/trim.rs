//! Rests at the ends of a movement, which no warp could make fit: they are cut off before registration.

use std::ops::Range;

/// Settings of [`resting_ends`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trim {
    /// What counts as rest: a speed below this share of the sequence's own root-mean-square speed.
    pub share: f64,
    /// The window over which speed is taken and smoothed, seconds.
    pub smooth_secs: f64,
    /// How much of the rest is kept on either side, seconds.
    pub margin_secs: f64,
    /// Frames that are left at least, if there are as many.
    pub least_frames: usize,
}

impl Default for Trim {
    fn default() -> Self {
        Self {
            share: 0.2,
            smooth_secs: 0.1,
            margin_secs: 0.1,
            least_frames: 8,
        }
    }
}

/// The frames that are left when the rests at both ends of a sequence are cut off.
///
/// `sequence` holds points, row-major with `dims` numbers a frame (metres), at `rate_hz`. Activity is their speed
/// (m/s, root mean square over the frame's numbers, as in the z-function of Fod, Mataric and Jenkins 2002, section 2.1), and a
/// movement begins where activity last began to rise before it exceeded `share` of its root mean square: an even
/// start from the first frame, however slow, is part of the movement. What never moves is left whole, as is what
/// has no whole frame or no rate.
pub fn resting_ends(sequence: &[f64], dims: usize, rate_hz: f64, trim: &Trim) -> Range<usize> {
    let frames = sequence.len().checked_div(dims).unwrap_or(0);
    if frames < 2 || !rate_hz.is_finite() || rate_hz <= 0.0 {
        return 0..frames;
    }
    let frames_in = |secs: f64| (secs.max(0.0) * rate_hz).round() as usize;
    let half = frames_in(0.5 * trim.smooth_secs).max(1);
    let speeds = speeds(sequence, dims, rate_hz, half);
    let squares: f64 = speeds.iter().map(|v| v * v).sum();
    let least = trim.share * (squares / frames as f64).sqrt();
    let moves = |v: &f64| *v > least;
    let (Some(first), Some(last)) = (
        speeds.iter().position(moves),
        speeds.iter().rposition(moves),
    ) else {
        return 0..frames;
    };
    let mut start = first;
    while start > 0 && speeds[start - 1] < speeds[start] {
        start -= 1;
    }
    let mut end = last;
    while end + 1 < frames && speeds[end + 1] < speeds[end] {
        end += 1;
    }
    let margin = frames_in(trim.margin_secs);
    start = start.saturating_sub(margin);
    end = end.saturating_add(margin).min(frames - 1) + 1;
    // Too short a rest of a movement is widened on both sides, and on the other where one side ends.
    let missing = trim.least_frames.min(frames).saturating_sub(end - start);
    start = start.saturating_sub(missing.div_ceil(2));
    end = (end + missing)
        .min(frames)
        .min(start + (end - start).max(trim.least_frames));
    start = start.min(end.saturating_sub(trim.least_frames));
    start..end
}

/// Speed of each frame over `2 half` frames, smoothed by a moving average as wide; both shrink at the ends.
fn speeds(sequence: &[f64], dims: usize, rate_hz: f64, half: usize) -> Vec<f64> {
    let frames = sequence.len() / dims;
    let row = |f: usize| &sequence[f * dims..(f + 1) * dims];
    let rough: Vec<f64> = (0..frames)
        .map(|t| {
            let (a, b) = (t.saturating_sub(half), (t + half).min(frames - 1));
            let pairs = row(a).iter().zip(row(b));
            let squares: f64 = pairs.map(|(x, y)| (y - x) * (y - x)).sum();
            (squares / dims as f64).sqrt() * rate_hz / (b - a) as f64
        })
        .collect();
    (0..frames)
        .map(|t| {
            let h = half.min(t).min(frames - 1 - t);
            rough[t - h..=t + h].iter().sum::<f64>() / (2 * h + 1) as f64
        })
        .collect()
}
