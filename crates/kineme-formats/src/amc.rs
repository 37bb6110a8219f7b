//! AMC, the Acclaim motion of an ASF skeleton: for each frame its number, then a line a bone.

use kineme::{Observed, Recording};
use nalgebra::{UnitQuaternion, Vector3};

use crate::asf::{Bone, Dof, Skeleton};
use crate::error::Result;
use crate::text::{Blame, Lines, number, quoted, words};

/// Frames a second where nobody says another: that of the published AMC collections.
pub const DEFAULT_RATE_HZ: f64 = 120.0;

/// Reads an AMC file of a skeleton. AMC has no time base: `rate_hz` is that of its publisher, by default
/// [`DEFAULT_RATE_HZ`].
///
/// # Errors
/// [`crate::FormatError`] with the line where a frame is cut, lacks a bone of the skeleton, or names
/// another one.
pub fn parse(
    name: &str,
    bytes: &[u8],
    skeleton: &Skeleton,
    rate_hz: Option<f64>,
) -> Result<Recording> {
    let blame = Blame(name);
    let n = skeleton.joints.len();
    let moving = skeleton.bones.iter().filter(|b| !b.dof.is_empty()).count();
    let mut degrees = skeleton.degrees;
    let mut lines = Lines::new(bytes);
    let mut rotations: Vec<UnitQuaternion<f64>> = Vec::new();
    let mut places: Vec<Vector3<f64>> = Vec::new();
    let mut frame: Option<Frame> = None;
    while let Some((at, line)) = lines.next_full() {
        if line.starts_with(b"#") {
            continue;
        }
        if let Some(key) = line.strip_prefix(b":") {
            match key.to_ascii_uppercase().as_slice() {
                b"DEGREES" => degrees = true,
                b"RADIANS" => degrees = false,
                _ => {}
            }
            continue;
        }
        if line.iter().all(u8::is_ascii_digit) {
            if let Some(done) = frame.take() {
                done.finish(blame, at, skeleton, moving, &mut rotations, &mut places)?;
                blame.proportionate(n, places.len(), bytes.len())?;
            }
            frame = Some(Frame::new(line, n));
            continue;
        }
        let Some(frame) = &mut frame else {
            return Err(blame.line(at, quoted(line), "the number of the first frame"));
        };
        let mut parts = words(line);
        let key = parts.next().unwrap_or_default();
        let index = skeleton
            .by_name
            .get(&key.to_ascii_lowercase())
            .copied()
            .ok_or_else(|| blame.line(at, quoted(key), "a bone of the ASF"))?;
        let bone = &skeleton.bones[index];
        let values: Option<Vec<f64>> = parts.map(number).collect();
        let values = values
            .filter(|v| v.len() == bone.dof.len())
            .ok_or_else(|| {
                let expected = format!(
                    "{} numbers, the dof of `{}` in the ASF",
                    bone.dof.len(),
                    skeleton.joints[index].name
                );
                blame.line(at, quoted(line), expected)
            })?;
        let (turn, place) = posed(bone, &values, degrees);
        if frame.posed[index].replace(turn).is_some() {
            return Err(blame.line(
                at,
                format!("{} twice in one frame", quoted(key)),
                "the number of the next frame before it",
            ));
        }
        frame.given += usize::from(!bone.dof.is_empty());
        if index == 0 {
            frame.place = place;
        }
    }
    let last = lines.number();
    match frame {
        Some(done) => done.finish(blame, last, skeleton, moving, &mut rotations, &mut places)?,
        None => return Err(blame.line(last, "no frame", "frames, each begun by its number")),
    }
    let source = skeleton.source.clone();
    for place in &mut places {
        *place = source.to_inner(*place);
    }
    for rotation in &mut rotations {
        *rotation = source.rotation_to_inner(*rotation);
    }
    let mut translations = vec![None; n];
    translations[0] = Some(places);
    let observed = Observed::Rotations {
        rotations,
        translations,
    };
    Recording::new(
        name,
        source,
        skeleton.joints.clone(),
        rate_hz.unwrap_or(DEFAULT_RATE_HZ),
        observed,
    )
    .map_err(|e| blame.refused(e))
}

/// `C M C^-1` of a bone and, of the root, its place, in the file's axes and units.
fn posed(bone: &Bone, values: &[f64], degrees: bool) -> (UnitQuaternion<f64>, Vector3<f64>) {
    let mut place = Vector3::zeros();
    let mut turns = [0.0; 3];
    for (dof, &value) in bone.dof.iter().zip(values) {
        match dof {
            Dof::Move(axis) => place[axis.index()] = value,
            Dof::Turn(axis) if degrees => turns[axis.index()] = value.to_radians(),
            Dof::Turn(axis) => turns[axis.index()] = value,
        }
    }
    let motion = bone.order.rotation(bone.order.0.map(|a| turns[a.index()]));
    (bone.axes * motion * bone.axes.inverse(), place)
}

/// A frame as far as it was read.
struct Frame {
    label: String,
    posed: Vec<Option<UnitQuaternion<f64>>>,
    given: usize,
    place: Vector3<f64>,
}

impl Frame {
    fn new(label: &[u8], bones: usize) -> Self {
        Self {
            label: quoted(label),
            posed: vec![None; bones],
            given: 0,
            place: Vector3::zeros(),
        }
    }

    /// Appends the frame, which must have every bone that moves; `at` is the line where it ends.
    fn finish(
        self,
        blame: Blame<'_>,
        at: usize,
        skeleton: &Skeleton,
        moving: usize,
        rotations: &mut Vec<UnitQuaternion<f64>>,
        places: &mut Vec<Vector3<f64>>,
    ) -> Result<()> {
        if self.given != moving {
            let absent = (0..self.posed.len())
                .find(|&b| self.posed[b].is_none() && !skeleton.bones[b].dof.is_empty())
                .map_or("", |b| skeleton.joints[b].name.as_str());
            return Err(blame.line(
                at,
                format!("the end of frame {} without bone `{absent}`", self.label),
                "a line for every bone that the ASF gives a dof",
            ));
        }
        rotations.extend(self.posed.into_iter().map(Option::unwrap_or_default));
        places.push(self.place);
        Ok(())
    }
}
