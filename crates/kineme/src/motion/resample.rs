//! Other rates: the one grid on which motions and recordings are resampled.

use nalgebra::{UnitQuaternion, Vector3};

use super::recording::{Observed, Recording};
use crate::error::{Error, Result};

/// Frames that resampling may make of fewer: some hours at the rate of any camera.
const MOST_FRAMES: f64 = 1e6;

/// Where a new frame lies between two old ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// The old frame before it, or at it.
    pub before: usize,
    /// The one after; the same at the end.
    pub after: usize,
    /// How far it is on the way from one to the other, in [0, 1).
    pub share: f64,
}

/// The places of the frames at `rate_hz` among `frames` at `from_hz`; the first stays at time zero.
pub(super) fn places(frames: usize, from_hz: f64, rate_hz: f64) -> Result<Vec<Place>> {
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Error::invalid(format!(
            "a rate must be positive, found {rate_hz} Hz"
        )));
    }
    let last = frames - 1;
    let count = ((last as f64 / from_hz) * rate_hz + 1e-9).floor() + 1.0;
    if count > MOST_FRAMES.max(frames as f64) {
        return Err(Error::invalid(format!(
            "{:.0} s at {rate_hz} Hz would be {count:.0} frames, more than {MOST_FRAMES:.0}",
            last as f64 / from_hz
        )));
    }
    Ok((0..count as usize)
        .map(|i| {
            // Rounding must not mix a neighbour into a frame that is hit exactly.
            let at = i as f64 * from_hz / rate_hz;
            let at = if (at - at.round()).abs() < 1e-9 {
                at.round()
            } else {
                at
            };
            let before = (at.floor() as usize).min(last);
            Place {
                before,
                after: (before + 1).min(last),
                share: at - before as f64,
            }
        })
        .collect())
}

impl Recording {
    /// The recording at another rate, the first frame at time zero: rotations along the shortest arc at even speed
    /// (Shoemake 1985), translations and positions linearly. A point between two frames is missing where one of
    /// the two is.
    ///
    /// # Errors
    /// When the rate is not positive, or would make more than a million frames of fewer.
    pub fn resampled(&self, rate_hz: f64) -> Result<Self> {
        let places = places(self.frames(), self.rate_hz(), rate_hz)?;
        let n = self.joints().len();
        let observed = match self.observed() {
            Observed::Rotations {
                rotations,
                translations,
            } => Observed::Rotations {
                rotations: places
                    .iter()
                    .flat_map(|p| (0..n).map(move |j| (p, j)))
                    .map(|(p, j)| {
                        let turn = |frame: usize| rotations[frame * n + j];
                        between(turn(p.before), turn(p.after), p.share)
                    })
                    .collect(),
                translations: translations
                    .iter()
                    .map(|path| path.as_deref().map(|path| along(path, &places)))
                    .collect(),
            },
            Observed::Positions(positions) => Observed::Positions(
                places
                    .iter()
                    .flat_map(|p| (0..n).map(move |j| (p, j)))
                    .map(|(p, j)| {
                        let point = |frame: usize| positions[frame * n + j];
                        if p.share == 0.0 {
                            return point(p.before);
                        }
                        Some(point(p.before)?.lerp(&point(p.after)?, p.share))
                    })
                    .collect(),
            ),
        };
        Recording::new(
            self.name(),
            self.source().clone(),
            self.joints().to_vec(),
            rate_hz,
            observed,
        )
    }
}

fn along(path: &[Vector3<f64>], places: &[Place]) -> Vec<Vector3<f64>> {
    places
        .iter()
        .map(|p| match p.share {
            0.0 => path[p.before],
            share => path[p.before].lerp(&path[p.after], share),
        })
        .collect()
}

fn between(a: UnitQuaternion<f64>, b: UnitQuaternion<f64>, share: f64) -> UnitQuaternion<f64> {
    if share == 0.0 {
        return a;
    }
    // Opposite rotations have no shortest arc; either end serves.
    a.try_slerp(&b, share, 1e-12).unwrap_or(a)
}
