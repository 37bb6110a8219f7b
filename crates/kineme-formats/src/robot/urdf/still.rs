//! Joints that are held, and where: those that slide, that mimic others, or that have no room to move.

use std::collections::BTreeMap;

use kineme::skeleton::Range;

use super::elements::{Joint, Kind};
use crate::error::Result;
use crate::robot::source::Sources;
use crate::sheet::quoted;

/// Names that a note lists at most.
const LISTED: usize = 8;

/// Where each joint is held, radians or metres; `None` of one that turns.
///
/// # Errors
/// When a joint mimics one that is not there, or in a circle itself.
pub fn held(sources: &Sources<'_>, joints: &[Joint<'_, '_>]) -> Result<Vec<Option<f64>>> {
    let index: BTreeMap<&str, usize> = joints
        .iter()
        .enumerate()
        .map(|(j, at)| (at.name, j))
        .collect();
    let mut copied = Vec::with_capacity(joints.len());
    for joint in joints {
        copied.push(match &joint.mimic {
            None => None,
            Some(mimic) => Some(*index.get(mimic.joint).ok_or_else(|| {
                let found = format!(
                    "{} mimics joint {}, which is not there",
                    quoted(joint.name),
                    quoted(mimic.joint)
                );
                sources.error(mimic.node, found, "a joint of the file")
            })?),
        });
    }
    let mut held: Vec<Option<f64>> = joints.iter().map(alone).collect();
    for k in 0..joints.len() {
        if held[k].is_some() {
            continue;
        }
        // From the joint along those that it mimics, to one whose place is known.
        let mut chain = Vec::new();
        let mut at = k;
        while let (None, Some(next)) = (held[at], copied[at]) {
            chain.push(at);
            if chain.len() > joints.len() {
                let found = format!("{} mimics itself", quoted(joints[k].name));
                return Err(sources.error(joints[k].node, found, "a joint that moves by itself"));
            }
            at = next;
        }
        let mut angle = held[at].unwrap_or_else(|| within(0.0, &joints[at].range));
        for &j in chain.iter().rev() {
            if let Some(mimic) = &joints[j].mimic {
                angle = within(mimic.multiplier * angle + mimic.offset, &joints[j].range);
                held[j] = Some(angle);
            }
        }
    }
    Ok(held)
}

/// Where a joint is held that mimics no other.
fn alone(joint: &Joint<'_, '_>) -> Option<f64> {
    match joint.kind {
        _ if joint.mimic.is_some() => None,
        Kind::Revolute if joint.range.low < joint.range.high => None,
        Kind::Continuous => None,
        Kind::Revolute | Kind::Prismatic => Some(within(0.0, &joint.range)),
        Kind::Fixed | Kind::Floating | Kind::Planar => Some(0.0),
    }
}

fn within(value: f64, range: &Range) -> f64 {
    value.max(range.low).min(range.high)
}

/// What is told of joints that are held although they could move.
pub fn told(joints: &[Joint<'_, '_>], held: &[Option<f64>]) -> Vec<String> {
    let named = |pick: &dyn Fn(&Joint<'_, '_>) -> bool| -> Vec<&str> {
        let joints = joints.iter().zip(held);
        let picked = joints.filter(|(joint, at)| at.is_some() && pick(joint));
        picked.map(|(joint, _)| joint.name).collect()
    };
    let turns = |kind| matches!(kind, Kind::Revolute | Kind::Continuous);
    [
        (
            named(&|j| j.mimic.is_some()),
            "mimicking others, held where they are while those are at zero",
        ),
        (
            named(&|j| j.mimic.is_none() && j.kind == Kind::Prismatic),
            "sliding, left where they are",
        ),
        (
            named(&|j| j.mimic.is_none() && turns(j.kind)),
            "with no room between lower and upper, held",
        ),
    ]
    .into_iter()
    .filter(|(names, _)| !names.is_empty())
    .map(|(names, what)| format!("joints {what}: {}", listed(&names)))
    .collect()
}

/// Names for a note, the first of many.
pub fn listed(names: &[&str]) -> String {
    let shown: Vec<String> = names.iter().take(LISTED).map(|n| quoted(n)).collect();
    match names.len() {
        n if n > LISTED => format!("{} and {} more", shown.join(", "), n - LISTED),
        _ => shown.join(", "),
    }
}
