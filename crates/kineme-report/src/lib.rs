//! Figures of a derived vocabulary as SVG, and the page that shows them and the movement itself.
//!
//! The page ([`Page`]) is one file of HTML: what moves on it is plain data ([`scene::Scene`]), drawn by the viewer, a
//! program of the browser that `cargo xtask viewer` builds and this crate carries.
//!
//! Every figure is a function from plain data to the text of one SVG: no file, no font and no script beside it, the
//! same bytes from the same data. It follows the reader's light or dark setting, tells groups apart by colours that
//! the colour-blind can tell apart (Okabe and Ito 2008) and by shapes, and says in the figure when it leaves
//! something out for want of room. Numbers that are not finite are left out and counted there too.
//!
//! ```
//! let residuals = [0.42, 0.11, 0.04, 0.035];
//! let svg = kineme_report::residual_variance(&residuals, 3);
//! assert!(svg.starts_with("<svg"));
//! ```

mod axis;
mod embedding;
mod hand_paths;
mod names;
mod packed;
mod page;
mod palette;
pub mod paper;
#[cfg(feature = "png")]
mod png;
mod residual;
pub mod scene;
mod strip;
mod svg;
mod table;
mod timeline;
mod transitions;
mod viewer;

pub use embedding::{Embedding, embedding};
pub use hand_paths::{GroupPaths, LOW_COHERENCE, hand_paths};
pub use names::short_names;
pub use page::{Figure, Listing, Page, Section};
#[cfg(feature = "png")]
pub use png::{PngError, png};
pub use residual::residual_variance;
pub use strip::strip;
pub use table::Table;
pub use timeline::{Row, Span, timeline};
pub use transitions::transitions;
pub use viewer::{HOW_TO_BUILD, viewer};
