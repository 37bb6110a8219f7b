//! Floor 0: rotations, splines, statistics, distances, partitions, eigenpairs. Knows no skeleton.

pub mod distances;
pub(crate) mod eigen;
pub mod local_scale;
pub mod partition;
pub mod rotation;
pub mod spline;
pub mod statistics;
