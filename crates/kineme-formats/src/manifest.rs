//! Manifests: labelled motions, or spans of them, a CSV of `file,label` and optionally `start,end,rate,p1,p2,...`.
//!
//! ```csv
//! file,label,start,end,rate,p1,p2
//! takes/jabs.bvh,jab,0.5,1.2,,0.9,-0.2
//! takes/jabs.bvh,jab,1.6,2.3,,0.4,0.1
//! set.zip/inner/wave.amc,wave,,,120,,
//! takes/swim.bvh,,,,,,
//! ```
//!
//! Columns stand in any order, but `p1`, `p2`, ... from left to right without gaps. Empty cells say nothing: no span
//! is the whole motion, no rate the file's own. A row without a label is a negative: none of the movements named.

use std::collections::HashMap;

use crate::error::{FormatError, Place, Result};
use crate::sheet::{Row, Sheet, quoted};

/// A labelled motion, or a span of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Labelled {
    /// The motion, named as the user names inputs: `set.zip/inner/a.bvh` included.
    pub file: String,
    /// What it is an example of; `None`: of none of the labels, a negative.
    pub label: Option<String>,
    /// Its start and end in the motion, seconds, not negative, the end after the start; `None`: all of it.
    pub span_secs: Option<(f64, f64)>,
    /// Frames a second of a file that does not say it itself, positive; rows of one file agree.
    pub rate_hz: Option<f64>,
    /// The adverbs `p1`, `p2`, ... in their own units; empty where none are given. Rows of one label have as many.
    pub parameters: Vec<f64>,
    /// The line it stands on, from 1, for errors found later.
    pub line: usize,
}

const HEADER: &str =
    "columns `file`, `label` and optionally `start`, `end`, `rate`, `p1`, `p2`, ...";

/// Which columns hold what.
struct Columns {
    file: usize,
    label: usize,
    span: Option<(usize, usize)>,
    rate: Option<usize>,
    parameters: Vec<usize>,
}

impl Columns {
    /// Reads a header; what is wrong with it, else.
    fn of(header: &[String]) -> std::result::Result<Self, String> {
        const NAMES: [&str; 5] = ["file", "label", "start", "end", "rate"];
        let mut known = [None; 5];
        let mut parameters = Vec::new();
        for (column, cell) in header.iter().enumerate() {
            if let Some(which) = NAMES.iter().position(|n| n == cell) {
                known[which] = Some(column);
            } else if *cell == format!("p{}", parameters.len() + 1) {
                parameters.push(column);
            } else {
                return Err(format!("column {}", quoted(cell)));
            }
        }
        let [file, label, start, end, rate] = known;
        let span = match (start, end) {
            (Some(start), Some(end)) => Some((start, end)),
            (None, None) => None,
            (Some(_), None) => return Err("column `start` without `end`".into()),
            (None, Some(_)) => return Err("column `end` without `start`".into()),
        };
        Ok(Self {
            file: file.ok_or("no column `file`")?,
            label: label.ok_or("no column `label`")?,
            span,
            rate,
            parameters,
        })
    }

    fn read(&self, row: &Row<'_>) -> Result<Labelled> {
        let span = self.span.map(|(start, end)| row.span(start, end));
        let rate_hz = self.rate.map_or(Ok(None), |column| row.number(column))?;
        if let Some(rate) = rate_hz.filter(|r| *r <= 0.0) {
            return Err(row.error(format!("rate {rate}"), "hertz above 0"));
        }
        Ok(Labelled {
            file: row.motion(self.file)?,
            label: Some(row.text(self.label)?)
                .filter(|l| !l.is_empty())
                .map(str::to_string),
            span_secs: span.transpose()?.flatten(),
            rate_hz,
            parameters: self.parameters(row)?,
            line: row.line(),
        })
    }

    /// The parameters given, which leave none out before the last.
    fn parameters(&self, row: &Row<'_>) -> Result<Vec<f64>> {
        let cells = self.parameters.iter().map(|&column| row.number(column));
        let cells: Vec<Option<f64>> = cells.collect::<Result<_>>()?;
        let given = cells.iter().rposition(Option::is_some).map_or(0, |i| i + 1);
        let cells = cells.into_iter().take(given).enumerate();
        cells
            .map(|(i, cell)| {
                let found = format!("p{given} without p{}", i + 1);
                cell.ok_or_else(|| row.error(found, "parameters from p1 on"))
            })
            .collect()
    }
}

/// Reads a manifest in the order of the rows.
///
/// # Errors
/// When a column is missing, unknown, repeated or, of `p1`, `p2`, ..., out of order; when a file is not named, a
/// number is not finite, only one of start and end is given, a start is negative or its end not after it, a rate is
/// not positive or not that of the same file's rows before; when parameters have gaps, are not as many as in the
/// label's rows before, or stand in a row without a label; when there is no row at all.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Vec<Labelled>> {
    let mut sheet = Sheet::open(name, bytes, HEADER)?;
    let columns = Columns::of(sheet.header()).map_err(|found| sheet.header_error(found, HEADER))?;
    let mut rows: Vec<Labelled> = Vec::new();
    let mut first_of_label: HashMap<String, usize> = HashMap::new();
    let mut first_of_file: HashMap<String, usize> = HashMap::new();
    while let Some(row) = sheet.next_row()? {
        let read = columns.read(&row)?;
        let at = rows.len();
        match &read.label {
            Some(label) => {
                let first = *first_of_label.entry(label.clone()).or_insert(at);
                if let Some(first) = rows.get(first) {
                    same_parameters(&row, &read, first)?;
                }
            }
            None if !read.parameters.is_empty() => {
                return Err(row.error("p1 without a label", "parameters of labelled motions"));
            }
            None => {}
        }
        let first = *first_of_file.entry(read.file.clone()).or_insert(at);
        if let Some(first) = rows.get(first) {
            same_rate(&row, &read, first)?;
        }
        rows.push(read);
    }
    if rows.is_empty() {
        let expected = "at least one row";
        return Err(FormatError::new(name, Place::File, "no motion", expected));
    }
    Ok(rows)
}

fn same_parameters(row: &Row<'_>, read: &Labelled, first: &Labelled) -> Result<()> {
    let (found, expected) = (read.parameters.len(), first.parameters.len());
    if found == expected {
        return Ok(());
    }
    let label = quoted(read.label.as_deref().unwrap_or_default());
    Err(row.error(
        format!("{found} parameters of {label}"),
        format!("{expected}, as in line {}", first.line),
    ))
}

fn same_rate(row: &Row<'_>, read: &Labelled, first: &Labelled) -> Result<()> {
    if read.rate_hz == first.rate_hz {
        return Ok(());
    }
    let told = |rate: Option<f64>| rate.map_or("no rate".to_string(), |r| format!("rate {r}"));
    Err(row.error(
        format!("{} of {}", told(read.rate_hz), quoted(&read.file)),
        format!("{}, as in line {}", told(first.rate_hz), first.line),
    ))
}
