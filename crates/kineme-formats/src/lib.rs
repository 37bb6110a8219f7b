//! Motion files in and out, archives, vocabulary files, and the files people write.

pub mod amc;
pub mod asf;
pub mod bvh;
pub mod deepmimic;
pub mod detect;
pub mod error;
pub mod input;
pub mod output;
pub mod positions;
mod text;

pub use error::{FormatError, Place, Result};
