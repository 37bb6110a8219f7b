//! Eigenpairs of symmetric matrices.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Mat, Par};
use nalgebra::DMatrix;

use crate::error::{Error, Result};

/// All eigenpairs of a symmetric matrix, rising. On one thread: the order of sums must not depend on their number.
///
/// # Errors
/// When it does not converge.
pub(crate) fn decompose(matrix: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>)> {
    let len = matrix.nrows();
    let mut values = faer::Col::<f64>::zeros(len);
    let mut vectors = Mat::zeros(len, len);
    let scratch = self_adjoint_evd_scratch::<f64>(
        len,
        ComputeEigenvectors::Yes,
        Par::Seq,
        Default::default(),
    );
    self_adjoint_evd(
        matrix.as_ref(),
        values.as_diagonal_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Default::default(),
    )
    .map_err(|_| Error::unsupported("the eigenvalues of a symmetric matrix did not converge"))?;
    Ok((values.iter().copied().collect(), vectors))
}

/// The principal directions of centred columns: variances along them, falling, and the directions as rows of a matrix.
/// Where columns hardly span the space, nalgebra's decomposition can answer with no numbers; faer's does not.
///
/// # Errors
/// When the decomposition does not converge.
pub(crate) fn principal(centred: &DMatrix<f64>) -> Result<(Vec<f64>, DMatrix<f64>)> {
    let spread = centred * centred.transpose() / centred.ncols() as f64;
    let n = spread.nrows();
    let (values, vectors) = decompose(&Mat::from_fn(n, n, |i, j| spread[(i, j)]))?;
    let falling: Vec<f64> = values.iter().rev().copied().collect();
    let rows = DMatrix::from_fn(n, n, |i, j| vectors[(j, n - 1 - i)]);
    Ok((falling, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_that_hardly_span_the_space_have_directions_that_are_numbers() {
        // Two directions, and dust of all sizes down to where products underflow.
        let dust = |i: usize, j: usize| 10f64.powi(-((7 * i + 13 * j) as i32 % 170));
        let columns = DMatrix::from_fn(60, 20, |i, j| match i {
            0 => j as f64 - 9.5,
            1 => 0.5 * (j as f64 - 9.5).powi(2) - 16.625,
            _ => dust(i, j) * 1e-12,
        });
        let (values, rows) = principal(&columns).expect("directions");
        assert!(values.windows(2).all(|v| v[0] >= v[1]));
        // Of a line the variance is (n^2 - 1) / 12, of half its square (n^2 - 1)(n^2 - 4) / 720, and they are uncorrelated.
        let expected = [399.0 * 396.0 / 720.0, 399.0 / 12.0];
        for (value, expected) in values.iter().zip(expected) {
            assert!(
                (value - expected).abs() < 1e-9 * expected,
                "{value}, not {expected}"
            );
        }
        assert!(values[2].abs() < 1e-9);
        let apart = &rows * rows.transpose() - DMatrix::identity(60, 60);
        assert!(apart.amax() < 1e-9, "{}", apart.amax());
        assert!((rows[(0, 1)].abs() - 1.0).abs() < 1e-9 && (rows[(1, 0)].abs() - 1.0).abs() < 1e-9);
    }
}
