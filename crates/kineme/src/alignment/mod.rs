//! Floor 2: dynamic time warping between movements, one pair or all pairs of many.
//!
//! [`distance`] and [`align`] are the exact definition in f64, for sequences of any lengths.
//! [`pair_distances`] and [`nearest_neighbours`] compute the same distance in f32 for many sequences
//! of equal length, several pairs at a time; sequences are plain vectors, frame by frame.

mod dtw;
mod lanes;
mod nearest;
mod pairs;

pub use dtw::{Alignment, Band, LocalCost, align, distance};
pub use nearest::{
    Nearest, NeighbourLists, Reached, RecallGoal, nearest_neighbours, nearest_to_recall, recall,
};
pub use pairs::{Sequences, distances_to_query, pair_distances};
