//! The pages of one column, checked and unpacked before they are decoded.

use bytes::Bytes;
use parquet::basic::{Compression, Encoding};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};

use super::thrift::{FALSE, STRUCT, TRUE, Thrift};

/// Where the pages of a column of a row group are, and what they may hold.
pub(super) struct Pages {
    /// The column's bytes from the next page on.
    pub bytes: Bytes,
    pub compression: Compression,
    /// Bytes a value.
    pub width: usize,
    /// Whether values may be missing.
    pub optional: bool,
    /// Values, missing ones too, that are yet to come.
    pub rows: usize,
    /// Whether the dictionary was there.
    pub dictionary: bool,
}

/// The head of a page, fields by their numbers.
#[derive(Default)]
struct Head {
    fields: [Option<i64>; 4],
    /// The fields of what belongs to its kind of page, and the field that this is.
    special: Option<(i64, [Option<i64>; 9])>,
}

const DATA: i64 = 0;
const INDEX: i64 = 1;
const DICTIONARY: i64 = 2;
const DATA_V2: i64 = 3;

fn wrong(what: impl Into<String>) -> ParquetError {
    ParquetError::General(what.into())
}

fn damaged() -> ParquetError {
    wrong("a damaged head of a page")
}

impl Head {
    fn read(bytes: &[u8]) -> Option<(Self, usize)> {
        let mut head = Self::default();
        let mut reader = Thrift::new(bytes);
        reader.structure(|page, field, kind| {
            match (field, kind) {
                (1..=3, 5) => head.fields[field as usize] = Some(page.int()?),
                (5 | 7 | 8, STRUCT) => {
                    let mut inner = [None; 9];
                    page.structure(|special, field, kind| match (field, kind) {
                        (1..=8, 4..=6) => {
                            inner[field as usize] = Some(special.int()?);
                            Some(())
                        }
                        (1..=8, TRUE | FALSE) => {
                            inner[field as usize] = Some(i64::from(kind == TRUE));
                            Some(())
                        }
                        _ => special.skip(kind),
                    })?;
                    head.special = Some((field, inner));
                }
                _ => page.skip(kind)?,
            }
            Some(())
        })?;
        Some((head, reader.at()))
    }

    /// A size or a number of things.
    fn size(&self, field: usize) -> Result<usize> {
        let size = self.fields[field].and_then(|v| u32::try_from(v).ok());
        size.map(|v| v as usize).ok_or_else(damaged)
    }
}

/// A field of a page's own head that is a size or a number of things.
fn size(special: &[Option<i64>; 9], field: usize) -> Result<u32> {
    let size = special[field].and_then(|v| u32::try_from(v).ok());
    size.ok_or_else(damaged)
}

impl Pages {
    fn next_page(&mut self) -> Result<Option<Page>> {
        while !self.bytes.is_empty() && self.rows > 0 {
            let (head, length) = Head::read(&self.bytes).ok_or_else(damaged)?;
            let packed = head.size(3)?;
            let mut body = self.bytes.split_off(length);
            if packed > body.len() {
                return Err(wrong("the end in the middle of a page"));
            }
            self.bytes = body.split_off(packed);
            let page = match (head.fields[1], &head.special) {
                (Some(DATA), Some((5, special))) => self.data(&head, special, body)?,
                (Some(DATA_V2), Some((8, special))) => self.data_v2(&head, special, body)?,
                (Some(DICTIONARY), Some((7, special))) => self.values(&head, special, body)?,
                (Some(INDEX), _) => continue,
                _ => return Err(damaged()),
            };
            // The library takes a page without values for the end.
            if page.num_values() > 0 || page.is_dictionary_page() {
                return Ok(Some(page));
            }
        }
        Ok(None)
    }

    /// The values of the dictionary.
    fn values(&mut self, head: &Head, special: &[Option<i64>; 9], body: Bytes) -> Result<Page> {
        let count = size(special, 1)?;
        // No column needs more different values than it has rows.
        if self.dictionary || count as usize > self.rows {
            return Err(wrong("a dictionary that cannot be the column's"));
        }
        self.dictionary = true;
        let buf = self.unpacked(body, head.size(2)?, self.width * count as usize)?;
        if buf.len() != self.width * count as usize {
            return Err(wrong("a dictionary of another size than it says"));
        }
        Ok(Page::DictionaryPage {
            buf,
            num_values: count,
            encoding: Encoding::PLAIN,
            is_sorted: false,
        })
    }

    fn data(&mut self, head: &Head, special: &[Option<i64>; 9], body: Bytes) -> Result<Page> {
        let num_values = self.rows_of(size(special, 1)?)?;
        let encoding = self.encoding(special[2])?;
        const RLE: i64 = Encoding::RLE as i64;
        if self.optional && special[3] != Some(RLE) {
            return Err(wrong("marks of missing values in the old, bit-packed way"));
        }
        let mut buf = self.unpacked(body, head.size(2)?, most(num_values))?;
        if encoding == Encoding::BYTE_STREAM_SPLIT {
            let marks = match (self.optional, buf.first_chunk()) {
                (false, _) => 0,
                (true, Some(length)) => 4usize.saturating_add(u32::from_le_bytes(*length) as usize),
                (true, None) => usize::MAX,
            };
            let (marks, values) = buf.split_at_checked(marks).ok_or_else(damaged)?;
            buf = [marks, &self.joined(values)].concat().into();
        }
        Ok(Page::DataPage {
            buf,
            num_values,
            encoding: decoded_as(encoding),
            def_level_encoding: Encoding::RLE,
            rep_level_encoding: Encoding::RLE,
            statistics: None,
        })
    }

    fn data_v2(&mut self, head: &Head, special: &[Option<i64>; 9], body: Bytes) -> Result<Page> {
        let num_values = self.rows_of(size(special, 1)?)?;
        let (num_nulls, num_rows) = (size(special, 2)?, size(special, 3)?);
        let encoding = self.encoding(special[4])?;
        let (def, rep) = (size(special, 5)?, size(special, 6)?);
        let levels = def as usize + rep as usize;
        let size = head.size(2)?;
        if levels > body.len() || levels > size || num_nulls > num_values || num_rows != num_values
        {
            return Err(damaged());
        }
        // What marks the missing values is never compressed, here.
        let (marks, values) = (body.slice(..levels), body.slice(levels..));
        let values = match special[7] {
            Some(0) => values,
            _ if size == levels => Bytes::new(),
            _ => self.unpacked(values, size - levels, most(num_values))?,
        };
        let values = match encoding {
            Encoding::BYTE_STREAM_SPLIT => self.joined(&values).into(),
            _ => values,
        };
        Ok(Page::DataPageV2 {
            buf: [marks, values].concat().into(),
            num_values,
            encoding: decoded_as(encoding),
            num_nulls,
            num_rows,
            def_levels_byte_len: def,
            rep_levels_byte_len: rep,
            is_compressed: false,
            statistics: None,
        })
    }

    /// Values whose first bytes stand together, and so on, each in one piece. The library does so, too, but trusts that
    /// there are as many as it wants.
    fn joined(&self, split: &[u8]) -> Vec<u8> {
        let count = split.len() / self.width;
        let value = |i| (0..self.width).map(move |byte| split[byte * count + i]);
        (0..count).flat_map(value).collect()
    }

    /// Counts the rows of a page.
    fn rows_of(&mut self, count: u32) -> Result<u32> {
        let left = self.rows.checked_sub(count as usize);
        self.rows = left.ok_or_else(|| wrong("more values than rows"))?;
        Ok(count)
    }

    /// The encoding of values. Of those that numbers have, DELTA_BINARY_PACKED is left out: the library's decoder of it
    /// runs out of its buffer where a page says that it is empty. Whole numbers have it where somebody asked for it.
    fn encoding(&self, found: Option<i64>) -> Result<Encoding> {
        let is = |encoding: Encoding| found == Some(encoding as i64);
        if is(Encoding::PLAIN) {
            Ok(Encoding::PLAIN)
        } else if is(Encoding::BYTE_STREAM_SPLIT) {
            Ok(Encoding::BYTE_STREAM_SPLIT)
        } else if !is(Encoding::RLE_DICTIONARY) && !is(Encoding::PLAIN_DICTIONARY) {
            let name = match is(Encoding::DELTA_BINARY_PACKED) {
                true => "the encoding DELTA_BINARY_PACKED",
                false => "another encoding",
            };
            Err(wrong(format!(
                "{name}, where plain, split and dictionaries can be read,"
            )))
        } else if self.dictionary {
            Ok(Encoding::RLE_DICTIONARY)
        } else {
            Err(wrong("no dictionary"))
        }
    }

    /// A page's bytes, which are to be so many, and may be at most `most`.
    fn unpacked(&self, body: Bytes, size: usize, most: usize) -> Result<Bytes> {
        let found = match self.compression {
            Compression::UNCOMPRESSED => body.len(),
            _ => snap::raw::decompress_len(&body).map_err(|e| wrong(e.to_string()))?,
        };
        if found != size || size > most {
            return Err(wrong("a page of another size than it says"));
        }
        match self.compression {
            Compression::UNCOMPRESSED => Ok(body),
            _ => {
                let unpacked = snap::raw::Decoder::new().decompress_vec(&body);
                Ok(unpacked.map_err(|e| wrong(e.to_string()))?.into())
            }
        }
    }
}

/// What the library is told: split values come joined.
fn decoded_as(encoding: Encoding) -> Encoding {
    match encoding {
        Encoding::BYTE_STREAM_SPLIT => Encoding::PLAIN,
        other => other,
    }
}

/// Bytes that no way to write so many numbers comes near: 8 of the number itself and 4 of its place in a dictionary.
fn most(values: u32) -> usize {
    16 * values as usize + 1024
}

impl Iterator for Pages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_page().transpose()
    }
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        self.next_page()
    }

    // Asked for only where rows are skipped or values are lists.
    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        Err(wrong("pages that are read in order"))
    }

    fn skip_next_page(&mut self) -> Result<()> {
        Err(wrong("pages that are read in order"))
    }
}
