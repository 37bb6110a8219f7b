//! Table I of the paper on open data: three sets of motion, every frame of which each of five behaviours is affirmed or
//! denied, and what the accuracy of that hides.
//!
//! The sets are made by [`movements`] (what simulated Ares did), [`animations`] and [`recorded`]; [`Mode`] says how is
//! decided, [`Tally`] counts, [`measures`] are what is read off the counts. [`table1`] runs all of it.

mod beside;
mod captured;
mod clip;
mod disturbed;
mod embedded;
mod measures;
mod mode;
mod movements;
mod row;
mod run;
mod tally;
mod written;

pub(crate) use captured::ALL_ZERO;
pub use captured::{Captured, Showing, recorded, shows};
pub use clip::{Altered, Clip, animations, unmoved};
pub use disturbed::{HYBRID_APART, cut_out, hybrids, reversed};
pub use embedded::{embedded, table};
pub use measures::{MEASURES, Measure, garwood, measures};
pub use mode::{Decisions, Mode};
pub use movements::{MovementSettings, RATE_HZ, drawn, movements, perform, plan, ready_made};
pub use row::{Row, Table, Timing};
pub use run::{TableSettings, boxer, table1};
pub use tally::{Counts, Tally};
