//! [`Transitions`]: joints that change hands, without a jump.
//!
//! Who moves a joint changes at once; what the joint did differently until then decays, as when a body joins a course.
//! The weights of the old and the new owner would cross over by the same quintic, but the old one need not go on for it,
//! a behaviour that begins on the spot is not diluted, and the speed of the change is bounded however far it goes.

use super::offset::{Inertialization, Offset, STEEPEST};
use super::state::Moving;

/// A part of the body whose joints count together.
#[derive(Debug, Clone)]
struct Part {
    /// The coordinates of its joints; of the root the one behind the joints'.
    joints: Vec<Vec<usize>>,
    offset: Offset,
    since: u64,
}

/// What is left of what joints did before they changed hands.
#[derive(Debug, Clone)]
pub(super) struct Transitions {
    parts: Vec<Part>,
    settings: Inertialization,
    root: usize,
}

impl Transitions {
    /// None under way, of these parts and a root.
    pub fn new(mut parts: Vec<Vec<Vec<usize>>>, root: usize, settings: Inertialization) -> Self {
        parts.retain(|part| part.iter().any(|joint| !joint.is_empty()));
        parts.push(vec![vec![root]]);
        let none = Moving::still(Vec::new());
        let part = |joints| Part {
            joints,
            offset: Offset::between(&none, &none, 0.0, 0.0),
            since: 0,
        };
        Self {
            parts: parts.into_iter().map(part).collect(),
            settings,
            root,
        }
    }

    /// From now on, tick `tick`, the parts with coordinates that `changed` go over from what they did (`now`) to `goal`.
    pub fn begin(&mut self, changed: &[bool], now: &Moving, goal: &Moving, tick: u64) {
        for part in &mut self.parts {
            if !part.joints.iter().flatten().any(|&c| changed[c]) {
                continue;
            }
            let gathered = |from: &Moving| {
                let of = |row: &[f64]| part.joints.iter().flatten().map(|&c| row[c]).collect();
                let is_root = part.joints[0].first() == Some(&self.root);
                Moving {
                    values: of(&from.values),
                    velocities: of(&from.velocities),
                    travel: if is_root { from.travel } else { [0.0; 3] },
                }
            };
            let apart = |joint: &Vec<usize>| -> f64 {
                let square = |&c: &usize| (now.values[c] - goal.values[c]).powi(2);
                joint.iter().map(square).sum::<f64>().sqrt()
            };
            let far: f64 = part.joints.iter().map(apart).sum();
            let most = if part.joints[0].first() == Some(&self.root) {
                self.settings.max_rise
            } else {
                self.settings.max_speed
            };
            let blend = self.settings.blend_secs;
            let secs = blend.max(STEEPEST * far / most);
            part.offset = Offset::between(&gathered(now), &gathered(goal), secs, blend);
            part.since = tick;
        }
    }

    /// Adds what is left at a tick.
    pub fn add(&self, tick: u64, rate_hz: f64, to: &mut Moving) {
        for part in &self.parts {
            let t = (tick - part.since) as f64 / rate_hz;
            if part.offset.is_over(t) {
                continue;
            }
            for ((x, v), c) in part.offset.left(t).zip(part.joints.iter().flatten()) {
                to.values[*c] += x;
                to.velocities[*c] += v;
            }
            if part.joints[0].first() == Some(&self.root) {
                let travel = part.offset.travel_left(t);
                to.travel
                    .iter_mut()
                    .zip(travel)
                    .for_each(|(sum, v)| *sum += v);
            }
        }
    }
}
