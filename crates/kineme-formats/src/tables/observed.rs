//! Joint-angle tables as a recogniser sees them: what is not in them is missing, and stays so.
//!
//! Such a table is of one body, which is known beforehand; nothing is retargeted.

use std::io::Read;
use std::sync::Arc;

use kineme::primitive::{Observation, Observations};
use kineme::{Root, Skeleton};
use nalgebra::Vector3;

use super::angles::{self, AngleRow, AngleRows};
use super::body_angles::{Filled, fill};
use crate::error::{FormatError, Place, Result};
use crate::sheet::{quoted, size_as_text};

/// A motion with what was missing in it, and what there is to warn of.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// The motion. Gaps are filled in time, for a motion is complete, and marked as missing.
    pub seen: Observations,
    /// Sentences for people.
    pub warnings: Vec<String>,
}

/// Whether all columns are coordinates of the body, and there is one.
fn serve(columns: &[String], body: &Skeleton) -> bool {
    let known = body.coordinate_names();
    !columns.is_empty() && columns.iter().all(|c| known.contains(c))
}

/// Reads a table of a body, CSV or Parquet; `None` where its columns are not all coordinates of this body.
///
/// A joint is missing in a frame in which one of its cells is empty, and everywhere where one of its columns is not
/// there; so is everything in frames that the times leave out.
///
/// # Errors
/// As [`angles::parse`]; when the times leave far more out than is there.
pub fn parse(name: &str, bytes: &[u8], body: &Arc<Skeleton>) -> Result<Option<Observed>> {
    let rows = AngleRows::open(name, bytes)?;
    if !serve(rows.columns(), body) {
        return Ok(None);
    }
    let (table, told) = angles::collect(name, rows)?;
    let Filled {
        motion,
        missing,
        mut warnings,
        ..
    } = fill(name, &table, body, size_as_text(bytes))?;
    warnings.extend(told);
    let gone = missing.iter().filter(|m| **m).count();
    let seen = match gone {
        0 => Observations::complete(motion),
        _ => {
            let share = 100.0 * gone as f64 / missing.len() as f64;
            warnings.push(format!("{share:.1} % of the joints not seen"));
            Observations::with_missing(motion, missing)
                .map_err(|e| FormatError::new(name, Place::File, e.to_string(), "a motion"))?
        }
    };
    Ok(Some(Observed { seen, warnings }))
}

/// The rows of a table of a body as observations, as they come: for streams.
pub struct ObservedRows<R> {
    rows: AngleRows<R>,
    body: Arc<Skeleton>,
    /// The coordinate of each column.
    coordinates: Vec<usize>,
    /// Of each joint, whether a column of it is not there.
    unseen: Vec<bool>,
    pose: Vec<f64>,
    missing: Vec<bool>,
}

impl<R: Read> ObservedRows<R> {
    /// Reads the header of a table named `file` in messages.
    ///
    /// # Errors
    /// As [`AngleRows::open`]; when a column is no coordinate of the body, or there is none.
    pub fn open(file: &str, reader: R, body: &Arc<Skeleton>) -> Result<Self> {
        let rows = AngleRows::open(file, reader)?;
        let names = body.coordinate_names();
        let error = |found: String| {
            let expected = format!("columns that are joint coordinates of `{}`", body.name());
            rows.header_error(found, &expected)
        };
        if rows.columns().is_empty() {
            return Err(error("no joint".into()));
        }
        let mut coordinates = Vec::new();
        for column in rows.columns() {
            let place = names.iter().position(|name| name == column);
            let strange = || error(format!("column {}", quoted(column)));
            coordinates.push(place.ok_or_else(strange)?);
        }
        let joints = 0..body.joints().len();
        let unseen = joints
            .map(|j| body.coordinates(j).any(|c| !coordinates.contains(&c)))
            .collect();
        Ok(Self {
            rows,
            coordinates,
            unseen,
            pose: body.neutral(),
            missing: Vec::new(),
            body: Arc::clone(body),
        })
    }

    /// The joints that never can be seen, because not all their columns are there.
    pub fn unseen(&self) -> Vec<&str> {
        let joints = self.body.joints().iter().zip(&self.unseen);
        let unseen = joints.filter(|(_, unseen)| **unseen);
        unseen.map(|(joint, _)| joint.name.as_str()).collect()
    }

    /// The next row; `None` at the end. Where one of the root's cells is empty, nothing is known of the root.
    ///
    /// # Errors
    /// As [`AngleRows::next_row`].
    pub fn next_row(&mut self) -> Result<Option<Observation<'_>>> {
        let Some(AngleRow { time, root, angles }) = self.rows.next_row()? else {
            return Ok(None);
        };
        self.missing.clone_from(&self.unseen);
        for (&c, angle) in self.coordinates.iter().zip(angles) {
            match angle {
                Some(angle) => self.pose[c] = angle,
                None => {
                    let joints = 0..self.body.joints().len();
                    let mut of = joints.filter(|&j| self.body.coordinates(j).contains(&c));
                    if let Some(j) = of.next() {
                        self.missing[j] = true;
                    }
                }
            }
        }
        Ok(Some(Observation {
            secs: time,
            pose: &self.pose,
            root: match root {
                [Some(x), Some(y), Some(z), Some(yaw)] => Some(Root {
                    position: Vector3::new(x, y, z),
                    yaw,
                }),
                _ => None,
            },
            missing: &self.missing,
        }))
    }
}
