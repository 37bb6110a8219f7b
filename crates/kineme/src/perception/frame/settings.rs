//! [`FrameSettings`]: how the exact frame classifier sees.

use crate::error::{Error, Result};
use crate::perception::checked::{counts, not_negative, positive};
use crate::perception::rows::MOST_DIMS;

/// How [`super::Frame`] sees.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSettings {
    /// Postures that are judged together, 1 to 64.
    pub n: usize,
    /// Frames from one of them to the next, 1 to 1000. Consecutive frames lie within one tolerance of each other and
    /// say little about direction; 4 or more at 60 Hz do.
    pub stride: usize,
    /// A coordinate counts as equal within this at least, radians.
    pub delta_rad: f64,
    /// The tolerance is this multiple of the vocabulary's mean leave-one-out error where that is more.
    pub residual: f64,
    /// The same for coordinates that no primitive moves, radians.
    pub constant_rad: f64,
    /// How far readings may pass the joint limits, radians: widens the range of the uniform background.
    pub limits_rad: f64,
    /// Parts of the body that may be at fault unannounced in a posture, 0 to 8. With 1, a broken sensor no longer
    /// silences everything, but what a movement does with one part no longer tells, either: a movement of one arm is
    /// then accepted backward.
    pub faults: usize,
    /// How often a part is at fault, above 0 and below 1; without effect where none may be.
    pub fault_rate: f64,
    /// Patches along each parameter of primitives with one, two and three parameters, 1 to 128, 32 and 12.
    pub patches: [usize; MOST_DIMS],
    /// Pieces of phase, 4 to 512.
    pub pieces: usize,
    /// How probable rest is beforehand, as a multiple of one primitive.
    pub prior_rest: f64,
    /// The same of a movement that is none of the primitives.
    pub prior_none: f64,
    /// Spans of a recognised motion last at least so long, seconds.
    pub dwell_secs: f64,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            n: 2,
            stride: 4,
            delta_rad: 0.08,
            residual: 2.5,
            constant_rad: 0.35,
            limits_rad: 0.2,
            faults: 0,
            fault_rate: 0.02,
            patches: [24, 8, 4],
            pieces: 64,
            prior_rest: 1.0,
            prior_none: 1.0,
            dwell_secs: 0.2,
        }
    }
}

impl FrameSettings {
    pub(super) fn check(&self) -> Result<()> {
        let [one, two, three] = self.patches;
        counts(&[
            ("n", self.n, 1, 64),
            ("stride", self.stride, 1, 1000),
            ("faults", self.faults, 0, 8),
            ("patches of one parameter", one, 1, 128),
            ("patches of two parameters", two, 1, 32),
            ("patches of three parameters", three, 1, 12),
            ("pieces", self.pieces, 4, 512),
        ])?;
        positive(&[
            ("delta_rad", self.delta_rad),
            ("constant_rad", self.constant_rad),
            ("prior_none", self.prior_none),
        ])?;
        not_negative(&[
            ("residual", self.residual),
            ("limits_rad", self.limits_rad),
            ("prior_rest", self.prior_rest),
            ("dwell_secs", self.dwell_secs),
        ])?;
        if !(self.fault_rate > 0.0 && self.fault_rate < 1.0) {
            return Err(Error::invalid(format!(
                "fault_rate must lie between 0 and 1, found {}",
                self.fault_rate
            )));
        }
        Ok(())
    }
}
