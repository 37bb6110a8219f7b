//! The frames of continuous recordings.

use crate::error::{Error, Result};
use crate::math::distances::count_points;

/// The frames of one or more recordings, as points.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// `values[d * len + i]`: component `d` of frame `i`; loops over frames then run through memory.
    values: Vec<f64>,
    dimension: usize,
    /// Where each recording starts, and the number of all frames.
    pub(super) starts: Vec<usize>,
    /// Squared diagonal of the box around all frames.
    pub(super) extent: f64,
}

impl Frames {
    /// Frames, row-major in `dimension` columns, of recordings with these numbers of frames, one after the other.
    ///
    /// # Errors
    /// When numbers are not finite, or the lengths do not add up or one is zero.
    pub fn new(points: &[f64], dimension: usize, lengths: &[usize]) -> Result<Self> {
        let len = count_points(points, dimension)?;
        let sum = lengths
            .iter()
            .try_fold(0usize, |sum, &n| sum.checked_add(n));
        if lengths.contains(&0) || sum != Some(len) || len < 2 {
            return Err(Error::invalid(format!(
                "recordings have a frame or more and {len} frames together, at least two, found lengths {lengths:?}"
            )));
        }
        let mut values = vec![0.0; points.len()];
        for (i, point) in points.chunks_exact(dimension).enumerate() {
            for (d, &value) in point.iter().enumerate() {
                values[d * len + i] = value;
            }
        }
        let extent = values
            .chunks_exact(len)
            .map(|column| {
                let ends = column.iter().fold((f64::MAX, f64::MIN), |(low, high), v| {
                    (v.min(low), v.max(high))
                });
                (ends.1 - ends.0).powi(2)
            })
            .sum();
        let ends = lengths.iter().scan(0, |end, &n| {
            *end += n;
            Some(*end)
        });
        Ok(Self {
            values,
            dimension,
            starts: std::iter::once(0).chain(ends).collect(),
            extent,
        })
    }

    /// The number of frames of all recordings.
    pub fn len(&self) -> usize {
        self.values.len() / self.dimension
    }

    /// Never true: frames that exist are two or more.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// First frame and frame after the last of each recording.
    pub(super) fn recordings(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.starts.windows(2).map(|w| (w[0], w[1]))
    }

    /// Squared distances of frame `x` to the frames of `range`, written over `row`.
    pub(super) fn squares(&self, x: usize, range: std::ops::Range<usize>, row: &mut [f64]) {
        row.fill(0.0);
        for column in self.values.chunks_exact(self.len()) {
            let here = column[x];
            for (sum, value) in row.iter_mut().zip(&column[range.clone()]) {
                let difference = value - here;
                *sum += difference * difference;
            }
        }
    }
}
