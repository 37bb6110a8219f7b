//! From columns of numbers to a Parquet file.
//!
//! Values stand one after the other as they are, and a column that never changes, as those of joints that a recording
//! does not move, is written once, as a dictionary of one. Nothing is compressed: angles hardly repeat, every reader
//! knows this, and the bytes follow from the numbers alone.

use std::borrow::Cow;
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, Repetition, Type};
use parquet::data_type::{DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type as Element, TypePtr};

use super::read::NUMBERS_A_BYTE;
use crate::error::FormatError;
use crate::text::Blame;

/// What a file says of who wrote it. No version: the same motion gives the same bytes.
const WRITER: &str = "kineme";

/// The values of a column.
pub(crate) enum Cells<'a> {
    /// INT64: 0, 1, 2, up to but not this.
    Count(usize),
    /// DOUBLE, none missing.
    All(&'a [f64]),
    /// DOUBLE, null where missing.
    Some(Cow<'a, [Option<f64>]>),
}

impl Cells<'_> {
    /// Whether it has values and they are the same to the last bit.
    fn is_constant(&self) -> bool {
        let mut bits: Box<dyn Iterator<Item = u64>> = match self {
            Cells::Count(_) => return false,
            Cells::All(values) => Box::new(values.iter().map(|v| v.to_bits())),
            Cells::Some(cells) => Box::new(cells.iter().flatten().map(|v| v.to_bits())),
        };
        let first = bits.next();
        first.is_some_and(|first| bits.all(|b| b == first))
    }

    /// Whether it takes 8 bytes a row.
    fn is_full_size(&self) -> bool {
        let full = match self {
            Cells::Count(_) | Cells::All(_) => true,
            Cells::Some(cells) => cells.iter().all(Option::is_some),
        };
        full && !self.is_constant()
    }
}

/// Writes columns of equal length, each under its name, as one row group. The same numbers give the same bytes.
///
/// # Errors
/// When the library cannot; `name` is the file's in the message.
pub(crate) fn write(
    name: &str,
    columns: &[(String, Cells<'_>)],
) -> std::result::Result<Vec<u8>, FormatError> {
    let written = file(columns);
    written.map_err(|e| Blame(name).file(e.to_string(), "a table that can be written"))
}

fn file(columns: &[(String, Cells<'_>)]) -> Result<Vec<u8>> {
    let mut properties = WriterProperties::builder()
        .set_created_by(WRITER.into())
        .set_compression(Compression::UNCOMPRESSED)
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::PLAIN)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_offset_index_disabled(true);
    // Where next to nothing moves, this would make a file that is refused as too small for what it holds.
    let whole = columns.iter().filter(|(_, c)| c.is_full_size()).count();
    if columns.len() <= 8 * NUMBERS_A_BYTE * whole {
        for (name, _) in columns.iter().filter(|(_, cells)| cells.is_constant()) {
            let path = ColumnPath::new(vec![name.clone()]);
            properties = properties.set_column_dictionary_enabled(path, true);
        }
    }
    let properties = properties.build();
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, schema(columns)?, Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for (_, cells) in columns {
        let Some(mut column) = group.next_column()? else {
            break;
        };
        match cells {
            Cells::Count(end) => {
                let values: Vec<i64> = (0..*end as i64).collect();
                column
                    .typed::<Int64Type>()
                    .write_batch(&values, None, None)?;
            }
            Cells::All(values) => {
                column
                    .typed::<DoubleType>()
                    .write_batch(values, None, None)?;
            }
            Cells::Some(cells) => {
                let there: Vec<f64> = cells.iter().copied().flatten().collect();
                let levels: Vec<i16> = cells.iter().map(|c| i16::from(c.is_some())).collect();
                let column = column.typed::<DoubleType>();
                column.write_batch(&there, Some(&levels), None)?;
            }
        }
        column.close()?;
    }
    group.close()?;
    file.close()?;
    Ok(bytes)
}

fn schema(columns: &[(String, Cells<'_>)]) -> Result<TypePtr> {
    let fields = columns.iter().map(|(name, cells)| {
        let (kind, repetition) = match cells {
            Cells::Count(_) => (Type::INT64, Repetition::REQUIRED),
            Cells::All(_) => (Type::DOUBLE, Repetition::REQUIRED),
            Cells::Some(_) => (Type::DOUBLE, Repetition::OPTIONAL),
        };
        let column = Element::primitive_type_builder(name, kind).with_repetition(repetition);
        Ok(Arc::new(column.build()?))
    });
    let root = Element::group_type_builder("schema").with_fields(fields.collect::<Result<_>>()?);
    Ok(Arc::new(root.build()?))
}
