//! C3D, the marker files of biomechanics: names and paths of markers, and the centres of the joints that they surround.
//!
//! Read are the markers: header, parameters and points of files of every processor, whole or real numbers, however many
//! frames. Forces and other analog channels are passed over. A marker lies on the skin; [`joint_centres`] says where
//! the joints are.

mod centres;
mod marker_sets;
mod model;
mod parameters;
mod places;

use kineme::math::rotation::Axis;
use kineme::{Format, Observed, Recording, Source};
use nalgebra::Vector3;

pub use centres::{Centred, joint_centres};

use crate::error::{FormatError, Place, Result};
use crate::tables::kinect::observed_joint;
use crate::tables::upright;
use crate::text::{Blame, make_unique, quoted};
use parameters::{BLOCK, KEY, Parameters};

/// Whether a file that starts with these bytes is a C3D file. The first byte counts blocks, so it is small, and no text.
pub fn sniff(head: &[u8]) -> bool {
    head.len() >= BLOCK && (2..=8).contains(&head[0]) && head[1] == KEY
}

/// Reads the markers of a file as joints without parents.
///
/// A marker is missing where its residual is negative or a coordinate is not a number. The upward axis is told from where
/// the markers of a known set are, else it is the file's `POINT:Y_SCREEN`, else told from the markers' names.
///
/// # Errors
/// When the file is no C3D, has no markers or no rate, or ends before its last frame; the place is the byte.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Recording> {
    let parameters = Parameters::read(name, bytes)?;
    let layout = Layout::of(name, bytes, &parameters)?;
    let mut warnings = Vec::new();
    let names = labels(&parameters, layout.markers, &mut warnings);
    let unit_metres = unit(&parameters, &mut warnings);
    let seen = layout.points(name, bytes, &parameters)?;
    let missing = seen.iter().filter(|p| p.is_none()).count();
    if missing > 0 {
        let share = 100.0 * missing as f64 / seen.len() as f64;
        warnings.push(format!("{share:.1} % of the markers' places missing"));
    }
    let up = up(&parameters, &names, &seen, unit_metres, &mut warnings);
    let source = Source {
        format: Format::C3d,
        up,
        unit_metres,
        warnings,
    };
    let positions = seen.iter().map(|p| p.map(|p| source.to_inner(p)));
    let observed = Observed::Positions(positions.collect());
    let joints = names.iter().map(|n| observed_joint(n, None)).collect();
    Recording::new(name, source, joints, layout.rate_hz, observed)
        .map_err(|e| Blame(name).refused(e))
}

/// Where the points lie in the file.
struct Layout {
    markers: usize,
    frames: usize,
    /// Frames a second.
    rate_hz: f64,
    /// The first byte of the first frame.
    start: usize,
    /// Bytes of a number: 2 whole, 4 real.
    width: usize,
    /// Bytes of a frame, analog channels included.
    frame: usize,
    /// The file's unit in a whole number; real numbers are in that unit already.
    scale: f64,
}

impl Layout {
    fn of(name: &str, bytes: &[u8], parameters: &Parameters<'_>) -> Result<Self> {
        let cpu = parameters.processor;
        let error = |at: usize, found: String, expected: &str| {
            FormatError::new(name, Place::Byte(at), found, expected)
        };
        let number = |group: &str, key: &str| parameters.numbers(group, key).first().copied();
        let markers = usize::from(cpu.word(bytes, 2));
        if markers == 0 {
            return Err(error(2, "no marker".into(), "markers: 3D points"));
        }
        let scale = f64::from(cpu.real(bytes, 12));
        if !scale.is_finite() || scale == 0.0 {
            let expected = "a scale: negative for real numbers, else the unit of whole ones";
            return Err(error(12, format!("scale {scale}"), expected));
        }
        let width = if scale < 0.0 { 4 } else { 2 };
        let rate = number("POINT", "RATE").filter(|hz| *hz > 0.0);
        let rate_hz = rate.unwrap_or_else(|| f64::from(cpu.real(bytes, 20)));
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            let expected = "frames a second, more than none";
            return Err(error(20, format!("a rate of {rate_hz} Hz"), expected));
        }
        let block = match usize::from(cpu.word(bytes, 16)) {
            0 => number("POINT", "DATA_START").map_or(0, |b| b as usize),
            block => block,
        };
        let start = block.saturating_sub(1) * BLOCK;
        if start < BLOCK || start >= bytes.len() {
            let found = format!("data in block {block} of {}", bytes.len().div_ceil(BLOCK));
            return Err(error(
                16,
                found,
                "a block after the header, inside the file",
            ));
        }
        let frame = width * (4 * markers + usize::from(cpu.word(bytes, 4)));
        let frames = declared(bytes, parameters);
        let there = (bytes.len() - start) / frame;
        if frames == 0 {
            return Err(error(6, "no frame".into(), "first and last frame"));
        }
        if frames > there {
            let found = format!("the end of the file after {there} of {frames} frames");
            return Err(error(
                bytes.len(),
                found,
                "all frames that the header counts",
            ));
        }
        Ok(Self {
            markers,
            frames,
            rate_hz,
            start,
            width,
            frame,
            scale,
        })
    }

    /// The place of every marker, frame by frame, in the file's axes and unit.
    fn points(
        &self,
        name: &str,
        bytes: &[u8],
        parameters: &Parameters<'_>,
    ) -> Result<Vec<Option<Vector3<f64>>>> {
        let cpu = parameters.processor;
        let mut points = Vec::with_capacity(self.frames * self.markers);
        for frame in 0..self.frames {
            for marker in 0..self.markers {
                let at = self.start + frame * self.frame + 4 * self.width * marker;
                let [x, y, z, residual] = [0, 1, 2, 3].map(|k| match self.width {
                    2 => f64::from(cpu.signed(bytes, at + 2 * k)),
                    _ => f64::from(cpu.real(bytes, at + 4 * k)),
                });
                let place = match self.width {
                    2 => Vector3::new(x, y, z) * self.scale,
                    _ => Vector3::new(x, y, z),
                };
                if let Some(wild) = place.iter().find(|c| c.is_infinite()) {
                    let place = Place::Byte(at);
                    return Err(FormatError::new(
                        name,
                        place,
                        wild.to_string(),
                        "finite numbers",
                    ));
                }
                let seen = residual >= 0.0 && place.iter().all(|c| c.is_finite());
                points.push(seen.then_some(place));
            }
        }
        Ok(points)
    }
}

/// How many frames there are to be. The header's counters end at 65,535; files with more say so elsewhere.
fn declared(bytes: &[u8], parameters: &Parameters<'_>) -> usize {
    let cpu = parameters.processor;
    let field = |key: &str| match parameters.numbers("TRIAL", key).as_slice() {
        [low, high, ..] => Some(low + 65_536.0 * high),
        _ => None,
    };
    if let (Some(first), Some(last)) = (field("ACTUAL_START_FIELD"), field("ACTUAL_END_FIELD"))
        && last >= first
    {
        return (last - first) as usize + 1;
    }
    let long = parameters.numbers("POINT", "LONG_FRAMES");
    if let Some(frames) = long.first().filter(|n| **n >= 1.0) {
        return *frames as usize;
    }
    let (first, last) = (cpu.word(bytes, 6), cpu.word(bytes, 8));
    match last.checked_sub(first) {
        Some(more) => usize::from(more) + 1,
        None => 0,
    }
}

/// The markers' names: those of `POINT:LABELS`, `LABELS2` and so on; who has none is numbered.
fn labels(parameters: &Parameters<'_>, markers: usize, warnings: &mut Vec<String>) -> Vec<String> {
    let mut names = parameters.texts("POINT", "LABELS");
    for more in 2.. {
        let next = parameters.texts("POINT", &format!("LABELS{more}"));
        if next.is_empty() || names.len() >= markers {
            break;
        }
        names.extend(next);
    }
    names.resize(markers, String::new());
    let nameless = names.iter().filter(|n| n.is_empty()).count();
    for (i, name) in names.iter_mut().enumerate() {
        if name.is_empty() {
            *name = format!("marker_{}", i + 1);
        }
    }
    if nameless > 0 {
        warnings.push(format!("{nameless} markers without a name were numbered"));
    }
    warnings.extend(make_unique(&mut names));
    names
}

/// Metres in the file's unit of length.
fn unit(parameters: &Parameters<'_>, warnings: &mut Vec<String>) -> f64 {
    let said = parameters.text("POINT", "UNITS");
    let metres = match said.as_deref().map(str::to_ascii_lowercase).as_deref() {
        Some("m" | "meter" | "meters" | "metre" | "metres") => Some(1.0),
        Some("cm") => Some(0.01),
        Some("mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres") => Some(0.001),
        Some("in" | "inch" | "inches") => Some(0.0254),
        Some("ft" | "foot" | "feet") => Some(0.3048),
        _ => None,
    };
    metres.unwrap_or_else(|| {
        warnings.push(match said {
            None => "no unit of length: millimetres assumed".into(),
            Some(unit) => format!(
                "unit of length {}: millimetres assumed",
                quoted(unit.as_bytes())
            ),
        });
        0.001
    })
}

/// The upward axis, y or z.
fn up(
    parameters: &Parameters<'_>,
    names: &[String],
    seen: &[Option<Vector3<f64>>],
    unit_metres: f64,
    warnings: &mut Vec<String>,
) -> Axis {
    if let Some(up) = marker_sets::up(names, seen) {
        return up;
    }
    match parameters.text("POINT", "Y_SCREEN").as_deref() {
        Some("+Z" | "Z") => Axis::Z,
        Some("+Y" | "Y") => Axis::Y,
        _ => {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let metres: Vec<_> = seen.iter().map(|p| p.map(|p| p * unit_metres)).collect();
            upright::detect(&names, &metres, warnings)
        }
    }
}
