//! From a Parquet file to columns of numbers.

use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::{
    ColumnChunkMetaData, ParquetMetaData, ParquetMetaDataOptions, ParquetMetaDataReader,
    ParquetStatisticsPolicy,
};
use parquet::schema::types::ColumnDescriptor;

use super::pages::Pages;
use super::{footer, is_index};
use crate::error::Result;
use crate::sheet::quoted;
use crate::text::Blame;

/// Numbers that a byte of the file may stand for. A column that never changes is written once, whatever its length: a
/// table of a body at rest has 17 numbers a byte. The factor, 200 bytes of numbers a byte, is that of archives.
pub(super) const NUMBERS_A_BYTE: usize = 25;
/// Numbers that a file may hold however small it is.
const ALWAYS_ALLOWED: usize = 1 << 16;

/// A table of numbers.
#[derive(Debug, Default)]
pub(crate) struct Table {
    /// The columns' names, trimmed.
    pub names: Vec<String>,
    /// The columns' numbers, as many as there are rows; NaN where one is missing.
    pub columns: Vec<Vec<f64>>,
    /// The number of rows.
    pub rows: usize,
    /// Sentences for people.
    pub warnings: Vec<String>,
}

/// Reads a table of the file `name`. An index of pandas is left out, with a warning.
///
/// # Errors
/// When the file is damaged, encrypted or compressed otherwise than by Snappy; when a column holds anything but numbers,
/// or the rows are out of all proportion to the file's size.
pub(crate) fn read(name: &str, bytes: &[u8]) -> Result<Table> {
    let blame = Blame(name);
    // The library's decoders assert what damaged bytes do not keep. What they panic at is in their own memory alone,
    // which is dropped, and a damaged file must be an error. No such file is known, fuzzing goes on.
    catch_unwind(AssertUnwindSafe(|| parsed(blame, bytes)))
        .unwrap_or_else(|_| Err(blame.file("bytes that make no sense", "a sound Parquet file")))
}

fn parsed(blame: Blame<'_>, bytes: &[u8]) -> Result<Table> {
    let cut_off = "a Parquet file that is damaged or was cut off";
    let whole = || blame.file(cut_off, "a whole one: its columns stand at its end");
    if bytes.ends_with(b"PARE") {
        return Err(blame.file("an encrypted Parquet file", "one that is not encrypted"));
    }
    let footer = footer::cut(bytes).ok_or_else(whole)?;
    let schema = footer::schema(footer).ok_or_else(whole)?;
    if let Some(column) = &schema.nested {
        return Err(strange(blame, column, "columns in it"));
    }
    let mut options = ParquetMetaDataOptions::new();
    options.set_column_stats_policy(ParquetStatisticsPolicy::SkipAll);
    options.set_size_stats_policy(ParquetStatisticsPolicy::SkipAll);
    options.set_encoding_stats_policy(ParquetStatisticsPolicy::SkipAll);
    let file = ParquetMetaDataReader::decode_metadata_with_options(footer, Some(&options));
    let file = file.map_err(|e| blame.file(told(e), "a sound Parquet file"))?;
    let rows = rows(&file).ok_or_else(whole)?;
    let columns = schema.names.len();
    if file.file_metadata().schema_descr().num_columns() != columns {
        return Err(whole());
    }
    let allowed = bytes.len().saturating_mul(NUMBERS_A_BYTE) + ALWAYS_ALLOWED;
    if rows.iter().sum::<usize>().saturating_mul(columns) > allowed {
        return Err(blame.file(
            format!(
                "{columns} columns of {} rows in only {} bytes",
                rows.iter().sum::<usize>(),
                bytes.len()
            ),
            "a file whose rows have numbers of their own",
        ));
    }
    let mut table = Table {
        rows: rows.iter().sum(),
        ..Table::default()
    };
    for (at, name) in schema.names.into_iter().enumerate() {
        if is_index(&name) {
            let told = format!("column `{name}` is an index of pandas and was ignored");
            table.warnings.push(told);
            continue;
        }
        let mut values = Vec::with_capacity(table.rows);
        for (group, &rows) in file.row_groups().iter().zip(&rows) {
            let chunk = group.columns().get(at).ok_or_else(whole)?;
            number_of(chunk.column_descr()).map_err(|found| strange(blame, &name, found))?;
            column(bytes, chunk, rows, &mut values).map_err(|e| {
                let found = format!("{} in column {}", told(e), quoted(&name));
                blame.file(found, "a sound Parquet file")
            })?;
        }
        table.names.push(name);
        table.columns.push(values);
    }
    Ok(table)
}

/// The rows of each group.
fn rows(file: &ParquetMetaData) -> Option<Vec<usize>> {
    let groups = file.row_groups().iter();
    let rows: Option<Vec<usize>> = groups.map(|g| usize::try_from(g.num_rows()).ok()).collect();
    let rows = rows?;
    let sum = rows.iter().try_fold(0usize, |sum, &r| sum.checked_add(r))?;
    (usize::try_from(file.file_metadata().num_rows()) == Ok(sum)).then_some(rows)
}

fn strange(blame: Blame<'_>, column: &str, found: &str) -> crate::FormatError {
    blame.file(
        format!("column {} with {found}", quoted(column)),
        "columns of numbers: DOUBLE, FLOAT, INT64 or INT32",
    )
}

/// What the library says, without its preface.
fn told(error: ParquetError) -> String {
    match error {
        ParquetError::General(text) | ParquetError::EOF(text) | ParquetError::NYI(text) => text,
        other => other.to_string(),
    }
}

/// Whether a column's integers have no sign; an error that says what it holds where these are no numbers.
fn number_of(column: &ColumnDescriptor) -> std::result::Result<bool, &'static str> {
    if column.max_rep_level() > 0 || column.max_def_level() > 1 || column.path().parts().len() > 1 {
        return Err("several values a row");
    }
    let integer = matches!(column.physical_type(), Type::INT32 | Type::INT64);
    match (column.physical_type(), column.logical_type_ref()) {
        (Type::BYTE_ARRAY, _) => Err("texts"),
        (Type::BOOLEAN, _) => Err("truths"),
        (Type::FIXED_LEN_BYTE_ARRAY, Some(LogicalType::Float16)) => Err("numbers of 16 bits"),
        (Type::FIXED_LEN_BYTE_ARRAY | Type::INT96, _) => Err("other things than numbers"),
        // A column of which nothing is there.
        (_, Some(LogicalType::Unknown)) => Ok(false),
        (_, Some(LogicalType::Integer(_)) | None) => match column.converted_type() {
            ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64 => Ok(true),
            ConvertedType::NONE
            | ConvertedType::INT_8
            | ConvertedType::INT_16
            | ConvertedType::INT_32
            | ConvertedType::INT_64 => Ok(false),
            _ => Err("dates, times or decimals"),
        },
        _ if integer => Err("dates, times or decimals"),
        _ => Err("other things than numbers"),
    }
}

/// Appends the numbers of a column of a row group.
fn column(
    bytes: &[u8],
    chunk: &ColumnChunkMetaData,
    rows: usize,
    values: &mut Vec<f64>,
) -> std::result::Result<(), ParquetError> {
    let wrong = |what: &str| ParquetError::General(what.into());
    let compression = chunk.compression();
    if !matches!(compression, Compression::UNCOMPRESSED | Compression::SNAPPY) {
        let name = chunk.compression_codec();
        return Err(wrong(&format!(
            "{name:?} compression, where Snappy or none can be read,"
        )));
    }
    // Some old writers say 0 where there is no dictionary.
    let dictionary = chunk.dictionary_page_offset().filter(|at| *at > 0);
    let start = dictionary.unwrap_or(chunk.data_page_offset());
    let range = usize::try_from(start)
        .ok()
        .zip(usize::try_from(chunk.compressed_size()).ok())
        .and_then(|(start, length)| bytes.get(start..start.checked_add(length)?));
    let range = range.ok_or_else(|| wrong("pages outside of the file"))?;
    let column = chunk.column_descr_ptr();
    let unsigned = number_of(&column).map_err(wrong)?;
    let optional = column.max_def_level() > 0;
    let pages = Pages {
        bytes: Bytes::copy_from_slice(range),
        compression,
        width: match column.physical_type() {
            Type::INT32 | Type::FLOAT => 4,
            _ => 8,
        },
        optional,
        rows,
        dictionary: false,
    };
    let reader = get_column_reader(column, Box::new(pages));
    let read = match reader {
        ColumnReader::DoubleColumnReader(r) => decoded(r, rows, optional, |v| v, values),
        ColumnReader::FloatColumnReader(r) => decoded(r, rows, optional, f64::from, values),
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            decoded(r, rows, optional, |v| f64::from(v.cast_unsigned()), values)
        }
        ColumnReader::Int32ColumnReader(r) => decoded(r, rows, optional, f64::from, values),
        ColumnReader::Int64ColumnReader(r) if unsigned => {
            decoded(r, rows, optional, |v| v.cast_unsigned() as f64, values)
        }
        ColumnReader::Int64ColumnReader(r) => decoded(r, rows, optional, |v| v as f64, values),
        _ => Err(wrong("other things than numbers")),
    };
    read.and_then(|read| match read == rows {
        true => Ok(()),
        false => Err(wrong(&format!("{read} values in place of {rows}"))),
    })
}

/// Appends the values that a reader gives, at most `rows`; how many they are.
fn decoded<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    optional: bool,
    number: impl Fn(T::T) -> f64,
    values: &mut Vec<f64>,
) -> std::result::Result<usize, ParquetError> {
    let (mut there, mut levels) = (Vec::new(), Vec::new());
    let (read, ..) = reader.read_records(rows, Some(&mut levels), None, &mut there)?;
    let mut there = there.into_iter().map(number);
    match optional {
        false => values.extend(there),
        true => values.extend(levels.iter().map(|&level| match level {
            1 => there.next().unwrap_or(f64::NAN),
            _ => f64::NAN,
        })),
    }
    Ok(read)
}
