//! Dynamic time warping of two sequences (Sakoe and Chiba 1978), several dimensions warped together.

use crate::error::{Error, Result};

/// Which pairs of frames a warping path may visit; `i` runs over the first sequence, `j` over the second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Band {
    /// Every pair.
    Full,
    /// Sakoe and Chiba's band of this radius in frames, parallel to the main diagonal and widened by the
    /// difference of the lengths: with `n <= m` frames, `-radius <= j - i <= m - n + radius`, and mirrored.
    Parallel(usize),
    /// A band along the straight line between the two corners, this many frames of the shorter sequence to
    /// either side: `|i (m - 1) - j (n - 1)| <= radius (max(n, m) - 1)`, radius at least 1 if lengths differ.
    Slanted(usize),
}

impl Band {
    /// The radius in frames of a band of this share of a length: `ceil(share * frames)`.
    ///
    /// Ten to twenty per cent is customary; 0.15 served whole-body motion best.
    pub fn radius(share: f64, frames: usize) -> usize {
        // A product such as 0.1 * 30 must not be lifted to 4 by its last bit.
        (share.max(0.0) * frames as f64 - 1e-9).ceil().max(0.0) as usize
    }

    /// The first and last column allowed in row `i` of an `n` by `m` table; `n` and `m` at least 1.
    pub(super) fn columns(self, i: usize, n: usize, m: usize) -> (usize, usize) {
        match self {
            Band::Full => (0, m - 1),
            Band::Parallel(radius) => {
                let below = radius.saturating_add(n.saturating_sub(m));
                let above = radius.saturating_add(m.saturating_sub(n));
                (i.saturating_sub(below), i.saturating_add(above).min(m - 1))
            }
            Band::Slanted(radius) => {
                if n == 1 || m == 1 {
                    return (0, m - 1);
                }
                let radius = if n == m { radius } else { radius.max(1) };
                let reach = radius.saturating_mul(n.max(m) - 1);
                let line = i * (m - 1);
                let first = line.saturating_sub(reach).div_ceil(n - 1);
                let last = line.saturating_add(reach) / (n - 1);
                (first, last.min(m - 1))
            }
        }
    }
}

/// What a pair of frames costs, and what the distance makes of a path's sum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LocalCost {
    /// Squared Euclidean distance; the distance is the root of the sum.
    #[default]
    SquaredEuclidean,
    /// Euclidean distance; the distance is the sum.
    Euclidean,
}

impl LocalCost {
    pub(super) fn between(self, x: &[f64], y: &[f64]) -> f64 {
        let squares = squared_distance(x, y);
        match self {
            LocalCost::SquaredEuclidean => squares,
            LocalCost::Euclidean => squares.sqrt(),
        }
    }

    pub(super) fn finish(self, sum: f64) -> f64 {
        match self {
            LocalCost::SquaredEuclidean => sum.sqrt(),
            LocalCost::Euclidean => sum,
        }
    }
}

/// A warping path and its length.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// The distance, as [`distance`] gives it.
    pub distance: f64,
    /// Pairs of frames `(i, j)` from `(0, 0)` to the last of both; each step advances one or both by one.
    /// Among equally cheap steps the diagonal wins, then the one that advances the first sequence.
    pub path: Vec<(usize, usize)>,
}

/// The warping distance of two sequences, row-major with `dims` numbers a frame.
///
/// Both ends are fixed, the steps (1,0), (0,1) and (1,1) weigh the same, all dimensions warp together.
///
/// # Errors
/// When `dims` is 0, a sequence is empty, its length no multiple of `dims`, a number not finite, or
/// the distance too large for one.
pub fn distance(a: &[f64], b: &[f64], dims: usize, band: Band, cost: LocalCost) -> Result<f64> {
    let sum = accumulate(a, b, dims, band, cost, |_, _, _| {})?;
    Ok(cost.finish(sum))
}

/// The warping distance of two sequences with one path that attains it; arguments as for [`distance`].
///
/// # Errors
/// As for [`distance`].
pub fn align(a: &[f64], b: &[f64], dims: usize, band: Band, cost: LocalCost) -> Result<Alignment> {
    // Rows of the table hold only the columns of the band, so memory is frames times band width.
    let mut rows: Vec<(usize, Vec<Step>)> = Vec::new();
    let sum = accumulate(a, b, dims, band, cost, |i, j, step| {
        if rows.len() == i {
            rows.push((j, Vec::new()));
        }
        rows[i].1.push(step);
    })?;
    let (mut i, mut j) = (a.len() / dims - 1, b.len() / dims - 1);
    let mut path = vec![(i, j)];
    while (i, j) != (0, 0) {
        let (first, steps) = &rows[i];
        match steps[j - first] {
            Step::Both => (i, j) = (i - 1, j - 1),
            Step::First => i -= 1,
            Step::Second => j -= 1,
        }
        path.push((i, j));
    }
    path.reverse();
    Ok(Alignment {
        distance: cost.finish(sum),
        path,
    })
}

/// The step by which the cheapest path enters a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Both,
    First,
    Second,
}

/// Fills the table row by row, tells `visit` each cell's step in order, returns the last cell's sum.
fn accumulate(
    a: &[f64],
    b: &[f64],
    dims: usize,
    band: Band,
    cost: LocalCost,
    mut visit: impl FnMut(usize, usize, Step),
) -> Result<f64> {
    let n = frames_of(a, dims)?;
    let m = frames_of(b, dims)?;
    // Index j + 1 holds column j; index 0 is the edge before the first column.
    let mut above = vec![f64::INFINITY; m + 1];
    let mut row = vec![f64::INFINITY; m + 1];
    above[0] = 0.0;
    for (i, x) in a.chunks_exact(dims).enumerate() {
        row.fill(f64::INFINITY);
        let (first, last) = band.columns(i, n, m);
        for j in first..=last {
            let (both, one, two) = (above[j], above[j + 1], row[j]);
            let (best, step) = if both <= one && both <= two {
                (both, Step::Both)
            } else if one <= two {
                (one, Step::First)
            } else {
                (two, Step::Second)
            };
            row[j + 1] = best + cost.between(x, &b[j * dims..(j + 1) * dims]);
            visit(i, j, step);
        }
        std::mem::swap(&mut above, &mut row);
    }
    if above[m].is_finite() {
        return Ok(above[m]);
    }
    Err(Error::invalid(
        "the sequences lie so far apart that their distance overflows",
    ))
}

/// The squared Euclidean distance of two frames.
///
/// Four sums side by side keep the processor busy; their order is fixed, so the result is too.
pub(super) fn squared_distance(x: &[f64], y: &[f64]) -> f64 {
    const SUMS: usize = 4;
    let (xs, ys) = (x.chunks_exact(SUMS), y.chunks_exact(SUMS));
    let rest = xs.remainder().iter().zip(ys.remainder());
    let rest: f64 = rest.map(|(p, q)| (p - q) * (p - q)).sum();
    let mut sums = [0.0; SUMS];
    for (p, q) in xs.zip(ys) {
        for k in 0..SUMS {
            sums[k] += (p[k] - q[k]) * (p[k] - q[k]);
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// The number of frames of a sequence, or what is wrong with it.
pub(super) fn frames_of(sequence: &[f64], dims: usize) -> Result<usize> {
    if dims == 0 || sequence.is_empty() || !sequence.len().is_multiple_of(dims) {
        return Err(Error::invalid(format!(
            "a sequence needs at least one frame of {dims} numbers each, found {} numbers",
            sequence.len()
        )));
    }
    if let Some(i) = sequence.iter().position(|v| !v.is_finite()) {
        return Err(Error::invalid(format!(
            "a sequence needs finite numbers, found {} in frame {}",
            sequence[i],
            i / dims
        )));
    }
    Ok(sequence.len() / dims)
}
