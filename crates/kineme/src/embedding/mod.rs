//! Floor 2: spatio-temporal Isomap (Jenkins and Mataric 2004). Distances and successors in, coordinates out.
//!
//! The steps, each usable alone: a [`NeighbourGraph`] of segments ([`NeighbourGraph::segmented`]) or of the frames of
//! continuous recordings ([`NeighbourGraph::continuous`]), in which items that are similar and go on similarly are
//! drawn together; [`Geodesics`], shortest paths in it; an [`Embedding`], their coordinates by multidimensional scaling
//! ([`embed`] does both); new items by [`NeighbourGraph::links`] and [`Embedding::place`].

mod components;
mod continuous;
mod eigen;
mod frames;
mod geodesics;
mod graph;
mod krylov;
mod out_of_sample;
mod scaling;
mod segmented;
mod space;

pub use components::Disconnected;
pub use continuous::{Continuous, nontrivial_neighbours};
pub use frames::Frames;
pub use geodesics::{Geodesics, LandmarkDistances};
pub use graph::{Edge, NeighbourGraph};
pub use out_of_sample::{Links, NewItem, Placement};
pub use scaling::{Scaling, classical_mds, residual_variance};
pub use segmented::{Distances, SpatioTemporal, TemporalRule};
pub use space::{EmbedOptions, Embedding, embed};
