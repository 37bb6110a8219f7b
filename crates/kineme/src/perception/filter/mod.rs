//! The filter: a stream is followed over primitive, parameters and phase; the default recogniser.

mod around;
mod chain;
mod emission;
mod evidence;
mod exact;
mod features;
mod going;
mod learned;
mod learning;
mod logistic;
mod manner;
mod model;
mod noise;
mod outline;
mod patterns;
mod place;
mod reading;
mod recogniser;
mod route;
mod rows;
mod shape;
mod sight;
mod steady;
mod stream;
mod tangents;
mod temperature;
mod track;

pub use recogniser::{Filter, FilterSettings};
