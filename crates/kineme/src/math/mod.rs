//! Floor 0: rotations, splines, statistics, distances, partitions. Knows no skeleton.

pub mod distances;
pub mod partition;
pub mod rotation;
pub mod spline;
pub mod statistics;
