//! Floor 2: cutting recordings into movements.
//!
//! Segmenters work on plain [`Signal`]s; whoever knows bodies makes these from motions:
//! [`pendulum`] (kinematic centroid) on the places of limbs, [`zfunction`] on joint coordinates,
//! [`changepoint`] on any features. [`clips`] and [`marks`] take what is already cut,
//! [`Segmenter`] holds the choice among them.

pub mod changepoint;
pub mod duration;
pub mod pendulum;
pub mod score;
mod segmenter;
mod signal;
mod spans;
pub mod zfunction;

pub use segmenter::{Segmenter, Views};
pub use signal::Signal;
pub use spans::{Segmentation, Span, SpanKind, clips, marks, movements};
