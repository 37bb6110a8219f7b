//! Where markers were, and what lies between them.

use kineme::math::statistics::median;
use nalgebra::Vector3;

/// A place, metres; `None` where it was not seen.
pub type Point = Option<Vector3<f64>>;
/// A place a frame.
pub type Path = Vec<Point>;

/// The places of all markers, frame by frame, metres.
pub struct Places<'r> {
    pub seen: &'r [Point],
    /// Markers.
    pub count: usize,
    pub frames: usize,
}

impl Places<'_> {
    /// Where a marker was seen.
    pub fn at(&self, frame: usize, marker: usize) -> Point {
        self.seen[frame * self.count + marker]
    }

    /// Midway between markers, where all of them are seen.
    pub fn middle(&self, of: &[usize]) -> Path {
        each(self.frames, |f| {
            let mut sum = Vector3::zeros();
            for marker in of {
                sum += self.at(f, *marker)?;
            }
            (!of.is_empty()).then(|| sum / of.len() as f64)
        })
    }

    /// The median distance of two markers.
    pub fn distance(&self, a: usize, b: usize) -> f64 {
        let apart = |f| Some((self.at(f, a)? - self.at(f, b)?).norm());
        let apart: Vec<f64> = (0..self.frames).filter_map(apart).collect();
        median(&apart).unwrap_or(0.0)
    }
}

/// A path, frame by frame.
pub fn each(frames: usize, at: impl FnMut(usize) -> Point) -> Path {
    (0..frames).map(at).collect()
}
