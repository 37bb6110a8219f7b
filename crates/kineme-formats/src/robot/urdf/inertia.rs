//! Inertias as an engine takes them: principal moments of a body that can be.

use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion};

/// Mass (kilograms, a milligram) of what moves and has none.
pub const LEAST_MASS: f64 = 1e-6;
/// Principal moment (kg m^2) of what moves and has none: of a milligram at 3 cm.
pub const LEAST_MOMENT: f64 = 1e-9;
/// By how much of the greatest moment a file may be off, for its digits are few, before it is told.
const ROUNDED: f64 = 1e-3;
/// Rounds of the search for the principal axes at most; it takes some ten.
const ROUNDS: usize = 1000;

/// An inertia by its principal moments, kg m^2, and their axes.
pub struct Principal {
    pub moments: [f64; 3],
    pub axes: UnitQuaternion<f64>,
}

impl Principal {
    /// The principal moments of an inertia; `None` when none are found.
    pub fn of(inertia: &Matrix3<f64>) -> Option<Self> {
        let eigen = SymmetricEigen::try_new(*inertia, f64::EPSILON, ROUNDS)?;
        let mut axes = eigen.eigenvectors;
        if axes.determinant() < 0.0 {
            axes.set_column(2, &-axes.column(2).into_owned());
        }
        let axes = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        let moments: [f64; 3] = eigen.eigenvalues.into();
        let finite = moments
            .iter()
            .chain(axes.coords.iter())
            .all(|x| x.is_finite());
        finite.then_some(Self { moments, axes })
    }

    /// Of nothing.
    pub fn none() -> Self {
        Self {
            moments: [0.0; 3],
            axes: UnitQuaternion::identity(),
        }
    }

    /// The same of a body that can be: no moment is below zero, none above the sum of the others.
    pub fn possible(self) -> Self {
        let [a, b, c] = self.moments.map(|x| x.max(0.0));
        Self {
            // Of three that are not negative only the greatest can be too great.
            moments: [a.min(b + c), b.min(c + a), c.min(a + b)],
            ..self
        }
    }

    /// Whether a body can have it, but for what a file rounds.
    pub fn is_possible(&self) -> bool {
        let [a, b, c] = self.moments;
        let slack = ROUNDED * a.abs().max(b.abs()).max(c.abs());
        let within = |x: f64, y: f64, z: f64| x >= -slack && x <= y + z + slack;
        within(a, b, c) && within(b, c, a) && within(c, a, b)
    }

    /// Whether it resists every turn.
    pub fn resists(&self) -> bool {
        self.moments.iter().all(|x| *x >= LEAST_MOMENT)
    }

    /// The same with moments that resist every turn.
    pub fn resisting(self) -> Self {
        Self {
            moments: self.moments.map(|x| x.max(LEAST_MOMENT)),
            ..self
        }
        .possible()
    }
}
