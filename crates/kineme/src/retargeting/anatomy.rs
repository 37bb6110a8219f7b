//! Anatomical frames: the orientation of every part of the body, from landmarks alone where possible.
//!
//! At the neutral standing pose every frame is the world's (x forward, y left, z up), whatever the source's rest pose.

use std::collections::BTreeMap;

use nalgebra::{UnitQuaternion, Vector3};

use super::landmarks::Landmarks;
use super::limb::{LimbKind, LimbSample, limb_frames};
use super::orientation::{Resting, oriented};
use crate::error::{Error, Result};
use crate::math::rotation::{frame_z_y, shortest, twist_angle, wrap};
use crate::skeleton::{JointKind, Role, Skeleton};

/// Length of thigh and shank over that of the trunk from hips to suprasternale (de Leva 1996, men).
const TRUNKS_A_LEG: f64 = (0.4222 + 0.4340) / 0.5319;

/// The most (radians) that a hand or foot known from a point swings away from forearm or shank.
const SWING: f64 = 1.75;

type Turns = Vec<UnitQuaternion<f64>>;

/// World orientation of each observed part at each frame, keyed by the role that moves it (`Chest` is the thorax).
#[derive(Debug, Clone, PartialEq)]
pub struct Anatomy {
    /// Orientations by role.
    pub parts: BTreeMap<Role, Turns>,
    /// The middle of the hips, metres, one a frame.
    pub hips: Vec<Vector3<f64>>,
    /// Length of thigh and shank together, metres, median over the frames; where legs were not observed, what is usual
    /// for a trunk of that length.
    pub scale: f64,
}

/// Roles of one limb, from the trunk outward.
struct Limb {
    carrier: Role,
    upper: Role,
    lower: Role,
    end: Role,
    tip: Role,
    arm: bool,
}

const LIMBS: [Limb; 4] = [
    Limb {
        carrier: Role::Chest,
        upper: Role::LeftUpperArm,
        lower: Role::LeftLowerArm,
        end: Role::LeftHand,
        tip: Role::LeftFingers,
        arm: true,
    },
    Limb {
        carrier: Role::Chest,
        upper: Role::RightUpperArm,
        lower: Role::RightLowerArm,
        end: Role::RightHand,
        tip: Role::RightFingers,
        arm: true,
    },
    Limb {
        carrier: Role::Hips,
        upper: Role::LeftUpperLeg,
        lower: Role::LeftLowerLeg,
        end: Role::LeftFoot,
        tip: Role::LeftToes,
        arm: false,
    },
    Limb {
        carrier: Role::Hips,
        upper: Role::RightUpperLeg,
        lower: Role::RightLowerLeg,
        end: Role::RightFoot,
        tip: Role::RightToes,
        arm: false,
    },
];

impl Anatomy {
    /// The frames of the observed parts; `body` gives the middle of each joint's range and the shape of the foot.
    ///
    /// # Errors
    /// When hips or shoulders were never seen.
    pub fn of(marks: &Landmarks, body: &Skeleton) -> Result<Self> {
        let need = |role: Role| {
            marks.path(role).ok_or_else(|| {
                Error::invalid(format!("the landmark {} was never observed", role.name()))
            })
        };
        let (left_hip, right_hip) = (need(Role::LeftUpperLeg)?, need(Role::RightUpperLeg)?);
        let (left_arm, right_arm) = (need(Role::LeftUpperArm)?, need(Role::RightUpperArm)?);
        let middle = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
            a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
        };
        let hips = middle(left_hip, right_hip);
        let shoulders = middle(left_arm, right_arm);
        let neck = marks.path(Role::Neck).unwrap_or(&shoulders);
        let waist = spine_point(marks, &hips, neck);
        let (top_of_pelvis, bottom_of_thorax) = match waist {
            Some(point) => (point, point),
            None => (neck, hips.as_slice()),
        };
        let mut parts = BTreeMap::new();
        let resting = Resting::of(marks);
        // The line of the hips is rigid, so the pelvis follows it exactly; shoulders shrug, so the thorax follows the spine.
        // Where rigs put the hips before or behind the spine differs; a standing zero pose says what upright is.
        let pelvis = match (marks.rotations.get(&Role::Hips), &resting) {
            (Some(own), Some(rest)) => own.iter().map(|q| q * rest.frame).collect(),
            _ => frames(marks.frames, |f| {
                frame_y_z(&(left_hip[f] - right_hip[f]), &(top_of_pelvis[f] - hips[f]))
            }),
        };
        let thorax = frames(marks.frames, |f| {
            frame_z_y(
                &(neck[f] - bottom_of_thorax[f]),
                &(left_arm[f] - right_arm[f]),
            )
        });
        if let Some(head) = head(marks, &thorax, neck, resting.as_ref()) {
            parts.insert(Role::Head, head);
        }
        for limb in &LIMBS {
            let carrier = if limb.carrier == Role::Hips {
                &pelvis
            } else {
                &thorax
            };
            limb_parts(marks, body, limb, carrier, resting.as_ref(), &mut parts);
        }
        parts.insert(Role::Hips, pelvis);
        parts.insert(Role::Chest, thorax);
        let scale = leg_length(marks).unwrap_or_else(|| {
            TRUNKS_A_LEG * median(neck.iter().zip(&hips).map(|(a, b)| (a - b).norm()))
        });
        Ok(Self { parts, hips, scale })
    }

    /// The heading at each frame: the turn of the pelvis about the vertical, unwrapped; held where the body is upside down.
    pub fn headings(&self) -> Vec<f64> {
        headings(&self.parts[&Role::Hips])
    }
}

/// The headings of a part: its turn about the vertical (swing and twist), unwrapped from frame to frame.
///
/// Upside down there is no such turn; near there the heading follows more and more slowly, so that it does not jump.
pub fn headings(turns: &[UnitQuaternion<f64>]) -> Vec<f64> {
    let z = Vector3::z_axis();
    // From the cosine of half the tilt, which is 1 upright and 0 upside down.
    let clear = |q: &UnitQuaternion<f64>| ((q.w.hypot(q.k) - 0.1) / 0.2).clamp(0.0, 1.0);
    let mut before = turns
        .iter()
        .find(|q| clear(q) > 0.0)
        .map_or(0.0, |q| twist_angle(q, &z));
    turns
        .iter()
        .map(|q| {
            before += clear(q) * wrap(twist_angle(q, &z) - before);
            before
        })
        .collect()
}

/// A frame whose y axis is exactly `y` and whose z axis lies as near `z` as it can.
fn frame_y_z(y: &Vector3<f64>, z: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let y = y.try_normalize(1e-9)?;
    let up = (z - y * y.dot(z)).try_normalize(1e-6 * z.norm().max(1e-9))?;
    frame_z_y(&up, &y)
}

/// One orientation a frame; where the landmarks coincide, the one before (identity at first).
fn frames(count: usize, at: impl Fn(usize) -> Option<UnitQuaternion<f64>>) -> Turns {
    let mut before = (0..count).find_map(&at).unwrap_or_default();
    (0..count)
        .map(|f| {
            before = at(f).unwrap_or(before);
            before
        })
        .collect()
}

/// The landmark of the spine nearest half-way between hips and neck, if one lies within the middle of the trunk.
fn spine_point<'a>(
    marks: &'a Landmarks,
    hips: &[Vector3<f64>],
    neck: &[Vector3<f64>],
) -> Option<&'a [Vector3<f64>]> {
    let place = |path: &[Vector3<f64>]| {
        let shares = path.iter().zip(hips).zip(neck).map(|((p, h), n)| {
            let trunk = n - h;
            (p - h).dot(&trunk) / trunk.norm_squared().max(1e-12)
        });
        median(shares)
    };
    [Role::Spine, Role::Chest, Role::UpperChest]
        .into_iter()
        .filter_map(|r| marks.path(r))
        .map(|path| (path, (place(path) - 0.5).abs()))
        .filter(|(_, off)| *off < 0.3)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(path, _)| path)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    crate::math::statistics::median(&values.collect::<Vec<_>>()).unwrap_or(1.0)
}

/// Thigh and shank of the left leg, else of the right.
fn leg_length(marks: &Landmarks) -> Option<f64> {
    let bone = |a: Role, b: Role| {
        let (a, b) = (marks.path(a)?, marks.path(b)?);
        Some(median(a.iter().zip(b).map(|(a, b)| (a - b).norm())))
    };
    LIMBS
        .iter()
        .filter(|l| !l.arm)
        .find_map(|l| Some(bone(l.upper, l.lower)? + bone(l.lower, l.end)?))
        .filter(|length| *length > 1e-6)
}

/// The head: from the source's orientation where it has one, else from where the head stands over the neck.
fn head(
    marks: &Landmarks,
    thorax: &[UnitQuaternion<f64>],
    neck: &[Vector3<f64>],
    resting: Option<&Resting>,
) -> Option<Turns> {
    // Skeletons without a head of its own (DeepMimic) turn it with the neck.
    let own = [Role::Head, Role::Neck]
        .iter()
        .find(|r| marks.positions.contains_key(r))
        .and_then(|r| marks.rotations.get(r));
    if let Some(own) = own {
        return Some(oriented(own, resting.map(|r| r.frame), thorax));
    }
    let head = marks.path(Role::Head)?;
    Some(frames(marks.frames, |f| {
        let up = (head[f] - neck[f]).try_normalize(1e-6)?;
        Some(shortest(&(thorax[f] * Vector3::z()), &up) * thorax[f])
    }))
}

/// The three parts of a limb, as far as they were observed, added to `parts`.
fn limb_parts(
    marks: &Landmarks,
    body: &Skeleton,
    limb: &Limb,
    carrier: &[UnitQuaternion<f64>],
    resting: Option<&Resting>,
    parts: &mut BTreeMap<Role, Turns>,
) {
    let (Some(root), Some(hinge)) = (marks.path(limb.upper), marks.path(limb.lower)) else {
        return;
    };
    let end = marks.path(limb.end);
    let toes = end
        .zip(marks.path(limb.tip))
        .filter(|_| !limb.arm && marks.rotations.is_empty());
    // The bone in the source's own axes does not move: its mean direction says where it lies.
    let own = marks.rotations.get(&limb.upper);
    let to_bone = own.and_then(|own| {
        let sum: Vector3<f64> = own
            .iter()
            .zip(root.iter().zip(hinge))
            .map(|(q, (a, b))| q.inverse() * (b - a))
            .sum();
        Some(shortest(&-Vector3::z(), &sum.try_normalize(1e-9)?))
    });
    let mut upper = -Vector3::z();
    let mut lower = -Vector3::z();
    let samples: Vec<LimbSample> = (0..marks.frames)
        .map(|f| {
            upper = (hinge[f] - root[f]).try_normalize(1e-6).unwrap_or(upper);
            lower = end
                .and_then(|e| (e[f] - hinge[f]).try_normalize(1e-6))
                .unwrap_or(if end.is_some() { lower } else { upper });
            LimbSample {
                carrier: carrier[f],
                upper,
                lower,
                toes: toes.and_then(|(end, tip)| (tip[f] - end[f]).try_normalize(1e-6)),
                source: own.zip(to_bone).map(|(own, turn)| own[f] * turn),
            }
        })
        .collect();
    let joint = body.joints_of(limb.upper).first().copied();
    let kind = LimbKind {
        bends_forward: limb.arm,
        reference: match joint.map(|j| &body.joints()[j].kind) {
            Some(JointKind::Ball { reference, .. }) => *reference,
            _ => UnitQuaternion::identity(),
        },
        single_hinge: body
            .joints_of(limb.lower)
            .first()
            .is_some_and(|&j| matches!(body.joints()[j].kind, JointKind::Hinge { .. })),
        // At rest the source's frame is the identity, so its bone frame is `to_bone`, the anatomy is the resting bone.
        resting: to_bone.and_then(|turn| {
            let rest = resting?.bone(limb.upper, limb.lower)?;
            Some(twist_angle(&(turn.inverse() * rest), &Vector3::z_axis()))
        }),
    };
    let found = limb_frames(&samples, &kind, marks.rate_hz);
    if end.is_some() {
        if let Some(turns) = end_part(marks, body, limb, &found.lower, resting) {
            parts.insert(limb.end, turns);
        }
        parts.insert(limb.lower, found.lower);
    }
    parts.insert(limb.upper, found.upper);
}

/// Hand or foot: from the source's orientation where it has one, else from the direction of fingers or toes.
fn end_part(
    marks: &Landmarks,
    body: &Skeleton,
    limb: &Limb,
    lower: &[UnitQuaternion<f64>],
    resting: Option<&Resting>,
) -> Option<Turns> {
    let ahead = if limb.arm {
        -Vector3::z()
    } else {
        let joint = *body.joints_of(limb.end).last()?;
        body.joints()[joint].tip.try_normalize(1e-9)?
    };
    let pointed = marks
        .path(limb.end)
        .zip(marks.path(limb.tip))
        .map(|(end, tip)| {
            frames(marks.frames, |f| {
                let direction = (tip[f] - end[f]).try_normalize(1e-6)?;
                let swing = shortest(&(lower[f] * ahead), &direction);
                // Points of hands and feet lie so near wrist and ankle that noise may turn them round.
                let share = (SWING / swing.angle().max(SWING)).min(1.0);
                Some(swing.powf(share) * lower[f])
            })
        });
    let Some(own) = marks.rotations.get(&limb.end) else {
        return pointed;
    };
    let rest = resting.and_then(|r| match limb.arm {
        true => r
            .bone(limb.end, limb.tip)
            .or_else(|| r.bone(limb.lower, limb.end)),
        // Legs may be spread at rest, and the feet with them.
        false => r.bone(limb.lower, limb.end),
    });
    Some(oriented(own, rest, pointed.as_deref().unwrap_or(lower)))
}
