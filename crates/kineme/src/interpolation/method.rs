//! Which interpolation, with its settings.

use super::kernel::Kernel;
use crate::error::{Error, Result};

/// How weights follow from parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Inverse distance weights (Shepard 1968): `d_i^-power` over their sum. Exact and convex, so it never leaves what
    /// the exemplars show; flat at every exemplar.
    Shepard {
        /// The exponent, positive; 2 is usual.
        power: f64,
    },
    /// Verbs and Adverbs (Rose, Cohen and Bodenheimer 1998) in the cardinal form of Sloan, Rose and Cohen (2001):
    /// `w_i(p) = sum_l a_il A_l(p) + sum_k r_ik R_k(p)` with `w_i(p_j) = 1` where i = j and 0 elsewhere. Weights may be
    /// negative.
    Cardinal {
        /// The radial part R.
        kernel: Kernel,
        /// The polynomial part A.
        tail: Tail,
        /// Added to the kernel's diagonal, 0 or more: the variance of an exemplar's noise over that of the kernel, as in
        /// kriging. 0 is exact.
        nugget: f64,
    },
}

/// The polynomial part of [`Method::Cardinal`]: a constant and one slope a dimension that the points span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tail {
    /// None; what the kernel leaves of the weight goes to all points alike. That is simple kriging about the exemplars'
    /// mean, to which everything falls back far away.
    None,
    /// Least squares to each cardinal vector first, radial functions through what is left (Rose et al. 1998).
    LeastSquares,
    /// Solved together with the radial part under its moment conditions, as in universal kriging.
    Augmented,
}

impl Method {
    /// # Errors
    /// For a power or support that is not positive and a nugget below 0 or not finite.
    pub(super) fn check(&self) -> Result<()> {
        let (name, value, least) = match *self {
            Self::Shepard { power } => ("power", power, f64::MIN_POSITIVE),
            Self::Cardinal {
                kernel: Kernel::Wendland { support },
                nugget,
                ..
            } if nugget >= 0.0 && nugget.is_finite() => {
                ("Wendland support", support, f64::MIN_POSITIVE)
            }
            Self::Cardinal { nugget, .. } => ("nugget", nugget, 0.0),
        };
        if value >= least && value.is_finite() {
            return Ok(());
        }
        let bound = if least > 0.0 { "positive" } else { "0 or more" };
        Err(Error::invalid(format!(
            "the {name} of an interpolation must be {bound} and finite, found {value}"
        )))
    }
}
