//! Motions as NPZ, for NumPy: a zip archive, not compressed, of arrays in NPY format 1.0.
//!
//! ```python
//! motion = numpy.load("walk.npz")
//! motion["poses"][:, motion["coordinates"] == "left_shoulder_y"]
//! ```
//!
//! Every archive holds `rate` (Hz, no dimension), `time` (frames; seconds from 0), `joints` (names) and `positions`
//! (frames x joints x 3; metres, z up, x forward, unless written in the source's own axes); points that were not seen
//! are NaN. Numbers are little-endian f64, names little-endian UTF-32. Time stamps are fixed: the same motion gives
//! the same bytes.
//!
//! Source of the layout: NumPy, `numpy.lib.format`, format version 1.0.

use std::io::{Cursor, Write};

use kineme::{Motion, Observed, Recording};
use nalgebra::{UnitQuaternion, Vector3};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use crate::error::{FormatError, Place, Result};
use crate::positions::{Frame, points};

/// A motion of a body. Beside what every archive holds: `body` (its name), `coordinates` (names), `poses`
/// (frames x coordinates; radians) and `root` (frames x 4: x, y, z in metres and yaw in radians).
///
/// # Errors
/// When the archive cannot be made.
pub fn write(motion: &Motion) -> Result<Vec<u8>> {
    let (skeleton, frames) = (motion.skeleton(), motion.frames());
    let mut arrays = Arrays::new(motion.name());
    arrays.names("body", &[], &[skeleton.name()])?;
    arrays.clock(motion.rate_hz(), frames)?;
    let coordinates = skeleton.coordinate_names();
    arrays.names("coordinates", &[coordinates.len()], &coordinates)?;
    arrays.numbers(
        "poses",
        &[frames, skeleton.dof()],
        motion.poses().iter().copied(),
    )?;
    let root = motion.roots().iter();
    let root = root.flat_map(|r| [r.position.x, r.position.y, r.position.z, r.yaw]);
    arrays.numbers("root", &[frames, 4], root)?;
    let joints: Vec<&str> = skeleton.joints().iter().map(|j| j.name.as_str()).collect();
    arrays.names("joints", &[joints.len()], &joints)?;
    let track = motion.joints();
    let positions = (0..frames)
        .flat_map(|f| track.at(f))
        .flat_map(Vector3::iter);
    arrays.numbers("positions", &[frames, joints.len(), 3], positions.copied())?;
    arrays.finish()
}

/// A recording as it is. Beside what every archive holds: `parents` (joints; their index, -1 for none) and, where
/// rotations were observed, `rotations` (frames x joints x 4; unit quaternions w, x, y, z in the parent's frame).
///
/// # Errors
/// When the archive cannot be made.
pub fn write_recording(recording: &Recording) -> Result<Vec<u8>> {
    let (joints, frames) = (recording.joints(), recording.frames());
    let mut arrays = Arrays::new(recording.name());
    arrays.clock(recording.rate_hz(), frames)?;
    let names: Vec<&str> = joints.iter().map(|j| j.name.as_str()).collect();
    arrays.names("joints", &[names.len()], &names)?;
    let parents = joints.iter().map(|j| j.parent.map_or(-1, |p| p as i64));
    arrays.array(
        "parents",
        "<i8",
        &[names.len()],
        parents.map(i64::to_le_bytes),
    )?;
    let mut placed = Vec::new();
    let positions = (0..frames).flat_map(|f| {
        recording.place(f, &mut placed);
        let points: Vec<_> = placed.iter().map(|p| p.position).collect();
        points.into_iter().flat_map(numbers_of)
    });
    arrays.numbers("positions", &[frames, names.len(), 3], positions)?;
    if let Observed::Rotations { rotations, .. } = recording.observed() {
        let parts = |q: &UnitQuaternion<f64>| [q.w, q.i, q.j, q.k];
        let rotations = rotations.iter().flat_map(parts);
        arrays.numbers("rotations", &[frames, names.len(), 4], rotations)?;
    }
    arrays.finish()
}

/// The points of a recording and nothing else, those that [`crate::positions::write`] writes, in the axes and the
/// unit of `frame`.
///
/// # Errors
/// When the archive cannot be made.
pub fn write_positions(recording: &Recording, frame: Frame) -> Result<Vec<u8>> {
    let (names, frames) = (crate::positions::names(recording), recording.frames());
    let mut arrays = Arrays::new(recording.name());
    arrays.clock(recording.rate_hz(), frames)?;
    arrays.names("joints", &[names.len()], &names)?;
    let positions = (0..frames).flat_map(|f| points(recording, frame, f));
    let positions = positions.flat_map(numbers_of);
    arrays.numbers("positions", &[frames, names.len(), 3], positions)?;
    arrays.finish()
}

fn numbers_of(point: Option<Vector3<f64>>) -> [f64; 3] {
    point.map_or([f64::NAN; 3], Into::into)
}

/// An archive in the making.
struct Arrays {
    file: String,
    zip: ZipWriter<Cursor<Vec<u8>>>,
}

impl Arrays {
    fn new(file: &str) -> Self {
        Self {
            file: file.to_string(),
            zip: ZipWriter::new(Cursor::new(Vec::new())),
        }
    }

    /// The arrays `rate` and `time`.
    fn clock(&mut self, rate_hz: f64, frames: usize) -> Result<()> {
        self.numbers("rate", &[], [rate_hz])?;
        self.numbers("time", &[frames], (0..frames).map(|f| f as f64 / rate_hz))
    }

    fn numbers(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = f64>,
    ) -> Result<()> {
        self.array(name, "<f8", shape, values.into_iter().map(f64::to_le_bytes))
    }

    fn names(&mut self, name: &str, shape: &[usize], values: &[impl AsRef<str>]) -> Result<()> {
        let values = values.iter().map(AsRef::as_ref);
        // NumPy pads shorter names with zeros and drops them on the way in.
        let longest = values.clone().map(|v| v.chars().count()).max();
        let width = longest.unwrap_or(0).max(1);
        let padded = values.flat_map(|v| {
            let letters = v.chars().map(u32::from);
            letters.chain(std::iter::repeat(0)).take(width)
        });
        self.array(
            name,
            &format!("<U{width}"),
            shape,
            padded.map(u32::to_le_bytes),
        )
    }

    fn array<const N: usize>(
        &mut self,
        name: &str,
        kind: &str,
        shape: &[usize],
        values: impl Iterator<Item = [u8; N]>,
    ) -> Result<()> {
        let mut bytes = header(kind, shape);
        bytes.extend(values.flatten());
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::DEFAULT)
            .system(System::Unix)
            .unix_permissions(0o644)
            .large_file(bytes.len() as u64 >= zip::ZIP64_BYTES_THR);
        self.zip
            .start_file(format!("{name}.npy"), options)
            .and_then(|()| Ok(self.zip.write_all(&bytes)?))
            .map_err(|e| unwritten(&self.file, &e.to_string()))
    }

    fn finish(self) -> Result<Vec<u8>> {
        let archive = self.zip.finish();
        let archive = archive.map_err(|e| unwritten(&self.file, &e.to_string()))?;
        Ok(archive.into_inner())
    }
}

fn unwritten(file: &str, found: &str) -> FormatError {
    FormatError::new(file, Place::File, found, "an archive that can be made")
}

/// What stands before an array's data in NPY format 1.0: magic, version, length and a Python dictionary, padded with
/// spaces so that the data begin at a multiple of 64 bytes.
fn header(kind: &str, shape: &[usize]) -> Vec<u8> {
    let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let tuple = shape.join(", ") + comma;
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({tuple}), }}");
    const BEFORE: usize = 10;
    let full = (BEFORE + text.len() + 1).next_multiple_of(64);
    text.extend(std::iter::repeat_n(' ', full - BEFORE - text.len() - 1));
    text.push('\n');
    // A few dimensions and a type make a header of one or two lines of 64 bytes: its length fits.
    let length = (text.len() as u16).to_le_bytes();
    [&b"\x93NUMPY\x01\x00"[..], &length, text.as_bytes()].concat()
}
