//! Motion files in and out, archives, vocabulary files, and the files people write.
//!
//! From a folder of recordings to a vocabulary file:
//!
//! ```no_run
//! use std::sync::Arc;
//!
//! use kineme::derivation::{Cut, Derivation};
//! use kineme::retargeting::retarget;
//! use kineme::segmentation::Segmenter;
//! use kineme_formats::input::{Inputs, ReadOptions};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let body = Arc::new(kineme::ares()?);
//! let mut motions = Vec::new();
//! for entry in Inputs::resolve(&["captures"], &ReadOptions::default())?.entries {
//!     motions.push(retarget(&entry.read()?, &body, None)?.motion);
//! }
//! let cut = Cut::Segmenter { segmenter: Segmenter::default(), target_secs: None };
//! let derived = Derivation::new(cut).run(&motions, &mut |_stage| {})?;
//! let vocabulary = derived.vocabulary(&motions, &kineme::Modelling::default(), &|_| None)?;
//! std::fs::write("moves.kineme", kineme_formats::vocabulary::write(&vocabulary, "moves.kineme")?)?;
//! # Ok(())
//! # }
//! ```

pub mod amc;
pub mod asf;
pub mod bvh;
pub mod c3d;
pub mod deepmimic;
pub mod detect;
mod document;
pub mod error;
pub mod input;
pub mod manifest;
pub mod marks;
pub mod npz;
pub mod output;
mod parquet;
pub mod plan;
pub mod positions;
pub mod profile;
pub mod robot;
pub mod script;
mod sheet;
mod stream;
pub mod tables;
mod text;
pub mod vocabulary;

pub use error::{FormatError, Place, Result, told};
