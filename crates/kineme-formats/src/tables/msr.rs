//! MSR-Action3D skeleton text: 20 lines a frame, `x y z confidence`, metres, y up.
//!
//! The publishers list the joints in an order of their own. It was read off the data: symmetric limbs have
//! equal lengths, feet point to the camera, and the subjects, told to use their right arm or leg (Li, Zhang,
//! Liu 2010), move the joints called right here. The axes are those of the Kinect: right-handed, z from the
//! camera, so a person who faces it has the left hand at smaller x.

use kineme::math::rotation::Axis;
use kineme::{Format, Observed, Recording, Source};
use nalgebra::Vector3;

use super::kinect;
use crate::error::{FormatError, Place, Result};
use crate::sheet::quoted;

/// Frames a second of the publishers' camera, where nothing else is known.
pub const DEFAULT_RATE_HZ: f64 = 15.0;

/// The joints in the order of the lines of a frame, named as UTD-MHAD names the Kinect's.
pub const LINE_ORDER: [&str; 20] = [
    "left_shoulder",
    "right_shoulder",
    "shoulder_center",
    "spine",
    "left_hip",
    "right_hip",
    "hip_center",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
    "left_hand",
    "right_hand",
    "left_knee",
    "right_knee",
    "left_ankle",
    "right_ankle",
    "left_foot",
    "right_foot",
    "head",
];

/// Whether a file that starts with these bytes looks like this format: twenty lines of four numbers, the
/// last of them a confidence from 0 to 1.
pub fn sniff(head: &[u8]) -> bool {
    let whole = head
        .iter()
        .rposition(|&b| b == b'\n')
        .map_or(head, |end| &head[..end]);
    let Ok(text) = std::str::from_utf8(whole) else {
        return false;
    };
    let a_point = |line: &&str| {
        let cells: Vec<&str> = line.split_ascii_whitespace().take(5).collect();
        cells.len() == 4
            && cells.iter().all(|c| c.parse::<f64>().is_ok())
            && cells[3]
                .parse::<f64>()
                .is_ok_and(|c| (0.0..=1.0).contains(&c))
    };
    text.lines()
        .filter(|l| !l.trim().is_empty())
        .take(LINE_ORDER.len())
        .take_while(a_point)
        .count()
        == LINE_ORDER.len()
}

/// Reads a recording: 20 joints, parents first as in the Kinect's skeleton, `rate_hz` or
/// [`DEFAULT_RATE_HZ`] with a warning.
///
/// A point of confidence 0 with all coordinates zero was not seen: missing. A confidence of 0 with
/// coordinates is the tracker's inference and kept. A file in which nothing was seen (the data set has one)
/// is a recording of missing points with a warning, so that one such file does not stop a folder.
///
/// # Errors
/// When a line is not four finite numbers, or the last frame is not whole.
pub fn parse(name: &str, bytes: &[u8], rate_hz: Option<f64>) -> Result<Recording> {
    let mut warnings = Vec::new();
    let rate_hz = rate_hz.unwrap_or_else(|| {
        warnings.push(format!("no time base: {DEFAULT_RATE_HZ} Hz assumed"));
        DEFAULT_RATE_HZ
    });
    let rows = read_rows(name, bytes)?;
    let mut source = Source {
        format: Format::MsrAction3d,
        up: Axis::Y,
        unit_metres: 1.0,
        warnings: Vec::new(),
    };

    let lines: Vec<usize> = kinect::JOINTS
        .iter()
        .filter_map(|(joint, _)| LINE_ORDER.iter().position(|l| l == joint))
        .collect();
    let positions: Vec<Option<Vector3<f64>>> = rows
        .chunks_exact(LINE_ORDER.len())
        .flat_map(|frame| lines.iter().map(|&line| frame[line]))
        .map(|point| point.map(|p| source.to_inner(p)))
        .collect();
    let missing = positions.iter().filter(|p| p.is_none()).count();
    if missing == positions.len() {
        warnings.push("nothing was seen in any frame: every point is missing".to_string());
    } else if missing > 0 {
        warnings.push(format!("{missing} of {} points missing", positions.len()));
    }

    let joints = kinect::JOINTS
        .iter()
        .enumerate()
        .map(|(j, (joint, _))| kinect::observed_joint(joint, kinect::ancestor(j, |_| true)))
        .collect();
    source.warnings = warnings;
    Recording::new(
        name,
        source,
        joints,
        rate_hz,
        Observed::Positions(positions),
    )
    .map_err(|e| FormatError::new(name, Place::File, e.to_string(), "a recording of positions"))
}

/// The points line by line: whole frames, at least one.
fn read_rows(name: &str, bytes: &[u8]) -> Result<Vec<Option<Vector3<f64>>>> {
    const EXPECTED: &str = "`x y z confidence`: four finite numbers";
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let place = Place::Byte(e.valid_up_to());
        FormatError::new(name, place, "bytes that are no text", EXPECTED)
    })?;
    let mut points = Vec::new();
    let mut last_line = 0;
    for (i, line) in text.lines().enumerate() {
        let error = |found: String| FormatError::new(name, Place::Line(i + 1), found, EXPECTED);
        let mut values = [0.0; 4];
        let mut count = 0;
        for cell in line.split_ascii_whitespace() {
            let value = cell
                .parse::<f64>()
                .ok()
                .filter(|v| v.is_finite())
                .ok_or_else(|| error(quoted(cell)))?;
            if let Some(slot) = values.get_mut(count) {
                *slot = value;
            }
            count += 1;
        }
        match count {
            0 => continue,
            4 => {
                let seen = values.iter().any(|v| *v != 0.0);
                points.push(seen.then(|| Vector3::new(values[0], values[1], values[2])));
                last_line = i + 1;
            }
            _ => return Err(error(format!("{count} numbers"))),
        }
    }
    let joints = LINE_ORDER.len();
    if points.is_empty() || points.len() % joints != 0 {
        return Err(FormatError::new(
            name,
            Place::Line(last_line.max(1)),
            format!(
                "the end after {} lines of frame {}",
                points.len() % joints,
                points.len() / joints + 1
            ),
            format!("{joints} lines a frame"),
        ));
    }
    Ok(points)
}
