//! Joint-position tables: `frame,<joint>_x,<joint>_y,<joint>_z,...` in metres, or `time` in place of `frame`.

use std::collections::HashMap;
use std::io::Read;

use kineme::{Format, Observed, RecordedJoint, Recording, Source};
use nalgebra::Vector3;

use super::{angles, kinect, timebase, upright};
use crate::error::{FormatError, Place, Result};
use crate::sheet::{Sheet, first_cells};

/// Frames a second where neither the table nor the caller says.
pub const DEFAULT_RATE_HZ: f64 = 30.0;

const HEADER: &str = "a header `frame,<joint>_x,<joint>_y,<joint>_z,...` (or `time` first)";

/// Whether a file that starts with these bytes looks like a table of positions: `frame` or `time`, then the
/// three coordinates of a joint. A table of joint angles is none, though its root has coordinates too.
pub fn sniff(head: &[u8]) -> bool {
    let cells = first_cells(head, 4);
    let [first, x, y, z] = cells.as_slice() else {
        return false;
    };
    let counted = ["frame", "time"].contains(&first.to_lowercase().as_str());
    let a_point = match (coordinate(x), coordinate(y), coordinate(z)) {
        (Some((a, 0)), Some((b, 1)), Some((c, 2))) => a == b && b == c,
        _ => false,
    };
    counted && a_point && !angles::sniff(head)
}

/// Reads a recording from CSV or Parquet.
///
/// An empty cell, null or NaN makes its point missing; so does a gap in `frame` or `time`, for whole frames. The
/// rate comes from `time`, else it is `rate_hz`, else [`DEFAULT_RATE_HZ`] with a warning. The upward axis is
/// found from the body's long axis. Where every joint is one of the Kinect's, they get its parents
/// and stand parents first; else all are roots in the order of the columns.
///
/// # Errors
/// When the header names no joint, lacks a coordinate or repeats a column; when a row has another number of
/// cells, a cell is no finite number, or `frame` or `time` does not rise.
pub fn parse(name: &str, bytes: &[u8], rate_hz: Option<f64>) -> Result<Recording> {
    let mut sheet = Sheet::open_numbers(name, bytes, HEADER)?;
    let columns = Columns::of(&sheet)?;
    let n = columns.joints.len();

    let mut clock = timebase::Clock::default();
    let mut seen: Vec<Option<Vector3<f64>>> = Vec::new();
    while let Some(row) = sheet.next_row()? {
        clock.push(row.required(0, columns.time_name())?, &row)?;
        for (_, xyz) in &columns.joints {
            let [x, y, z] = *xyz;
            let point = (row.number(x)?, row.number(y)?, row.number(z)?);
            seen.push(match point {
                (Some(x), Some(y), Some(z)) => Some(Vector3::new(x, y, z)),
                _ => None,
            });
        }
    }
    let mut warnings = sheet.warnings().to_vec();
    warnings.extend(columns.warnings);
    let grid = clock.grid(name, columns.timed, rate_hz, &mut warnings)?;

    let order = kinect_order(&columns.joints);
    let names: Vec<&str> = columns.joints.iter().map(|(j, _)| j.as_str()).collect();
    let up = upright::detect(&names, &seen, &mut warnings);
    let source = Source {
        format: Format::PositionTable,
        up,
        unit_metres: 1.0,
        warnings: Vec::new(),
    };
    let mut positions = vec![None; grid.frames * n];
    for (row, &frame) in seen.chunks_exact(n).zip(&grid.frame_of_row) {
        for (to, (from, _)) in order.iter().enumerate() {
            positions[frame * n + to] = row[*from].map(|p| source.to_inner(p));
        }
    }
    let missing = positions.iter().filter(|p| p.is_none()).count();
    if missing > 0 {
        warnings.push(format!("{missing} of {} points missing", positions.len()));
    }
    let joints: Vec<RecordedJoint> = order
        .iter()
        .map(|&(from, parent)| kinect::observed_joint(names[from], parent))
        .collect();
    let source = Source { warnings, ..source };
    let observed = Observed::Positions(positions);
    Recording::new(name, source, joints, grid.rate_hz, observed)
        .map_err(|e| FormatError::new(name, Place::File, e.to_string(), "a recording of positions"))
}

/// What the header says: where each joint's coordinates stand.
struct Columns {
    timed: bool,
    joints: Vec<(String, [usize; 3])>,
    warnings: Vec<String>,
}

impl Columns {
    fn of<R: Read>(sheet: &Sheet<R>) -> Result<Self> {
        let header = sheet.header();
        let error = |found: String| sheet.header_error(found, HEADER);
        let timed = match header[0].to_lowercase().as_str() {
            "time" => true,
            "frame" => false,
            other => return Err(error(format!("`{other}` first"))),
        };
        let mut joints: Vec<(String, [Option<usize>; 3])> = Vec::new();
        let mut place: HashMap<&str, usize> = HashMap::new();
        let mut ignored = Vec::new();
        for (column, cell) in header.iter().enumerate().skip(1) {
            let Some((joint, axis)) = coordinate(cell) else {
                ignored.push(cell.as_str());
                continue;
            };
            let j = *place.entry(joint).or_insert_with(|| {
                joints.push((joint.to_string(), [None; 3]));
                joints.len() - 1
            });
            if joints[j].1[axis].replace(column).is_some() {
                return Err(error(format!("two columns for `{cell}`")));
            }
        }
        if joints.is_empty() {
            return Err(error("no joint".to_string()));
        }
        let joints = joints
            .into_iter()
            .map(|(joint, xyz)| match xyz {
                [Some(x), Some(y), Some(z)] => Ok((joint, [x, y, z])),
                _ => Err(error(format!("`{joint}` without all of _x, _y, _z"))),
            })
            .collect::<Result<_>>()?;
        let mut warnings = Vec::new();
        if let Some(first) = ignored.first() {
            warnings.push(format!(
                "{} columns are no coordinates and were ignored: `{first}`{}",
                ignored.len(),
                if ignored.len() > 1 { ", ..." } else { "" }
            ));
        }
        Ok(Self {
            timed,
            joints,
            warnings,
        })
    }

    fn time_name(&self) -> &'static str {
        if self.timed { "time" } else { "frame" }
    }
}

/// The joint and the axis (0, 1, 2) of a column `<joint>_x`.
fn coordinate(cell: &str) -> Option<(&str, usize)> {
    let (joint, axis) = cell.rsplit_once('_')?;
    let axis = ["x", "y", "z"]
        .iter()
        .position(|a| axis.eq_ignore_ascii_case(a))?;
    (!joint.is_empty()).then_some((joint, axis))
}

/// For each joint of the recording: its place among the columns' joints, and its parent in the recording.
fn kinect_order(joints: &[(String, [usize; 3])]) -> Vec<(usize, Option<usize>)> {
    let mut column_of = [None; kinect::JOINTS.len()];
    for (column, (joint, _)) in joints.iter().enumerate() {
        match kinect::find(joint) {
            Some(k) if column_of[k].is_none() => column_of[k] = Some(column),
            _ => return (0..joints.len()).map(|j| (j, None)).collect(),
        }
    }
    let mut place = [None; kinect::JOINTS.len()];
    let mut order = Vec::new();
    for k in 0..kinect::JOINTS.len() {
        if let Some(column) = column_of[k] {
            let parent = kinect::ancestor(k, |a| column_of[a].is_some()).and_then(|a| place[a]);
            place[k] = Some(order.len());
            order.push((column, parent));
        }
    }
    order
}
