//! A wanted duration in place of thresholds.
//!
//! Each segmenter has one quantity that lengthens or shortens its movements; it is searched on a logarithmic
//! scale until the median movement is as long as wanted, or as near as the recording allows.

use super::changepoint::{self, ChangePoint};
use super::pendulum::{self, Limb, Pendulum};
use super::signal::{Signal, above_zero};
use super::spans::{Segmentation, Span};
use super::zfunction::{self, Threshold, ZFunction};
use crate::error::Result;

/// Range of the scale, as powers of two to either side of 1.
const OCTAVES: f64 = 8.0;
/// Segmentations tried after the first: enough to find the scale to a per cent.
const PROBES: usize = 13;

/// Pendulum swings of a median of `target_secs`: scales how large a swing must be and how far it must return.
///
/// Rests stay what they are, so swings cannot become longer than the stretches between them.
///
/// # Errors
/// As for [`pendulum::segment`], and when the target is not positive.
pub fn pendulum(limbs: &[Limb], config: &Pendulum, target_secs: f64) -> Result<Segmentation> {
    let rate_hz = limbs.first().map_or(1.0, |l| l.bob.rate_hz());
    search(target_secs, rate_hz, true, |scale| {
        let scaled = Pendulum {
            min_swing: config.min_swing * scale,
            fall: config.fall * scale,
            fall_share: (config.fall_share * scale).min(0.95),
            ..*config
        };
        pendulum::segment(limbs, &scaled)
    })
}

/// Movements by activity of a median of `target_secs`: scales both thresholds of z.
///
/// # Errors
/// As for [`zfunction::segment`], and when the target is not positive.
pub fn zfunction(
    angles: &Signal,
    weights: &[f64],
    config: &ZFunction,
    target_secs: f64,
) -> Result<Segmentation> {
    let z = zfunction::activity(angles, weights, config.smooth_secs)?;
    search(target_secs, angles.rate_hz(), false, |scale| {
        let scaled = ZFunction {
            threshold: match config.threshold {
                Threshold::Share(v) => Threshold::Share(v * scale),
                Threshold::Otsu(v) => Threshold::Otsu(v * scale),
                Threshold::Fixed(v) => Threshold::Fixed(v * scale),
            },
            ..*config
        };
        zfunction::segment_activity(&z, angles.rate_hz(), &scaled)
    })
}

/// Segments between change points of a median of `target_secs`: scales the penalty.
///
/// # Errors
/// As for [`changepoint::segment`], and when the target is not positive.
pub fn changepoint(
    features: &Signal,
    config: &ChangePoint,
    target_secs: f64,
) -> Result<Segmentation> {
    search(target_secs, features.rate_hz(), true, |scale| {
        let scaled = ChangePoint {
            penalty: config.penalty * scale,
            ..*config
        };
        changepoint::segment(features, &scaled)
    })
}

/// Bisection over the scale; the best of all that was seen is kept, as real recordings are only nearly monotone.
///
/// `rising` says that a larger scale gives longer movements. Nearness is that of logarithms: twice as long
/// is as far as half as long.
fn search(
    target_secs: f64,
    rate_hz: f64,
    rising: bool,
    mut segment: impl FnMut(f64) -> Result<Vec<Span>>,
) -> Result<Segmentation> {
    above_zero("the target duration", target_secs)?;
    let mut probe = |exponent: f64| -> Result<Segmentation> {
        let scale = f64::exp2(exponent);
        Ok(Segmentation::new(segment(scale)?, rate_hz, scale))
    };
    let far = |t: &Segmentation| {
        t.median_secs
            .map_or(f64::INFINITY, |m| (m / target_secs).ln().abs())
    };
    // The setting as it was given comes first, and stays if nothing is nearer.
    let mut best = probe(0.0)?;
    let mut median = best.median_secs;
    let (mut low, mut high) = (None, None);
    let mut exponent = 0.0;
    for _ in 0..PROBES {
        // Where nothing moves any more the threshold was too high, as if movements were too short.
        if median.is_some_and(|m| m > target_secs) == rising {
            high = Some(exponent);
        } else {
            low = Some(exponent);
        }
        // Outward in doubling steps until the target is enclosed, as far-off settings can be slow.
        exponent = match (low, high) {
            (Some(low), Some(high)) => 0.5 * (low + high),
            (Some(low), None) if low < OCTAVES => f64::max(1.0, 2.0 * low),
            (None, Some(high)) if high > -OCTAVES => f64::min(-1.0, 2.0 * high),
            _ => break,
        };
        let next = probe(exponent)?;
        median = next.median_secs;
        if far(&next) < far(&best) {
            best = next;
        }
    }
    Ok(best)
}
