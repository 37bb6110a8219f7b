//! A recording as BVH, in the axes, units and channel orders of the file it came from.

use std::fmt::Write as _;
use std::io::Write;

use kineme::math::rotation::{Axis, EulerOrder, wrap};
use kineme::{Observed, Recording};
use nalgebra::{UnitQuaternion, Vector3};

use super::interpret::{Clip, Positions, Reading};
use super::{Channel, Joint};
use crate::error::{FormatError, Place, Result};
use crate::text::shortest;

/// The order given to joints that came without one.
const ORDER: EulerOrder = EulerOrder([Axis::Z, Axis::X, Axis::Y]);
/// Deeper joints are not indented further, so that a chain of n joints takes n lines, not n squared bytes.
const DEEPEST: usize = 60;

/// Writes a recording of rotations as BVH in its source's axes and units; reading it again gives the
/// same placements.
///
/// Joints come depth first. Joints that translate get six channels, the others three; a missing order is ZXY.
/// Angles follow each other without jumps of a whole turn. Position channels are written so that
/// [`super::parse`] understands them as meant: in place of `OFFSET` where its rule finds that, else added, else
/// with `OFFSET` zero. A tip is written as an end site unless a child starts there.
///
/// # Errors
/// When the recording holds bare positions or lengths that overflow in the file's unit, or `out` cannot be written.
pub fn write(recording: &Recording, out: &mut dyn Write) -> Result<()> {
    let Some(clip) = written_clip(recording) else {
        return Err(FormatError::new(
            recording.name(),
            Place::File,
            "bare positions",
            "rotations, which BVH holds (retarget to a body first)",
        ));
    };
    let finite = |v: &Vector3<f64>| v.iter().all(|c| c.is_finite());
    let positions = clip.positions.iter().flatten().flat_map(|p| &p.values);
    let rest = clip
        .joints
        .iter()
        .flat_map(|j| [Some(&j.offset), j.site.as_ref()]);
    if !positions.chain(rest.flatten()).all(finite) {
        return Err(FormatError::new(
            recording.name(),
            Place::File,
            "lengths too large for the file's unit",
            "finite numbers",
        ));
    }
    let mut text = hierarchy(&clip);
    let _ = write!(
        text,
        "MOTION\nFrames: {}\nFrame Time: {}\n",
        clip.frames,
        frame_time(recording.rate_hz())
    );
    let failed = |e: std::io::Error| {
        FormatError::new(
            recording.name(),
            Place::File,
            e.to_string(),
            "a place to write to",
        )
    };
    out.write_all(text.as_bytes()).map_err(failed)?;
    let n = clip.joints.len();
    let mut previous = vec![[0.0; 3]; n];
    for frame in 0..clip.frames {
        text.clear();
        for (j, joint) in clip.joints.iter().enumerate() {
            if let Some(positions) = &clip.positions[j] {
                for value in positions.values[frame].iter() {
                    push(&mut text, rounded(*value));
                }
            }
            let order = joint.order().unwrap_or(ORDER);
            let angles = angles(&order, &clip.rotations[frame * n + j], &previous[j]);
            previous[j] = angles;
            for angle in angles {
                push(&mut text, rounded(angle.to_degrees()));
            }
        }
        text.push('\n');
        out.write_all(text.as_bytes()).map_err(failed)?;
    }
    Ok(())
}

/// The recording as a file's content, joints depth first; `None` without rotations.
fn written_clip(recording: &Recording) -> Option<Clip> {
    let Observed::Rotations {
        rotations,
        translations,
    } = recording.observed()
    else {
        return None;
    };
    let source = recording.source();
    let observed = recording.joints();
    let (n, frames) = (observed.len(), recording.frames());
    let order = depth_first(&observed.iter().map(|j| j.parent).collect::<Vec<_>>());
    let mut place = vec![0; n];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    let mut continued = vec![false; n];
    for child in observed {
        if let Some(parent) = child.parent {
            continued[parent] |= observed[parent].tip == Some(child.offset);
        }
    }
    let mut joints: Vec<Joint> = order
        .iter()
        .map(|&j| {
            let joint = &observed[j];
            let turns = joint.order.unwrap_or(ORDER).0.map(Channel::Rotation);
            let mut channels = Vec::new();
            if translations[j].is_some() {
                channels.extend([Axis::X, Axis::Y, Axis::Z].map(Channel::Position));
            }
            channels.extend(turns);
            Joint {
                name: joint.name.clone(),
                parent: joint.parent.map(|p| place[p]),
                offset: source.to_native(joint.offset),
                site: joint
                    .tip
                    .filter(|_| !continued[j])
                    .map(|t| source.to_native(t)),
                channels,
            }
        })
        .collect();
    let native: Vec<Option<Vec<Vector3<f64>>>> = order
        .iter()
        .map(|&j| {
            let places = translations[j].as_ref()?;
            Some(places.iter().map(|&p| source.to_native(p)).collect())
        })
        .collect();
    let turns = (0..frames)
        .flat_map(|f| order.iter().map(move |&j| f * n + j))
        .map(|at| source.rotation_to_native(rotations[at]))
        .collect();
    let mut clip = Clip {
        positions: vec![None; n],
        joints: Vec::new(),
        frames,
        rotations: turns,
    };
    for reading in [Reading::Replace, Reading::Add] {
        clip.joints.clone_from(&joints);
        clip.positions = positions(&joints, &native, reading);
        let understood = clip.decide();
        if understood.root == reading && understood.children == reading {
            return Some(clip);
        }
    }
    for (joint, places) in joints.iter_mut().zip(&native) {
        if places.is_some() {
            joint.offset = Vector3::zeros();
        }
    }
    clip.positions = positions(&joints, &native, Reading::Replace);
    clip.joints = joints;
    Some(clip)
}

/// Position channels that mean these places under a reading.
fn positions(
    joints: &[Joint],
    places: &[Option<Vec<Vector3<f64>>>],
    reading: Reading,
) -> Vec<Option<Positions>> {
    joints
        .iter()
        .zip(places)
        .map(|(joint, places)| {
            let values = match reading {
                Reading::Replace => places.clone()?,
                Reading::Add => places.as_ref()?.iter().map(|p| p - joint.offset).collect(),
            };
            Some(Positions {
                values,
                given: [true; 3],
            })
        })
        .collect()
}

/// Joint indices in depth-first order, siblings as they come.
fn depth_first(parents: &[Option<usize>]) -> Vec<usize> {
    let mut children = vec![Vec::new(); parents.len()];
    let mut stack = Vec::new();
    for (j, parent) in parents.iter().enumerate().rev() {
        match parent {
            Some(p) => children[*p].push(j),
            None => stack.push(j),
        }
    }
    let mut order = Vec::with_capacity(parents.len());
    while let Some(j) = stack.pop() {
        order.push(j);
        stack.append(&mut children[j]);
    }
    order
}

fn hierarchy(clip: &Clip) -> String {
    let mut text = String::from("HIERARCHY\n");
    let mut open: Vec<usize> = Vec::new();
    let tabs = |depth: usize| "\t".repeat(depth.min(DEEPEST));
    for (j, joint) in clip.joints.iter().enumerate() {
        while open.last().is_some_and(|&top| joint.parent != Some(top)) {
            open.pop();
            let _ = writeln!(text, "{}}}", tabs(open.len()));
        }
        let depth = open.len();
        let outer = tabs(depth);
        let inner = tabs(depth + 1);
        let word = if depth == 0 { "ROOT" } else { "JOINT" };
        let name = plain(&joint.name);
        let _ = writeln!(text, "{outer}{word} {name}\n{outer}{{");
        let _ = writeln!(text, "{inner}OFFSET{}", vector(&joint.offset));
        let _ = write!(text, "{inner}CHANNELS {}", joint.channels.len());
        for channel in &joint.channels {
            let _ = match channel {
                Channel::Position(axis) => write!(text, " {axis:?}position"),
                Channel::Rotation(axis) => write!(text, " {axis:?}rotation"),
            };
        }
        text.push('\n');
        if let Some(site) = &joint.site {
            let deep = tabs(depth + 2);
            let _ = writeln!(
                text,
                "{inner}End Site\n{inner}{{\n{deep}OFFSET{}\n{inner}}}",
                vector(site)
            );
        }
        open.push(j);
    }
    while open.pop().is_some() {
        let _ = writeln!(text, "{}}}", tabs(open.len()));
    }
    text
}

fn vector(v: &Vector3<f64>) -> String {
    let mut text = String::new();
    for value in v.iter() {
        text.push(' ');
        text.push_str(&shortest(rounded(*value)));
    }
    text
}

/// A name without what the format cannot hold: braces, ends of lines.
fn plain(name: &str) -> String {
    let name: String = name
        .trim()
        .chars()
        .map(|c| {
            if c.is_control() || matches!(c, '{' | '}') {
                '_'
            } else {
                c
            }
        })
        .collect();
    if name.is_empty() { "_".into() } else { name }
}

fn push(row: &mut String, value: f64) {
    if !row.is_empty() {
        row.push(' ');
    }
    row.push_str(&shortest(value));
}

/// The number to ten decimals, which brings back the file's own digits; large ones untouched.
fn rounded(value: f64) -> f64 {
    if value.abs() < 1e5 {
        // Adding zero turns -0 into 0.
        (value * 1e10).round() / 1e10 + 0.0
    } else {
        value
    }
}

/// The shortest decimal of seconds a frame that gives this rate back.
fn frame_time(rate_hz: f64) -> String {
    let secs = rate_hz.recip();
    (1..17)
        .map(|digits| format!("{secs:.digits$e}"))
        .find(|text| text.parse::<f64>().is_ok_and(|t| t.recip() == rate_hz))
        .and_then(|text| text.parse::<f64>().ok())
        .map_or_else(|| shortest(secs), shortest)
}

/// Intrinsic angles (radians) of a rotation: exact at gimbal lock too, and of the equivalent triples the one nearest
/// the previous frame's.
fn angles(order: &EulerOrder, q: &UnitQuaternion<f64>, previous: &[f64; 3]) -> [f64; 3] {
    let [first_axis, ..] = order.0;
    let [i, j, k] = order.0.map(Axis::index);
    let proper = i == k;
    // A turn about `a` takes `b` toward the third axis when the three follow each other, else away from it.
    let third = |a: usize, b: usize| 3 - a - b;
    let sign = |a: usize, b: usize| if (b + 3 - a) % 3 == 1 { 1.0 } else { -1.0 };
    let m = q.to_rotation_matrix();
    let (sine, cosine) = if proper {
        (m[(j, i)], -sign(i, j) * m[(third(i, j), i)])
    } else {
        (-sign(i, j) * m[(j, k)], m[(k, k)])
    };
    // At the lock the first angle is free; the others are taken from what it leaves, so nothing is lost.
    let first = if sine.hypot(cosine) > 1e-13 {
        sine.atan2(cosine)
    } else {
        previous[0]
    };
    let rest = (first_axis.turn(-first) * q).to_rotation_matrix();
    // rest = R_j R_k: its column k is that of R_j, its row j that of R_k.
    let middle = (sign(j, k) * rest[(third(j, k), k)]).atan2(rest[(k, k)]);
    let last = (-sign(k, j) * rest[(j, third(k, j))]).atan2(rest[(j, j)]);
    let candidates = [
        [first, middle, last],
        if proper {
            [
                first + std::f64::consts::PI,
                -middle,
                last + std::f64::consts::PI,
            ]
        } else {
            [
                first + std::f64::consts::PI,
                std::f64::consts::PI - middle,
                last + std::f64::consts::PI,
            ]
        },
    ]
    .map(|triple| std::array::from_fn(|a| previous[a] + wrap(triple[a] - previous[a])));
    let far = |triple: &[f64; 3]| -> f64 { (0..3).map(|a| (triple[a] - previous[a]).abs()).sum() };
    if far(&candidates[1]) < far(&candidates[0]) {
        candidates[1]
    } else {
        candidates[0]
    }
}
