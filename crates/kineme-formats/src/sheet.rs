//! Comma-separated tables with a header, read row by row with line numbers.

use std::collections::{HashSet, VecDeque};
use std::io::Read;

use crate::error::{FormatError, Place, Result};

/// A table being read: its header, then its rows.
pub(crate) struct Sheet<R> {
    file: String,
    reader: csv::Reader<LineStarts<R>>,
    header: Vec<String>,
    header_line: usize,
    record: csv::ByteRecord,
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
            reader,
            header: Vec::new(),
            header_line: 1,
            record: csv::ByteRecord::new(),
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
        let mut seen = HashSet::new();
        if let Some(twice) = header.iter().find(|h| !seen.insert(h.as_str())) {
            return Err(row.error(format!("column `{twice}` twice"), "every column once"));
        }
        (sheet.header_line, sheet.header) = (row.line(), header);
        Ok(sheet)
    }

    /// The header's cells, trimmed, each once.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// An error in the header.
    pub fn header_error(&self, found: impl Into<String>, expected: &str) -> FormatError {
        FormatError::new(&self.file, Place::Line(self.header_line), found, expected)
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
        let more = self
            .reader
            .read_byte_record(&mut self.record)
            .map_err(|e| {
                FormatError::new(
                    &self.file,
                    Place::File,
                    e.to_string(),
                    "a comma-separated table",
                )
            })?;
        let start = self.record.position().map_or(0, csv::Position::byte);
        let line = self.reader.get_mut().line_from(start);
        Ok(more.then_some(Row {
            file: &self.file,
            line,
            record: &self.record,
        }))
    }
}

/// Passes bytes on and notes where lines begin: `csv` counts neither empty lines nor CRLF as an editor does.
struct LineStarts<R> {
    inner: R,
    offset: u64,
    line: usize,
    fresh: bool,
    /// Offset of the first byte and number of each line that is not empty, those yet to be asked for.
    starts: VecDeque<(u64, usize)>,
}

impl<R> LineStarts<R> {
    fn new(inner: R) -> Self {
        Self {
            inner,
            offset: 0,
            line: 1,
            fresh: true,
            starts: VecDeque::new(),
        }
    }

    /// The number, from 1, of the first line that is not empty and begins at `offset` or later.
    fn line_from(&mut self, offset: u64) -> usize {
        while self.starts.front().is_some_and(|(at, _)| *at < offset) {
            self.starts.pop_front();
        }
        self.starts.front().map_or(self.line, |(_, line)| *line)
    }
}

impl<R: Read> Read for LineStarts<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(buffer)?;
        for &byte in &buffer[..count] {
            let ends = matches!(byte, b'\n' | b'\r');
            if self.fresh && !ends {
                self.starts.push_back((self.offset, self.line));
            }
            self.fresh = ends;
            self.line += usize::from(byte == b'\n');
            self.offset += 1;
        }
        Ok(count)
    }
}

/// One row of a table.
pub(crate) struct Row<'a> {
    file: &'a str,
    line: usize,
    record: &'a csv::ByteRecord,
}

impl<'a> Row<'a> {
    /// The row's line, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        self.record.len()
    }

    /// An error on this row.
    pub fn error(&self, found: impl Into<String>, expected: impl Into<String>) -> FormatError {
        FormatError::new(self.file, Place::Line(self.line), found, expected)
    }

    /// A cell as text.
    pub fn text(&self, column: usize) -> Result<&'a str> {
        let cell = self.record.get(column).unwrap_or_default();
        std::str::from_utf8(cell).map_err(|_| self.error("bytes that are no text", "UTF-8"))
    }

    /// A cell as a finite number; `None` when it is empty or NaN: missing.
    pub fn number(&self, column: usize) -> Result<Option<f64>> {
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
