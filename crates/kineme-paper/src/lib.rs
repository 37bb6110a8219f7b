//! The reproduction: what the paper shows, computed again on open data.

pub mod derivation;
pub mod figures;
mod kmeans;
pub mod sets;
pub mod table;
