//! Motion files in and out, archives, vocabulary files, and the files people write.

pub mod error;

pub use error::{FormatError, Place, Result};
