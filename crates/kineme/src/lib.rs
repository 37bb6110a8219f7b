//! Kineme: motor primitives from motion capture.

pub mod alignment;
pub mod error;
pub mod math;
pub mod motion;
pub mod segmentation;
pub mod skeleton;

pub use error::{Error, Result};
pub use motion::{Format, Observed, Placement, RecordedJoint, Recording, Source};
pub use skeleton::Role;
