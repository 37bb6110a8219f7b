//! The polynomial part: a constant and slopes along the directions that the points span.

use nalgebra::{DMatrix, SVD};

use crate::error::{Error, Result};

/// A direction counts as spanned when the points spread along it by more than this share of their largest spread.
const SPANNED: f64 = 1e-6;

/// An orthonormal basis of the affine functions on a set of points.
pub(super) struct Trend {
    /// Mean of the points.
    pub(super) centre: Vec<f64>,
    /// One row a point, one column a function: the constant, then one a spanned direction. Columns are orthonormal.
    pub(super) columns: DMatrix<f64>,
    /// `rank` x dims: the gradients of the functions but the constant.
    directions: DMatrix<f64>,
}

impl Trend {
    /// Of `n` distinct points, row-major.
    ///
    /// # Errors
    /// When the decomposition of their spread does not converge.
    pub(super) fn new(points: &[f64], n: usize, dims: usize) -> Result<Self> {
        let points = DMatrix::from_row_slice(n, dims, points);
        let centre = points.row_mean();
        let mut centred = points;
        for mut row in centred.row_iter_mut() {
            row -= &centre;
        }
        let scale = centred.amax();
        let centre: Vec<f64> = centre.iter().copied().collect();
        let constant = 1.0 / (n as f64).sqrt();
        if scale == 0.0 || n < 2 {
            return Ok(Self {
                centre,
                columns: DMatrix::from_element(n, 1, constant),
                directions: DMatrix::zeros(0, dims),
            });
        }
        let svd = SVD::try_new_unordered(centred / scale, true, true, f64::EPSILON, 10_000);
        let parts = svd.and_then(|s| Some((s.u?, s.singular_values, s.v_t?)));
        let (u, values, v_t) = parts
            .filter(|(_, values, _)| values.iter().all(|s| s.is_finite()))
            .ok_or_else(|| Error::invalid("the spread of the parameters cannot be decomposed"))?;
        let largest = values.max();
        let spanned: Vec<usize> = (0..values.len())
            .filter(|&l| values[l] > SPANNED * largest)
            .collect();
        let rank = spanned.len();
        let columns = DMatrix::from_fn(n, 1 + rank, |i, l| match l {
            0 => constant,
            _ => u[(i, spanned[l - 1])],
        });
        let directions = DMatrix::from_fn(rank, dims, |l, d| {
            v_t[(spanned[l], d)] / (values[spanned[l]] * scale)
        });
        Ok(Self {
            centre,
            columns,
            directions,
        })
    }

    /// How many directions the points span.
    pub(super) fn rank(&self) -> usize {
        self.directions.nrows()
    }

    /// For coefficients (functions x weights): each weight's value at the centre, and its slopes, dims x weights.
    pub(super) fn expand(&self, coefficients: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
        let constant = self.columns[(0, 0)];
        let values = coefficients.row(0).iter().map(|a| a * constant).collect();
        let slopes = self.directions.transpose() * coefficients.rows(1, self.rank());
        (values, slopes)
    }
}
