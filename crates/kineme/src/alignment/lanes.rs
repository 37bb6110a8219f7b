//! The inner loop of many warpings at once: one query against [`LANES`] others, one a lane.
//!
//! Each lane does the arithmetic of one pair in a fixed order, so the result does not depend on the
//! vector width that the machine offers, nor on which pairs share a block.

use pulp::{Arch, Simd, WithSimd};

/// Pairs worked on together.
pub(super) const LANES: usize = 8;

/// One number of each of the [`LANES`] others.
pub(super) type Lane = [f32; LANES];

/// Columns whose local costs are summed together, to keep several independent sums in registers.
const COLUMNS: usize = 4;

/// Sequences of `frames` by `dims` numbers, warped within `radius` frames of the diagonal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub frames: usize,
    pub dims: usize,
    pub radius: usize,
}

/// Warping distances of many queries against one block.
pub(super) struct BlockTask<'a> {
    /// The block, `[frame][dim]` of lanes.
    pub block: &'a [Lane],
    /// Queries one after the other, each `[frame][dim]`.
    pub queries: &'a [f32],
    pub shape: Shape,
}

impl BlockTask<'_> {
    /// The distances: for each query one lane of roots of summed squares.
    pub fn run(self) -> Vec<Lane> {
        Arch::new().dispatch(self)
    }
}

impl WithSimd for BlockTask<'_> {
    type Output = Vec<Lane>;

    // Inlined into a function compiled for the machine's vector instructions; the loops vectorise there.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<Lane> {
        let Shape { frames, dims, .. } = self.shape;
        let mut rows = [
            vec![[f32::INFINITY; LANES]; frames + 1],
            vec![[f32::INFINITY; LANES]; frames + 1],
        ];
        let mut out = Vec::with_capacity(self.queries.len() / (frames * dims));
        for query in self.queries.chunks_exact(frames * dims) {
            let mut sums = warp(query, self.block, self.shape, &mut rows);
            for v in &mut sums {
                *v = v.sqrt();
            }
            out.push(sums);
        }
        out
    }
}

/// Euclidean distances of many queries against one block, without warping.
pub(super) struct EuclideanTask<'a> {
    /// The block: `size` lanes.
    pub block: &'a [Lane],
    /// Queries one after the other, `size` numbers each.
    pub queries: &'a [f32],
}

impl EuclideanTask<'_> {
    /// The squared distances: for each query one lane.
    pub fn run(self) -> Vec<Lane> {
        Arch::new().dispatch(self)
    }
}

impl WithSimd for EuclideanTask<'_> {
    type Output = Vec<Lane>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<Lane> {
        let size = self.block.len();
        let fours = self.queries.chunks_exact(4 * size);
        let rest = fours.remainder();
        let mut out = Vec::with_capacity(self.queries.len() / size);
        for four in fours {
            let (q0, others) = four.split_at(size);
            let (q1, others) = others.split_at(size);
            let (q2, q3) = others.split_at(size);
            let mut sums = [[0.0; LANES]; 4];
            for ((((cell, a), b), c), d) in self.block.iter().zip(q0).zip(q1).zip(q2).zip(q3) {
                for (sum, x) in sums.iter_mut().zip([a, b, c, d]) {
                    add_squares(sum, *x, cell);
                }
            }
            out.extend(sums);
        }
        for query in rest.chunks_exact(size) {
            let mut sum = [0.0; LANES];
            for (cell, x) in self.block.iter().zip(query) {
                add_squares(&mut sum, *x, cell);
            }
            out.push(sum);
        }
        out
    }
}

/// The least sum of squared differences along a path in the band, for each lane.
#[inline(always)]
fn warp(query: &[f32], block: &[Lane], shape: Shape, rows: &mut [Vec<Lane>; 2]) -> Lane {
    let Shape {
        frames,
        dims,
        radius,
    } = shape;
    let [above, row] = rows;
    // Index j + 1 holds column j. Only the cells at the band's edges are reset: the rest is overwritten.
    above.fill([f32::INFINITY; LANES]);
    above[0] = [0.0; LANES];
    for (i, frame) in query.chunks_exact(dims).enumerate() {
        let first = i.saturating_sub(radius);
        let last = (i + radius).min(frames - 1);
        row[first] = [f32::INFINITY; LANES];
        let mut left = [f32::INFINITY; LANES];
        let mut j = first;
        while j <= last {
            let count = COLUMNS.min(last + 1 - j);
            let others = &block[j * dims..(j + count) * dims];
            let costs = if count == COLUMNS {
                four_costs(frame, others)
            } else {
                some_costs(frame, others)
            };
            for (column, cost) in (j..j + count).zip(&costs) {
                let (both, one) = (above[column], above[column + 1]);
                for l in 0..LANES {
                    left[l] = least(least(both[l], one[l]), left[l]) + cost[l];
                }
                row[column + 1] = left;
            }
            j += count;
        }
        if last + 2 <= frames {
            row[last + 2] = [f32::INFINITY; LANES];
        }
        std::mem::swap(above, row);
    }
    above[frames]
}

/// Squared distances of one frame of the query to four frames of the block.
#[inline(always)]
fn four_costs(frame: &[f32], others: &[Lane]) -> [Lane; COLUMNS] {
    let dims = frame.len();
    let (o0, rest) = others.split_at(dims);
    let (o1, rest) = rest.split_at(dims);
    let (o2, o3) = rest.split_at(dims);
    let mut sums = [[0.0; LANES]; COLUMNS];
    for ((((x, a), b), c), d) in frame.iter().zip(o0).zip(o1).zip(o2).zip(o3) {
        for (sum, other) in sums.iter_mut().zip([a, b, c, d]) {
            add_squares(sum, *x, other);
        }
    }
    sums
}

/// The same for fewer frames, at the end of a row.
#[inline(always)]
fn some_costs(frame: &[f32], others: &[Lane]) -> [Lane; COLUMNS] {
    let mut sums = [[0.0; LANES]; COLUMNS];
    for (sum, other) in sums.iter_mut().zip(others.chunks_exact(frame.len())) {
        for (x, o) in frame.iter().zip(other) {
            add_squares(sum, *x, o);
        }
    }
    sums
}

#[inline(always)]
fn add_squares(sum: &mut Lane, x: f32, other: &Lane) {
    for l in 0..LANES {
        let difference = x - other[l];
        sum[l] += difference * difference;
    }
}

/// The smaller number; unlike `f32::min` one machine instruction, as no number here is NaN.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
