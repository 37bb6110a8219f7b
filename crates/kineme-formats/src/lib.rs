//! Motion files in and out, archives, vocabulary files, and the files people write.

pub mod amc;
pub mod asf;
pub mod bvh;
pub mod deepmimic;
pub mod detect;
mod document;
pub mod error;
pub mod input;
pub mod marks;
pub mod output;
pub mod positions;
pub mod profile;
pub mod script;
mod sheet;
pub mod tables;
mod text;
pub mod vocabulary;

pub use error::{FormatError, Place, Result};
