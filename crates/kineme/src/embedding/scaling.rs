//! Classical multidimensional scaling (Torgerson 1952), its landmark form (de Silva and Tenenbaum 2004), and how well
//! the coordinates keep the distances.

use rayon::prelude::*;

use super::eigen::{self, Eigenpairs};
use super::geodesics::LandmarkDistances;
use crate::error::{Error, Result};
use crate::math::distances::DistanceMatrix;

/// Below this residual variance an embedding keeps its distances well enough.
const GOOD_ENOUGH: f64 = 0.05;

/// Coordinates whose Euclidean distances come near the given ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// Row-major, items by `dimension`; the axes by falling eigenvalue, each with its largest entry positive.
    pub coordinates: Vec<f64>,
    /// Columns: as many as were asked for and have positive eigenvalues, at least one.
    pub dimension: usize,
    /// The leading eigenvalues of the doubly centred squares, falling; those that are not positive give no axis.
    pub eigenvalues: Vec<f64>,
    /// Magnitude of the negative eigenvalues over that of all: how far the distances are from Euclidean. Exact up to
    /// 1,000 items, estimated above.
    pub negative_share: f64,
}

/// Classical scaling into at most `max_dimension` axes.
///
/// # Errors
/// Without items or axes, or when a distance is infinite.
pub fn classical_mds(distances: &DistanceMatrix, max_dimension: usize) -> Result<Scaling> {
    Ok(scale(distances, max_dimension)?.0)
}

/// Coordinates, and what places other items among them.
pub(super) fn scale(
    distances: &DistanceMatrix,
    max_dimension: usize,
) -> Result<(Scaling, Projection)> {
    if distances.is_empty() || max_dimension == 0 {
        return Err(Error::invalid(
            "scaling needs at least one item and one axis",
        ));
    }
    if distances.upper().iter().any(|d| d.is_infinite()) {
        return Err(Error::invalid(
            "scaling needs finite distances: join or separate the components first",
        ));
    }
    let len = distances.len();
    let Eigenpairs {
        values,
        vectors,
        negative_share,
    } = eigen::leading(distances, max_dimension)?;
    // Eigenvalues at the level of rounding are none.
    let least = 1e-12 * values[0].max(0.0);
    let dimension = values.iter().filter(|v| **v > least).count().max(1);
    let axes: Vec<Vec<f64>> = (0..dimension)
        .map(|k| {
            let root = values[k].max(0.0).sqrt();
            let share = if root > 0.0 { 1.0 / root } else { 0.0 };
            vectors[k].iter().map(|v| v * share).collect()
        })
        .collect();
    let coordinates = (0..len)
        .flat_map(|i| (0..dimension).map(move |k| (i, k)))
        .map(|(i, k)| vectors[k][i] * values[k].max(0.0).sqrt())
        .collect();
    let mut mean_squares = vec![0.0; len];
    for i in 0..len {
        for (d, j) in distances.upper_row(i).iter().zip(i + 1..) {
            mean_squares[i] += d * d / len as f64;
            mean_squares[j] += d * d / len as f64;
        }
    }
    let scaling = Scaling {
        coordinates,
        dimension,
        eigenvalues: values,
        negative_share,
    };
    Ok((scaling, Projection { mean_squares, axes }))
}

/// Places an item by its distances to reference items: `y_k = -1/2 v_k' (delta - mean delta) / sqrt(lambda_k)` with
/// squared distances `delta` (L-MDS of de Silva and Tenenbaum 2004; the Nystrom formula of Bengio and others 2004).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Projection {
    mean_squares: Vec<f64>,
    axes: Vec<Vec<f64>>,
}

impl Projection {
    /// The coordinates of an item on the first `dimension` axes, from its distance to each reference.
    pub(super) fn place(&self, distances: &[f64], dimension: usize) -> Vec<f64> {
        let place = |axis: &Vec<f64>| {
            let terms = axis.iter().zip(distances).zip(&self.mean_squares);
            -0.5 * terms.map(|((a, d), m)| a * (d * d - m)).sum::<f64>()
        };
        self.axes[..dimension].iter().map(place).collect()
    }

    /// The number of axes.
    pub(super) fn axes(&self) -> usize {
        self.axes.len()
    }
}

/// `1 - r^2` between given and embedded distances, over all pairs, for the first 1, 2, ... columns (Tenenbaum, de Silva
/// and Langford 2000). Infinite distances are left out.
///
/// # Errors
/// When the coordinates are not row-major items by `dimension`.
pub fn residual_variance(
    distances: &DistanceMatrix,
    coordinates: &[f64],
    dimension: usize,
) -> Result<Vec<f64>> {
    if dimension == 0 || coordinates.len() != distances.len() * dimension {
        return Err(Error::invalid(format!(
            "{} coordinates are not {} items in {dimension} columns",
            coordinates.len(),
            distances.len()
        )));
    }
    let rows: Vec<(usize, &[f64], usize)> = (0..distances.len())
        .map(|i| (i, distances.upper_row(i), i + 1))
        .collect();
    Ok(unexplained(&rows, coordinates, dimension))
}

/// The same from landmarks to all items.
pub(super) fn landmark_residual_variance(
    distances: &LandmarkDistances,
    coordinates: &[f64],
    dimension: usize,
) -> Vec<f64> {
    let named = distances.landmarks.iter().zip(&distances.rows);
    let rows: Vec<(usize, &[f64], usize)> = named.map(|(&l, row)| (l, row.as_slice(), 0)).collect();
    unexplained(&rows, coordinates, dimension)
}

/// Sums over pairs from which a correlation follows.
#[derive(Clone, Copy, Default)]
struct Sums {
    given: f64,
    given_squares: f64,
    embedded: f64,
    embedded_squares: f64,
    products: f64,
    count: f64,
}

/// For each row `(item, distances, first)`: distances of the item to items `first`, `first + 1`, ...
fn unexplained(rows: &[(usize, &[f64], usize)], coordinates: &[f64], dimension: usize) -> Vec<f64> {
    let at = |i: usize| &coordinates[i * dimension..(i + 1) * dimension];
    let row_sums: Vec<Vec<Sums>> = rows
        .par_iter()
        .map(|&(item, distances, first)| {
            let mut sums = vec![Sums::default(); dimension];
            for (&given, other) in distances.iter().zip(first..) {
                if given.is_infinite() || other == item {
                    continue;
                }
                let mut squares = 0.0;
                for ((sum, a), b) in sums.iter_mut().zip(at(item)).zip(at(other)) {
                    squares += (a - b) * (a - b);
                    let embedded = f64::sqrt(squares);
                    sum.given += given;
                    sum.given_squares += given * given;
                    sum.embedded += embedded;
                    sum.embedded_squares += squares;
                    sum.products += given * embedded;
                    sum.count += 1.0;
                }
            }
            sums
        })
        .collect();
    (0..dimension)
        .map(|k| {
            let mut all = Sums::default();
            for sums in &row_sums {
                let s = sums[k];
                all.given += s.given;
                all.given_squares += s.given_squares;
                all.embedded += s.embedded;
                all.embedded_squares += s.embedded_squares;
                all.products += s.products;
                all.count += s.count;
            }
            let n = all.count.max(1.0);
            let given = all.given_squares - all.given * all.given / n;
            let embedded = all.embedded_squares - all.embedded * all.embedded / n;
            let both = all.products - all.given * all.embedded / n;
            if given > 0.0 && embedded > 0.0 {
                (1.0 - both * both / (given * embedded)).max(0.0)
            } else {
                1.0
            }
        })
        .collect()
}

/// The number of axes to keep: the first with less than 5 % residual variance, else the knee of the curve, its point
/// farthest below the chord from first to last.
pub(super) fn choose_dimension(residual: &[f64]) -> usize {
    if let Some(d) = residual.iter().position(|r| *r < GOOD_ENOUGH) {
        return d + 1;
    }
    let last = residual.len().saturating_sub(1);
    let below = |d: usize| {
        let chord = residual[0] + (residual[last] - residual[0]) * d as f64 / last.max(1) as f64;
        chord - residual[d]
    };
    let knee = (0..residual.len()).max_by(|&a, &b| below(a).total_cmp(&below(b)).then(b.cmp(&a)));
    knee.map_or(1, |d| d + 1)
}
