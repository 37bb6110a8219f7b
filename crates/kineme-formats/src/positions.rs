//! World positions of a recording as a table, CSV or Parquet: `frame,<joint>_x,<joint>_y,<joint>_z,...`.

use std::borrow::Cow;
use std::io::Write;

use kineme::{Format, Recording};
use nalgebra::Vector3;

use crate::error::{FormatError, Place, Result};
use crate::parquet::Cells;
use crate::text::shortest;

/// Axes and unit of written positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// Right-handed, z up, x forward, metres.
    #[default]
    Metres,
    /// The source file's own axes and unit.
    Native,
}

/// Writes the world positions of all joints at all frames as CSV, frames counted from 0, numbers as the shortest
/// decimals that read back alike, empty cells where a point was not seen.
///
/// Tips (BVH end sites) follow their joint as `<joint>_End`; a bone of an ASF is told by its tip under its own name.
///
/// # Errors
/// When `out` cannot be written.
pub fn write(recording: &Recording, frame: Frame, out: &mut dyn Write) -> Result<()> {
    let failed = |e: csv::Error| {
        FormatError::new(
            recording.name(),
            Place::File,
            e.to_string(),
            "a place to write to",
        )
    };
    let mut header = vec!["frame".to_owned()];
    for name in names(recording) {
        header.extend(["x", "y", "z"].map(|axis| format!("{name}_{axis}")));
    }
    let mut table = csv::Writer::from_writer(out);
    table.write_record(&header).map_err(failed)?;
    let mut row: Vec<String> = Vec::with_capacity(header.len());
    for index in 0..recording.frames() {
        row.clear();
        row.push(index.to_string());
        for point in points(recording, frame, index) {
            match point {
                Some(point) => row.extend(point.iter().map(|v| shortest(*v))),
                None => row.extend([const { String::new() }; 3]),
            }
        }
        table.write_record(&row).map_err(failed)?;
    }
    table.flush().map_err(|e| failed(e.into()))
}

/// As [`write()`], as Parquet: numbers as they are, null where a point was not seen.
///
/// # Errors
/// When the table cannot be made.
pub fn write_parquet(recording: &Recording, frame: Frame) -> Result<Vec<u8>> {
    let names = names(recording);
    let axes = names
        .iter()
        .flat_map(|name| ["x", "y", "z"].map(|axis| format!("{name}_{axis}")));
    let mut columns: Vec<(String, Vec<Option<f64>>)> = axes.map(|a| (a, Vec::new())).collect();
    for index in 0..recording.frames() {
        let points = points(recording, frame, index);
        let values = points
            .iter()
            .flat_map(|p| p.map_or([None; 3], |p| [p.x, p.y, p.z].map(Some)));
        for ((_, column), value) in columns.iter_mut().zip(values) {
            column.push(value);
        }
    }
    let mut table = vec![("frame".to_owned(), Cells::Count(recording.frames()))];
    let columns = columns.into_iter();
    table.extend(columns.map(|(name, column)| (name, Cells::Some(Cow::Owned(column)))));
    crate::parquet::write(recording.name(), &table)
}

/// The names of the points, in the order of [`points`].
pub(crate) fn names(recording: &Recording) -> Vec<String> {
    let mut names = Vec::new();
    for joint in recording.joints() {
        names.push(joint.name.clone());
        if joint.tip.is_some() && !has_bones(recording) {
            names.push(format!("{}_End", joint.name));
        }
    }
    names
}

/// Where the points are at a frame; `None` where one was not seen.
pub(crate) fn points(
    recording: &Recording,
    frame: Frame,
    index: usize,
) -> Vec<Option<Vector3<f64>>> {
    let mut points = Vec::new();
    for (joint, placed) in recording.joints().iter().zip(recording.placements(index)) {
        if joint.tip.is_none() || !has_bones(recording) {
            points.push(placed.position);
        }
        if let Some(tip) = joint.tip {
            let joint = placed.position.zip(placed.rotation);
            points.push(joint.map(|(place, turn)| place + turn * tip));
        }
    }
    if frame == Frame::Native {
        for point in points.iter_mut().flatten() {
            *point = recording.source().to_native(*point);
        }
    }
    points
}

/// Whether a joint with a tip is a bone and told by that alone.
fn has_bones(recording: &Recording) -> bool {
    recording.source().format == Format::AsfAmc
}
