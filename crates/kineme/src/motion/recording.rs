//! [`Recording`]: what a motion file holds, in its own skeleton.

use nalgebra::{UnitQuaternion, Vector3};

use crate::error::{Error, Result};
use crate::math::rotation::{Axis, EulerOrder};

/// The file format that a recording came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Biovision hierarchy.
    Bvh,
    /// Acclaim skeleton and motion.
    AsfAmc,
    /// DeepMimic clip.
    DeepMimic,
    /// Markers of a C3D file.
    C3d,
    /// Table of joint positions.
    PositionTable,
    /// MSR-Action3D skeleton text.
    MsrAction3d,
    /// Table of joint angles of a body.
    AngleTable,
    /// Made by a program: nothing was read.
    Synthetic,
}

impl Format {
    /// The name as `info` prints it.
    pub fn name(self) -> &'static str {
        match self {
            Format::Bvh => "bvh",
            Format::AsfAmc => "asf/amc",
            Format::DeepMimic => "deepmimic",
            Format::C3d => "c3d",
            Format::PositionTable => "positions",
            Format::MsrAction3d => "msr-action3d",
            Format::AngleTable => "angles",
            Format::Synthetic => "synthetic",
        }
    }
}

/// Where numbers came from: format, axes and unit of the file, and what the reader had to decide.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The file's format.
    pub format: Format,
    /// The file's upward axis: y or z.
    pub up: Axis,
    /// Metres a unit of length of the file.
    pub unit_metres: f64,
    /// What the reader detected or doubted, for people.
    pub warnings: Vec<String>,
}

impl Source {
    /// A point of the file in our frame: right-handed, z up, x forward, metres.
    ///
    /// A file with y up is turned by the cyclic permutation (x, y, z) -> (z, x, y), which is exact and
    /// makes z, forward in such files by custom, our x.
    pub fn to_inner(&self, p: Vector3<f64>) -> Vector3<f64> {
        self.turn_to_inner(p) * self.unit_metres
    }

    /// A point of our frame in the file's own axes and units.
    pub fn to_native(&self, p: Vector3<f64>) -> Vector3<f64> {
        let p = p / self.unit_metres;
        match self.up {
            Axis::Y => Vector3::new(p.y, p.z, p.x),
            Axis::X | Axis::Z => p,
        }
    }

    /// A rotation of the file in our axes.
    pub fn rotation_to_inner(&self, q: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let v = self.turn_to_inner(q.imag());
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_parts(q.w, v))
    }

    /// A rotation of our frame in the file's own axes.
    pub fn rotation_to_native(&self, q: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let v = q.imag();
        let v = match self.up {
            Axis::Y => Vector3::new(v.y, v.z, v.x),
            Axis::X | Axis::Z => v,
        };
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_parts(q.w, v))
    }

    fn turn_to_inner(&self, p: Vector3<f64>) -> Vector3<f64> {
        match self.up {
            Axis::Y => Vector3::new(p.z, p.x, p.y),
            Axis::X | Axis::Z => p,
        }
    }
}

/// A joint of a recording's own skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedJoint {
    /// The file's name of it, unique in the recording.
    pub name: String,
    /// Its parent, which comes earlier; `None` for a root (bare positions may be all roots).
    pub parent: Option<usize>,
    /// Its place in the parent's frame at rest, metres.
    pub offset: Vector3<f64>,
    /// Where its bone ends, in its own frame, metres: a BVH end site, the tip of an ASF bone.
    pub tip: Option<Vector3<f64>>,
    /// The order in which the file gives its angles, if it turns.
    pub order: Option<EulerOrder>,
    /// Degrees of freedom that the file gives it.
    pub dof: usize,
}

/// What was observed of the joints, frame by frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Observed {
    /// Rotations in the parent's frame, and for some joints translations in place of their offset.
    Rotations {
        /// Frame-major: `rotations[frame * joints + joint]`.
        rotations: Vec<UnitQuaternion<f64>>,
        /// For each joint that translates: its place in the parent's frame at each frame, metres.
        translations: Vec<Option<Vec<Vector3<f64>>>>,
    },
    /// World positions, frame-major, metres; `None` where a point was not seen.
    Positions(Vec<Option<Vector3<f64>>>),
}

/// What a motion file holds: its own skeleton and every frame of it, in metres, z up, x forward.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    name: String,
    source: Source,
    joints: Vec<RecordedJoint>,
    rate_hz: f64,
    frames: usize,
    observed: Observed,
}

impl Recording {
    /// A recording of these joints at `rate_hz`.
    ///
    /// # Errors
    /// Without joints or frames, when a parent does not come before its child, when lengths disagree,
    /// when a number is not finite or the rate not positive.
    pub fn new(
        name: impl Into<String>,
        source: Source,
        joints: Vec<RecordedJoint>,
        rate_hz: f64,
        observed: Observed,
    ) -> Result<Self> {
        let n = joints.len();
        if n == 0 {
            return Err(Error::invalid("a recording needs at least one joint"));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Error::invalid(format!(
                "a recording needs a positive frame rate, found {rate_hz} Hz"
            )));
        }
        if let Some((i, joint)) = joints
            .iter()
            .enumerate()
            .find(|(i, j)| j.parent.is_some_and(|p| p >= *i))
        {
            return Err(Error::invalid(format!(
                "parents come before children, but joint {i} `{}` does not follow its parent",
                joint.name
            )));
        }
        let finite = |v: &Vector3<f64>| v.iter().all(|c| c.is_finite());
        let rest_finite = joints
            .iter()
            .all(|j| finite(&j.offset) && j.tip.as_ref().is_none_or(finite));
        let (values, ok) = match &observed {
            Observed::Rotations {
                rotations,
                translations,
            } => {
                let frames = rotations.len() / n;
                let lengths = translations.len() == n
                    && translations.iter().flatten().all(|t| t.len() == frames);
                if !lengths {
                    return Err(Error::invalid(
                        "translations do not match joints and frames",
                    ));
                }
                let ok = rotations
                    .iter()
                    .all(|q| q.coords.iter().all(|c| c.is_finite()))
                    && translations.iter().flatten().flatten().all(finite);
                (rotations.len(), ok)
            }
            Observed::Positions(positions) => {
                (positions.len(), positions.iter().flatten().all(finite))
            }
        };
        if values == 0 || values % n != 0 {
            return Err(Error::invalid(format!(
                "{values} values are no whole number of frames of {n} joints"
            )));
        }
        if !(ok && rest_finite) {
            return Err(Error::invalid("a recording needs finite numbers"));
        }
        Ok(Self {
            name: name.into(),
            source,
            joints,
            rate_hz,
            frames: values / n,
            observed,
        })
    }

    /// A recording of parts known to agree, such as those of a valid motion.
    pub(super) fn of_parts(
        name: &str,
        source: Source,
        joints: Vec<RecordedJoint>,
        rate_hz: f64,
        frames: usize,
        observed: Observed,
    ) -> Self {
        Self {
            name: name.into(),
            source,
            joints,
            rate_hz,
            frames,
            observed,
        }
    }

    /// The same with another source, known to be valid.
    pub(super) fn sourced(mut self, source: Source) -> Self {
        self.source = source;
        self
    }

    /// The recording's name, as `info` prints it: `set.zip/inner/walk.bvh`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where it came from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Its joints, parents before children.
    pub fn joints(&self) -> &[RecordedJoint] {
        &self.joints
    }

    /// Frames a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The number of frames, at least one.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Seconds from the first to the last frame: 0 for a single one.
    pub fn duration_secs(&self) -> f64 {
        (self.frames - 1) as f64 / self.rate_hz
    }

    /// Degrees of freedom of the file's skeleton.
    pub fn dof(&self) -> usize {
        self.joints.iter().map(|j| j.dof).sum()
    }

    /// What was observed.
    pub fn observed(&self) -> &Observed {
        &self.observed
    }

    /// World placements of all joints at a frame: position (metres), and orientation where rotations were observed.
    ///
    /// # Panics
    /// When `frame` is not below [`Self::frames`].
    pub fn placements(&self, frame: usize) -> Vec<Placement> {
        let mut placed = Vec::with_capacity(self.joints.len());
        self.place(frame, &mut placed);
        placed
    }

    /// As [`Self::placements`], written over `placed`, whose memory serves frame after frame.
    ///
    /// # Panics
    /// When `frame` is not below [`Self::frames`].
    pub fn place(&self, frame: usize, placed: &mut Vec<Placement>) {
        assert!(frame < self.frames, "frame {frame} of {}", self.frames);
        let n = self.joints.len();
        placed.clear();
        match &self.observed {
            Observed::Positions(positions) => placed.extend(
                positions[frame * n..(frame + 1) * n]
                    .iter()
                    .map(|&position| Placement {
                        position,
                        rotation: None,
                    }),
            ),
            Observed::Rotations {
                rotations,
                translations,
            } => {
                for (j, joint) in self.joints.iter().enumerate() {
                    let local = translations[j].as_ref().map_or(joint.offset, |t| t[frame]);
                    let turn = rotations[frame * n + j];
                    let parent = joint
                        .parent
                        .and_then(|p| placed[p].position.zip(placed[p].rotation));
                    let (position, rotation) = match parent {
                        Some((p, q)) => (p + q * local, q * turn),
                        None => (local, turn),
                    };
                    placed.push(Placement {
                        position: Some(position),
                        rotation: Some(rotation),
                    });
                }
            }
        }
    }
}

/// Where a joint is in the world, as far as it was observed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// World position, metres; `None` where it was not seen.
    pub position: Option<Vector3<f64>>,
    /// World orientation of the joint's own frame; `None` for bare positions.
    pub rotation: Option<UnitQuaternion<f64>>,
}
