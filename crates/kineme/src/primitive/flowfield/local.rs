//! The local model of the manifold round a posture: near courses blended.

use nalgebra::{SMatrix, SVector};

use super::field::Flowfield;
use super::samples::{MOST_AXES, MOST_NEIGHBOURS, Matches};
use crate::primitive::course::{Sample, sample};

/// Parameters at most for which the model is affine in them.
const MOST_AFFINE: usize = 4;
/// How far from the neighbours' mean their affine model is trusted, in squared standard deviations.
const FARTHEST: f64 = 4.0;

/// A place on the manifold: exemplars' weights and phase.
pub(super) struct Place {
    /// Weights of the exemplars.
    pub shares: Vec<f64>,
    pub parameters: Vec<f64>,
    /// As the window counts: in a cycle not wrapped.
    pub phase: f64,
}

impl Flowfield {
    /// Shares of the nearest of `matches`: a kernel of distances that vanishes at the first that is not among them, so
    /// that none enters or leaves suddenly. What all have in common, the distance to the manifold, cancels.
    pub(super) fn kernel(&self, matches: &Matches) -> ([f64; MOST_NEIGHBOURS], usize) {
        let found = matches.as_slice();
        let k = self.settings.neighbours.min(found.len());
        let nearest = found[0].cost;
        let beyond = match found.get(k) {
            Some(next) => next.cost - nearest,
            None => 1.25 * (found[k - 1].cost - nearest),
        };
        let mut shares = [0.0; MOST_NEIGHBOURS];
        let mut sum = 0.0;
        for (share, m) in shares.iter_mut().zip(&found[..k]) {
            let far = m.cost - nearest;
            *share = if beyond > 0.0 {
                (1.0 - far / beyond).powi(2)
            } else {
                1.0
            };
            sum += *share;
        }
        for share in &mut shares[..k] {
            *share /= sum;
        }
        (shares, k)
    }

    /// The place on the manifold near a posture whose parameters are about `about`: the kernel mean of the nearest courses,
    /// moved along the manifold to where the posture is (weighted regression of postures on parameters, Atkeson, Moore and
    /// Schaal 1997). Without that the mean of one-sided neighbours would draw inward at the manifold's edge.
    pub(super) fn place(
        &self,
        query: &[f64; MOST_AXES],
        about: &[f64],
        matches: &Matches,
    ) -> Place {
        let (mut kernel, k) = self.kernel(matches);
        if k > 1 && (1..=MOST_AFFINE).contains(&self.dims) {
            self.regress(query, about, matches, &mut kernel[..k]);
        }
        let mut place = Place {
            shares: vec![0.0; self.curves.len()],
            parameters: vec![0.0; self.dims],
            phase: 0.0,
        };
        for (m, &share) in matches.as_slice().iter().zip(&kernel[..k]) {
            let point = &self.points[m.course * self.dims..(m.course + 1) * self.dims];
            for (p, v) in place.parameters.iter_mut().zip(point) {
                *p += share * v;
            }
            place.phase += share * self.samples.phase(m);
        }
        self.interpolator
            .weights(&place.parameters, &mut place.shares);
        place
    }

    /// Turns kernel shares into those of the affine model at the query, which never leaves its neighbours' spread.
    fn regress(
        &self,
        query: &[f64; MOST_AXES],
        about: &[f64],
        matches: &Matches,
        kernel: &mut [f64],
    ) {
        type Square = SMatrix<f64, MOST_AFFINE, MOST_AFFINE>;
        type Column = SVector<f64, MOST_AFFINE>;
        let found = matches.as_slice();
        let column = |values: &[f64]| {
            let mut p = Column::zeros();
            for (d, v) in values.iter().enumerate() {
                p[d] = *v;
            }
            p
        };
        let point = |course: usize| column(&self.points[course * self.dims..][..self.dims]);
        let mut middle = Column::zeros();
        let mut posture = [0.0; MOST_AXES];
        let mut postures = [[0.0; MOST_AXES]; MOST_NEIGHBOURS];
        for ((m, &w), y) in found.iter().zip(&*kernel).zip(&mut postures) {
            self.samples.posture(m, y);
            middle += w * point(m.course);
            for (p, v) in posture.iter_mut().zip(&*y) {
                *p += w * v;
            }
        }
        // Covariances of parameters with themselves and with postures.
        let mut spread = Square::zeros();
        let mut crossed = [Column::zeros(); MOST_AXES];
        for ((m, &w), y) in found.iter().zip(&*kernel).zip(&postures) {
            let off = point(m.course) - middle;
            spread += w * off * off.transpose();
            for ((c, v), p) in crossed.iter_mut().zip(y).zip(&posture) {
                *c += w * (v - p) * off;
            }
        }
        // Least squares in the shift's coefficients: postures and remembered parameters, each with its weight. What the
        // manifold leaves of the posture is noise: the larger it is, the nearer the neighbours' mean.
        let stiff = self.stiffness();
        let mut normal = stiff * spread * spread;
        let mut right = stiff * spread * (column(about) - middle);
        for ((c, q), p) in crossed.iter().zip(query).zip(&posture) {
            normal += c * c.transpose();
            right += (q - p) * c;
        }
        normal += found[0].cost * spread;
        let floor = 1e-9 * normal.trace() + f64::MIN_POSITIVE;
        for d in 0..MOST_AFFINE {
            normal[(d, d)] += if d < self.dims { floor } else { 1.0 };
        }
        let Some(factor) = normal.cholesky() else {
            return;
        };
        let mut along = factor.solve(&right);
        let far = (along.transpose() * spread * along)[(0, 0)];
        if far > FARTHEST {
            along *= (FARTHEST / far).sqrt();
        }
        for (m, w) in found.iter().zip(kernel) {
            *w *= 1.0 + (point(m.course) - middle).dot(&along);
        }
    }

    /// What the primitive is at a place.
    pub(super) fn point(&self, shares: &[f64], phase: f64) -> Sample {
        let curves = self.curves.iter().zip(shares.iter().copied());
        sample(curves, self.body.dof(), self.on_curve(phase))
    }

    pub(super) fn on_curve(&self, phase: f64) -> f64 {
        if self.cyclic {
            phase.rem_euclid(1.0)
        } else {
            phase.clamp(0.0, 1.0)
        }
    }
}
