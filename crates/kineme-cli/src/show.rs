//! `kineme show`: what a vocabulary holds.

use crate::args::{Global, ShowArgs};
use crate::describe;
use crate::failure::{Failure, print};
use crate::vocabularies::{primitive, read};

pub fn run(args: &ShowArgs, global: &Global) -> Result<u8, Failure> {
    let vocabulary = read(&args.vocabulary)?;
    let told = match &args.primitive {
        Some(name) => describe::one(&vocabulary, primitive(&vocabulary, name)?, global)?,
        None => describe::all(&vocabulary, &args.vocabulary.display().to_string(), global)?,
    };
    print(told.as_bytes())?;
    Ok(0)
}
