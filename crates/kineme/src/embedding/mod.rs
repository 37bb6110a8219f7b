//! Floor 2: spatio-temporal Isomap (Jenkins and Mataric 2004). Distances and successors in, coordinates out.
//!
//! The steps, each usable alone: a [`NeighbourGraph`] of segments ([`NeighbourGraph::segmented`]) or of the frames of
//! continuous recordings ([`NeighbourGraph::continuous`]), in which items that are similar and go on similarly are
//! drawn together; [`Geodesics`], shortest paths in it; an [`Embedding`], their coordinates by multidimensional scaling
//! ([`embed`] does both); new items by [`NeighbourGraph::links`] and [`Embedding::place`].

mod components;
mod continuous;
mod eigen;
mod geodesics;
mod graph;
mod out_of_sample;
mod scaling;
mod space;

pub use components::Disconnected;
pub use continuous::{Continuous, Frames, nontrivial_neighbours};
pub use geodesics::{Geodesics, LandmarkDistances};
pub use graph::{Distances, Edge, NeighbourGraph, SpatioTemporal, TemporalRule};
pub use out_of_sample::{Links, NewItem, Placement};
pub use scaling::{Scaling, classical_mds, residual_variance};
pub use space::{EmbedOptions, Embedding, embed};
