//! Floor 4: the automatic determination of a vocabulary (paper, section III-A): segment, spatio-temporal Isomap, cluster.

mod coherence;
mod features;
mod groups;
mod levels;
mod procedure;
mod segments;
mod settings;
mod vocabulary;

pub use features::{Features, dims as feature_dims};
pub use groups::{Behaviors, Group};
pub use levels::{SecondLevel, alternation, transitions};
pub use procedure::{Derived, SegmentDistances, Stage};
pub use segments::{Cut, Mark, Segment, cut};
pub use settings::{Clustering, Derivation, Neighbourhood};
pub use vocabulary::MAX_EXEMPLARS;
