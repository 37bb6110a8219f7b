//! The tables of `docs/perception.md`: recognition of real people, beside baselines.

pub mod answers;
pub mod calibration;
pub mod clips;
pub mod corpora;
pub mod damage;
pub mod exercises;
pub mod export;
pub mod few_shots;
pub mod known;
pub mod latency;
pub mod law;
pub mod open_set;
pub mod peers;
pub mod streams;
pub mod summary;
pub mod tables;
pub mod trials;
