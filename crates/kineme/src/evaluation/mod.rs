//! Floor 5: how well a recogniser does, beside baselines. Knows the [`crate::primitive::Recogniser`] trait and no recogniser.
//!
//! [`scores`] judges answers to whole clips, [`stream_scores`] those to every frame of recordings; [`differences`] compares
//! two recognisers on the same clips; [`pooled_scores`] judges clips that were asked in several splits, and
//! [`calibration_by_chance`] tells what exactly right probabilities would seem to miss on so few clips. All of them are
//! functions of what was answered: whoever wants to know how long it took measures that outside. [`NearestDtw`],
//! [`NearestPosture`] and [`Constant`] are recognisers that anything better must beat.

mod baselines;
mod bootstrap;
mod chance;
mod clips;
mod measures;
mod streams;

pub use baselines::{
    Constant, Features, NearestDtw, NearestDtwSettings, NearestPosture, NearestPostureSettings,
};
pub use bootstrap::{Bootstrap, Estimate};
pub use chance::{ByChance, calibration_by_chance};
pub use clips::{Confusion, Judged, Scores, differences, pooled_scores, scores};
pub use streams::{Delays, Stream, StreamScores, StreamSettings, stream_scores};
