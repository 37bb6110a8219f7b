//! [`Track`]: Cartesian paths of named points.

use nalgebra::Vector3;

/// Paths of named points through space at one rate, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    rate_hz: f64,
    names: Vec<String>,
    points: Vec<Vector3<f64>>,
}

impl Track {
    /// Paths of the points `names`, frame-major.
    ///
    /// # Panics
    /// When `points` is no whole number of frames.
    pub fn new(rate_hz: f64, names: Vec<String>, points: Vec<Vector3<f64>>) -> Self {
        assert!(
            !names.is_empty() && points.len().is_multiple_of(names.len()),
            "whole frames of named points"
        );
        Self {
            rate_hz,
            names,
            points,
        }
    }

    /// Frames a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The points' names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The number of frames.
    pub fn frames(&self) -> usize {
        self.points.len() / self.names.len()
    }

    /// All points at a frame, in the order of [`Self::names`].
    pub fn at(&self, frame: usize) -> &[Vector3<f64>] {
        let n = self.names.len();
        &self.points[frame * n..(frame + 1) * n]
    }

    /// The path of the point with this index.
    pub fn path(&self, point: usize) -> impl Iterator<Item = Vector3<f64>> + '_ {
        self.points
            .iter()
            .skip(point)
            .step_by(self.names.len())
            .copied()
    }
}
