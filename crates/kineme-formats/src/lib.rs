//! Motion files in and out, archives, vocabulary files, and the files people write.

mod document;
pub mod error;
pub mod marks;
pub mod profile;
pub mod script;
mod sheet;
pub mod tables;
pub mod vocabulary;

pub use error::{FormatError, Place, Result};
