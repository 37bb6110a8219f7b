//! Warping distances of all pairs of many sequences of equal length.

use rayon::prelude::*;

use super::lanes::{BlockTask, LANES, Lane, Shape};
use crate::error::{Error, Result};

/// Many sequences of equal length, held in f32 about their common mean.
///
/// The mean (a vector of `dims` numbers, over all frames of all sequences) is removed before rounding:
/// distances do not change by it, and lose less to rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequences {
    frames: usize,
    dims: usize,
    mean: Vec<f64>,
    values: Vec<f32>,
}

impl Sequences {
    /// Takes `values[(item * frames + frame) * dims + dim]`; no items at all are allowed.
    ///
    /// # Errors
    /// When `frames` or `dims` is 0, `values` is no whole number of items, or a number is not finite or
    /// more than 1e15 from the mean (its square would leave f32).
    pub fn new(values: &[f64], frames: usize, dims: usize) -> Result<Self> {
        if frames == 0 || dims == 0 || !values.len().is_multiple_of(frames * dims) {
            return Err(Error::invalid(format!(
                "sequences of {frames} frames of {dims} numbers cannot be cut from {} numbers",
                values.len()
            )));
        }
        let mut mean = vec![0.0; dims];
        for frame in values.chunks_exact(dims) {
            for (sum, v) in mean.iter_mut().zip(frame) {
                *sum += v;
            }
        }
        let count = (values.len() / dims).max(1) as f64;
        for sum in &mut mean {
            *sum /= count;
        }
        let values = centred(values, &mean)?;
        Ok(Self {
            frames,
            dims,
            mean,
            values,
        })
    }

    /// How many sequences there are.
    pub fn len(&self) -> usize {
        self.values.len() / (self.frames * self.dims)
    }

    /// True without any sequence.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Frames of each sequence.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Numbers a frame.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The sequences `items`, one after the other, `[frame][dim]` each, about the mean.
    pub(super) fn slice(&self, items: std::ops::Range<usize>) -> &[f32] {
        let size = self.frames * self.dims;
        &self.values[items.start * size..items.end * size]
    }

    pub(super) fn shape(&self, radius: usize) -> Shape {
        Shape {
            frames: self.frames,
            dims: self.dims,
            // A wider band holds nothing more.
            radius: radius.min(self.frames),
        }
    }

    /// Up to [`LANES`] sequences side by side, `[frame][dim]` of lanes; spare lanes repeat the last.
    pub(super) fn block(&self, items: &[usize]) -> Vec<Lane> {
        let mut block = vec![[0.0; LANES]; self.frames * self.dims];
        for lane in 0..LANES {
            let item = items[lane.min(items.len() - 1)];
            for (cell, v) in block.iter_mut().zip(self.slice(item..item + 1)) {
                cell[lane] = *v;
            }
        }
        block
    }

    /// Distances of `queries` (whole sequences about the mean) to `items`: a row of `items.len()` each.
    pub(super) fn distances(&self, queries: &[f32], items: &[usize], radius: usize) -> Vec<f64> {
        let count = queries.len() / (self.frames * self.dims);
        let mut rows = vec![0.0; count * items.len()];
        for (b, lanes) in items.chunks(LANES).enumerate() {
            let task = BlockTask {
                block: &self.block(lanes),
                queries,
                shape: self.shape(radius),
            };
            for (query, sums) in task.run().iter().enumerate() {
                let start = query * items.len() + b * LANES;
                for (out, v) in rows[start..start + lanes.len()].iter_mut().zip(sums) {
                    *out = f64::from(*v);
                }
            }
        }
        rows
    }
}

/// The warping distances of all pairs: a symmetric matrix, row-major, with a zero diagonal.
///
/// The distance is that of [`distance`](super::distance) with squared Euclidean cost and a band of
/// `radius` frames, computed in f32 (relative error below 1e-5), [`f64`] outside. Memory is 8 bytes a cell:
/// above some thousand sequences take [`nearest_neighbours`](super::nearest_neighbours).
pub fn pair_distances(sequences: &Sequences, radius: usize) -> Vec<f64> {
    let n = sequences.len();
    // One block of columns a task, against all rows down to the diagonal.
    let columns: Vec<Vec<Lane>> = (0..n.div_ceil(LANES))
        .into_par_iter()
        .map(|b| {
            let items: Vec<usize> = (b * LANES..((b + 1) * LANES).min(n)).collect();
            BlockTask {
                block: &sequences.block(&items),
                queries: sequences.slice(0..items[items.len() - 1]),
                shape: sequences.shape(radius),
            }
            .run()
        })
        .collect();
    let mut matrix = vec![0.0; n * n];
    for (b, rows) in columns.iter().enumerate() {
        for (i, lanes) in rows.iter().enumerate() {
            for (j, v) in (b * LANES..n).zip(lanes) {
                if i < j {
                    matrix[i * n + j] = f64::from(*v);
                    matrix[j * n + i] = f64::from(*v);
                }
            }
        }
    }
    matrix
}

/// The warping distances of one more sequence (`[frame][dim]`, as long as the others) to all `sequences`,
/// as [`pair_distances`] computes them.
///
/// # Errors
/// When the query has another size, or numbers that [`Sequences::new`] refuses.
pub fn distances_to_query(sequences: &Sequences, query: &[f64], radius: usize) -> Result<Vec<f64>> {
    let size = sequences.frames * sequences.dims;
    if query.len() != size {
        return Err(Error::invalid(format!(
            "the query needs {size} numbers ({} frames of {}), found {}",
            sequences.frames,
            sequences.dims,
            query.len()
        )));
    }
    let query = centred(query, &sequences.mean)?;
    let items: Vec<usize> = (0..sequences.len()).collect();
    Ok(sequences.distances(&query, &items, radius))
}

/// `values` less the mean, in f32.
fn centred(values: &[f64], mean: &[f64]) -> Result<Vec<f32>> {
    if let Some(v) = values.iter().find(|v| !v.is_finite()) {
        return Err(Error::invalid(format!(
            "sequences need finite numbers, found {v}"
        )));
    }
    let limit = 1e15;
    let mut centred = Vec::with_capacity(values.len());
    for frame in values.chunks_exact(mean.len()) {
        for (v, m) in frame.iter().zip(mean) {
            let difference = v - m;
            if difference.is_nan() || difference.abs() > limit {
                return Err(Error::invalid(format!(
                    "sequences need numbers within {limit:e} of their mean, found {v}"
                )));
            }
            centred.push(difference as f32);
        }
    }
    Ok(centred)
}
