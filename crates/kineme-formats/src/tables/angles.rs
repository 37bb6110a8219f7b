//! Joint-angle tables: `time,root_x,root_y,root_z,root_yaw`, then a column per joint coordinate, radians.
//!
//! What the columns mean is a body's business: here they are names and numbers.

use std::borrow::Cow;
use std::io::Read;

use crate::error::{FormatError, Place, Result};
use crate::parquet;
use crate::parquet::Cells;
use crate::sheet::{Row, Sheet, first_cells, quoted};
use crate::stream::Peeked;

/// The columns every table begins with: seconds, metres (z up), radians.
pub const FIXED_COLUMNS: [&str; 5] = ["time", "root_x", "root_y", "root_z", "root_yaw"];

const HEADER: &str = "a header `time,root_x,root_y,root_z,root_yaw,<joint coordinates>...`";

/// A table of joint angles over time. A missing value is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AngleTable {
    /// Seconds, rising; one a row.
    pub times: Vec<f64>,
    /// The root's path, one a row: x, y, z in metres (z up) and yaw in radians.
    pub root: Vec<[Option<f64>; 4]>,
    /// Each joint coordinate's name (`<joint>_x` of a rotation vector, `<joint>` of a hinge) and its
    /// values in radians, one a row.
    pub columns: Vec<(String, Vec<Option<f64>>)>,
}

/// One row of a table of joint angles.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleRow {
    /// Seconds.
    pub time: f64,
    /// x, y, z in metres (z up) and yaw in radians.
    pub root: [Option<f64>; 4],
    /// Radians, in the order of [`AngleRows::columns`].
    pub angles: Vec<Option<f64>>,
}

/// The rows of a table, read as they come: for streams.
pub struct AngleRows<R> {
    sheet: Sheet<Peeked<R>>,
    last_time: Option<f64>,
}

/// Whether a file that starts with these bytes looks like a table of joint angles.
pub fn sniff(head: &[u8]) -> bool {
    first_cells(head, FIXED_COLUMNS.len()) == FIXED_COLUMNS
}

impl<R: Read> AngleRows<R> {
    /// Reads the header of a table named `file` in messages. Of Parquet, whose columns follow one another, it reads
    /// everything.
    ///
    /// # Errors
    /// When the header does not begin with [`FIXED_COLUMNS`], repeats a name or leaves one empty.
    pub fn open(file: &str, reader: R) -> Result<Self> {
        let sheet = Sheet::open_numbers(file, reader, HEADER)?;
        let header = sheet.header();
        let error = |found: String| sheet.header_error(found, HEADER);
        for (i, expected) in FIXED_COLUMNS.iter().enumerate() {
            match header.get(i) {
                Some(cell) if cell == expected => {}
                Some(cell) => {
                    return Err(error(format!("{} in place of `{expected}`", quoted(cell))));
                }
                None => return Err(error(format!("no column `{expected}`"))),
            }
        }
        if header.iter().any(String::is_empty) {
            return Err(error("a column without a name".to_string()));
        }
        Ok(Self {
            sheet,
            last_time: None,
        })
    }

    /// The names of the joint coordinates.
    pub fn columns(&self) -> &[String] {
        &self.sheet.header()[FIXED_COLUMNS.len()..]
    }

    /// An error in the header.
    pub(super) fn header_error(&self, found: impl Into<String>, expected: &str) -> FormatError {
        self.sheet.header_error(found, expected)
    }

    /// The next row; `None` at the end.
    ///
    /// # Errors
    /// When the row has another number of cells than the header, a cell is no finite number, or the time
    /// is missing or does not rise.
    pub fn next_row(&mut self) -> Result<Option<AngleRow>> {
        let last = self.last_time;
        let Some(row) = self.sheet.next_row()? else {
            return Ok(None);
        };
        let row = angle_row(&row, last)?;
        self.last_time = Some(row.time);
        Ok(Some(row))
    }
}

impl<R: Read> Iterator for AngleRows<R> {
    type Item = Result<AngleRow>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_row().transpose()
    }
}

fn angle_row(row: &Row<'_>, last: Option<f64>) -> Result<AngleRow> {
    let time = row.required(0, "time")?;
    if let Some(last) = last
        && time <= last
    {
        return Err(row.error(format!("time {time} after {last}"), "times that rise"));
    }
    let mut root = [None; 4];
    for (i, value) in root.iter_mut().enumerate() {
        *value = row.number(1 + i)?;
    }
    let angles = (FIXED_COLUMNS.len()..row.len())
        .map(|i| row.number(i))
        .collect::<Result<_>>()?;
    Ok(AngleRow { time, root, angles })
}

/// Reads a whole table, CSV or Parquet.
///
/// # Errors
/// As [`AngleRows::open`] and [`AngleRows::next_row`]; and when the table has no row.
pub fn parse(name: &str, bytes: &[u8]) -> Result<AngleTable> {
    Ok(collect(name, AngleRows::open(name, bytes)?)?.0)
}

/// The table that rows make, and sentences about it for people.
pub(super) fn collect<R: Read>(
    name: &str,
    mut rows: AngleRows<R>,
) -> Result<(AngleTable, Vec<String>)> {
    let mut table = AngleTable {
        columns: rows
            .columns()
            .iter()
            .map(|c| (c.clone(), Vec::new()))
            .collect(),
        ..AngleTable::default()
    };
    while let Some(row) = rows.next_row()? {
        table.times.push(row.time);
        table.root.push(row.root);
        for ((_, column), value) in table.columns.iter_mut().zip(row.angles) {
            column.push(value);
        }
    }
    if table.times.is_empty() {
        return Err(FormatError::new(
            name,
            Place::File,
            "no row",
            "at least one row of angles",
        ));
    }
    Ok((table, rows.sheet.warnings().to_vec()))
}

impl AngleTable {
    /// The table as a CSV file: numbers in the fewest digits that read back as the same f64.
    ///
    /// # Errors
    /// When the table would not read back: no row, columns of different lengths, names that are empty or repeated,
    /// times that do not rise, numbers that are not finite. The place is the row's line.
    pub fn write(&self, name: &str) -> Result<Vec<u8>> {
        self.check(name)?;
        let mut writer = csv::Writer::from_writer(Vec::new());
        let broken = |e: csv::Error| {
            FormatError::new(
                name,
                Place::File,
                e.to_string(),
                "a table that can be written",
            )
        };
        let names = self.columns.iter().map(|(c, _)| c.as_str());
        let header: Vec<&str> = FIXED_COLUMNS.into_iter().chain(names).collect();
        writer.write_record(&header).map_err(broken)?;
        for (i, time) in self.times.iter().enumerate() {
            let angles = self.columns.iter().map(|(_, column)| column[i]);
            let cells = [Some(*time)].into_iter().chain(self.root[i]).chain(angles);
            writer.write_record(cells.map(number)).map_err(broken)?;
        }
        writer
            .into_inner()
            .map_err(|e| FormatError::new(name, Place::File, e.to_string(), "memory to write to"))
    }

    /// The table as a Parquet file: numbers as they are, null where one is missing, columns in the order of the CSV.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_parquet(&self, name: &str) -> Result<Vec<u8>> {
        self.check(name)?;
        let mut columns = Vec::with_capacity(FIXED_COLUMNS.len() + self.columns.len());
        let [time, root @ ..] = FIXED_COLUMNS;
        columns.push((time.to_owned(), Cells::All(&self.times)));
        for (i, of_root) in root.into_iter().enumerate() {
            let path = self.root.iter().map(|r| r[i]).collect();
            columns.push((of_root.to_owned(), Cells::Some(Cow::Owned(path))));
        }
        for (coordinate, values) in &self.columns {
            columns.push((coordinate.clone(), Cells::Some(Cow::Borrowed(values))));
        }
        parquet::write(name, &columns)
    }

    fn check(&self, name: &str) -> Result<()> {
        let error = |place, found: String, expected: &str| {
            Err(FormatError::new(name, place, found, expected))
        };
        let rows = self.times.len();
        if rows == 0 {
            return error(Place::File, "no row".to_string(), "at least one row");
        }
        let mut names = std::collections::HashSet::from(FIXED_COLUMNS);
        for (column, values) in &self.columns {
            if column.trim() != column || column.is_empty() || !names.insert(column) {
                let expected = "names of columns, each once, without space around";
                return error(Place::Line(1), format!("`{column}`"), expected);
            }
            if values.len() != rows {
                let found = format!("{} values of `{column}`", values.len());
                return error(Place::File, found, "as many as there are times");
            }
        }
        if self.root.len() != rows {
            let found = format!("{} placements of the root", self.root.len());
            return error(Place::File, found, "as many as there are times");
        }
        for i in 0..rows {
            let line = Place::Line(i + 2);
            if i > 0 && self.times[i] <= self.times[i - 1] {
                let found = format!("time {} after {}", self.times[i], self.times[i - 1]);
                return error(line, found, "times that rise");
            }
            let angles = self.columns.iter().filter_map(|(_, column)| column[i]);
            let values = self.root[i].into_iter().flatten();
            let mut all = [self.times[i]].into_iter().chain(values).chain(angles);
            if let Some(value) = all.find(|v| !v.is_finite()) {
                return error(line, value.to_string(), "finite numbers");
            }
        }
        Ok(())
    }
}

/// The shortest text that reads back as the same f64; exponents keep very small and large numbers short.
fn number(value: Option<f64>) -> String {
    match value {
        None => String::new(),
        Some(v) if v != 0.0 && !(1e-5..1e16).contains(&v.abs()) => format!("{v:e}"),
        Some(v) => format!("{v}"),
    }
}
