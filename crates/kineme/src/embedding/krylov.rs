//! A block Lanczos method for `B = -1/2 H (D o D) H`, applied to vectors without being formed.

use faer::Mat;
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::error::Result;
use crate::math::distances::DistanceMatrix;
use crate::math::eigen::decompose;

/// Vectors in a block.
pub(super) const WIDTH: usize = 4;
/// Partial sums of a product; fixed, so that the result does not depend on the number of threads.
const STRIDES: usize = 32;

type Block = Vec<[f64; WIDTH]>;

/// An orthonormal basis of a block Krylov space of `B`, orthogonal to `locked`, and `B` projected on it.
pub(super) struct Krylov<'a> {
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
    pub(super) fn new(
        distances: &'a DistanceMatrix,
        locked: Vec<Vec<f64>>,
        random: &mut Pcg64,
    ) -> Self {
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

    /// How many blocks `B` was applied to.
    pub(super) fn steps(&self) -> usize {
        self.projected.len()
    }

    /// How many vectors were set aside.
    pub(super) fn locked(&self) -> usize {
        self.locked.len()
    }

    /// Adds a block: `B` times the last one, orthogonalised against all (twice: once loses half the digits).
    pub(super) fn advance(&mut self, random: &mut Pcg64) {
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
    pub(super) fn ritz(&self) -> Result<(Vec<f64>, Mat<f64>)> {
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
    pub(super) fn residual(&self, weights: &Mat<f64>, k: usize) -> f64 {
        let first = weights.nrows() - WIDTH;
        let row = |r: usize| -> f64 {
            (0..WIDTH)
                .map(|c| self.factor[r][c] * weights[(first + c, k)])
                .sum()
        };
        (0..WIDTH).map(|r| row(r).powi(2)).sum::<f64>().sqrt()
    }

    /// Ritz vector `k`, of length one.
    pub(super) fn vector(&self, weights: &Mat<f64>, k: usize) -> Vec<f64> {
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
