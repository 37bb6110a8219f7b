//! The figures of the paper (Drumwright, Jenkins and Mataric 2004): plain data in, one SVG out.
//!
//! Whatever is the exact answer beside the paper's approximation is green in all of them, the value conditioned on and
//! the interval found are vermilion, what a primitive can do is blue.

mod density;
mod encoding;
mod flow;
mod flowchart;
mod hand_panels;
mod mixture;
mod plot;

pub use density::{Density, density};
pub use encoding::{EncodedDecision, EncodedPaths, encoded_paths};
pub use flow::{Arrow, Flow, Stick, flow};
pub use flowchart::{Edge, Flowchart, Kind, Node, flowchart};
pub use hand_panels::{HandPanel, hand_panels};
pub use mixture::{Cell, Mixture, ParameterSet, mixture};
