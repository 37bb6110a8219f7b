//! Anatomical frames: the orientation of every part of the body, from landmarks alone where possible.
//!
//! At the neutral standing pose every frame is the world's (x forward, y left, z up), whatever the source's rest pose.

use std::collections::BTreeMap;

use nalgebra::{UnitQuaternion, Vector3};

use super::landmarks::Landmarks;
use super::limb::{LimbSample, limb_frames};
use crate::error::{Error, Result};
use crate::math::rotation::{frame_z_y, shortest, twist_angle};
use crate::skeleton::{JointKind, Role, Skeleton};

type Turns = Vec<UnitQuaternion<f64>>;

/// World orientation of each observed part at each frame, keyed by the role that moves it (`Chest` is the thorax).
#[derive(Debug, Clone, PartialEq)]
pub struct Anatomy {
    /// Orientations by role.
    pub parts: BTreeMap<Role, Turns>,
    /// The middle of the hips, metres, one a frame.
    pub hips: Vec<Vector3<f64>>,
    /// Length of thigh and shank together (else of the trunk), metres, median over the frames.
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
        // The line of the hips is rigid, so the pelvis follows it exactly; shoulders shrug, so the thorax follows the spine.
        let pelvis = frames(marks.frames, |f| {
            frame_y_z(&(left_hip[f] - right_hip[f]), &(top_of_pelvis[f] - hips[f]))
        });
        let thorax = frames(marks.frames, |f| {
            frame_z_y(
                &(neck[f] - bottom_of_thorax[f]),
                &(left_arm[f] - right_arm[f]),
            )
        });
        let resting = Resting::of(marks);
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
        let scale = leg_length(marks)
            .unwrap_or_else(|| median_length(neck.iter().zip(&hips).map(|(a, b)| (a - b).norm())));
        Ok(Self { parts, hips, scale })
    }

    /// The heading at each frame: the turn of the pelvis about the vertical, unwrapped; held where the body is upside down.
    pub fn headings(&self) -> Vec<f64> {
        let z = Vector3::z_axis();
        let mut before = 0.0;
        self.parts[&Role::Hips]
            .iter()
            .map(|q| {
                if q.w.hypot(q.k) > 0.1 {
                    before += crate::math::rotation::wrap(twist_angle(q, &z) - before);
                }
                before
            })
            .collect()
    }
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
        median_length(shares)
    };
    [Role::Spine, Role::Chest, Role::UpperChest]
        .into_iter()
        .filter_map(|r| marks.path(r))
        .map(|path| (path, (place(path) - 0.5).abs()))
        .filter(|(_, off)| *off < 0.3)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(path, _)| path)
}

fn median_length(values: impl Iterator<Item = f64>) -> f64 {
    crate::math::statistics::median(&values.collect::<Vec<_>>()).unwrap_or(1.0)
}

fn leg_length(marks: &Landmarks) -> Option<f64> {
    let bone = |a: Role, b: Role| {
        let (a, b) = (marks.path(a)?, marks.path(b)?);
        Some(median_length(a.iter().zip(b).map(|(a, b)| (a - b).norm())))
    };
    let length =
        bone(Role::LeftUpperLeg, Role::LeftLowerLeg)? + bone(Role::LeftLowerLeg, Role::LeftFoot)?;
    (length > 1e-6).then_some(length)
}

/// The source's zero pose, if it is a standing person: then it says how each part's own axes lie in the anatomy.
struct Resting<'a> {
    marks: &'a Landmarks,
    frame: UnitQuaternion<f64>,
}

impl<'a> Resting<'a> {
    fn of(marks: &'a Landmarks) -> Option<Self> {
        let at = |r: Role| marks.rest.get(&r).copied();
        let (left, right) = (at(Role::LeftUpperLeg)?, at(Role::RightUpperLeg)?);
        let hips = 0.5 * (left + right);
        let shoulders = 0.5 * (at(Role::LeftUpperArm)? + at(Role::RightUpperArm)?);
        let feet = 0.5 * (at(Role::LeftFoot)? + at(Role::RightFoot)?);
        let upright = |v: Vector3<f64>| v.try_normalize(1e-9).is_some_and(|v| v.z > 0.8);
        let frame = frame_z_y(&Vector3::z(), &(left - right))?;
        (upright(shoulders - hips) && upright(hips - feet)).then_some(Self { marks, frame })
    }

    /// How a bone from `from` to `to` lies at rest: the neutral hanging bone swung the shortest way.
    fn bone(&self, from: Role, to: Role) -> Option<UnitQuaternion<f64>> {
        let direction = self.marks.rest.get(&to)? - self.marks.rest.get(&from)?;
        let local = (self.frame.inverse() * direction).try_normalize(1e-9)?;
        Some(self.frame * shortest(&-Vector3::z(), &local))
    }
}

/// The constant turn from a part's own axes to the anatomy that agrees best with `estimate` over the recording.
fn calibration(
    own: &[UnitQuaternion<f64>],
    estimate: &[UnitQuaternion<f64>],
) -> UnitQuaternion<f64> {
    // Chordal mean (Markley et al. 2007): the main eigenvector of the sum of q q'.
    let mut sum = nalgebra::Matrix4::<f64>::zeros();
    let step = (own.len() / 512).max(1);
    for (a, b) in own.iter().zip(estimate).step_by(step) {
        let q = (a.inverse() * b).into_inner().coords;
        sum += q * q.transpose();
    }
    let eigen = sum.symmetric_eigen();
    let best = eigen.eigenvalues.imax();
    let v = eigen.eigenvectors.column(best);
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(v[3], v[0], v[1], v[2]))
}

/// The head: from the source's orientation where it has one, else from where the head stands over the neck.
fn head(
    marks: &Landmarks,
    thorax: &[UnitQuaternion<f64>],
    neck: &[Vector3<f64>],
    resting: Option<&Resting>,
) -> Option<Turns> {
    if let Some(own) = marks.rotations.get(&Role::Head) {
        let turn = resting.map_or_else(|| calibration(own, thorax), |r| r.frame);
        return Some(own.iter().map(|q| q * turn).collect());
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
    // The bone in the source's own axes does not move: its median direction says where it lies.
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
                source: own.zip(to_bone).map(|(own, turn)| own[f] * turn),
            }
        })
        .collect();
    let reference = body
        .joints_of(limb.upper)
        .first()
        .map(|&j| match &body.joints()[j].kind {
            JointKind::Ball { reference, .. } => *reference,
            _ => UnitQuaternion::identity(),
        })
        .unwrap_or_default();
    // At rest the source's frame is the identity, so its bone frame is `to_bone`, the anatomy is the resting bone.
    let rest_twist = to_bone.and_then(|turn| {
        let rest = resting?.bone(limb.upper, limb.lower)?;
        Some(twist_angle(&(turn.inverse() * rest), &Vector3::z_axis()))
    });
    let found = limb_frames(&samples, limb.arm, &reference, rest_twist);
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
        let joint = *body.joints_of(limb.end).first()?;
        body.joints()[joint].tip.normalize()
    };
    let pointed = marks
        .path(limb.end)
        .zip(marks.path(limb.tip))
        .map(|(end, tip)| {
            frames(marks.frames, |f| {
                let direction = (tip[f] - end[f]).try_normalize(1e-6)?;
                Some(shortest(&(lower[f] * ahead), &direction) * lower[f])
            })
        });
    let Some(own) = marks.rotations.get(&limb.end) else {
        return pointed;
    };
    let turn = match (resting, &pointed) {
        (Some(r), _) if limb.arm => r
            .bone(limb.end, limb.tip)
            .or_else(|| r.bone(limb.lower, limb.end))?,
        (Some(r), _) => r.frame,
        (None, Some(p)) => calibration(own, p),
        (None, None) => calibration(own, lower),
    };
    Some(own.iter().map(|q| q * turn).collect())
}
