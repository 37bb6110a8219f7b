//! Marks: spans of motions cut by hand, a CSV of `file,start,end` and optionally `recording`.

use crate::error::{FormatError, Place, Result};
use crate::sheet::{Sheet, quoted};

/// A span of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// The motion, named as the user names inputs: `set.zip/inner/a.bvh` included.
    pub file: String,
    /// Seconds from the motion's start, not negative.
    pub start: f64,
    /// Seconds from the motion's start, after `start`.
    pub end: f64,
    /// Spans of one recording follow each other in the order of the rows; `None`: the file is the recording.
    pub recording: Option<String>,
    /// The line it stands on, from 1, for errors found later.
    pub line: usize,
}

const HEADER: &str = "columns `file`, `start`, `end` and optionally `recording`";

/// Reads marks in the order of the rows.
///
/// # Errors
/// When a column is missing, unknown or repeated, a file is not named, a time is missing or no finite number,
/// `start` is negative or `end` not after it; when there is no mark at all.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Vec<Mark>> {
    let mut sheet = Sheet::open(name, bytes, HEADER)?;
    let mut columns = [None; 4];
    const NAMES: [&str; 4] = ["file", "start", "end", "recording"];
    for (column, cell) in sheet.header().iter().enumerate() {
        match NAMES.iter().position(|n| n == cell) {
            Some(which) => columns[which] = Some(column),
            None => return Err(sheet.header_error(quoted(cell), HEADER)),
        }
    }
    let [Some(file), Some(start), Some(end), recording] = columns else {
        let found = quoted(&sheet.header().join(","));
        return Err(sheet.header_error(found, HEADER));
    };

    let mut marks = Vec::new();
    while let Some(row) = sheet.next_row()? {
        let span = row.span(start, end)?;
        let (start, end) = span.ok_or_else(|| row.error("no start", "a span in seconds"))?;
        marks.push(Mark {
            file: row.motion(file)?,
            start,
            end,
            recording: match recording.map(|c| row.text(c)).transpose()? {
                None | Some("") => None,
                Some(name) => Some(name.to_string()),
            },
            line: row.line(),
        });
    }
    if marks.is_empty() {
        return Err(FormatError::new(
            name,
            Place::File,
            "no mark",
            "at least one row",
        ));
    }
    Ok(marks)
}
