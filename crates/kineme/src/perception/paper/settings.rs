//! [`PaperSettings`]: how the paper's classifier sees.

use crate::error::Result;
use crate::perception::checked::{counts, not_negative, positive};
use crate::perception::rows::MOST_DIMS;

/// How [`super::Paper`] sees. The paper publishes n alone; every other number is ours.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperSettings {
    /// Postures that are judged together, 1 to 64: 1 and 2 in the paper's table.
    pub n: usize,
    /// Frames from one of them to the next, 1 to 1000.
    pub stride: usize,
    /// A coordinate counts as equal within this at least, radians; no bin of a histogram is narrower.
    pub delta_rad: f64,
    /// The tolerance is this multiple of the vocabulary's mean leave-one-out error where that is more.
    pub residual: f64,
    /// The same for coordinates that no primitive moves, radians.
    pub constant_rad: f64,
    /// Tolerance for sensor malfunction, radians: how far readings may pass the joint limits.
    pub limits_rad: f64,
    /// Granularity of the interval search: pieces into which phase is cut, 4 to 512.
    pub pieces: usize,
    /// Granularity of the sampling: places along each parameter of primitives with one, two and three parameters, 2 to
    /// 128, 32 and 12.
    pub samples: [usize; MOST_DIMS],
    /// Spans of a recognised motion last at least so long, seconds.
    pub dwell_secs: f64,
}

impl Default for PaperSettings {
    fn default() -> Self {
        Self {
            n: 2,
            stride: 1,
            delta_rad: 0.08,
            residual: 1.0,
            constant_rad: 0.35,
            limits_rad: 0.2,
            pieces: 128,
            samples: [64, 13, 6],
            dwell_secs: 0.2,
        }
    }
}

impl PaperSettings {
    pub(super) fn check(&self) -> Result<()> {
        let [one, two, three] = self.samples;
        counts(&[
            ("n", self.n, 1, 64),
            ("stride", self.stride, 1, 1000),
            ("pieces", self.pieces, 4, 512),
            ("samples of one parameter", one, 2, 128),
            ("samples of two parameters", two, 2, 32),
            ("samples of three parameters", three, 2, 12),
        ])?;
        positive(&[
            ("delta_rad", self.delta_rad),
            ("constant_rad", self.constant_rad),
        ])?;
        not_negative(&[
            ("residual", self.residual),
            ("limits_rad", self.limits_rad),
            ("dwell_secs", self.dwell_secs),
        ])?;
        Ok(())
    }
}
