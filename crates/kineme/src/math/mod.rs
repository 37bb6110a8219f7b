//! Floor 0: rotations, splines, statistics. Knows no skeleton.

pub mod rotation;
pub mod spline;
pub mod statistics;
