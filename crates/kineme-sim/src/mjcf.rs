//! [`mjcf`]: the model of a body, as MuJoCo reads it, made from its skeleton.

use std::fmt::Write as _;

use kineme::Skeleton;
use kineme::math::rotation::exp;
use kineme::skeleton::{Joint, JointKind, Link, Role};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::hinges::{names, triple};
use crate::settings::SimSettings;
use crate::triple::Triple;

/// Coordinates of each axis of a ball's limits, ends included, that say how far its hinges go.
const POSTURES: usize = 9;
/// How far (radians, 1 degree) hinges of a ball go beyond the postures that were looked at.
const BEYOND: f64 = std::f64::consts::PI / 180.0;
/// Middle angle (radians, 75 degrees) beyond which the hinges of a ball are given no limits: near the lock their
/// angles say little about the posture.
const LOCKING: f64 = 75.0 * std::f64::consts::PI / 180.0;
/// Angle (radians, 170 degrees) of a ball's hinge beyond which it has no limits either: it would go right round.
const FARTHEST: f64 = 170.0 * std::f64::consts::PI / 180.0;
/// Least half axis of a part as it is drawn, metres.
const THIN: f64 = 0.004;

/// The torque (N m) that a drive of each hinge of this joint gives at most, as of a strong adult; infinite for a joint
/// without a role and for the pelvis, which is held from outside.
///
/// Joints in series carry the same moment, so every vertebra has the strength of its region, and the shoulder girdle
/// that of the shoulder. No table of the originals' drives is known. The trunk's is what an uppercut takes, more than
/// the 150 N m that serve for slower movements; fingers and toes hold a hand's or a foot's load at their lever.
pub fn torque_limit(joint: &Joint) -> f64 {
    use Role::*;
    match joint.role {
        None | Some(Hips) => f64::INFINITY,
        Some(Spine | Chest | UpperChest) => 250.0,
        Some(Neck | Head) => 30.0,
        Some(LeftShoulder | RightShoulder | LeftUpperArm | RightUpperArm) => 90.0,
        Some(LeftLowerArm | RightLowerArm) => 60.0,
        Some(LeftHand | RightHand) => 15.0,
        Some(LeftFingers | RightFingers) => 8.0,
        Some(LeftUpperLeg | RightUpperLeg | LeftLowerLeg | RightLowerLeg) => 200.0,
        Some(LeftFoot | RightFoot) => 120.0,
        Some(LeftToes | RightToes) => 40.0,
    }
}

/// The model of a body (MJCF): masses, centres and inertias of its links, a hinge for each coordinate (a ball is three
/// hinges in one body, see [`Triple`]), and a drive for each hinge. The root stands at the origin and is welded to the
/// world but for its own joint.
///
/// Drives exert the torque that they are told; the feedback of a [`crate::Servo`] is added when the model is loaded,
/// for its gains come out of the mass matrix. Each link is drawn as the ellipsoid of uniform density that has its
/// inertia; nothing collides.
pub fn mjcf(body: &Skeleton, settings: &SimSettings) -> String {
    let mut children = vec![Vec::new(); body.joints().len()];
    for (j, joint) in body.joints().iter().enumerate() {
        if let Some(parent) = joint.parent {
            children[parent].push(j);
        }
    }
    let mut text = format!(
        "<mujoco model=\"{}\">\n  <compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\"/>\n  \
         <option timestep=\"{}\" integrator=\"implicitfast\">\n    <flag contact=\"disable\" limit=\"{}\"/>\n  </option>\n  \
         <default>\n    <joint type=\"hinge\" armature=\"{}\"/>\n    \
         <geom type=\"ellipsoid\" mass=\"0\" contype=\"0\" conaffinity=\"0\"/>\n  </default>\n  <worldbody>\n",
        escaped(body.name()),
        settings.step_secs,
        if settings.joint_limits {
            "enable"
        } else {
            "disable"
        },
        settings.armature,
    );
    let mut hinges = Vec::new();
    // What is still to be written: a joint with its depth, or the end of one.
    let mut rest = vec![(0, 2, false)];
    while let Some((j, depth, ends)) = rest.pop() {
        let indent = "  ".repeat(depth);
        if ends {
            let _ = writeln!(text, "{indent}</body>");
            continue;
        }
        write_body(&mut text, body, j, &indent, settings);
        let limit = torque_limit(&body.joints()[j]);
        hinges.extend(names(body, j).into_iter().map(|name| (name, limit)));
        rest.push((j, depth, true));
        rest.extend(children[j].iter().rev().map(|&c| (c, depth + 1, false)));
    }
    text.push_str("  </worldbody>\n  <actuator>\n");
    for (name, limit) in hinges {
        let name = escaped(&name);
        let range = if settings.torque_limits && limit.is_finite() {
            format!(" forcerange=\"{} {limit}\"", -limit)
        } else {
            String::new()
        };
        let _ = writeln!(
            text,
            "    <general name=\"{name}\" joint=\"{name}\" biastype=\"affine\"{range}/>"
        );
    }
    text.push_str("  </actuator>\n</mujoco>\n");
    text
}

/// The beginning of a joint's body: its place, its link, its hinges, its look.
fn write_body(text: &mut String, body: &Skeleton, j: usize, indent: &str, settings: &SimSettings) {
    let joint = &body.joints()[j];
    let offset = if joint.parent.is_some() {
        joint.offset
    } else {
        Vector3::zeros()
    };
    let turned = match &joint.kind {
        JointKind::Ball { reference, .. } => *reference,
        _ => UnitQuaternion::identity(),
    };
    let _ = writeln!(
        text,
        "{indent}<body name=\"{}\" pos=\"{}\" quat=\"{}\">",
        escaped(&joint.name),
        numbers(offset.as_slice()),
        quaternion(&turned)
    );
    let link = &joint.link;
    if link.mass_kg > 0.0 {
        let i = &link.inertia;
        let inertia = [
            i[(0, 0)],
            i[(1, 1)],
            i[(2, 2)],
            i[(0, 1)],
            i[(0, 2)],
            i[(1, 2)],
        ];
        let _ = writeln!(
            text,
            "{indent}  <inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>",
            numbers(link.center.as_slice()),
            link.mass_kg,
            numbers(&inertia)
        );
    }
    write_hinges(text, body, j, indent, settings);
    if link.mass_kg > 0.0 {
        let (axes, frame) = ellipsoid(link);
        let _ = writeln!(
            text,
            "{indent}  <geom pos=\"{}\" quat=\"{}\" size=\"{}\"/>",
            numbers(link.center.as_slice()),
            quaternion(&frame),
            numbers(axes.as_slice())
        );
    }
}

fn write_hinges(
    text: &mut String,
    body: &Skeleton,
    j: usize,
    indent: &str,
    settings: &SimSettings,
) {
    let (axes, ranges) = match (&body.joints()[j].kind, triple(body, j)) {
        (JointKind::Hinge { axis, range }, _) => {
            (vec![axis.into_inner()], Some(vec![(range.low, range.high)]))
        }
        (_, Some(triple)) => (
            triple.axes().to_vec(),
            reach(body, j, &triple).map(|r| r.to_vec()),
        ),
        _ => return,
    };
    for (i, (name, axis)) in names(body, j).iter().zip(axes).enumerate() {
        let range = match &ranges {
            Some(ranges) if settings.joint_limits => {
                format!(" range=\"{} {}\"", ranges[i].0, ranges[i].1)
            }
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            "{indent}  <joint name=\"{}\" axis=\"{}\"{range}/>",
            escaped(name),
            numbers(axis.as_slice())
        );
    }
}

/// How far (radians) the hinges of a ball must go to reach every posture within the body's limits; `None` where it has
/// no limits or comes near the lock on the way.
fn reach(body: &Skeleton, j: usize, triple: &Triple) -> Option<[(f64, f64); 3]> {
    let limits: [_; 3] = body.limits(j).try_into().ok()?;
    let axes = &body.joints()[j].axes;
    let axes = [axes.flexion, axes.abduction, axes.axial];
    let along = |k: usize, i: usize| {
        let share = i as f64 / (POSTURES - 1) as f64;
        axes[k] * (limits[k].low + share * (limits[k].high - limits[k].low))
    };
    let mut reach = [(0.0_f64, 0.0_f64); 3];
    for i in 0..POSTURES.pow(3) {
        let digits = [i / POSTURES.pow(2), i / POSTURES % POSTURES, i % POSTURES];
        let v = along(0, digits[0]) + along(1, digits[1]) + along(2, digits[2]);
        let rotation = exp(&v);
        let angles = triple.angles(&rotation, [0.0; 3]);
        if triple.lock(&rotation) > LOCKING || angles.iter().any(|a| a.abs() > FARTHEST) {
            return None;
        }
        for (range, angle) in reach.iter_mut().zip(angles) {
            *range = (range.0.min(angle), range.1.max(angle));
        }
    }
    Some(reach.map(|(low, high)| (low - BEYOND, high + BEYOND)))
}

/// Half axes (metres) and frame of the ellipsoid of uniform density with a link's mass and inertia:
/// `I_x = m (b^2 + c^2) / 5`.
fn ellipsoid(link: &Link) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let eigen = link.inertia.symmetric_eigen();
    let i = eigen.eigenvalues;
    let half = |own: f64, one: f64, other: f64| {
        (2.5 * (one + other - own) / link.mass_kg)
            .max(0.0)
            .sqrt()
            .max(THIN)
    };
    let axes = Vector3::new(
        half(i.x, i.y, i.z),
        half(i.y, i.z, i.x),
        half(i.z, i.x, i.y),
    );
    let mut frame = eigen.eigenvectors;
    if frame.determinant() < 0.0 {
        frame.set_column(2, &-frame.column(2).into_owned());
    }
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(frame);
    (axes, UnitQuaternion::from_rotation_matrix(&rotation))
}

fn numbers(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|v| v.to_string()).collect();
    words.join(" ")
}

fn quaternion(q: &Quaternion<f64>) -> String {
    numbers(&[q.w, q.i, q.j, q.k])
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
