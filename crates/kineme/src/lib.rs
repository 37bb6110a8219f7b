//! Kineme: motor primitives from motion capture.

pub mod alignment;
pub mod choreography;
pub mod clustering;
pub mod derivation;
pub mod embedding;
pub mod error;
pub mod math;
pub mod motion;
pub mod primitive;
pub mod retargeting;
pub mod segmentation;
pub mod skeleton;

pub use error::{Error, Result};
pub use motion::{Format, Motion, Observed, Placement, RecordedJoint, Recording, Source, Track};
pub use primitive::{Behavior, Exemplar, Primitive, Provenance, Transitions, Vocabulary};
pub use skeleton::{Role, Root, Skeleton, adonis, ares, body};
