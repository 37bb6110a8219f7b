//! What a BVH file leaves unsaid: how positions are meant, which axis is up, what a unit is.

use kineme::math::rotation::Axis;
use kineme::{Format, Observed, RecordedJoint, Recording, Source};
use nalgebra::{UnitQuaternion, Vector3};

use super::{Channel, File, Joint};
use crate::error::Result;
use crate::text::{Blame, shortest};

/// Metres of the units in use: metre, centimetre, inch, millimetre, and CMU's (0.45 inches to the unit).
const UNITS: [f64; 5] = [1.0, 0.01, 0.0254, 0.001, 0.0254 / 0.45];
/// The longest chain of bones below the first branching joint of an adult, metres.
const REACH: f64 = 1.15;
/// Frames looked at to decide.
const SAMPLES: usize = 24;

/// What position channels mean at a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reading {
    /// They stand in place of `OFFSET`.
    Replace,
    /// They are added to it.
    Add,
}

/// What is decided about a file, and why, where it matters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Decided {
    pub(super) up: Axis,
    pub(super) root: Reading,
    pub(super) children: Reading,
    unit_metres: f64,
    why: Vec<String>,
}

/// Position channels of one joint.
#[derive(Debug, Clone)]
pub(super) struct Positions {
    /// A frame each; zero where the file has no channel for the axis.
    pub(super) values: Vec<Vector3<f64>>,
    /// The axes that have a channel.
    pub(super) given: [bool; 3],
}

impl Positions {
    /// The joint's place in its parent's frame.
    fn place(&self, frame: usize, offset: &Vector3<f64>, reading: Reading) -> Vector3<f64> {
        let value = self.values[frame];
        match reading {
            Reading::Add => offset + value,
            Reading::Replace => Vector3::from_fn(|axis, _| {
                if self.given[axis] {
                    value[axis]
                } else {
                    offset[axis]
                }
            }),
        }
    }
}

/// A motion in the file's axes and units, positions not yet understood.
#[derive(Debug)]
pub(super) struct Clip {
    pub(super) joints: Vec<Joint>,
    pub(super) frames: usize,
    /// `rotations[frame * joints + joint]`.
    pub(super) rotations: Vec<UnitQuaternion<f64>>,
    pub(super) positions: Vec<Option<Positions>>,
}

/// The recording of a file, its conventions decided and told.
pub(super) fn recording(name: &str, file: File, bytes: usize) -> Result<Recording> {
    let blame = Blame(name);
    blame.proportionate(file.joints.len(), file.frames, bytes)?;
    let mut warnings = file.warnings;
    let clip = Clip::new(file.joints, file.frames, &file.values);
    let decided = clip.decide();
    warnings.extend(decided.why.iter().cloned());
    let source = Source {
        format: Format::Bvh,
        up: decided.up,
        unit_metres: decided.unit_metres,
        warnings,
    };
    clip.into_recording(name, source, &decided, file.frame_secs)
}

impl Clip {
    fn new(joints: Vec<Joint>, frames: usize, values: &[f64]) -> Self {
        let width = joints.iter().map(|j| j.channels.len()).sum::<usize>();
        let orders: Vec<_> = joints.iter().map(Joint::order).collect();
        let mut positions: Vec<Option<Positions>> = joints
            .iter()
            .map(|joint| {
                let given = [Axis::X, Axis::Y, Axis::Z]
                    .map(|a| joint.channels.contains(&Channel::Position(a)));
                given.contains(&true).then(|| Positions {
                    values: Vec::with_capacity(frames),
                    given,
                })
            })
            .collect();
        let mut rotations = Vec::with_capacity(joints.len() * frames);
        for row in values.chunks_exact(width) {
            let mut rest = row;
            for ((joint, order), positions) in joints.iter().zip(&orders).zip(&mut positions) {
                let (own, tail) = rest.split_at(joint.channels.len());
                rest = tail;
                let mut angles = [0.0; 3];
                let mut turns = 0;
                let mut place = Vector3::zeros();
                for (channel, &value) in joint.channels.iter().zip(own) {
                    match channel {
                        Channel::Position(axis) => place[axis.index()] = value,
                        Channel::Rotation(_) => {
                            angles[turns] = value.to_radians();
                            turns += 1;
                        }
                    }
                }
                rotations.push(order.map_or_else(UnitQuaternion::identity, |o| o.rotation(angles)));
                if let Some(positions) = positions {
                    positions.values.push(place);
                }
            }
        }
        Self {
            joints,
            frames,
            rotations,
            positions,
        }
    }

    /// Decides what the file leaves open: see the rules in the module above.
    pub(super) fn decide(&self) -> Decided {
        let mut why = Vec::new();
        let children = self.children(&mut why);
        let up = self.up(children);
        let reach = self.longest_chain(children);
        let root = self.root(up, children, reach, &mut why);
        let unit_metres = unit(reach);
        let axis = if up == Axis::Y { "y" } else { "z" };
        let told = shortest((unit_metres * 1e7).round() / 1e7);
        let metres = reach * unit_metres;
        why.insert(
            0,
            format!(
                "read as {axis} up, {told} m a unit (the longest chain of bones is {metres:.2} m)"
            ),
        );
        Decided {
            up,
            root,
            children,
            unit_metres,
            why,
        }
    }

    fn up(&self, children: Reading) -> Axis {
        let slant = |points: &[Vector3<f64>]| {
            let extent = |axis| {
                let (low, high) = bounds(points, axis);
                high - low
            };
            extent(2) / extent(1).max(f64::MIN_POSITIVE)
        };
        let mut posed: Vec<f64> = self
            .sampled()
            .map(|frame| slant(&self.posed(frame, Reading::Replace, children)))
            .collect();
        posed.sort_by(f64::total_cmp);
        let posed = posed[posed.len() / 2];
        let rest = slant(&self.points(|_| UnitQuaternion::identity(), |j| self.joints[j].offset));
        if posed > 1.0 && rest > 1.0 / 1.5 && posed.max(rest) > 1.5 {
            Axis::Z
        } else {
            Axis::Y
        }
    }

    /// What positions of the root mean.
    fn root(&self, up: Axis, children: Reading, body: f64, why: &mut Vec<String>) -> Reading {
        let open = self
            .joints
            .iter()
            .zip(&self.positions)
            .find_map(|(joint, positions)| {
                let positions = positions.as_ref().filter(|_| joint.parent.is_none())?;
                (joint.offset.norm() > 1e-3 * body).then_some((joint.offset, positions))
            });
        let Some((offset, positions)) = open else {
            return Reading::Replace;
        };
        let first = positions.place(0, &offset, Reading::Replace);
        if (first - offset).norm() <= 0.05 * offset.norm() {
            why.push("position channels of the root replace its OFFSET, which they repeat".into());
            return Reading::Replace;
        }
        let lowest = |reading| {
            self.sampled()
                .map(|frame| bounds(&self.posed(frame, reading, children), up.index()).0)
                .fold(f64::INFINITY, f64::min)
        };
        let (replaced, added) = (lowest(Reading::Replace), lowest(Reading::Add));
        let (reading, word, chosen, other) =
            if added.abs() < replaced.abs() && added.abs() < 0.5 * body {
                (Reading::Add, "are added to", added, replaced)
            } else {
                (Reading::Replace, "replace", replaced, added)
            };
        why.push(format!(
            "position channels of the root {word} its OFFSET: the lowest point is then at {chosen:.1} units, else at {other:.1}"
        ));
        reading
    }

    /// The vote of the joints below the root.
    fn children(&self, why: &mut Vec<String>) -> Reading {
        let (mut near_offset, mut near_zero) = (0, 0);
        for (joint, positions) in self.joints.iter().zip(&self.positions) {
            let (Some(positions), Some(_)) = (positions, joint.parent) else {
                continue;
            };
            let sum: Vector3<f64> = positions.values.iter().sum();
            let mean = sum / self.frames as f64;
            let size = joint.offset.norm();
            if size == 0.0 {
                continue;
            }
            if (mean - joint.offset).norm() <= 0.25 * size {
                near_offset += 1;
            } else if mean.norm() <= 0.25 * size {
                near_zero += 1;
            }
        }
        let reading = if near_zero > near_offset {
            Reading::Add
        } else {
            Reading::Replace
        };
        if near_zero + near_offset > 0 {
            let (word, votes) = match reading {
                Reading::Add => ("are added to", near_zero),
                Reading::Replace => ("replace", near_offset),
            };
            why.push(format!(
                "position channels of joints below the root {word} their OFFSET, as {votes} of {} joints suggest",
                near_zero + near_offset
            ));
        }
        reading
    }

    /// Length of the longest chain of bones below [`Self::top`], as posed in the first frame.
    fn longest_chain(&self, children: Reading) -> f64 {
        let n = self.joints.len();
        let top = self.top();
        let mut lengths: Vec<Option<f64>> = vec![None; n];
        lengths[top] = Some(0.0);
        let mut longest = 0.0f64;
        for (j, joint) in self.joints.iter().enumerate().skip(top) {
            if let Some(above) = joint.parent.and_then(|p| lengths[p]) {
                lengths[j] = Some(above + self.local(0, j, Reading::Replace, children).norm());
            }
            if let Some(length) = lengths[j] {
                longest = longest.max(length + joint.site.map_or(0.0, |s| s.norm()));
            }
        }
        longest
    }

    /// The first joint that branches, else the first: what comes before leads from the floor to the hips.
    fn top(&self) -> usize {
        let mut branches = vec![0usize; self.joints.len()];
        for parent in self.joints.iter().filter_map(|j| j.parent) {
            branches[parent] += 1;
        }
        branches.iter().position(|&b| b > 1).unwrap_or(0)
    }

    fn sampled(&self) -> impl Iterator<Item = usize> {
        let count = SAMPLES.min(self.frames);
        let last = self.frames - 1;
        (0..count).map(move |i| i * last / (count - 1).max(1))
    }

    fn local(&self, frame: usize, j: usize, root: Reading, children: Reading) -> Vector3<f64> {
        let joint = &self.joints[j];
        let reading = if joint.parent.is_some() {
            children
        } else {
            root
        };
        match &self.positions[j] {
            Some(positions) => positions.place(frame, &joint.offset, reading),
            None => joint.offset,
        }
    }

    /// Points of a frame: joints and end sites, from [`Self::top`] on.
    fn posed(&self, frame: usize, root: Reading, children: Reading) -> Vec<Vector3<f64>> {
        let n = self.joints.len();
        self.points(
            |j| self.rotations[frame * n + j],
            |j| self.local(frame, j, root, children),
        )
    }

    fn points(
        &self,
        turn: impl Fn(usize) -> UnitQuaternion<f64>,
        local: impl Fn(usize) -> Vector3<f64>,
    ) -> Vec<Vector3<f64>> {
        let mut frames: Vec<(Vector3<f64>, UnitQuaternion<f64>)> =
            Vec::with_capacity(self.joints.len());
        let mut points = Vec::with_capacity(self.joints.len());
        let top = self.top();
        for (j, joint) in self.joints.iter().enumerate() {
            let (place, rotation) = match joint.parent {
                Some(p) => (frames[p].0 + frames[p].1 * local(j), frames[p].1 * turn(j)),
                None => (local(j), turn(j)),
            };
            frames.push((place, rotation));
            if j >= top {
                points.push(place);
                points.extend(joint.site.map(|s| place + rotation * s));
            }
        }
        points
    }

    fn into_recording(
        self,
        name: &str,
        source: Source,
        decided: &Decided,
        frame_secs: f64,
    ) -> Result<Recording> {
        let translations = self
            .joints
            .iter()
            .zip(&self.positions)
            .map(|(joint, positions)| {
                let reading = if joint.parent.is_some() {
                    decided.children
                } else {
                    decided.root
                };
                let positions = positions.as_ref()?;
                let places = (0..self.frames)
                    .map(|f| source.to_inner(positions.place(f, &joint.offset, reading)));
                Some(places.collect())
            })
            .collect();
        let joints = self
            .joints
            .iter()
            .map(|joint| RecordedJoint {
                name: joint.name.clone(),
                parent: joint.parent,
                offset: source.to_inner(joint.offset),
                tip: joint.site.map(|s| source.to_inner(s)),
                order: joint.order(),
                dof: joint.channels.len(),
            })
            .collect();
        let mut rotations = self.rotations;
        for rotation in &mut rotations {
            *rotation = source.rotation_to_inner(*rotation);
        }
        let observed = Observed::Rotations {
            rotations,
            translations,
        };
        Recording::new(name, source, joints, frame_secs.recip(), observed)
            .map_err(|e| Blame(name).refused(e))
    }
}

/// Metres a unit: the one in use that makes the longest chain of bones nearest an adult's.
fn unit(chain: f64) -> f64 {
    let miss = |unit: f64| (chain * unit / REACH).ln().abs();
    let mut best = UNITS[0];
    for unit in UNITS {
        if miss(unit) < miss(best) {
            best = unit;
        }
    }
    best
}

fn bounds(points: &[Vector3<f64>], axis: usize) -> (f64, f64) {
    points
        .iter()
        .map(|p| p[axis])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        })
}
