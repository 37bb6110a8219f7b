//! Floor 2: dynamic time warping between movements, and their registration to one phase.
//!
//! [`distance`] and [`align`] are the exact definition in f64, for sequences of any lengths.
//! [`pair_distances`] and [`nearest_neighbours`] compute the same distance in f32 for many sequences
//! of equal length, several pairs at a time; sequences are plain vectors, frame by frame.
//!
//! [`resting_ends`] cuts rests off, [`Registration`] gives every exemplar of a group a [`Warp`] from the common phase
//! to its own time, along paths of limited slope ([`align_sloped`]). Groups that repeat themselves from end to end
//! ([`period`]) are cut to one cycle each, all from the same event on ([`cycles`]). [`Registration::structures`] finds
//! the exemplars that no warp brings together with the others, such as the left hand among right ones.

mod centre;
mod cycle;
mod dtw;
mod lanes;
mod nearest;
mod pairs;
mod period;
mod registration;
mod slope;
mod smooth;
mod structure;
mod trim;
mod warp;

pub use cycle::{Cycle, cycle, cycles};
pub use dtw::{Alignment, Band, LocalCost, align, distance};
pub use nearest::{
    Nearest, NeighbourLists, Reached, RecallGoal, nearest_neighbours, nearest_to_recall, recall,
};
pub use pairs::{Sequences, distances_to_query, pair_distances};
pub use period::{Period, period};
pub use registration::{Aligned, Registered, Registration};
pub use slope::align_sloped;
pub use structure::{Mismatch, Structure};
pub use trim::{Trim, resting_ends};
pub use warp::{Warp, resample};
