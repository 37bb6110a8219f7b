//! Floor 5: recognising movement with the same vocabulary that makes it (paper, section V).

mod chain;
mod emission;
mod evidence;
mod features;
mod filter;
mod model;
mod noise;
mod rows;

pub use filter::{Filter, FilterSettings};
