//! Verbs and Adverbs in its cardinal form: one factorisation, the weights of all exemplars at once.

use nalgebra::{DMatrix, Dyn};

use super::kernel::{Kernel, Radial, distance, distance_squared};
use super::method::Tail;
use super::shepard::COINCIDENT;
use super::trend::Trend;
use crate::error::{Error, Result};

/// Ridge of a factorisation that fails without, as a share of the mean of the diagonal.
const RIDGE: f64 = 1e-8;
/// Above this condition of the system its solver warns.
const ILL_CONDITIONED: f64 = 1e8;
/// Rounds of iterative refinement.
const REFINEMENTS: usize = 3;
/// Residual up to which a point is given to itself outright; the step beside it is of this size at most.
const EXACT: f64 = 1e-6;

/// Fitted cardinal functions of distinct points. A weight is `value_i + slopes_i (p - centre) + sum_k radial_ki R_k(p)`,
/// and what the sum then lacks of one is given to all alike: rounding, or with no tail what the kernel leaves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cardinal {
    radial: Radial,
    centre: Vec<f64>,
    /// n: at the centre.
    values: Vec<f64>,
    /// dims x n, row-major.
    slopes: Vec<f64>,
    /// n x n: one row a radial function, one column a weight.
    coefficients: Vec<f64>,
    /// Row sums of `coefficients` where there is no tail, else empty.
    sums: Vec<f64>,
    /// The weights at a point are that point's alone.
    pub(super) exact: bool,
}

/// What the system is made of.
pub(super) struct System<'a> {
    /// n x dims, row-major, all different.
    pub(super) points: &'a [f64],
    pub(super) n: usize,
    pub(super) dims: usize,
    pub(super) kernel: Kernel,
    pub(super) tail: Tail,
    pub(super) nugget: f64,
}

impl Cardinal {
    /// Solves for the cardinal functions; adds to `notes` what a user should know.
    ///
    /// # Errors
    /// When the kernel's matrix is singular, which a Wendland kernel's never is, or overflows.
    pub(super) fn fit(system: &System, notes: &mut Vec<String>) -> Result<Self> {
        let &System {
            points, n, dims, ..
        } = system;
        let trend = Trend::new(points, n, dims)?;
        if system.tail != Tail::None && trend.rank() < dims {
            notes.push(format!(
                "the points span {} of {dims} parameters: the linear part is confined to that subspace",
                trend.rank()
            ));
        }
        let radial = Radial::new(system.kernel, dims);
        let identity = DMatrix::identity(n, n);
        let on_points = &trend.columns * trend.columns.transpose();
        // As many points as the linear part has coefficients: it passes through all of them.
        let linear_only = system.tail != Tail::None && n == trend.rank() + 1;
        let mut residual = 0.0;
        let (affine, coefficients) = if linear_only {
            (trend.columns.transpose(), DMatrix::zeros(n, n))
        } else {
            let row = |i: usize| &points[i * dims..(i + 1) * dims];
            let mut matrix = DMatrix::from_fn(n, n, |i, k| radial.value(distance(row(i), row(k))));
            for i in 0..n {
                matrix[(i, i)] += system.nugget;
            }
            let right = match system.tail {
                Tail::LeastSquares => &identity - on_points,
                Tail::None | Tail::Augmented => identity,
            };
            let solution = match system.tail {
                Tail::Augmented => solve_augmented(matrix, &trend.columns, &right),
                Tail::None | Tail::LeastSquares => {
                    let definite = system.kernel.is_positive_definite();
                    solve(matrix, &right, definite)
                }
            }?;
            note_quality(&solution, notes);
            residual = solution.residual;
            let x = solution.x;
            let affine = match system.tail {
                Tail::None => DMatrix::zeros(1 + trend.rank(), n),
                Tail::LeastSquares => trend.columns.transpose(),
                Tail::Augmented => x.rows(n, 1 + trend.rank()).into_owned(),
            };
            (affine, x.rows(0, n).into_owned())
        };
        let (values, slopes) = trend.expand(&affine);
        if coefficients.iter().chain(&slopes).any(|x| !x.is_finite()) {
            return Err(Error::invalid(
                "the interpolation of these parameters overflows double precision",
            ));
        }
        let sums = match system.tail {
            Tail::None => coefficients.row_iter().map(|r| r.sum()).collect(),
            Tail::LeastSquares | Tail::Augmented => Vec::new(),
        };
        // nalgebra stores columns first: the transpose's columns are the rows wanted.
        Ok(Self {
            radial,
            centre: trend.centre,
            values,
            slopes: slopes.transpose().as_slice().to_vec(),
            coefficients: coefficients.transpose().as_slice().to_vec(),
            sums,
            exact: system.nugget == 0.0 && residual <= EXACT,
        })
    }

    /// The weights at `p`.
    pub(super) fn weights(&self, points: &[f64], p: &[f64], weights: &mut [f64]) {
        let n = weights.len();
        weights.copy_from_slice(&self.values);
        for ((x, c), slopes) in p.iter().zip(&self.centre).zip(self.slopes.chunks_exact(n)) {
            add_scaled(weights, x - c, slopes);
        }
        let rows = self.coefficients.chunks_exact(n);
        for (k, (point, row)) in points.chunks_exact(p.len()).zip(rows).enumerate() {
            let d = distance_squared(p, point);
            if self.exact && d < COINCIDENT * COINCIDENT {
                weights.fill(0.0);
                weights[k] = 1.0;
                return;
            }
            let value = self.radial.value(d.sqrt());
            if value != 0.0 {
                add_scaled(weights, value, row);
            }
        }
        let lacking = (1.0 - weights.iter().sum::<f64>()) / n as f64;
        for w in weights {
            *w += lacking;
        }
    }

    /// The gradient of the weights at `p`, n x dims.
    pub(super) fn gradient(&self, points: &[f64], p: &[f64], gradient: &mut [f64]) {
        let dims = p.len();
        let n = gradient.len() / dims;
        for (l, slopes) in self.slopes.chunks_exact(n).enumerate() {
            for (g, slope) in gradient[l..].iter_mut().step_by(dims).zip(slopes) {
                *g = *slope;
            }
        }
        let rows = self.coefficients.chunks_exact(n);
        for (point, row) in points.chunks_exact(dims).zip(rows) {
            let factor = self.radial.slope_over_distance(distance(p, point));
            if factor == 0.0 {
                continue;
            }
            for (g, c) in gradient.chunks_exact_mut(dims).zip(row) {
                let scaled = factor * c;
                for ((g, x), y) in g.iter_mut().zip(p).zip(point) {
                    *g += scaled * (x - y);
                }
            }
        }
        for l in 0..dims {
            let mean = gradient[l..].iter().step_by(dims).sum::<f64>() / n as f64;
            for g in gradient[l..].iter_mut().step_by(dims) {
                *g -= mean;
            }
        }
    }

    /// What the kernel alone leaves of the weight at `p`: one less the sum of the weights before they are balanced.
    pub(super) fn deficit(&self, points: &[f64], p: &[f64]) -> f64 {
        if self.sums.is_empty() {
            return 0.0;
        }
        let rows = points.chunks_exact(p.len()).zip(&self.sums);
        1.0 - rows
            .map(|(point, sum)| sum * self.radial.value(distance(p, point)))
            .sum::<f64>()
    }
}

fn add_scaled(to: &mut [f64], factor: f64, row: &[f64]) {
    for (t, x) in to.iter_mut().zip(row) {
        *t += factor * x;
    }
}

/// A solved system, and how well.
struct Solution {
    x: DMatrix<f64>,
    /// In the 1-norm.
    condition: f64,
    /// Largest entry of what is left of the right-hand side.
    residual: f64,
    ridge: bool,
}

fn note_quality(solution: &Solution, notes: &mut Vec<String>) {
    if solution.ridge {
        notes
            .push("the kernel's matrix is singular to working precision: a ridge was added".into());
    } else if solution.condition > ILL_CONDITIONED {
        notes.push(format!(
            "ill conditioned ({:.0e}): some points nearly coincide, or the kernel is too wide for them",
            solution.condition
        ));
    }
    if solution.residual > EXACT {
        notes.push(format!(
            "the exemplars are not met at their own parameters: their weights are off by up to {:.0e}",
            solution.residual
        ));
    }
}

/// A factorised matrix.
enum Factor {
    Cholesky(nalgebra::Cholesky<f64, Dyn>),
    Lu(nalgebra::LU<f64, Dyn, Dyn>),
}

impl Factor {
    fn solve(&self, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        match self {
            Self::Cholesky(c) => Some(c.solve(right)),
            Self::Lu(lu) => lu.solve(right),
        }
    }
}

/// Solves with a kernel's matrix: by Cholesky where it is positive definite, which may take a ridge, else by LU.
/// Refinement against the matrix itself removes the ridge again as far as the condition allows.
fn solve(matrix: DMatrix<f64>, right: &DMatrix<f64>, definite: bool) -> Result<Solution> {
    let n = matrix.nrows();
    let scale = matrix.amax();
    if !(scale.is_finite() && scale > 0.0) {
        return Err(singular());
    }
    let matrix = matrix / scale;
    let mut ridge = false;
    let factor = if definite {
        let plain = matrix.clone().cholesky();
        ridge = plain.is_none();
        let ridged = || {
            let ridge = DMatrix::identity(n, n) * (RIDGE * matrix.trace() / n as f64);
            (&matrix + ridge).cholesky()
        };
        Factor::Cholesky(plain.or_else(ridged).ok_or_else(singular)?)
    } else {
        Factor::Lu(matrix.clone().lu())
    };
    let inverse = factor
        .solve(&DMatrix::identity(n, n))
        .ok_or_else(singular)?;
    let condition = one_norm(&matrix) * one_norm(&inverse);
    let mut x = inverse * right;
    let mut left = right - &matrix * &x;
    for _ in 0..REFINEMENTS {
        let Some(step) = factor.solve(&left) else {
            break;
        };
        let next = &x + step;
        let next_left = right - &matrix * &next;
        if next_left.amax() < left.amax() {
            (x, left) = (next, next_left);
        }
    }
    Ok(Solution {
        x: x / scale,
        condition,
        residual: left.amax(),
        ridge,
    })
}

/// Solves with a kernel's matrix bordered by the orthonormal `columns` of a polynomial under the moment conditions:
/// the radial coefficients, and below them the polynomial's.
fn solve_augmented(
    matrix: DMatrix<f64>,
    columns: &DMatrix<f64>,
    right: &DMatrix<f64>,
) -> Result<Solution> {
    let (n, functions) = columns.shape();
    // The border has entries of the kernel's size, or its condition would be that of the units.
    let scale = matrix.amax();
    let mut bordered = DMatrix::zeros(n + functions, n + functions);
    bordered.view_mut((0, 0), (n, n)).copy_from(&matrix);
    let border = columns * scale;
    bordered.view_mut((0, n), (n, functions)).copy_from(&border);
    bordered
        .view_mut((n, 0), (functions, n))
        .copy_from(&border.transpose());
    let mut moments = DMatrix::zeros(n + functions, right.ncols());
    moments.rows_mut(0, n).copy_from(right);
    let mut solution = solve(bordered, &moments, false)?;
    solution.x.rows_mut(n, functions).scale_mut(scale);
    Ok(solution)
}

fn one_norm(matrix: &DMatrix<f64>) -> f64 {
    matrix
        .column_iter()
        .map(|c| c.iter().map(|x| x.abs()).sum())
        .fold(0.0, f64::max)
}

fn singular() -> Error {
    Error::unsupported(
        "the kernel's matrix is singular for these parameters: take a Wendland kernel, or an augmented tail",
    )
}
