//! Floor 2: groups of items, from distances ([`hdbscan()`], the default) or from points ([`sweep_and_prune`], as the
//! paper has it). Noise stays noise: an item without a group is `None`.

mod hdbscan;
mod silhouette;
mod sweep;

pub use hdbscan::{Density, hdbscan, hdbscan_judged};
pub use silhouette::{contrast, mean_silhouette, silhouettes};
pub use sweep::{IntervalClusters, SweepAndPrune, Width, sweep_and_prune};
