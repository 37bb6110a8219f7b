//! From the orientations of a body's parts to its coordinates, one pose at a time.

use std::sync::Arc;

use nalgebra::UnitQuaternion;

use super::hinges::{Hinges, Start};
use crate::math::rotation::{exp, log};
use crate::skeleton::{JointKind, Role, Skeleton};

/// The role under which the anatomy keeps a part: the whole trunk up to the thorax is `Chest`, neck and head `Head`.
pub fn anatomical(role: Role) -> Role {
    match role {
        Role::Spine | Role::UpperChest => Role::Chest,
        Role::Neck => Role::Head,
        other => other,
    }
}

/// The joint that carries each anatomical part: at the neutral pose the frames of all bodies agree, so its world
/// orientation is the part's.
pub fn carriers(body: &Skeleton) -> Vec<(Role, usize)> {
    let mut carriers: Vec<(Role, usize)> = Vec::new();
    for &role in Role::ALL {
        let Some(&joint) = body.joints_of(role).last() else {
            continue;
        };
        let part = anatomical(role);
        match carriers.iter_mut().find(|(r, _)| *r == part) {
            Some(known) => known.1 = joint,
            None => carriers.push((part, joint)),
        }
    }
    carriers
}

/// Length of thigh and shank, metres; zero without legs.
pub fn leg_length(body: &Skeleton) -> f64 {
    let bone = |from: Role, to: Role| -> Option<f64> {
        let (from, to) = (*body.joints_of(from).first()?, *body.joints_of(to).first()?);
        let parent = |j: &usize| body.joints()[*j].parent;
        let path = std::iter::successors(Some(to), parent).take_while(|&j| j != from);
        Some(
            path.map(|j| body.joints()[j].offset)
                .sum::<nalgebra::Vector3<f64>>()
                .norm(),
        )
    };
    [
        (Role::LeftUpperLeg, Role::LeftLowerLeg),
        (Role::LeftLowerLeg, Role::LeftFoot),
    ]
    .into_iter()
    .filter_map(|(from, to)| bone(from, to))
    .sum()
}

/// The chain of joints that brings each anatomical part about, from the root outward.
fn chains(body: &Skeleton) -> Vec<(Role, Vec<usize>)> {
    let mut chains = vec![
        (Role::Hips, body.joints_of(Role::Hips)),
        (Role::Chest, body.trunk()),
        (Role::Head, body.neck()),
    ];
    for &role in Role::ALL {
        if anatomical(role) == role && chains.iter().all(|(r, _)| *r != role) {
            chains.push((role, body.joints_of(role)));
        }
    }
    chains.retain(|(_, joints)| joints.iter().any(|&j| body.joints()[j].kind.dof() > 0));
    chains
}

/// What a joint has to bring about.
#[derive(Debug, Clone, Copy)]
enum Task {
    /// Nothing: it belongs to no part, or to a run of hinges that was placed with the first of them.
    None,
    /// Its share of the turning that it and the joints after it in the chain still have to do; 1 for the last.
    Alone { part: usize, share: f64 },
    /// The same, of all hinges of a run together.
    Run { part: usize, share: f64, run: usize },
}

/// Finds the coordinates that bring every part nearest its orientation, from the root outward, each joint starting from
/// where the ones before it really are.
#[derive(Debug, Clone)]
pub struct Fitting {
    body: Arc<Skeleton>,
    parts: Vec<Role>,
    tasks: Vec<Task>,
    runs: Vec<Hinges>,
    turned: Vec<UnitQuaternion<f64>>,
}

impl Fitting {
    /// For this body.
    pub fn of(body: &Arc<Skeleton>) -> Self {
        let chains = chains(body);
        let mut tasks = vec![Task::None; body.joints().len()];
        let mut runs = Vec::new();
        for (part, (_, chain)) in chains.iter().enumerate() {
            for (first, end) in groups(body, chain) {
                let sum = |from: usize, to: usize| -> f64 {
                    chain[from..to]
                        .iter()
                        .map(|&j| body.joints()[j].share)
                        .sum()
                };
                let share = match end == chain.len() {
                    true => 1.0,
                    false => sum(first, end) / sum(first, chain.len()).max(1e-12),
                };
                let run = end - first > 1;
                tasks[chain[first]] = match run {
                    true => Task::Run {
                        part,
                        share,
                        run: runs.len(),
                    },
                    false => Task::Alone { part, share },
                };
                if run {
                    runs.push(Hinges::new(body, &chain[first..end]));
                }
            }
        }
        Self {
            parts: chains.into_iter().map(|(role, _)| role).collect(),
            tasks,
            runs,
            turned: vec![UnitQuaternion::identity(); body.joints().len()],
            body: Arc::clone(body),
        }
    }

    /// The parts that the body moves.
    pub fn parts(&self) -> &[Role] {
        &self.parts
    }

    /// Writes the pose at which the parts come nearest their orientations: `target` gives the world's of a part, by its
    /// place in [`Self::parts`], or `None` for a part that keeps what `pose` has. `heading` is the root's.
    pub fn fit(
        &mut self,
        heading: &UnitQuaternion<f64>,
        target: impl Fn(usize) -> Option<UnitQuaternion<f64>>,
        start: Start<'_>,
        pose: &mut [f64],
    ) {
        let before = match start {
            Start::Anywhere => None,
            Start::After(before) | Start::Beside(before) => Some(before),
        };
        for (j, joint) in self.body.joints().iter().enumerate() {
            let base = joint.parent.map_or(*heading, |p| self.turned[p]);
            match self.tasks[j] {
                Task::None => {}
                Task::Alone { part, share } => {
                    if let Some(target) = target(part) {
                        let goal = part_of(&base, &target, share);
                        self.body.set_rotation(pose, j, &goal, before);
                        if !self.runs.is_empty() {
                            self.stop(j, start, pose);
                        }
                    }
                }
                Task::Run { part, share, run } => {
                    if let Some(target) = target(part) {
                        let goal = part_of(&base, &target, share);
                        self.runs[run].place(&goal, start, pose);
                    }
                }
            }
            self.turned[j] = base * self.body.rotation(j, &pose[self.body.coordinates(j)]);
        }
    }

    /// Holds a single hinge of a machine at its stops. Ranges of people are what most of them do, and a recording may go
    /// beyond; a body with parts of several hinges is a machine, and its ranges are stops.
    fn stop(&self, joint: usize, start: Start<'_>, pose: &mut [f64]) {
        let JointKind::Hinge { range, .. } = &self.body.joints()[joint].kind else {
            return;
        };
        let at = self.body.coordinates(joint).start;
        match start {
            Start::Beside(centre) if range.low < centre[at] && centre[at] < range.high => {}
            Start::Beside(centre) => pose[at] = centre[at],
            _ => pose[at] = pose[at].max(range.low).min(range.high),
        }
    }
}

/// The rotation in the frame `base` that does `share` of what is missing from `target`.
fn part_of(
    base: &UnitQuaternion<f64>,
    target: &UnitQuaternion<f64>,
    share: f64,
) -> UnitQuaternion<f64> {
    let local = base.inverse() * target;
    if share < 1.0 {
        exp(&(log(&local) * share))
    } else {
        local
    }
}

/// The moving joints of a chain that are placed together, as ranges of it: hinges that follow each other, else one
/// joint. A joint that does not move, or whose parent's turn is not that of the hinge before, begins anew.
fn groups(body: &Skeleton, chain: &[usize]) -> Vec<(usize, usize)> {
    let hinge = |j: usize| matches!(body.joints()[j].kind, JointKind::Hinge { .. });
    // From a joint inward over those that do not move.
    let carrier = |j: usize| {
        let parent = |j: &usize| body.joints()[*j].parent;
        std::iter::successors(parent(&j), parent)
            .find(|&p| body.joints()[p].kind.dof() > 0 || body.joints()[p].parent.is_none())
    };
    let mut groups: Vec<(usize, usize)> = Vec::new();
    for (k, &j) in chain.iter().enumerate() {
        let follows = k > 0 && hinge(j) && hinge(chain[k - 1]) && carrier(j) == Some(chain[k - 1]);
        match groups.last_mut() {
            Some(last) if follows => last.1 = k + 1,
            _ => groups.push((k, k + 1)),
        }
    }
    groups
}
