//! Floor 1: recordings as observed, motions of a body, Cartesian tracks, segments.

mod recording;

pub use recording::{Format, Observed, Placement, RecordedJoint, Recording, Source};
