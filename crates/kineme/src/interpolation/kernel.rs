//! Radial basis functions of the distance between two parameter vectors.

/// A radial basis function of the distance r, in units of the parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// Wendland's C2 function (1995), `(1 - r/s)^4 (4 r/s + 1)` below the support s and 0 beyond it: positive definite
    /// up to three dimensions. In m > 3 the exponent is Wendland's for m, `floor(m/2) + 3`, to stay so.
    Wendland {
        /// Distance at which it vanishes; positive. [`wendland_support`] proposes one.
        support: f64,
    },
    /// `-r`: continuous, with a kink at every exemplar. Conditionally positive definite.
    Linear,
    /// `r^3`. Conditionally positive definite: made for [`super::Tail::Augmented`].
    Cubic,
    /// `r^2 ln r` (Duchon 1977): in two dimensions the surface that bends least. Conditionally positive definite as well.
    ThinPlate,
}

impl Kernel {
    /// True for kernels whose matrix is positive definite with or without a polynomial.
    pub(super) fn is_positive_definite(self) -> bool {
        matches!(self, Self::Wendland { .. })
    }
}

/// A kernel among vectors of a known dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Radial {
    kernel: Kernel,
    /// Wendland's exponent.
    degree: i32,
}

impl Radial {
    pub(super) fn new(kernel: Kernel, dims: usize) -> Self {
        let degree = (dims / 2 + 3).max(4);
        Self {
            kernel,
            degree: i32::try_from(degree).unwrap_or(i32::MAX),
        }
    }

    /// The value at distance `r`.
    pub(super) fn value(&self, r: f64) -> f64 {
        match self.kernel {
            Kernel::Wendland { support } if r < support => {
                let x = r / support;
                (1.0 - x).powi(self.degree) * (f64::from(self.degree) * x + 1.0)
            }
            Kernel::Wendland { .. } => 0.0,
            Kernel::Linear => -r,
            Kernel::Cubic => r * r * r,
            Kernel::ThinPlate if r > 0.0 => r * r * r.ln(),
            Kernel::ThinPlate => 0.0,
        }
    }

    /// The derivative at distance `r`, divided by `r`: times the difference of the vectors it is the gradient. 0 at r = 0,
    /// where the gradient vanishes or, for the linear kernel, has a kink.
    pub(super) fn slope_over_distance(&self, r: f64) -> f64 {
        match self.kernel {
            Kernel::Wendland { support } if r < support => {
                let k = f64::from(self.degree);
                let x = r / support;
                -k * (k + 1.0) * (1.0 - x).powi(self.degree - 1) / (support * support)
            }
            Kernel::Wendland { .. } => 0.0,
            Kernel::Linear | Kernel::ThinPlate if r == 0.0 => 0.0,
            Kernel::Linear => -1.0 / r,
            Kernel::Cubic => 3.0 * r,
            Kernel::ThinPlate => 2.0 * r.ln() + 1.0,
        }
    }
}

/// The support of the Wendland kernel that is the default for `points` (`n` x `dims`, row-major): four times the largest
/// distance from a point to its nearest other one, coinciding points apart; 1 where there is only one place.
///
/// The usual radius is twice that distance (Rose, Cohen and Bodenheimer 1998, for B-spline bumps). Wendland's function is
/// narrower for the same support: on smooth functions over grids and scattered points four times halves the error between
/// exemplars, while noise in them is passed on as before and the condition stays far below what is warned of.
pub fn wendland_support(points: &[f64], n: usize, dims: usize) -> f64 {
    let row = |i: usize| &points[i * dims..(i + 1) * dims];
    let nearest = |i: usize| {
        (0..n)
            .map(|j| distance(row(i), row(j)))
            .filter(|&d| d > 0.0)
            .fold(f64::INFINITY, f64::min)
    };
    let widest = (0..n)
        .map(nearest)
        .filter(|d| d.is_finite())
        .fold(0.0, f64::max);
    if widest > 0.0 { 4.0 * widest } else { 1.0 }
}

/// Euclidean distance.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    distance_squared(a, b).sqrt()
}

/// Its square.
pub(super) fn distance_squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}
