//! Floor 1: recordings as observed, motions of a body, Cartesian tracks.

mod activity;
mod body_motion;
mod from_motion;
mod landmarks;
mod recording;
mod resample;
mod source;
mod track;
mod travel;

pub use activity::{CENTROID_DIMS, STACKED_DIMS};
pub use body_motion::Motion;
pub use landmarks::{landmark_dims, landmarks_at, landmarks_of, mirror_landmarks};
pub use recording::{Format, Observed, Placement, RecordedJoint, Recording, Source};
pub use track::Track;
