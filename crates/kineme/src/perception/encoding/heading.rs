//! Which way a body faces: the horizontal part of the line of its shoulders.
//!
//! Taken frame by frame the heading carries the noise of the shoulders into the hands; taken once a clip it forgets that
//! people turn. One rule serves trackers of either kind: a Gaussian mean over a third of a second, in which a line counts
//! by its horizontal length, so that a body which lies on its side keeps the heading that it had.

use nalgebra::{Vector2, Vector3};

/// How many standard deviations of the mean are looked at.
const REACH: f64 = 3.5;

/// The headings (radians, 0 faces x) of lines from the right to the left shoulder, smoothed over `width_secs`. Where
/// nothing was seen, that of the frame before.
pub(super) fn headings(lines: &[Option<Vector3<f64>>], rate_hz: f64, width_secs: f64) -> Vec<f64> {
    let flat: Vec<Vector2<f64>> = lines
        .iter()
        .map(|line| line.map_or(Vector2::zeros(), |l| Vector2::new(l.y, -l.x)))
        .collect();
    let width = width_secs * rate_hz;
    let span = (REACH * width).floor() as usize;
    let kernel: Vec<f64> = (0..=span)
        .map(|d| (-0.5 * (d as f64 / width.max(1e-9)).powi(2)).exp())
        .collect();
    let mut before = 0.0;
    (0..flat.len())
        .map(|f| {
            let window = f.saturating_sub(span)..(f + span + 1).min(flat.len());
            let sum: Vector2<f64> = window.map(|g| flat[g] * kernel[g.abs_diff(f)]).sum();
            if sum.norm_squared() > 1e-12 {
                before = sum.y.atan2(sum.x);
            }
            before
        })
        .collect()
}
