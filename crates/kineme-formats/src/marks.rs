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
    let header_error = |found: String| FormatError::new(name, Place::Line(1), found, HEADER);
    let mut columns = [None; 4];
    const NAMES: [&str; 4] = ["file", "start", "end", "recording"];
    for (column, cell) in sheet.header().iter().enumerate() {
        match NAMES.iter().position(|n| n == cell) {
            Some(which) => columns[which] = Some(column),
            None => return Err(header_error(quoted(cell))),
        }
    }
    let [Some(file), Some(start), Some(end), recording] = columns else {
        return Err(header_error(quoted(&sheet.header().join(","))));
    };

    let mut marks = Vec::new();
    while let Some(row) = sheet.next_row()? {
        let mark = Mark {
            file: row.text(file)?.to_string(),
            start: row.required(start, "start")?,
            end: row.required(end, "end")?,
            recording: match recording.map(|c| row.text(c)).transpose()? {
                None | Some("") => None,
                Some(name) => Some(name.to_string()),
            },
            line: row.line(),
        };
        if mark.file.is_empty() {
            return Err(row.error("no file", "the name of a motion"));
        }
        if mark.start < 0.0 {
            return Err(row.error(format!("start {}", mark.start), "0 or more seconds"));
        }
        if mark.end <= mark.start {
            return Err(row.error(
                format!("end {} not after start {}", mark.end, mark.start),
                "an end after the start",
            ));
        }
        marks.push(mark);
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
