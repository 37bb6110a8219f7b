//! [`FlowSettings`]: how a primitive is sampled into a field, and how the field draws.

use super::samples::{MOST_NEIGHBOURS, MOST_PIECES};
use crate::error::{Error, Result};

/// What the field remembers from one moment to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Memory {
    /// The phase: only what lies a little behind and ahead of it is near.
    #[default]
    Phase,
    /// Nothing, as in the paper: the nearest postures, whatever their phase, are averaged. Movements that come back
    /// through the same postures stall.
    None,
}

/// What a radian of each coordinate counts in the distance of postures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Metric {
    /// The squared displacement of the landmarks a radian, at the mean posture: a shoulder counts more than a wrist.
    #[default]
    Landmarks,
    /// One over the squared range of the joint, as in the activity of segmentation.
    Activity,
}

/// How a primitive becomes a flowfield.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowSettings {
    /// What the field remembers.
    pub memory: Memory,
    /// What each coordinate counts.
    pub metric: Metric,
    /// Courses sampled beside the exemplars, at most 512; `None`: as many as the number of parameters asks for.
    pub courses: Option<usize>,
    /// Pieces into which phase is cut, 8 to 128.
    pub pieces: usize,
    /// Nearest courses that are blended (k), 1 to 31.
    pub neighbours: usize,
    /// Correction toward the manifold (k_c), 1/s.
    pub correction: f64,
    /// How far behind and ahead of the phase postures are sought, in phase.
    pub window: [f64; 2],
    /// A phase off by this much counts as much as a posture off by `sigma_rad`.
    pub sigma: f64,
    /// Parameters off by this much count as much as a posture off by `sigma_rad`.
    pub sigma_parameters: f64,
    /// The distance that postures keep from the manifold, radians.
    pub sigma_rad: f64,
    /// Whether the pace of what is observed is learned, too.
    pub learn_pace: bool,
    /// Distance from the manifold beyond which a posture is out of the basin, radians.
    pub basin_rad: f64,
}

impl Default for FlowSettings {
    fn default() -> Self {
        Self {
            memory: Memory::Phase,
            metric: Metric::Landmarks,
            courses: None,
            pieces: 64,
            neighbours: 8,
            correction: 2.0,
            window: [0.03, 0.12],
            sigma: 0.015,
            sigma_parameters: 0.5,
            sigma_rad: 0.05,
            learn_pace: true,
            basin_rad: 0.6,
        }
    }
}

impl FlowSettings {
    /// The settings of the paper's field: without memory, and drawn to the manifold as strongly as serves it best.
    pub fn paper() -> Self {
        Self {
            memory: Memory::None,
            correction: 4.0,
            ..Self::default()
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        let wrong = |what: String| Err(Error::invalid(format!("flowfield: {what}")));
        if self.courses.is_some_and(|c| c > MOST_COURSES) {
            return wrong(format!("at most {MOST_COURSES} courses"));
        }
        if !(8..=MOST_PIECES).contains(&self.pieces) {
            return wrong(format!("{} pieces, not 8 to {MOST_PIECES}", self.pieces));
        }
        if !(1..=MOST_NEIGHBOURS).contains(&self.neighbours) {
            return wrong(format!(
                "{} neighbours, not 1 to {MOST_NEIGHBOURS}",
                self.neighbours
            ));
        }
        let positive = [
            self.correction,
            self.sigma,
            self.sigma_parameters,
            self.sigma_rad,
            self.basin_rad,
        ];
        if positive.iter().any(|v| !(v.is_finite() && *v > 0.0)) {
            return wrong("correction, sigmas and basin are positive".into());
        }
        if self.window.iter().any(|w| !(0.0..=0.45).contains(w)) {
            return wrong(format!("a window of {:?}, not 0 to 0.45", self.window));
        }
        Ok(())
    }
}

/// Courses that may be asked for, which bounds the memory.
pub(super) const MOST_COURSES: usize = 512;
