//! Routes: where a clip leads, by which a walk that turns left is told from one that goes straight on.
//!
//! Postures of the two are alike, and so is their travel at nearly every moment: only what it adds up to differs.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::noise::pairs;
use super::rows::Row;
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::primitive::Vocabulary;

/// At the ends of so many equal parts of a clip it is asked how far it has led.
const PARTS: usize = 4;
/// Numbers of a route: at each of these ends forward and leftward travel since the beginning, metres, as the body faced
/// on its way, and the turn to the left, radians.
const DIMS: usize = 3 * PARTS;
/// Standard deviations of these three, expected before any exemplar was seen, and how many residuals that counts for.
const PRIOR: [f64; 3] = [0.3, 0.2, 0.35];
const PRIOR_COUNT: f64 = 20.0;
/// The share of the covariance that is replaced by its diagonal.
const SHRINK: f64 = 0.1;
/// A number counts as so many squared deviations at most, in the mean: who walks on for longer than any exemplar did is
/// as far from all of them, and walks.
const MOST: f64 = 10.0;

/// The routes of rows, whitened by how those of one primitive differ.
#[derive(Debug, Clone)]
pub(super) struct Routes {
    rows: Vec<DVector<f64>>,
    whitening: Cholesky<f64, Dyn>,
}

impl Routes {
    /// The routes of rows: those of exemplars' recordings, blended where the row is. `None` where all rows lead to one
    /// place: there a route tells nothing.
    ///
    /// # Errors
    /// When their covariance is not positive definite.
    pub fn new(vocabulary: &Vocabulary, rows: &[Row]) -> Result<Option<Self>> {
        let of_primitives = vocabulary.primitives().iter().map(|p| {
            let exemplars = p.exemplars().iter();
            exemplars.map(|e| route(&e.motion)).collect::<Vec<_>>()
        });
        let of_primitives: Vec<Vec<DVector<f64>>> = of_primitives.collect();
        let of_row = |row: &Row| {
            let own = &of_primitives[row.primitive];
            if let Some(exemplar) = row.exemplar {
                return own[exemplar].clone();
            }
            let mut weights = vec![0.0; own.len()];
            let interpolator = vocabulary.primitives()[row.primitive].interpolator();
            interpolator.weights(&row.parameters, &mut weights);
            let terms = own.iter().zip(weights);
            terms.fold(DVector::zeros(DIMS), |sum, (r, w)| sum + r * w)
        };
        let routes: Vec<DVector<f64>> = rows.iter().map(of_row).collect();
        if routes.windows(2).all(|pair| pair[0] == pair[1]) {
            return Ok(None);
        }
        let whitening = Cholesky::new(covariance(vocabulary, rows, &routes))
            .ok_or_else(|| Error::invalid("routes that differ without bounds"))?;
        let mut this = Self {
            rows: Vec::new(),
            whitening,
        };
        this.rows = routes.iter().map(|r| this.white(r)).collect();
        Ok(Some(this))
    }

    /// Squared distances, in deviations, of a clip's route to those of the rows; `None` where the root never moves, as
    /// it does where nobody saw it.
    pub fn distances(&self, clip: &Motion) -> Option<Vec<f64>> {
        let roots = clip.roots();
        if roots.windows(2).all(|pair| pair[0] == pair[1]) {
            return None;
        }
        let seen = self.white(&route(clip));
        let far = MOST * DIMS as f64;
        let distance = |row: &DVector<f64>| (row - &seen).norm_squared().min(far);
        Some(self.rows.iter().map(distance).collect())
    }

    fn white(&self, route: &DVector<f64>) -> DVector<f64> {
        let l = self.whitening.l_dirty();
        // A factor of Cholesky's has no zero on its diagonal.
        l.solve_lower_triangular(route)
            .unwrap_or_else(|| route.clone())
    }
}

/// Travel since the beginning at the end of each part of a motion.
fn route(motion: &Motion) -> DVector<f64> {
    let since = motion.travelled();
    let last = since.len() - 1;
    let at = |part: usize| {
        let place = part as f64 / PARTS as f64 * last as f64;
        let (i, j) = (place as usize, (place as usize + 1).min(last));
        let s = place - i as f64;
        (0..3).map(move |k| (i, j, s, k))
    };
    let numbers = (1..=PARTS).flat_map(at);
    let numbers = numbers.map(|(i, j, s, k)| since[i][k] + s * (since[j][k] - since[i][k]));
    DVector::from_iterator(DIMS, numbers)
}

/// The covariance of a route about that of its row.
fn covariance(vocabulary: &Vocabulary, rows: &[Row], routes: &[DVector<f64>]) -> DMatrix<f64> {
    let prior = (0..DIMS).map(|i| PRIOR_COUNT * PRIOR[i % 3] * PRIOR[i % 3]);
    let mut sum = DMatrix::from_diagonal(&DVector::from_iterator(DIMS, prior));
    let mut count = PRIOR_COUNT;
    for primitive in 0..vocabulary.primitives().len() {
        let residual = |(a, b): (usize, usize)| {
            let r = &routes[a] - &routes[b];
            (r.norm_squared(), r)
        };
        for r in pairs(vocabulary, rows, primitive, residual) {
            // Two rows differ by twice what one differs from the truth.
            sum += &r * r.transpose() * 0.5;
            count += 1.0;
        }
    }
    let covariance = sum / count;
    let diagonal = DMatrix::from_diagonal(&covariance.diagonal());
    covariance * (1.0 - SHRINK) + diagonal * SHRINK
}
