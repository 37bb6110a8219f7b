//! What varies around the moments of rows: phase along each, parameters across, told by the rows beside it.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::exact::Tangents;
use super::rows::{Row, spacing};
use crate::error::Result;
use crate::perception::rows::manifold;
use crate::primitive::Vocabulary;

/// Deviations: of phase in moments of the row, of parameters in halves of the grid's spacing. Within half a moment and
/// half a spacing everything is alike probable (deviation 1/sqrt(3) of that), and a little more.
const PHASE: f64 = 0.35;
const PARAMETER: f64 = 0.7;
/// Rows this near in every parameter, in spacings, tell how the manifold lies.
const BESIDE: f64 = 1.25;
/// Displacements are mostly of what came before a movement until it has lasted so long.
const BEGINNING_SECS: f64 = 0.1;
/// Ridge of the fit to the rows beside, in squared spacings.
const RIDGE: f64 = 1e-3;

/// The tangents of a vocabulary's rows, whose moments have these features (states x dims). `None` where no primitive's
/// parameters have a meaning: the exemplars of people span no manifold that anybody would follow to the millimetre.
///
/// # Errors
/// When a fit to rows beside fails.
pub(super) fn tangents(
    vocabulary: &Vocabulary,
    rows: &[Row],
    features: &[f64],
    dims: usize,
) -> Result<Option<Tangents>> {
    let known = |row: &Row| manifold(&vocabulary.primitives()[row.primitive]);
    if !rows.iter().any(known) {
        return Ok(None);
    }
    let most = rows.iter().map(|r| r.parameters.len()).max().unwrap_or(0);
    let count = 1 + most;
    let mut starts = vec![0];
    for row in rows {
        starts.push(starts[starts.len() - 1] + row.phases.len());
    }
    let of = |r: usize| -> Result<Vec<Option<Vec<f64>>>> {
        let row = &rows[r];
        let moments = row.phases.len();
        if !known(row) {
            return Ok(vec![None; moments]);
        }
        let mut own = vec![vec![0.0; count * dims]; moments];
        let at = |k: usize| &features[(starts[r] + k) * dims..(starts[r] + k + 1) * dims];
        let beside = beside(rows, r)?;
        for (k, vectors) in own.iter_mut().enumerate() {
            let (before, after) = match row.cyclic {
                true => ((k + moments - 1) % moments, (k + 1) % moments),
                false => (k.saturating_sub(1), (k + 1).min(moments - 1)),
            };
            let (before, now, after) = (at(before), at(k), at(after));
            for i in 0..dims {
                vectors[i] = PHASE * (after[i] - before[i]);
            }
            for (other, weights) in &beside {
                let there = moment_of(&rows[*other], row, k);
                let first = (starts[*other] + there.0) * dims;
                let (low, high) = features[first..first + 2 * dims].split_at(dims);
                for i in 0..dims {
                    let apart = low[i] + there.1 * (high[i] - low[i]) - now[i];
                    for (j, w) in weights.iter().enumerate() {
                        vectors[(1 + j) * dims + i] += w * apart;
                    }
                }
            }
        }
        Ok(own.into_iter().map(Some).collect())
    };
    let all: Vec<Vec<Option<Vec<f64>>>> = (0..rows.len())
        .into_par_iter()
        .map(of)
        .collect::<Result<_>>()?;
    let begins = |row: &Row, k: usize| {
        let secs = k as f64 * row.step_secs - row.still_secs;
        !row.cyclic && secs <= BEGINNING_SECS
    };
    let beginning = rows
        .iter()
        .flat_map(|row| (0..row.phases.len()).map(move |k| begins(row, k)));
    // The tangent of phase spans two moments.
    let pace = |row: &Row| vec![1.0 / (2.0 * PHASE * row.step_secs); row.phases.len()];
    Ok(Some(Tangents {
        beginning: beginning.collect(),
        pace: rows.iter().flat_map(pace).collect(),
        count,
        vectors: all.concat(),
    }))
}

/// The rows beside a row, with the weight of each one's difference in the tangent of every parameter (least squares).
fn beside(rows: &[Row], r: usize) -> Result<Vec<(usize, Vec<f64>)>> {
    let row = &rows[r];
    let m = row.parameters.len();
    let Some(step) = spacing(m) else {
        return Ok(Vec::new());
    };
    let gap = |other: &Row| -> Vec<f64> {
        let pairs = other.parameters.iter().zip(&row.parameters);
        pairs.map(|(a, b)| (a - b) / step).collect()
    };
    let near: Vec<(usize, Vec<f64>)> = rows
        .iter()
        .enumerate()
        .filter(|(i, other)| *i != r && other.primitive == row.primitive)
        .map(|(i, other)| (i, gap(other)))
        .filter(|(_, g)| g.iter().all(|g| g.abs() <= BESIDE))
        .collect();
    if near.is_empty() {
        return Ok(near);
    }
    let gaps = DMatrix::from_fn(near.len(), m, |i, j| near[i].1[j]);
    let inner = gaps.transpose() * &gaps + DMatrix::identity(m, m) * RIDGE;
    let weights = inner
        .cholesky()
        .map(|c| c.solve(&gaps.transpose()))
        .ok_or_else(|| crate::error::Error::invalid("parameters that are no numbers"))?;
    let scaled = |i: usize| -> DVector<f64> { weights.column(i) * (0.5 * PARAMETER) };
    Ok(near
        .iter()
        .enumerate()
        .map(|(i, (other, _))| (*other, scaled(i).as_slice().to_vec()))
        .collect())
}

/// The moment of another row that corresponds to one of `row`: an index, not the last, and the share from there to the
/// next.
fn moment_of(other: &Row, row: &Row, k: usize) -> (usize, f64) {
    let moving = |r: &Row| (r.phases.len() - 1) as f64 - 2.0 * r.still_secs / r.step_secs;
    let since = k as f64 - row.still_secs / row.step_secs;
    let there = since * moving(other) / moving(row) + other.still_secs / other.step_secs;
    let there = there.clamp(0.0, (other.phases.len() - 1) as f64);
    let low = (there as usize).min(other.phases.len() - 2);
    (low, there - low as f64)
}
