//! The footer of a Parquet file, checked for what it claims, and the columns that it names.

use super::thrift::{BINARY, LIST, STRUCT, Thrift};
use super::{MAGIC, TRAILER};

/// The columns of a file.
#[derive(Debug, Default)]
pub(super) struct Schema {
    /// Of all columns that hold values, trimmed.
    pub names: Vec<String>,
    /// The first column that consists of others.
    pub nested: Option<String>,
}

/// The length in bytes of the footer of a file that ends with these bytes.
pub(super) fn length(tail: &[u8]) -> Option<usize> {
    let trailer = &tail[tail.len().checked_sub(TRAILER)?..];
    let length = trailer.strip_suffix(MAGIC)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(length)).ok()
}

/// The footer of a file that ends with these bytes; `None` where there is none, or more of it.
pub(super) fn cut(tail: &[u8]) -> Option<&[u8]> {
    let end = tail.len().checked_sub(TRAILER)?;
    tail.get(end.checked_sub(length(tail)?)?..end)
}

/// Reads the columns' names, and walks the whole footer: where this gives something, no list in it claims more elements
/// than there are bytes.
pub(super) fn schema(footer: &[u8]) -> Option<Schema> {
    let mut schema = None;
    Thrift::new(footer).structure(|file, field, kind| match (field, kind) {
        // A second one would be what the library reads.
        (2, LIST) if schema.is_none() => {
            schema = Some(elements(file)?);
            Some(())
        }
        (2, _) => None,
        _ => file.skip(kind),
    })?;
    schema
}

/// The elements of the schema: the root, then the columns, those that consist of others before these.
fn elements(file: &mut Thrift<'_>) -> Option<Schema> {
    let (kind, count) = file.list()?;
    if kind != STRUCT {
        return None;
    }
    let mut schema = Schema::default();
    for at in 0..count {
        let (mut name, mut children) = (None, None);
        file.structure(|element, field, kind| match (field, kind) {
            (4, BINARY) if name.is_none() => {
                name = Some(std::str::from_utf8(element.binary()?).ok()?);
                Some(())
            }
            (5, 5) if children.is_none() => {
                children = Some(element.int()?);
                Some(())
            }
            (4 | 5, _) => None,
            _ => element.skip(kind),
        })?;
        let (name, children) = (name?.trim().to_owned(), children.unwrap_or(0));
        match (at, children) {
            // The library takes the root's word for how many there are.
            (0, children) if usize::try_from(children).ok()? < count => {}
            (0, _) => return None,
            (_, 0) => schema.names.push(name),
            _ => {
                schema.nested.get_or_insert(name);
            }
        }
    }
    Some(schema)
}
