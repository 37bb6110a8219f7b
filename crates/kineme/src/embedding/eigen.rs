//! Leading eigenpairs of the doubly centred matrix of classical scaling, `B = -1/2 H (D o D) H`.
//!
//! Small matrices are decomposed whole. Large ones by a block Lanczos method that never forms `B`: blocks, because data
//! on a loop have double eigenvalues, of which a single Krylov vector sees one; ordered by value, not magnitude,
//! because geodesics give large negative eigenvalues too.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Mat, Par};
use rand::RngExt;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::math::distances::DistanceMatrix;

/// Matrices up to this size are decomposed whole.
const WHOLE: usize = 1000;
/// Vectors in a block.
const WIDTH: usize = 4;
/// A pair is found when its residual is below this share of the largest eigenvalue.
const TOLERANCE: f64 = 1e-11;
/// Blocks at most: their memory is `32 * BLOCKS` bytes an item.
const BLOCKS: usize = 100;
/// Partial sums of a product; fixed, so that the result does not depend on the number of threads.
const STRIDES: usize = 32;
/// Blocks of the estimate of the sum of magnitudes.
const PROBE_BLOCKS: usize = 10;

type Block = Vec<[f64; WIDTH]>;

/// Leading eigenpairs, and what share of the spectrum is negative.
#[derive(Debug, Clone)]
pub(super) struct Eigenpairs {
    /// Decreasing.
    pub values: Vec<f64>,
    /// Unit vectors, the entry of largest magnitude positive.
    pub vectors: Vec<Vec<f64>>,
    /// Sum of negative magnitudes over sum of all magnitudes.
    pub negative_share: f64,
}

/// The `count` algebraically largest eigenpairs of the doubly centred squares of `distances`, which are finite.
pub(super) fn leading(distances: &DistanceMatrix, count: usize) -> Result<Eigenpairs> {
    let count = count.min(distances.len());
    let mut pairs = if distances.len() <= WHOLE {
        whole(distances, count)?
    } else {
        iterative(distances, count)?
    };
    for vector in &mut pairs.vectors {
        let largest = vector
            .iter()
            .fold(0.0f64, |m, v| if v.abs() > m.abs() { *v } else { m });
        if largest < 0.0 {
            vector.iter_mut().for_each(|v| *v = -*v);
        }
    }
    Ok(pairs)
}

fn whole(distances: &DistanceMatrix, count: usize) -> Result<Eigenpairs> {
    let len = distances.len();
    let mut b = Mat::from_fn(len, len, |i, j| distances.get(i, j).powi(2));
    let means: Vec<f64> = (0..len)
        .map(|j| b.col(j).iter().sum::<f64>() / len as f64)
        .collect();
    let mean = means.iter().sum::<f64>() / len as f64;
    for j in 0..len {
        for i in 0..len {
            b[(i, j)] = -0.5 * (b[(i, j)] - means[i] - means[j] + mean);
        }
    }
    let (values, vectors) = decompose(&b)?;
    let all: f64 = values.iter().map(|v| v.abs()).sum();
    let negative: f64 = values.iter().map(|v| (-v).max(0.0)).sum();
    let top = (0..count).map(|k| len - 1 - k);
    Ok(Eigenpairs {
        values: top.clone().map(|k| values[k]).collect(),
        vectors: top
            .map(|k| vectors.col(k).iter().copied().collect())
            .collect(),
        negative_share: if all > 0.0 { negative / all } else { 0.0 },
    })
}

/// All eigenpairs of a symmetric matrix, rising. On one thread: the order of sums must not depend on their number.
fn decompose(matrix: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>)> {
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
    .map_err(|_| Error::unsupported("the eigenvalues of the distances did not converge"))?;
    Ok((values.iter().copied().collect(), vectors))
}

fn iterative(distances: &DistanceMatrix, count: usize) -> Result<Eigenpairs> {
    let len = distances.len();
    let mut random = Pcg64::seed_from_u64(0);
    let mut krylov = Krylov::new(distances, Vec::new(), &mut random);
    let (values, weights) = loop {
        krylov.advance(&mut random);
        let steps = krylov.basis.len() - 1;
        let last = steps == BLOCKS;
        // Decomposing the small matrix costs little, but not nothing.
        if steps * WIDTH < count + WIDTH || !(steps.is_multiple_of(4) || last) {
            continue;
        }
        let (values, weights) = krylov.ritz()?;
        let size = values.len();
        let found = (size - count..size)
            .all(|k| krylov.residual(&weights, k) <= TOLERANCE * values[size - 1].abs());
        if found || last {
            break (values, weights);
        }
    };
    let top = (0..count).map(|k| values.len() - 1 - k);
    let vectors: Vec<Vec<f64>> = top.clone().map(|k| krylov.vector(&weights, k)).collect();
    let values: Vec<f64> = top.map(|k| values[k]).collect();
    drop(krylov);
    // The trace is the sum of all eigenvalues; the sum of magnitudes outside the pairs found is a block quadrature of
    // |x| over the rest of the spectrum (stochastic Lanczos, Ubaru, Chen and Saad 2017).
    let trace = trace(distances);
    let mut krylov = Krylov::new(distances, vectors.clone(), &mut random);
    for _ in 0..PROBE_BLOCKS {
        krylov.advance(&mut random);
    }
    let (ritz, weights) = krylov.ritz()?;
    let seen: f64 = (0..ritz.len())
        .map(|k| {
            let weight: f64 = (0..WIDTH).map(|r| weights[(r, k)].powi(2)).sum();
            ritz[k].abs() * weight
        })
        .sum();
    let rest = (len - 1 - count) as f64 / WIDTH as f64 * seen;
    let all = rest + values.iter().map(|v| v.abs()).sum::<f64>();
    Ok(Eigenpairs {
        values,
        vectors,
        negative_share: if all > 0.0 {
            ((all - trace) / (2.0 * all)).max(0.0)
        } else {
            0.0
        },
    })
}

/// The trace of `B`: half the mean of all squares times the number of items.
fn trace(distances: &DistanceMatrix) -> f64 {
    let rows: Vec<f64> = (0..distances.len())
        .into_par_iter()
        .map(|i| distances.upper_row(i).iter().map(|d| d * d).sum())
        .collect();
    rows.iter().sum::<f64>() / distances.len() as f64
}

/// An orthonormal basis of a block Krylov space of `B`, orthogonal to `locked`, and `B` projected on it.
struct Krylov<'a> {
    distances: &'a DistanceMatrix,
    locked: Vec<Vec<f64>>,
    basis: Vec<Block>,
    /// Coefficients of `B` times each block in the basis up to and with that block.
    projected: Vec<Vec<[[f64; WIDTH]; WIDTH]>>,
    /// The triangular factor of the newest block.
    factor: [[f64; WIDTH]; WIDTH],
    /// The largest norm that `B` gave a vector so far: what is nothing beside it is rounding.
    scale: f64,
}

impl<'a> Krylov<'a> {
    fn new(distances: &'a DistanceMatrix, locked: Vec<Vec<f64>>, random: &mut Pcg64) -> Self {
        let mut krylov = Self {
            distances,
            locked,
            basis: Vec::new(),
            projected: Vec::new(),
            factor: Default::default(),
            scale: 0.0,
        };
        let mut block = random_block(distances.len(), random);
        krylov.orthogonalise(&mut block);
        krylov.normalise(&mut block, random);
        krylov.basis.push(block);
        krylov
    }

    /// Adds a block: `B` times the last one, orthogonalised against all (twice: once loses half the digits).
    fn advance(&mut self, random: &mut Pcg64) {
        let mut block = self.apply(&self.basis[self.basis.len() - 1]);
        self.scale = (0..WIDTH).fold(self.scale, |m, c| m.max(norm(&block, c)));
        let mut coefficients = self.orthogonalise(&mut block);
        let again = self.orthogonalise(&mut block);
        for (sum, more) in coefficients.iter_mut().zip(&again) {
            for (row, add) in sum.iter_mut().zip(more) {
                for (c, a) in row.iter_mut().zip(add) {
                    *c += a;
                }
            }
        }
        self.projected.push(coefficients);
        self.factor = self.normalise(&mut block, random);
        self.basis.push(block);
    }

    /// `B` times a block.
    fn apply(&self, block: &Block) -> Block {
        let len = block.len();
        let partial: Vec<Block> = (0..STRIDES)
            .into_par_iter()
            .map(|first| {
                let mut product = vec![[0.0; WIDTH]; len];
                for i in (first..len).step_by(STRIDES) {
                    let here = block[i];
                    let mut sum = [0.0; WIDTH];
                    let after = block[i + 1..].iter().zip(&mut product[i + 1..]);
                    for (d, (x, y)) in self.distances.upper_row(i).iter().zip(after) {
                        let square = d * d;
                        for c in 0..WIDTH {
                            sum[c] += square * x[c];
                            y[c] += square * here[c];
                        }
                    }
                    for c in 0..WIDTH {
                        product[i][c] += sum[c];
                    }
                }
                product
            })
            .collect();
        let mut product = vec![[0.0; WIDTH]; len];
        product.par_iter_mut().enumerate().for_each(|(i, y)| {
            for part in &partial {
                for c in 0..WIDTH {
                    y[c] -= 0.5 * part[i][c];
                }
            }
        });
        centre(&mut product);
        product
    }

    /// Removes from a block what lies in the locked vectors and in the basis; returns the latter's coefficients.
    fn orthogonalise(&self, block: &mut Block) -> Vec<[[f64; WIDTH]; WIDTH]> {
        centre(block);
        for vector in &self.locked {
            let mut dots = [0.0; WIDTH];
            for (x, v) in block.iter().zip(vector) {
                for c in 0..WIDTH {
                    dots[c] += x[c] * v;
                }
            }
            for (x, v) in block.iter_mut().zip(vector) {
                for c in 0..WIDTH {
                    x[c] -= dots[c] * v;
                }
            }
        }
        // Each basis block is removed before the next is measured (modified Gram-Schmidt).
        let mut all = Vec::with_capacity(self.basis.len());
        for q in &self.basis {
            let mut dots = [[0.0; WIDTH]; WIDTH];
            for (x, v) in block.iter().zip(q) {
                for r in 0..WIDTH {
                    for c in 0..WIDTH {
                        dots[r][c] += v[r] * x[c];
                    }
                }
            }
            for (x, v) in block.iter_mut().zip(q) {
                for r in 0..WIDTH {
                    for c in 0..WIDTH {
                        x[c] -= dots[r][c] * v[r];
                    }
                }
            }
            all.push(dots);
        }
        all
    }

    /// Makes the columns of a block orthonormal; returns the upper triangular factor. A column that vanishes (the space
    /// is exhausted) becomes a random one with a zero in the factor.
    fn normalise(&self, block: &mut Block, random: &mut Pcg64) -> [[f64; WIDTH]; WIDTH] {
        let mut factor = [[0.0; WIDTH]; WIDTH];
        for c in 0..WIDTH {
            for _ in 0..2 {
                for r in 0..c {
                    let dot: f64 = block.iter().map(|x| x[r] * x[c]).sum();
                    block.iter_mut().for_each(|x| x[c] -= dot * x[r]);
                    factor[r][c] += dot;
                }
            }
            factor[c][c] = norm(block, c);
            if factor[c][c] <= 1e-13 * self.scale {
                factor[c][c] = 0.0;
                let mut fresh = random_block(block.len(), random);
                self.orthogonalise(&mut fresh);
                self.orthogonalise(&mut fresh);
                for (x, f) in block.iter_mut().zip(&fresh) {
                    x[c] = f[c];
                }
                for _ in 0..2 {
                    for r in 0..c {
                        let dot: f64 = block.iter().map(|x| x[r] * x[c]).sum();
                        block.iter_mut().for_each(|x| x[c] -= dot * x[r]);
                    }
                }
            }
            let length = norm(block, c);
            block.iter_mut().for_each(|x| x[c] /= length);
        }
        factor
    }

    /// Eigenpairs of the projection, rising: those of `B` as far as the space holds them.
    fn ritz(&self) -> Result<(Vec<f64>, Mat<f64>)> {
        let size = self.projected.len() * WIDTH;
        let mut small = Mat::zeros(size, size);
        for (k, column) in self.projected.iter().enumerate() {
            for (j, dots) in column.iter().enumerate() {
                for (r, row) in dots.iter().enumerate() {
                    for (c, &value) in row.iter().enumerate() {
                        // The upper triangle holds it all; in the diagonal block both halves are averaged.
                        let (a, b) = (j * WIDTH + r, k * WIDTH + c);
                        let share = if j == k { 0.5 } else { 1.0 };
                        small[(a, b)] += share * value;
                        small[(b, a)] += share * value;
                    }
                }
            }
        }
        decompose(&small)
    }

    /// The norm of what `B` makes of Ritz vector `k` beyond its own multiple.
    fn residual(&self, weights: &Mat<f64>, k: usize) -> f64 {
        let first = weights.nrows() - WIDTH;
        let row = |r: usize| -> f64 {
            (0..WIDTH)
                .map(|c| self.factor[r][c] * weights[(first + c, k)])
                .sum()
        };
        (0..WIDTH).map(|r| row(r).powi(2)).sum::<f64>().sqrt()
    }

    /// Ritz vector `k`, of length one.
    fn vector(&self, weights: &Mat<f64>, k: usize) -> Vec<f64> {
        let mut vector = vec![0.0; self.distances.len()];
        for (j, block) in self.basis[..self.projected.len()].iter().enumerate() {
            for (sum, x) in vector.iter_mut().zip(block) {
                for c in 0..WIDTH {
                    *sum += weights[(j * WIDTH + c, k)] * x[c];
                }
            }
        }
        let norm = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|v| *v /= norm);
        vector
    }
}

fn norm(block: &Block, column: usize) -> f64 {
    let squares: f64 = block.iter().map(|x| x[column] * x[column]).sum();
    squares.sqrt()
}

fn random_block(len: usize, random: &mut Pcg64) -> Block {
    let mut block: Block = (0..len)
        .map(|_| std::array::from_fn(|_| random.random_range(-1.0..1.0)))
        .collect();
    centre(&mut block);
    block
}

/// Takes the mean of each column away: `H` times the block.
fn centre(block: &mut Block) {
    let mut means = [0.0; WIDTH];
    for x in block.iter() {
        for c in 0..WIDTH {
            means[c] += x[c];
        }
    }
    let len = block.len() as f64;
    for x in block.iter_mut() {
        for c in 0..WIDTH {
            x[c] -= means[c] / len;
        }
    }
}
