//! What can be believed of an observation: short gaps are bridged, missing joints of a chain stand in for each other,
//! and a joint that is where no exemplar ever had it counts as broken.

use super::features::{Layout, Moment};
use super::model::{Bounds, Model};
use crate::primitive::Observation;
use crate::skeleton::Skeleton;

/// A joint that was not seen keeps its last coordinates for so long.
const BRIDGED_SECS: f64 = 0.25;
/// A joint out of every exemplar's range for so long counts as broken.
const BROKEN_SECS: f64 = 0.5;
/// Where joints out of range leave more than this share unknown of the numbers that the exemplars move, more than a limb, it
/// is an unknown movement and no broken sensor.
const BROKEN_SHARE: f64 = 1.0 / 3.0;

/// The joints of a stream, as far as they can be believed.
#[derive(Debug, Clone)]
pub(super) struct Sight<'m> {
    layout: &'m Layout,
    bounds: &'m Bounds,
    /// Which numbers of a posture the rows differ in.
    moved: &'m [bool],
    pose: Vec<f64>,
    /// When each joint was last seen.
    seen: Vec<Option<f64>>,
    /// Since when each joint is out of range.
    out: Vec<Option<f64>>,
    /// Which joints could not be believed last.
    lost: Vec<bool>,
}

impl<'m> Sight<'m> {
    pub fn new(model: &'m Model) -> Self {
        let body = model.layout.body();
        Self {
            layout: &model.layout,
            bounds: &model.bounds,
            moved: &model.moved,
            pose: body.neutral(),
            seen: vec![None; body.joints().len()],
            out: vec![None; body.joints().len()],
            lost: vec![false; body.joints().len()],
        }
    }

    /// The joints as they were last believed to be; not a number where they were lost.
    pub fn pose(&self) -> Vec<f64> {
        let mut pose = self.pose.clone();
        for j in (0..self.lost.len()).filter(|&j| self.lost[j]) {
            pose[self.layout.body().coordinates(j)].fill(f64::NAN);
        }
        pose
    }

    /// The moment of an observation.
    pub fn see(&mut self, observed: &Observation<'_>) -> Moment {
        let body = self.layout.body();
        let joints = body.joints().len();
        for j in 0..joints {
            if observed.missing.get(j).copied().unwrap_or(false) {
                continue;
            }
            let own = body.coordinates(j);
            self.pose[own.clone()].copy_from_slice(&observed.pose[own.clone()]);
            self.seen[j] = Some(observed.secs);
            self.out[j] = match self.bounds.contain(own, &self.pose) {
                true => None,
                false => self.out[j].or(Some(observed.secs)),
            };
        }
        let gone = |since: &Option<f64>, secs: f64| since.is_none_or(|s| observed.secs - s > secs);
        let unseen: Vec<bool> = (0..joints)
            .map(|j| !body.coordinates(j).is_empty() && gone(&self.seen[j], BRIDGED_SECS))
            .collect();
        let out = |j: usize| self.out[j].is_some_and(|s| observed.secs - s >= BROKEN_SECS);
        let broken: Vec<bool> = (0..joints).map(|j| unseen[j] || out(j)).collect();
        let (mut pose, mut unknown) = self.without(&unseen);
        self.lost = unseen;
        if broken != self.lost {
            let (believed, fewer) = self.without(&broken);
            let hidden = |unknown: &[bool]| {
                let pairs = unknown.iter().zip(self.moved);
                pairs.filter(|(u, moved)| **u && **moved).count()
            };
            let more = hidden(&fewer) - hidden(&unknown);
            let moved = self.moved.iter().filter(|m| **m).count();
            if more as f64 <= BROKEN_SHARE * moved as f64 {
                (pose, unknown) = (believed, fewer);
                self.lost = broken;
            }
        }
        Moment {
            secs: observed.secs,
            posture: self.layout.posture(&pose),
            unknown,
            root: observed.root,
        }
    }

    /// The pose without joints that are lost, and which numbers of the posture are unknown then.
    fn without(&self, lost: &[bool]) -> (Vec<f64>, Vec<bool>) {
        let (mut pose, mut lost) = (self.pose.clone(), lost.to_vec());
        stand_in(self.layout.body(), &mut pose, &mut lost);
        let unknown = self.layout.unknown(&lost);
        (pose, unknown)
    }
}

/// Vertebrae share their rotation: one that is lost takes the mean of the others of its role.
fn stand_in(body: &Skeleton, pose: &mut [f64], lost: &mut [bool]) {
    for j in 0..lost.len() {
        let Some(role) = body.joints()[j].role.filter(|_| lost[j]) else {
            continue;
        };
        let own = body.coordinates(j);
        let like = |k: &usize| !lost[*k] && body.coordinates(*k).len() == own.len();
        let others: Vec<usize> = body.joints_of(role).into_iter().filter(like).collect();
        if others.is_empty() {
            continue;
        }
        for (c, at) in own.enumerate() {
            let sum: f64 = others
                .iter()
                .map(|&k| pose[body.coordinates(k).start + c])
                .sum();
            pose[at] = sum / others.len() as f64;
        }
        lost[j] = false;
    }
}
