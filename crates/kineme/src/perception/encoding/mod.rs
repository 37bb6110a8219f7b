//! Trajectory encoding (paper, section V-B): movement recognised from the paths of hands, feet or head alone, and said
//! again in the joints of the vocabulary's body.

mod calibration;
mod chains;
mod confidence;
mod cost;
mod decided;
mod encoded;
mod encoder;
mod explained;
mod extrapolation;
mod heading;
mod listener;
mod literal;
mod literally;
mod outline;
mod paths;
mod performed;
mod rejection;
mod result;
mod rows;
mod settings;
mod track;

pub use confidence::Confidence;
pub use decided::Decided;
pub use encoder::Encoder;
pub use explained::Explained;
pub use paths::EffectorPaths;
pub use rejection::{Rejection, SCORES};
pub use result::{EncodedSpan, Encoding};
pub use settings::{EncodingMethod, EncodingSettings, Extent, Matching};
