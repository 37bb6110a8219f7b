//! Joints of a body: what they can do, how far, and what they carry.

use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

use super::role::Role;

/// The signed axes of a joint's clinical movements, in the parent's frame at the neutral standing pose.
///
/// A positive angle bends, leads away from the body's middle (trunk: to the left) and turns inward (trunk: to the left).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClinicalAxes {
    /// Axis of flexion.
    pub flexion: Vector3<f64>,
    /// Axis of abduction.
    pub abduction: Vector3<f64>,
    /// Axis of axial rotation.
    pub axial: Vector3<f64>,
}

impl ClinicalAxes {
    /// The rotation of clinical angles (radians), composed in this order: flexion, then abduction and axial rotation in the turned frame.
    pub fn rotation(&self, flexion: f64, abduction: f64, axial: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.flexion * flexion)
            * UnitQuaternion::from_scaled_axis(self.abduction * abduction)
            * UnitQuaternion::from_scaled_axis(self.axial * axial)
    }
}

/// An interval of angles, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least angle.
    pub low: f64,
    /// Greatest angle.
    pub high: f64,
}

impl Range {
    /// A range given in degrees.
    pub fn degrees(low: f64, high: f64) -> Self {
        Self {
            low: low.to_radians(),
            high: high.to_radians(),
        }
    }

    /// The middle of the range.
    pub fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }
}

/// How a joint moves.
#[derive(Debug, Clone, PartialEq)]
pub enum JointKind {
    /// Not at all.
    Fixed,
    /// About one axis (in the parent's frame); one coordinate, the angle in radians.
    Hinge {
        /// The axis of positive turning.
        axis: Unit<Vector3<f64>>,
        /// Anatomical range.
        range: Range,
    },
    /// About any axis; three coordinates, the rotation vector (radians) relative to `reference`.
    Ball {
        /// The rotation in the middle of the anatomical range, where the coordinates are zero.
        reference: UnitQuaternion<f64>,
        /// Ranges of flexion, abduction and axial rotation.
        ranges: [Range; 3],
    },
}

impl JointKind {
    /// The number of coordinates: 0, 1 or 3.
    pub fn dof(&self) -> usize {
        match self {
            JointKind::Fixed => 0,
            JointKind::Hinge { .. } => 1,
            JointKind::Ball { .. } => 3,
        }
    }
}

/// The rigid part that a joint moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Mass, kilograms.
    pub mass_kg: f64,
    /// Centre of mass in the joint's frame, metres.
    pub center: Vector3<f64>,
    /// Inertia about the centre of mass, in the joint's axes, kg m^2.
    pub inertia: Matrix3<f64>,
}

/// A joint with the link that it moves. At the neutral pose every joint's frame is the world's: x forward, y left, z up.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name, unique in the skeleton.
    pub name: String,
    /// The joint that carries it; `None` for the root.
    pub parent: Option<usize>,
    /// Its place in the parent's frame, metres.
    pub offset: Vector3<f64>,
    /// How it moves.
    pub kind: JointKind,
    /// Its clinical axes.
    pub axes: ClinicalAxes,
    /// The part of the body that it moves; a chain of vertebrae shares one role.
    pub role: Option<Role>,
    /// Its share of the rotation of the chain that it belongs to (trunk or neck and head), in (0, 1].
    pub share: f64,
    /// Where its bone ends, in its own frame, metres.
    pub tip: Vector3<f64>,
    /// What it carries.
    pub link: Link,
}
