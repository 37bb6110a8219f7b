//! World positions of a recording as a table: `frame,<joint>_x,<joint>_y,<joint>_z,...`.

use std::io::Write;

use kineme::{Format, Recording};
use nalgebra::Vector3;

use crate::error::{FormatError, Place, Result};
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
    let bones = recording.source().format == Format::AsfAmc;
    let joints = recording.joints();
    let mut header = vec!["frame".to_owned()];
    let mut columns = |name: &str| {
        for axis in ["x", "y", "z"] {
            header.push(format!("{name}_{axis}"));
        }
    };
    for joint in joints {
        columns(&joint.name);
        if joint.tip.is_some() && !bones {
            columns(&format!("{}_End", joint.name));
        }
    }
    let mut table = csv::Writer::from_writer(out);
    table.write_record(&header).map_err(failed)?;
    let mut row: Vec<String> = Vec::with_capacity(header.len());
    for index in 0..recording.frames() {
        row.clear();
        row.push(index.to_string());
        for (joint, placed) in joints.iter().zip(recording.placements(index)) {
            let tip = match (joint.tip, placed.position, placed.rotation) {
                (Some(tip), Some(place), Some(turn)) => Some(place + turn * tip),
                _ => None,
            };
            if bones && joint.tip.is_some() {
                point(recording, frame, tip, &mut row);
                continue;
            }
            point(recording, frame, placed.position, &mut row);
            if joint.tip.is_some() {
                point(recording, frame, tip, &mut row);
            }
        }
        table.write_record(&row).map_err(failed)?;
    }
    table.flush().map_err(|e| failed(e.into()))
}

fn point(recording: &Recording, frame: Frame, place: Option<Vector3<f64>>, row: &mut Vec<String>) {
    match place {
        Some(place) => {
            let place = match frame {
                Frame::Metres => place,
                Frame::Native => recording.source().to_native(place),
            };
            row.extend(place.iter().map(|v| shortest(*v)));
        }
        None => row.extend([String::new(), String::new(), String::new()]),
    }
}
