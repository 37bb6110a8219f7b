//! Time warping with a limited slope: no frame of one sequence is held for long while the other moves on.

use super::dtw::{Alignment, Band, LocalCost, frames_of};
use crate::error::{Error, Result};

/// Predecessors of a cell are kept in a byte, so a run may be this long.
const LONGEST_RUN: usize = 100;

/// The cheapest warping path whose slope stays between `1 / slope` and `slope`, with its distance.
///
/// After a step that advances both sequences at most `slope - 1` steps (rounded down) may advance one of them
/// alone, and then both must advance again: Sakoe and Chiba's (1978) slope constraint with P = 1 / (slope - 1),
/// two single steps for the customary slope 3. Without the limit a plateau swallows a whole stretch of the other
/// sequence (the "singularity" of plain warping). Everything else is as in [`align`](super::align).
///
/// # Errors
/// As for [`align`](super::align); when `slope` is below 1 or above 100; when the lengths differ by more than the
/// slope allows, or no such path lies within the band.
pub fn align_sloped(
    a: &[f64],
    b: &[f64],
    dims: usize,
    band: Band,
    cost: LocalCost,
    slope: f64,
) -> Result<Alignment> {
    let (n, m) = (frames_of(a, dims)?, frames_of(b, dims)?);
    if !(slope >= 1.0 && slope <= LONGEST_RUN as f64) {
        return Err(Error::invalid(format!(
            "the slope of a warping path must be from 1 to {LONGEST_RUN}, found {slope}"
        )));
    }
    let table = Table::filled(a, b, dims, band, cost, slope as usize - 1);
    if !table.sum.is_finite() {
        return Err(Error::invalid(format!(
            "no path of slope up to {slope} within the band joins {n} and {m} frames at a finite distance"
        )));
    }
    Ok(Alignment {
        distance: cost.finish(table.sum),
        path: table.path(n - 1, m - 1),
    })
}

/// Which way each cell was entered. A cell has one state for each way to enter it: 0 by a step of both sequences,
/// `1..=run` as the so-manieth single step of the first in a row, `run + 1..=2 run` likewise of the second.
struct Table {
    run: usize,
    /// For each row its first column and, for each cell of the band, the state before a step of both.
    before: Vec<(usize, Vec<u8>)>,
    /// The last cell's best sum and its state.
    sum: f64,
    last: usize,
}

impl Table {
    fn filled(a: &[f64], b: &[f64], dims: usize, band: Band, cost: LocalCost, run: usize) -> Self {
        let (n, m) = (a.len() / dims, b.len() / dims);
        let states = 2 * run + 1;
        // Group j + 1 holds the states of column j; group 0 is the edge before the first column.
        let mut above = vec![f64::INFINITY; (m + 1) * states];
        let mut row = above.clone();
        above[0] = 0.0;
        let mut before = Vec::with_capacity(n);
        for (i, x) in a.chunks_exact(dims).enumerate() {
            row.fill(f64::INFINITY);
            let (first, last) = band.columns(i, n, m);
            let mut entered = Vec::with_capacity((last + 1).saturating_sub(first));
            for j in first..=last {
                let here = cost.between(x, &b[j * dims..(j + 1) * dims]);
                let (sum, state) = least(&above[j * states..(j + 1) * states]);
                entered.push(state as u8);
                let (left, cell) = row[j * states..(j + 2) * states].split_at_mut(states);
                let up = &above[(j + 1) * states..(j + 2) * states];
                cell[0] = here + sum;
                for k in 1..=run {
                    cell[k] = here + up[k - 1];
                    let shorter = if k == 1 { 0 } else { run + k - 1 };
                    cell[run + k] = here + left[shorter];
                }
            }
            before.push((first, entered));
            std::mem::swap(&mut above, &mut row);
        }
        let (sum, last) = least(&above[m * states..]);
        Self {
            run,
            before,
            sum,
            last,
        }
    }

    /// The path that ends in the cell `(i, j)` in the best state.
    fn path(&self, mut i: usize, mut j: usize) -> Vec<(usize, usize)> {
        let mut state = self.last;
        let mut path = vec![(i, j)];
        while (i, j) != (0, 0) {
            if state == 0 {
                let (first, entered) = &self.before[i];
                state = usize::from(entered[j - first]);
                (i, j) = (i - 1, j - 1);
            } else if state <= self.run {
                state -= 1;
                i -= 1;
            } else {
                state = if state == self.run + 1 { 0 } else { state - 1 };
                j -= 1;
            }
            path.push((i, j));
        }
        path.reverse();
        path
    }
}

/// The least of the sums and the first state that has it.
fn least(sums: &[f64]) -> (f64, usize) {
    let mut best = (sums[0], 0);
    for (state, &sum) in sums.iter().enumerate().skip(1) {
        if sum < best.0 {
            best = (sum, state);
        }
    }
    best
}
