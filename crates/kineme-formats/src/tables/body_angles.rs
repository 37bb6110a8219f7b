//! Joint-angle tables of a body: a motion as a table, and such a table as a recording.
//!
//! A table does not name its body: its columns do, for every coordinate has a name of its own.

use std::collections::HashSet;
use std::sync::Arc;

use kineme::{Format, Motion, Recording, Root, Skeleton, Source, adonis, ares};
use nalgebra::Vector3;

use super::angles::{self, AngleRows, AngleTable};
use super::timebase::Clock;
use crate::error::{FormatError, Place, Result};
use crate::sheet::{header_place, quoted, size_as_text};
use crate::text::Blame;

/// The table of a motion: times from 0, the root's path, every coordinate of its body.
pub fn table(motion: &Motion) -> AngleTable {
    let names = motion.skeleton().coordinate_names();
    let frames = 0..motion.frames();
    AngleTable {
        times: frames
            .clone()
            .map(|f| f as f64 / motion.rate_hz())
            .collect(),
        root: motion
            .roots()
            .iter()
            .map(|r| [r.position.x, r.position.y, r.position.z, r.yaw].map(Some))
            .collect(),
        columns: names
            .into_iter()
            .enumerate()
            .map(|(i, name)| {
                let column = frames.clone().map(|f| Some(motion.pose(f)[i]));
                (name, column.collect())
            })
            .collect(),
    }
}

/// Reads a table of one of the bodies `ares` and `adonis` as a recording of it.
///
/// Cells that are missing, and frames that the times leave out, are filled linearly in time, and before the first and
/// after the last value with that value; what was never observed stays neutral. Both are told in a warning.
///
/// # Errors
/// As [`angles::parse`]; when a column is no coordinate of one of the bodies, or the root's cells are not numbers.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Recording> {
    let (table, told) = angles::collect(name, AngleRows::open(name, bytes)?)?;
    let body = body_of(name, &table, header_place(bytes))?;
    let Filled {
        motion,
        cells,
        unseen,
        mut warnings,
        ..
    } = fill(name, &table, &body, size_as_text(bytes))?;
    warnings.extend(told);
    if cells > 0 {
        warnings.push(format!("{cells} cells missing and filled in time"));
    }
    if unseen > 0 {
        warnings.push(format!(
            "{unseen} coordinates of `{}` never observed: neutral",
            body.name()
        ));
    }
    let recording = Recording::from_motion(&motion);
    let source = Source {
        format: Format::AngleTable,
        warnings,
        ..recording.source().clone()
    };
    recording.with_source(source).map_err(|e| refused(name, &e))
}

/// A table as a motion without gaps, and where they were.
pub(super) struct Filled {
    pub motion: Motion,
    /// Whether a joint lacked a coordinate: frames x joints, frame-major.
    pub missing: Vec<bool>,
    /// Cells that were filled in time.
    pub cells: usize,
    /// Coordinates without any value.
    pub unseen: usize,
    pub warnings: Vec<String>,
}

/// Lays a table of a body, from a text of so many bytes, on an even grid of frames without gaps.
pub(super) fn fill(
    name: &str,
    table: &AngleTable,
    body: &Arc<Skeleton>,
    bytes: usize,
) -> Result<Filled> {
    let mut warnings = Vec::new();
    let grid = Clock::of(table.times.clone()).grid(name, true, None, &mut warnings)?;
    let joints = body.joints().len();
    Blame(name).proportionate(joints, grid.frames, bytes)?;
    let path = |values: &mut dyn Iterator<Item = Option<f64>>| {
        let mut path = vec![None; grid.frames];
        for (frame, value) in grid.frame_of_row.iter().zip(values) {
            path[*frame] = value;
        }
        path
    };
    let mut cells = 0;
    let mut fill = |path: &[Option<f64>]| {
        cells += path.iter().filter(|v| v.is_none()).count();
        filled(path)
    };
    let root: Vec<Vec<f64>> = (0..4)
        .map(|i| {
            let column = fill(&path(&mut table.root.iter().map(|r| r[i])));
            column.unwrap_or_else(|| vec![0.0; grid.frames])
        })
        .collect();
    let mut poses: Vec<f64> = body.neutral().repeat(grid.frames);
    let mut missing = vec![false; grid.frames * joints];
    let mut unseen = 0;
    let names = body.coordinate_names();
    for joint in 0..joints {
        for i in body.coordinates(joint) {
            let column = table.columns.iter().find(|(c, _)| *c == names[i]);
            let seen = column.map(|(_, values)| path(&mut values.iter().copied()));
            for f in 0..grid.frames {
                let known = seen.as_ref().is_some_and(|path| path[f].is_some());
                missing[f * joints + joint] |= !known;
            }
            let values = seen.and_then(|path| fill(&path));
            unseen += usize::from(values.is_none());
            for (f, value) in values.into_iter().flatten().enumerate() {
                poses[f * body.dof() + i] = value;
            }
        }
    }
    let roots = (0..grid.frames)
        .map(|f| Root {
            position: Vector3::new(root[0][f], root[1][f], root[2][f]),
            yaw: root[3][f],
        })
        .collect();
    let motion = Motion::new(name, Arc::clone(body), grid.rate_hz, poses, roots);
    Ok(Filled {
        motion: motion.map_err(|e| refused(name, &e))?,
        missing,
        cells,
        unseen,
        warnings,
    })
}

fn refused(name: &str, error: &kineme::Error) -> FormatError {
    FormatError::new(name, Place::File, error.to_string(), "a motion")
}

/// The body whose coordinates the columns are; where they serve both, the one that they fill better.
fn body_of(name: &str, table: &AngleTable, header: Place) -> Result<Arc<Skeleton>> {
    let mut best: Option<Skeleton> = None;
    let mut strangers: Option<Vec<&str>> = None;
    for built_in in [ares, adonis] {
        let body = built_in()
            .map_err(|e| FormatError::new(name, Place::File, e.to_string(), "a built-in body"))?;
        let known: HashSet<String> = body.coordinate_names().into_iter().collect();
        let columns = table.columns.iter().map(|(c, _)| c.as_str());
        let strange: Vec<&str> = columns.filter(|c| !known.contains(*c)).collect();
        if strange.is_empty() {
            if best.as_ref().is_none_or(|b| body.dof() < b.dof()) {
                best = Some(body);
            }
        } else if strangers.as_ref().is_none_or(|s| strange.len() < s.len()) {
            strangers = Some(strange);
        }
    }
    best.map(Arc::new).ok_or_else(|| {
        let first = strangers.and_then(|s| s.first().copied());
        FormatError::new(
            name,
            header,
            format!("column {}", quoted(first.unwrap_or_default())),
            "columns that are joint coordinates of `ares` or of `adonis`",
        )
    })
}

/// Values in time with their gaps filled; `None` where there is no value at all.
fn filled(path: &[Option<f64>]) -> Option<Vec<f64>> {
    let seen: Vec<(usize, f64)> = path
        .iter()
        .enumerate()
        .filter_map(|(f, v)| Some((f, (*v)?)))
        .collect();
    let (first, last) = (seen.first()?, seen.last()?);
    let mut next = 0;
    let values = (0..path.len()).map(|f| {
        while next < seen.len() && seen[next].0 < f {
            next += 1;
        }
        match (next.checked_sub(1).map(|p| seen[p]), seen.get(next)) {
            (_, None) => last.1,
            (None, Some(_)) => first.1,
            (_, Some((at, value))) if *at == f => *value,
            (Some((before, a)), Some((after, b))) => {
                a + (b - a) * (f - before) as f64 / (after - before) as f64
            }
        }
    });
    Some(values.collect())
}
