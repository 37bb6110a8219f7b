//! What postures are compared by: where the hands are against the shoulders, where the body's joints are against the
//! root, how both moved in the last fifth of a second, and how the root travelled.
//!
//! On real people positions beat rotations, the hands and the whole body together beat either, and displacements tell
//! a movement from its reverse.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{Rotation2, UnitQuaternion, Vector2, Vector3};

use super::rows::{Clock, Path, Row};
use crate::motion::landmarks_of;
use crate::skeleton::{Role, Root, Skeleton};

/// Seconds over which displacements are taken.
pub(super) const WINDOW_SECS: f64 = 0.2;
/// Seconds at the beginning whose mean posture is the offset.
const OFFSET_SECS: f64 = 5.0 / 30.0;
/// Numbers that tell the root's travel: forward and leftward displacement, turn.
const TRAVEL: usize = 3;

/// Which numbers describe a moment of a body.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    body: Arc<Skeleton>,
    /// Joints of the landmarks.
    joints: Vec<usize>,
    /// Landmarks of the two shoulders and of the hands' tips; empty where the body lacks shoulders.
    shoulders: Option<[usize; 2]>,
    tips: Vec<usize>,
    /// For each landmark, the joints whose rotations move it.
    movers: Vec<Vec<usize>>,
}

/// A posture in the numbers of a [`Layout`], and when it was.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    pub secs: f64,
    pub posture: Vec<f64>,
    /// Which of them are not known; empty where all are.
    pub unknown: Vec<bool>,
    pub root: Option<Root>,
}

/// The numbers of a moment and which of them are unknown (empty: none).
#[derive(Debug, Clone)]
pub(super) struct Feature {
    pub values: Vec<f64>,
    pub unknown: Vec<bool>,
}

impl Layout {
    pub fn of(body: &Arc<Skeleton>) -> Self {
        let landmarks = landmarks_of(body);
        let place = |role: Role| landmarks.iter().position(|(r, _)| *r == role);
        let shoulders = match (place(Role::LeftUpperArm), place(Role::RightUpperArm)) {
            (Some(left), Some(right)) => Some([left, right]),
            _ => None,
        };
        let tip = |fingers, hand| place(fingers).or_else(|| place(hand));
        let tips = [
            tip(Role::LeftFingers, Role::LeftHand),
            tip(Role::RightFingers, Role::RightHand),
        ];
        let movers = landmarks.iter().map(|&(_, j)| {
            let mut chain = Vec::new();
            let mut joint = j;
            while let Some(parent) = body.joints()[joint].parent {
                if !body.coordinates(parent).is_empty() {
                    chain.push(parent);
                }
                joint = parent;
            }
            chain
        });
        Self {
            movers: movers.collect(),
            joints: landmarks.iter().map(|(_, j)| *j).collect(),
            tips: match shoulders {
                Some(_) => tips.into_iter().flatten().collect(),
                None => Vec::new(),
            },
            shoulders,
            body: Arc::clone(body),
        }
    }

    /// The body.
    pub fn body(&self) -> &Skeleton {
        &self.body
    }

    /// Which numbers of a feature tell postures, not displacements.
    pub fn still(&self) -> Vec<bool> {
        let split = 3 * self.tips.len();
        let n = self.posture_dims();
        let mut still = Vec::with_capacity(self.dims());
        for part in [split, n - split] {
            still.extend(std::iter::repeat_n(true, part));
            still.extend(std::iter::repeat_n(false, part));
        }
        still.extend([false; TRAVEL]);
        still
    }

    /// The numbers of a posture that tell the hands' tips, and the landmarks of these roles.
    pub fn numbers_of(&self, roles: &[Role]) -> Vec<usize> {
        let tips = self.tips.len();
        let landmarks = landmarks_of(&self.body).into_iter().enumerate();
        let own = landmarks.filter(|(_, (role, _))| roles.contains(role));
        let places = (0..tips).chain(own.map(|(landmark, _)| tips + landmark));
        places.flat_map(|p| 3 * p..3 * p + 3).collect()
    }

    /// Numbers of a posture.
    pub fn posture_dims(&self) -> usize {
        3 * (self.tips.len() + self.joints.len())
    }

    /// Numbers of a feature.
    pub fn dims(&self) -> usize {
        2 * self.posture_dims() + TRAVEL
    }

    /// The hands' part of a feature, and the body's; the first may be empty.
    pub fn parts(&self) -> [Range<usize>; 2] {
        let hands = 6 * self.tips.len();
        [0..hands, hands..self.dims()]
    }

    /// Hands, then landmarks, at a pose.
    pub fn posture(&self, pose: &[f64]) -> Vec<f64> {
        let frames = self.body.frames(pose, &Root::ORIGIN);
        let at = |landmark: usize| frames[self.joints[landmark]].position;
        let mut posture = Vec::with_capacity(self.posture_dims());
        if let Some([left, right]) = self.shoulders.map(|s| s.map(at)) {
            let line = left - right;
            let heading = (-line.x).atan2(line.y);
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -heading);
            for &tip in &self.tips {
                let p = turn * (at(tip) - 0.5 * (left + right));
                posture.extend_from_slice(p.as_slice());
            }
        }
        for landmark in 0..self.joints.len() {
            posture.extend_from_slice(at(landmark).as_slice());
        }
        posture
    }

    /// Which numbers of a posture are unknown when the rotations of these joints are.
    pub fn unknown(&self, lost: &[bool]) -> Vec<bool> {
        if !lost.contains(&true) {
            return Vec::new();
        }
        let hidden = |landmark: usize| self.movers[landmark].iter().any(|&j| lost[j]);
        let shoulders = self.shoulders.is_some_and(|s| s.into_iter().any(hidden));
        let tips = self.tips.iter().map(|&t| shoulders || hidden(t));
        let all = tips.chain((0..self.joints.len()).map(hidden));
        all.flat_map(|h| [h; 3]).collect()
    }

    /// The numbers of a moment, of which another is a window earlier.
    pub fn feature(&self, now: &Moment, then: &Moment, offset: Option<&[f64]>) -> Feature {
        let split = 3 * self.tips.len();
        let n = self.posture_dims();
        let mut values = Vec::with_capacity(self.dims());
        for part in [0..split, split..n] {
            let off = |i: usize| offset.map_or(0.0, |o| 0.5 * o[i]);
            values.extend(part.clone().map(|i| now.posture[i] - off(i)));
            values.extend(part.map(|i| now.posture[i] - then.posture[i]));
        }
        let travel = match (&now.root, &then.root) {
            (Some(now), Some(then)) => Some(travel(now, then)),
            _ => None,
        };
        values.extend(travel.unwrap_or_default());
        let hidden = |m: &Moment, i: usize| m.unknown.get(i).copied().unwrap_or(false);
        let complete = now.unknown.is_empty() && then.unknown.is_empty() && travel.is_some();
        let mut unknown = Vec::new();
        if !complete {
            for part in [0..split, split..n] {
                unknown.extend(part.clone().map(|i| hidden(now, i)));
                unknown.extend(part.map(|i| hidden(now, i) || hidden(then, i)));
            }
            unknown.extend([travel.is_none(); TRAVEL]);
        }
        Feature { values, unknown }
    }

    /// The features of a row's moments, one after the other.
    pub fn of_row(&self, row: &Row, path: &Path<'_>, offset: bool) -> Vec<f64> {
        let clock = Clock::of(path, row.cyclic);
        let moment = |secs: f64| {
            let sample = path.sample(clock.phase(secs));
            Moment {
                secs,
                posture: self.posture(&sample.pose),
                unknown: Vec::new(),
                root: None,
            }
        };
        let offset = offset.then(|| {
            let first: Vec<Moment> = (0..4)
                .map(|k| moment(OFFSET_SECS * f64::from(k) / 3.0))
                .collect();
            mean_posture(first.iter())
        });
        let mut values = Vec::with_capacity(row.phases.len() * self.dims());
        for k in 0..row.phases.len() {
            let secs = k as f64 * row.step_secs - row.still_secs;
            let before = secs - WINDOW_SECS;
            let (now, then) = (moment(secs), moment(before));
            let mut feature = self.feature(&now, &then, offset.as_deref());
            let moved = self.travel_between(path, &clock, before, secs);
            let first = feature.values.len() - TRAVEL;
            feature.values[first..].copy_from_slice(&moved);
            values.append(&mut feature.values);
        }
        values
    }

    /// The root's travel along a path, by Simpson's rule.
    fn travel_between(&self, path: &Path<'_>, clock: &Clock, from: f64, to: f64) -> [f64; TRAVEL] {
        let rate = |secs: f64| {
            if !clock.runs(secs) {
                return [0.0; TRAVEL];
            }
            let t = path.sample(clock.phase(secs)).travel;
            [t.forward, t.left, t.yaw_rate]
        };
        let [a, b, c] = [rate(from), rate(0.5 * (from + to)), rate(to)];
        std::array::from_fn(|i| (to - from) * (a[i] + 4.0 * b[i] + c[i]) / 6.0)
    }
}

/// Displacement forward and to the left, in the direction faced now, and the turn to the left.
fn travel(now: &Root, then: &Root) -> [f64; TRAVEL] {
    let p = now.position - then.position;
    let v = Rotation2::new(-now.yaw) * Vector2::new(p.x, p.y);
    [v.x, v.y, now.yaw - then.yaw]
}

fn mean_posture<'a>(moments: impl Iterator<Item = &'a Moment>) -> Vec<f64> {
    let mut mean: Vec<f64> = Vec::new();
    let mut count = 0.0;
    for m in moments {
        mean.resize(m.posture.len(), 0.0);
        for (sum, v) in mean.iter_mut().zip(&m.posture) {
            *sum += v;
        }
        count += 1.0;
    }
    for sum in &mut mean {
        *sum /= count;
    }
    mean
}

/// The last moments of a stream.
#[derive(Debug, Clone, Default)]
pub(super) struct Recent {
    moments: VecDeque<Moment>,
}

impl Recent {
    /// Takes the newest moment, and forgets what no window needs any more.
    pub fn push(&mut self, moment: Moment) {
        let from = moment.secs - WINDOW_SECS;
        while self.moments.get(1).is_some_and(|m| m.secs <= from) {
            self.moments.pop_front();
        }
        self.moments.push_back(moment);
    }

    /// The newest moment.
    pub fn now(&self) -> Option<&Moment> {
        self.moments.back()
    }

    /// The moment a window before the newest; the oldest where that is younger.
    pub fn then(&self) -> Option<Moment> {
        let (now, oldest) = (self.moments.back()?, self.moments.front()?);
        let secs = now.secs - WINDOW_SECS;
        let Some(next) = self
            .moments
            .get(1)
            .filter(|n| oldest.secs < secs && n.secs > secs)
        else {
            return Some(oldest.clone());
        };
        let s = (secs - oldest.secs) / (next.secs - oldest.secs);
        let between = |a: f64, b: f64| a + s * (b - a);
        let postures = oldest.posture.iter().zip(&next.posture);
        let hidden = |m: &Moment, i: usize| m.unknown.get(i).copied().unwrap_or(false);
        let known = oldest.unknown.is_empty() && next.unknown.is_empty();
        Some(Moment {
            secs,
            posture: postures.map(|(&a, &b)| between(a, b)).collect(),
            unknown: match known {
                true => Vec::new(),
                false => (0..oldest.posture.len())
                    .map(|i| hidden(oldest, i) || hidden(next, i))
                    .collect(),
            },
            root: match (oldest.root, next.root) {
                (Some(a), Some(b)) => Some(Root {
                    position: a.position + s * (b.position - a.position),
                    yaw: between(a.yaw, b.yaw),
                }),
                _ => None,
            },
        })
    }
}

/// The mean posture of the first moments of a clip.
pub(super) fn offset(moments: &[Moment]) -> Vec<f64> {
    let until = moments.first().map_or(0.0, |m| m.secs) + OFFSET_SECS;
    mean_posture(moments.iter().take_while(|m| m.secs <= until))
}
