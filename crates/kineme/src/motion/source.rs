//! What can be said anew of where a recording came from.

use nalgebra::{UnitQuaternion, Vector3};

use super::recording::{Observed, Recording, Source};
use crate::error::{Error, Result};
use crate::math::rotation::Axis;

impl Recording {
    /// The same movement with another account of its source: writers use the axes and the unit that it names.
    ///
    /// # Errors
    /// When the unit is not positive.
    pub fn with_source(self, source: Source) -> Result<Self> {
        check_unit(source.unit_metres)?;
        Ok(self.sourced(source))
    }

    /// What the file means if `up` is its upward axis and `unit_metres` its unit, whatever its reader took them for.
    ///
    /// # Errors
    /// When the unit is not positive, or makes a length that is not finite.
    pub fn reread(&self, up: Axis, unit_metres: f64) -> Result<Self> {
        check_unit(unit_metres)?;
        let old = self.source();
        let new = Source {
            up,
            unit_metres,
            ..old.clone()
        };
        let place = |p: Vector3<f64>| new.to_inner(old.to_native(p));
        let turn = |q: UnitQuaternion<f64>| new.rotation_to_inner(old.rotation_to_native(q));
        let mut joints = self.joints().to_vec();
        for joint in &mut joints {
            joint.offset = place(joint.offset);
            joint.tip = joint.tip.map(place);
        }
        let observed = match self.observed() {
            Observed::Rotations {
                rotations,
                translations,
            } => Observed::Rotations {
                rotations: rotations.iter().map(|q| turn(*q)).collect(),
                translations: translations
                    .iter()
                    .map(|path| Some(path.as_ref()?.iter().map(|p| place(*p)).collect()))
                    .collect(),
            },
            Observed::Positions(positions) => {
                Observed::Positions(positions.iter().map(|p| p.map(place)).collect())
            }
        };
        Recording::new(self.name(), new, joints, self.rate_hz(), observed)
    }
}

fn check_unit(unit_metres: f64) -> Result<()> {
    if unit_metres.is_finite() && unit_metres > 0.0 {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "a unit of length is positive, found {unit_metres} m"
    )))
}
