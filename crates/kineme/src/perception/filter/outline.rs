//! The outlines of a filter's rows and of what it sees.

use nalgebra::DVector;
use rayon::prelude::*;

use super::features::Layout;
use super::noise::pairs;
use super::rows::Row;
use crate::error::Result;
use crate::perception::outline::{self, outline};
use crate::primitive::Vocabulary;
use crate::skeleton::Role;

/// Beside the hands as seen from the shoulders, these landmarks: ends and middles of limbs and trunk.
const ROLES: [Role; 10] = [
    Role::Chest,
    Role::Head,
    Role::LeftLowerArm,
    Role::LeftHand,
    Role::RightLowerArm,
    Role::RightHand,
    Role::LeftLowerLeg,
    Role::LeftFoot,
    Role::RightLowerLeg,
    Role::RightFoot,
];

/// The outlines of rows.
#[derive(Debug, Clone)]
pub(super) struct Outlines {
    /// Numbers of a posture that are looked at.
    looked_at: Vec<usize>,
    rows: outline::Outlines,
}

impl Outlines {
    /// The outlines of rows: those of exemplars' recordings, looked at so many times a second. `None` where a row lies
    /// between exemplars: there the manifold is known, and a blend of recordings is none of its movements.
    ///
    /// # Errors
    /// When their covariance is not positive definite.
    pub fn new(
        vocabulary: &Vocabulary,
        rows: &[Row],
        layout: &Layout,
        clock_hz: f64,
    ) -> Result<Option<Self>> {
        let looked_at = layout.numbers_of(&ROLES);
        let of = |row: &Row| {
            let exemplars = vocabulary.primitives()[row.primitive].exemplars();
            let motion = &exemplars[row.exemplar?].motion;
            let every = ((motion.rate_hz() / clock_hz).round() as usize).max(1);
            let frames = (0..motion.frames()).step_by(every);
            let postures: Vec<f64> = frames
                .flat_map(|f| layout.posture(motion.pose(f)))
                .collect();
            Some(outline(&postures, layout.posture_dims(), &looked_at))
        };
        let outlines: Option<Vec<DVector<f64>>> = rows.par_iter().map(of).collect();
        let Some(outlines) = outlines.filter(|o| !o.is_empty() && !looked_at.is_empty()) else {
            return Ok(None);
        };
        let residual = |(a, b): (usize, usize)| {
            let r = &outlines[a] - &outlines[b];
            (r.norm_squared(), r)
        };
        let primitives = 0..vocabulary.primitives().len();
        let residuals: Vec<DVector<f64>> = primitives
            .flat_map(|p| pairs(vocabulary, rows, p, residual))
            .collect();
        Ok(Some(Self {
            rows: outline::Outlines::new(&outlines, &residuals)?,
            looked_at,
        }))
    }

    /// Squared distances, in deviations, in the mean of the directions, of a clip's postures (one after the other, evenly
    /// in time) to the rows.
    pub fn distances(&self, postures: &[f64], dims: usize) -> Vec<f64> {
        self.rows
            .distances(&outline(postures, dims, &self.looked_at))
    }
}
