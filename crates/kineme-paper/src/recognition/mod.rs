//! The tables of `docs/perception.md`: recognition of real people, beside baselines.

pub mod answers;
pub mod clips;
pub mod corpora;
pub mod known;
pub mod peers;
pub mod summary;
