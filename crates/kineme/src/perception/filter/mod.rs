//! The filter: a stream is followed over primitive, parameters and phase; the default recogniser.

mod chain;
mod emission;
mod evidence;
mod features;
mod model;
mod noise;
mod recogniser;
mod rows;

pub use recogniser::{Filter, FilterSettings};
