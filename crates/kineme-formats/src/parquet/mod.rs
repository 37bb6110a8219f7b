//! Apache Parquet: tables of numbers, column by column, in and out.
//!
//! The library `parquet` decodes and encodes columns. It trusts what a file claims of its own sizes, and a file of a
//! hundred bytes can claim gigabytes; so the footer ([`footer`]) and every page ([`pages`]) are checked here before the
//! library sees them.
//!
//! Source of the layout: Apache Parquet, `parquet-format` 2.11, `README.md` and `parquet.thrift`.

mod footer;
mod pages;
mod read;
mod thrift;
mod write;

pub(crate) use read::{Table, read};
pub(crate) use write::{Cells, write};

/// What a file begins and ends with.
const MAGIC: &[u8] = b"PAR1";
/// Bytes after the footer: its length, and [`MAGIC`].
const TRAILER: usize = 8;

/// Whether a file that starts with these bytes is Parquet.
pub(crate) fn begins(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// The names of the columns, which stand in the footer at a file's end; `None` where that cannot be read. `end(n)`
/// gives the last n bytes of the file, or all where it has fewer.
pub(crate) fn column_names(end: impl Fn(usize) -> Option<Vec<u8>>) -> Option<Vec<String>> {
    // Hundreds of columns fit; nothing is known yet of how long the footer is.
    const GUESS: usize = 1 << 16;
    let mut tail = end(GUESS)?;
    let length = footer::length(&tail)?;
    if length > tail.len() - TRAILER {
        tail = end(length + TRAILER)?;
    }
    let footer = footer::cut(&tail)?;
    let schema = footer::schema(footer)?;
    let names = schema.names.into_iter();
    Some(names.filter(|name| !is_index(name)).collect())
}

/// Whether a column is the index that pandas writes beside a table whose rows were numbered otherwise than 0, 1, 2.
fn is_index(name: &str) -> bool {
    name.starts_with("__index_level_") && name.ends_with("__")
}
