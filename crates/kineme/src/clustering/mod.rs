//! Floor 2: groups of items, from distances ([`hdbscan()`], the default) or from points ([`sweep_and_prune`], as the
//! paper has it). Noise stays noise: an item without a group is `None`.

mod hdbscan;
mod sweep;

pub use hdbscan::{Density, hdbscan};
pub use sweep::{IntervalClusters, SweepAndPrune, Width, sweep_and_prune};
