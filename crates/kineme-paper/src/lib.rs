//! The reproduction: what the paper shows, computed again on open data.

pub mod derivation;
mod kmeans;
pub mod sets;
pub mod table;
