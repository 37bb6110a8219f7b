//! Floor 5: recognising movement with the same vocabulary that makes it (paper, section V).

mod filter;

pub use filter::{Filter, FilterSettings};
