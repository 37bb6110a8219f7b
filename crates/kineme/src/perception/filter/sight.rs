//! What can be believed of an observation: short gaps are bridged, missing joints of a chain stand in for each other,
//! and a joint that is where no exemplar ever had it counts as broken.

use super::features::{Layout, Moment};
use super::model::Bounds;
use crate::primitive::Observation;
use crate::skeleton::Skeleton;

/// A joint that was not seen keeps its last coordinates for so long.
const BRIDGED_SECS: f64 = 0.25;
/// A joint out of every exemplar's range for so long counts as broken.
const BROKEN_SECS: f64 = 0.5;
/// Where a greater share of the joints is out of range, it is an unknown movement and no broken sensor.
const BROKEN_SHARE: f64 = 0.2;

/// The joints of a stream, as far as they can be believed.
#[derive(Debug, Clone)]
pub(super) struct Sight<'m> {
    layout: &'m Layout,
    bounds: &'m Bounds,
    pose: Vec<f64>,
    /// When each joint was last seen.
    seen: Vec<Option<f64>>,
    /// Since when each joint is out of range.
    out: Vec<Option<f64>>,
    /// Which joints could not be believed last.
    lost: Vec<bool>,
}

impl<'m> Sight<'m> {
    pub fn new(layout: &'m Layout, bounds: &'m Bounds) -> Self {
        let body = layout.body();
        Self {
            layout,
            bounds,
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
        let mut lost: Vec<bool> = (0..joints)
            .map(|j| !body.coordinates(j).is_empty() && gone(&self.seen[j], BRIDGED_SECS))
            .collect();
        let broken: Vec<usize> = (0..joints)
            .filter(|&j| self.out[j].is_some_and(|s| observed.secs - s >= BROKEN_SECS))
            .collect();
        // Of joints that nothing known moves nothing is expected.
        let moving = (0..joints)
            .filter(|&j| self.bounds.move_any(body.coordinates(j)))
            .count();
        if broken.len() as f64 <= BROKEN_SHARE * moving as f64 {
            for j in broken {
                lost[j] = true;
            }
        }
        let mut pose = self.pose.clone();
        self.lost.clone_from(&lost);
        stand_in(body, &mut pose, &mut lost);
        Moment {
            secs: observed.secs,
            posture: self.layout.posture(&pose),
            unknown: self.layout.unknown(&lost),
            root: observed.root,
        }
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
