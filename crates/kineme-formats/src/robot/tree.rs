//! The bodies and hinges of a robot, as its file has them: what every reader makes, and all that follows goes by.

use nalgebra::{Matrix3, Unit, Vector3};

use kineme::skeleton::Range;

/// The range of a hinge without a limit: a turn either way.
pub const TURN: f64 = std::f64::consts::TAU;

/// A rigid body of a robot, its parent before it.
#[derive(Debug, Clone)]
pub struct Body {
    pub name: String,
    pub parent: Option<usize>,
    /// Its place at rest, in the world, metres.
    pub position: Vector3<f64>,
    pub hinges: Vec<Hinge>,
    /// Mass in kilograms, centre in the world, inertia about it in the world's axes; `None` when only geoms tell.
    pub inertial: Option<(f64, Vector3<f64>, Matrix3<f64>)>,
}

/// A hinge of a body, at rest, in the world.
#[derive(Debug, Clone)]
pub struct Hinge {
    pub name: String,
    pub anchor: Vector3<f64>,
    pub axis: Unit<Vector3<f64>>,
    /// Angles that it may have, radians, zero at rest.
    pub range: Range,
    /// The engine's coordinate at rest, radians.
    pub reference: f64,
}

/// What a robot's file holds of use here.
#[derive(Debug, Default)]
pub struct Tree {
    /// What the robot is called.
    pub title: Option<String>,
    pub bodies: Vec<Body>,
    /// The robot as MJCF without shapes, where its file is none.
    pub mjcf: Option<String>,
    /// What was passed over, each once.
    pub warnings: Vec<String>,
}

/// Bodies and hinges of a robot at most; the largest humanoids with hands have some hundred.
pub const MOST: usize = 2000;
