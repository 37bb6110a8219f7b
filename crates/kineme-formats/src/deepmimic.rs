//! DeepMimic clips: JSON with a row of 44 numbers a frame, for the character `humanoid3d`.
//!
//! Row: duration (s), root position (3), then rotations of root, chest, neck, right hip (quaternions, w first), right knee
//! (angle), right ankle, right shoulder (quaternions), right elbow (angle), and the left limbs alike. Metres,
//! radians, x forward, y up, z to the right; knees and elbows turn about z. Peng, Abbeel, Levine and van de
//! Panne, "DeepMimic", ACM Transactions on Graphics 37(4), 2018. The rest offsets are those of its character file
//! `humanoid3d` (`AttachX` to `AttachZ` of its joints). The frame rate is that of the first frame's duration; the last
//! frame's is often zero.

use std::fmt;

use kineme::math::rotation::Axis;
use kineme::{Format, Observed, RecordedJoint, Recording, Source};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;
use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};

use crate::error::Result;
use crate::text::Blame;

/// Numbers of a frame.
const WIDTH: usize = 44;

/// How a joint turns in the row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Turn {
    /// Four numbers, w first.
    Ball,
    /// One angle about z.
    Hinge,
}

/// A joint of `humanoid3d` in its own axes, metres.
struct Joint {
    name: &'static str,
    parent: Option<usize>,
    offset: [f64; 3],
    tip: Option<[f64; 3]>,
    turn: Turn,
}

const fn joint(
    name: &'static str,
    parent: usize,
    offset: [f64; 3],
    tip: Option<[f64; 3]>,
    turn: Turn,
) -> Joint {
    Joint {
        name,
        parent: Some(parent),
        offset,
        tip,
        turn,
    }
}

/// The neck's tip is the centre of the head; the elbow's, the wrist; the ankle's, the front of the sole.
const HEAD: Option<[f64; 3]> = Some([0.0, 0.175, 0.0]);
const WRIST: Option<[f64; 3]> = Some([0.0, -0.258947, 0.0]);
const TOE: Option<[f64; 3]> = Some([0.1335, -0.05, 0.0]);

const JOINTS: [Joint; 13] = [
    Joint {
        name: "root",
        parent: None,
        offset: [0.0; 3],
        tip: None,
        turn: Turn::Ball,
    },
    joint("chest", 0, [0.0, 0.236151, 0.0], None, Turn::Ball),
    joint("neck", 1, [0.0, 0.223894, 0.0], HEAD, Turn::Ball),
    joint("right_hip", 0, [0.0, 0.0, 0.084887], None, Turn::Ball),
    joint("right_knee", 3, [0.0, -0.421546, 0.0], None, Turn::Hinge),
    joint("right_ankle", 4, [0.0, -0.40987, 0.0], TOE, Turn::Ball),
    joint(
        "right_shoulder",
        1,
        [-0.02405, 0.2435, 0.18311],
        None,
        Turn::Ball,
    ),
    joint("right_elbow", 6, [0.0, -0.274788, 0.0], WRIST, Turn::Hinge),
    joint("left_hip", 0, [0.0, 0.0, -0.084887], None, Turn::Ball),
    joint("left_knee", 8, [0.0, -0.421546, 0.0], None, Turn::Hinge),
    joint("left_ankle", 9, [0.0, -0.40987, 0.0], TOE, Turn::Ball),
    joint(
        "left_shoulder",
        1,
        [-0.02405, 0.2435, -0.18311],
        None,
        Turn::Ball,
    ),
    joint("left_elbow", 11, [0.0, -0.274788, 0.0], WRIST, Turn::Hinge),
];

/// The part of a clip that is motion.
#[derive(Deserialize)]
struct Clip {
    #[serde(rename = "Frames")]
    frames: Vec<Row>,
}

/// One frame.
struct Row([f64; WIDTH]);

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_seq(RowVisitor)
    }
}

struct RowVisitor;

impl<'de> Visitor<'de> for RowVisitor {
    type Value = Row;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a frame of {WIDTH} numbers")
    }

    // Counted here, so that the message carries the line of the frame.
    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> std::result::Result<Row, A::Error> {
        let mut row = [0.0; WIDTH];
        for (i, slot) in row.iter_mut().enumerate() {
            *slot = seq
                .next_element()?
                .ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        if seq.next_element::<f64>()?.is_some() {
            return Err(A::Error::invalid_length(WIDTH + 1, &self));
        }
        Ok(Row(row))
    }
}

/// Reads a DeepMimic clip of `humanoid3d`; `name` is what errors and the recording call it.
///
/// # Errors
/// [`crate::FormatError`] with the line where the text is no JSON or a frame has not 44 numbers, or naming the
/// frame whose numbers mean nothing.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Recording> {
    let blame = Blame(name);
    let clip: Clip = serde_json::from_slice(bytes).map_err(|e| {
        blame.line(
            e.line().max(1),
            e.to_string(),
            "a DeepMimic clip: a JSON object with `Frames` of 44 numbers each",
        )
    })?;
    let Some(first) = clip.frames.first() else {
        return Err(blame.file("no frame", "at least one frame in `Frames`"));
    };
    let frame_secs = first.0[0];
    if frame_secs.is_nan() || frame_secs <= 0.0 {
        return Err(blame.file(
            format!("a duration of {frame_secs} in the first frame"),
            "seconds above zero",
        ));
    }
    let mut warnings = Vec::new();
    // The last frame's duration counts for nothing.
    let played = &clip.frames[..clip.frames.len() - 1];
    let uneven = |row: &&Row| (row.0[0] - frame_secs).abs() > 1e-3 * frame_secs;
    let others = played.iter().filter(uneven).count();
    if others > 0 {
        warnings.push(format!(
            "{others} frames last longer or shorter than the first, whose duration was taken for all"
        ));
    }
    let source = Source {
        format: Format::DeepMimic,
        up: Axis::Y,
        unit_metres: 1.0,
        warnings,
    };
    let mut rotations = Vec::with_capacity(clip.frames.len() * JOINTS.len());
    let mut places = Vec::with_capacity(clip.frames.len());
    for (number, row) in clip.frames.iter().enumerate() {
        let (head, mut rest) = row.0.split_at(4);
        places.push(source.to_inner(Vector3::new(head[1], head[2], head[3])));
        for joint in &JOINTS {
            let turn = match joint.turn {
                Turn::Ball => {
                    let (q, tail) = rest.split_at(4);
                    rest = tail;
                    let q = Quaternion::new(q[0], q[1], q[2], q[3]);
                    UnitQuaternion::try_new(q, 0.1).ok_or_else(|| {
                        blame.file(
                            format!("({q}) as rotation of `{}` in frame {number}", joint.name),
                            "a unit quaternion",
                        )
                    })?
                }
                Turn::Hinge => {
                    let (angle, tail) = rest.split_at(1);
                    rest = tail;
                    Axis::Z.turn(angle[0])
                }
            };
            rotations.push(source.rotation_to_inner(turn));
        }
    }
    let joints = JOINTS
        .iter()
        .map(|joint| RecordedJoint {
            name: joint.name.into(),
            parent: joint.parent,
            offset: source.to_inner(joint.offset.into()),
            tip: joint.tip.map(|t| source.to_inner(t.into())),
            order: None,
            dof: match (joint.parent, joint.turn) {
                (None, _) => 6,
                (_, Turn::Ball) => 3,
                (_, Turn::Hinge) => 1,
            },
        })
        .collect();
    let mut translations = vec![None; JOINTS.len()];
    translations[0] = Some(places);
    let observed = Observed::Rotations {
        rotations,
        translations,
    };
    Recording::new(name, source, joints, frame_secs.recip(), observed).map_err(|e| blame.refused(e))
}
