//! The reproduction: what the paper shows, computed again on open data.

pub mod choreographies;
#[cfg(feature = "sim")]
pub mod control;
pub mod demo;
pub mod derivation;
pub mod encoding_test;
pub mod figures;
pub mod flow_table;
pub mod interpolation_table;
pub mod intervals;
pub mod inverse;
mod kmeans;
pub mod model_table;
pub mod models;
pub mod out_and_back;
pub mod paper_figures;
pub mod postures;
pub mod recognition;
pub mod scene;
pub mod sets;
pub mod show;
pub mod sparring;
pub mod table;
pub mod table1;
