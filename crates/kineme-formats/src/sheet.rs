//! Tables with named columns, read row by row: comma-separated text with line numbers, or Parquet.

use std::collections::HashSet;
use std::io::Read;

use crate::error::{FormatError, Place, Result, told};
use crate::parquet;
use crate::stream::{LineStarts, Peeked};

/// A table being read: its header, then its rows.
pub(crate) struct Sheet<R> {
    file: String,
    header: Vec<String>,
    header_place: Place,
    rows: Rows<R>,
    warnings: Vec<String>,
}

/// Where rows come from.
enum Rows<R> {
    Text {
        reader: Box<csv::Reader<LineStarts<R>>>,
        record: csv::ByteRecord,
    },
    Numbers {
        table: parquet::Table,
        next: usize,
    },
}

/// The place of a table's header.
pub(crate) fn header_place(bytes: &[u8]) -> Place {
    match parquet::begins(bytes) {
        true => Place::File,
        false => Place::Line(1),
    }
}

/// The size in bytes that a table of numbers has as text, about: a number takes 8 bytes in Parquet and up to 20 in text.
pub(crate) fn size_as_text(bytes: &[u8]) -> usize {
    match parquet::begins(bytes) {
        true => bytes.len().saturating_mul(2),
        false => bytes.len(),
    }
}

impl<R: Read> Sheet<Peeked<R>> {
    /// Opens a table of numbers: Parquet, which is read to its end, or text as [`Sheet::open`] does.
    pub fn open_numbers(file: &str, reader: R, expected: &str) -> Result<Self> {
        let failed = |e| FormatError::new(file, Place::File, told(&e), "a readable table");
        let mut reader = Peeked::new(reader, b"PAR1").map_err(failed)?;
        if !parquet::begins(reader.head()) {
            return Self::open(file, reader, expected);
        }
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).map_err(failed)?;
        let mut table = parquet::read(file, &bytes)?;
        let header = std::mem::take(&mut table.names);
        let error = |found: String, expected: &str| {
            Err(FormatError::new(file, Place::File, found, expected))
        };
        if header.is_empty() {
            return error("no column".into(), expected);
        }
        if let Some(twice) = twice(&header) {
            return error(format!("column `{twice}` twice"), "every column once");
        }
        Ok(Self {
            file: file.to_string(),
            header,
            header_place: Place::File,
            warnings: std::mem::take(&mut table.warnings),
            rows: Rows::Numbers { table, next: 0 },
        })
    }
}

/// A name that stands in a header more than once.
fn twice(header: &[String]) -> Option<&String> {
    let mut seen = HashSet::new();
    header.iter().find(|h| !seen.insert(h.as_str()))
}

impl<R: Read> Sheet<R> {
    /// Reads the header. Spaces round cells and a byte order mark are dropped; `expected` describes the
    /// header for the error of an empty file.
    pub fn open(file: &str, reader: R, expected: &str) -> Result<Self> {
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(LineStarts::new(reader));
        let mut sheet = Self {
            file: file.to_string(),
            header: Vec::new(),
            header_place: Place::Line(1),
            rows: Rows::Text {
                reader: Box::new(reader),
                record: csv::ByteRecord::new(),
            },
            warnings: Vec::new(),
        };
        let Some(row) = sheet.read()? else {
            return Err(FormatError::new(
                file,
                Place::File,
                "nothing in the file",
                expected,
            ));
        };
        let header = (0..row.len())
            .map(|i| row.text(i).map(str::to_string))
            .collect::<Result<Vec<_>>>()?;
        if let Some(twice) = twice(&header) {
            return Err(row.error(format!("column `{twice}` twice"), "every column once"));
        }
        (sheet.header_place, sheet.header) = (row.place, header);
        Ok(sheet)
    }

    /// The header's cells, trimmed, each once.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// An error in the header.
    pub fn header_error(&self, found: impl Into<String>, expected: &str) -> FormatError {
        FormatError::new(&self.file, self.header_place, found, expected)
    }

    /// What there is to tell people of the table.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The next row, with as many cells as the header; `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>> {
        let columns = self.header.len();
        let Some(row) = self.read()? else {
            return Ok(None);
        };
        if row.len() != columns {
            return Err(row.error(
                format!("{} cells", row.len()),
                format!("{columns}, as in the header"),
            ));
        }
        Ok(Some(row))
    }

    fn read(&mut self) -> Result<Option<Row<'_>>> {
        let file = &self.file;
        match &mut self.rows {
            Rows::Text { reader, record } => {
                let more = reader.read_byte_record(record).map_err(|e| {
                    let expected = "a comma-separated table";
                    FormatError::new(file, Place::File, e.to_string(), expected)
                })?;
                let start = record.position().map_or(0, csv::Position::byte);
                let place = Place::Line(reader.get_mut().line_from(start));
                let cells = Cells::Text(record);
                Ok(more.then_some(Row { file, place, cells }))
            }
            Rows::Numbers { table, next } => {
                let row = *next;
                *next += 1;
                let cells = Cells::Numbers {
                    header: &self.header,
                    table,
                    row,
                };
                let place = Place::Row(row + 1);
                Ok((row < table.rows).then_some(Row { file, place, cells }))
            }
        }
    }
}

/// One row of a table.
pub(crate) struct Row<'a> {
    file: &'a str,
    place: Place,
    cells: Cells<'a>,
}

enum Cells<'a> {
    Text(&'a csv::ByteRecord),
    Numbers {
        header: &'a [String],
        table: &'a parquet::Table,
        row: usize,
    },
}

impl<'a> Row<'a> {
    /// The row's line, from 1, or its number where a table has no lines.
    pub fn line(&self) -> usize {
        match self.place {
            Place::Line(line) | Place::Row(line) => line,
            Place::Byte(_) | Place::File => 1,
        }
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        match self.cells {
            Cells::Text(record) => record.len(),
            Cells::Numbers { header, .. } => header.len(),
        }
    }

    /// An error on this row.
    pub fn error(&self, found: impl Into<String>, expected: impl Into<String>) -> FormatError {
        FormatError::new(self.file, self.place, found, expected)
    }

    /// A cell as text.
    pub fn text(&self, column: usize) -> Result<&'a str> {
        let Cells::Text(record) = self.cells else {
            return Err(self.error("a number", "a text"));
        };
        let cell = record.get(column).unwrap_or_default();
        std::str::from_utf8(cell).map_err(|_| self.error("bytes that are no text", "UTF-8"))
    }

    /// A cell as a finite number; `None` when it is empty, null or NaN: missing.
    pub fn number(&self, column: usize) -> Result<Option<f64>> {
        if let Cells::Numbers { header, table, row } = self.cells {
            let value = table.columns[column][row];
            if value.is_infinite() {
                let found = format!("{value} in column {}", quoted(&header[column]));
                return Err(self.error(found, "a finite number, or nothing"));
            }
            return Ok((!value.is_nan()).then_some(value));
        }
        let text = self.text(column)?;
        if text.is_empty() || text.eq_ignore_ascii_case("nan") {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(self.error(quoted(text), "a finite number, or nothing")),
        }
    }

    /// A cell as a finite number that must be there; `what` names it in the error.
    pub fn required(&self, column: usize, what: &str) -> Result<f64> {
        self.number(column)?
            .ok_or_else(|| self.error(format!("no {what}"), "a finite number"))
    }

    /// A cell that names a motion.
    pub fn motion(&self, column: usize) -> Result<String> {
        let name = self.text(column)?;
        if name.is_empty() {
            return Err(self.error("no file", "the name of a motion"));
        }
        Ok(name.to_string())
    }

    /// Cells of a span of time in seconds: none, or a start of 0 or more and an end after it.
    pub fn span(&self, start: usize, end: usize) -> Result<Option<(f64, f64)>> {
        if self.number(start)?.is_none() && self.number(end)?.is_none() {
            return Ok(None);
        }
        let (start, end) = (self.required(start, "start")?, self.required(end, "end")?);
        if start < 0.0 {
            return Err(self.error(format!("start {start}"), "0 or more seconds"));
        }
        if end <= start {
            let found = format!("end {end} not after start {start}");
            return Err(self.error(found, "an end after the start"));
        }
        Ok(Some((start, end)))
    }
}

/// The first cells of a table that starts with these bytes, at most `count`, as text: to tell tables apart.
pub(crate) fn first_cells(head: &[u8], count: usize) -> Vec<String> {
    let text = String::from_utf8_lossy(head);
    let line = text.trim_start_matches('\u{feff}').trim_start();
    let line = line.lines().next().unwrap_or_default();
    line.split(',')
        .take(count)
        .map(|cell| cell.trim().trim_matches('"').to_string())
        .collect()
}

/// A piece of a file for a message: quoted, and cut when it is long.
pub(crate) fn quoted(text: &str) -> String {
    const SHOWN: usize = 60;
    if text.chars().count() <= SHOWN {
        return format!("`{text}`");
    }
    let start: String = text.chars().take(SHOWN).collect();
    format!("`{start}...`")
}
