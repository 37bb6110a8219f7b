//! The frame of a limb's upper segment: its bone's direction and its twist about it.
//!
//! The twist follows the hinge plane of elbow or knee. Near a straight limb the plane is lost, and the source's own
//! twist carries on, or continuity where the source has none.

use nalgebra::{UnitQuaternion, Vector3};

use crate::math::rotation::{shortest, twist_angle, wrap};

/// Flexion (radians) below which the hinge plane says nothing, and above which it says all.
const STRAIGHT: f64 = 0.17;
const BENT: f64 = 0.44;

/// One frame of a limb as it was observed, all in world axes.
#[derive(Debug, Clone, Copy)]
pub struct LimbSample {
    /// Orientation of the part that carries the limb (thorax or pelvis).
    pub carrier: UnitQuaternion<f64>,
    /// Unit direction of the upper segment, outward.
    pub upper: Vector3<f64>,
    /// Unit direction of the lower segment, outward.
    pub lower: Vector3<f64>,
    /// The source's orientation of the upper segment, its bone along -z, if it has one.
    pub source: Option<UnitQuaternion<f64>>,
}

/// Frames of a limb's two segments.
#[derive(Debug, Clone, PartialEq)]
pub struct LimbFrames {
    /// Orientation of the upper segment: bone along -z, hinge axis along y.
    pub upper: Vec<UnitQuaternion<f64>>,
    /// Orientation of the lower segment: a pure hinge away from the upper.
    pub lower: Vec<UnitQuaternion<f64>>,
}

/// The frame of twist zero for a bone along `direction` (in the carrier's axes): the shortest way from the reference.
fn untwisted(reference: &UnitQuaternion<f64>, direction: &Vector3<f64>) -> UnitQuaternion<f64> {
    shortest(&(reference * -Vector3::z()), direction) * reference
}

/// Frames of a limb over time. `bends_forward` is true for the arm (the forearm comes forward), false for the leg;
/// `reference` is the middle of the joint's range; `resting` the twist offset known from the source's zero pose, if any.
pub fn limb_frames(
    samples: &[LimbSample],
    bends_forward: bool,
    reference: &UnitQuaternion<f64>,
    resting: Option<f64>,
) -> LimbFrames {
    let side = if bends_forward { -1.0 } else { 1.0 };
    let z = Vector3::z_axis();
    // Per frame: frame of twist zero, twist of the hinge plane with its confidence, twist of the source.
    let looked: Vec<_> = samples
        .iter()
        .map(|s| {
            let base = s.carrier * untwisted(reference, &(s.carrier.inverse() * s.upper));
            let normal = s.upper.cross(&s.lower) * side;
            let flexion = normal.norm().atan2(s.upper.dot(&s.lower));
            let share = ((flexion - STRAIGHT) / (BENT - STRAIGHT)).clamp(0.0, 1.0);
            let confidence = share * share * (3.0 - 2.0 * share);
            let local = base.inverse() * normal;
            let plane = (-local.x).atan2(local.y);
            let source = s.source.map(|q| twist_angle(&(base.inverse() * q), &z));
            (base, plane, confidence, source)
        })
        .collect();
    let twists = if looked.iter().all(|l| l.3.is_some()) {
        let pairs: Vec<(f64, f64, f64)> = looked
            .iter()
            .map(|l| (l.1, l.2, l.3.unwrap_or_default()))
            .collect();
        twists_with_source(&pairs, resting)
    } else {
        let pairs: Vec<(f64, f64)> = looked.iter().map(|l| (l.1, l.2)).collect();
        let plain: Vec<f64> = samples
            .iter()
            .zip(&looked)
            .map(|(s, l)| {
                let hanging =
                    s.carrier * shortest(&-Vector3::z(), &(s.carrier.inverse() * s.upper));
                twist_angle(&(l.0.inverse() * hanging), &z)
            })
            .collect();
        twists_by_continuity(&pairs, &plain)
    };
    let upper: Vec<UnitQuaternion<f64>> = looked
        .iter()
        .zip(&twists)
        .map(|(l, &twist)| l.0 * UnitQuaternion::from_axis_angle(&z, twist))
        .collect();
    let lower = upper
        .iter()
        .zip(samples)
        .map(|(u, s)| shortest(&(u * -Vector3::z()), &s.lower) * u)
        .collect();
    LimbFrames { upper, lower }
}

/// The source's twist, offset so that it agrees with the hinge plane where that is clear, corrected there frame by frame.
fn twists_with_source(pairs: &[(f64, f64, f64)], resting: Option<f64>) -> Vec<f64> {
    let (mut x, mut y) = (0.0, 0.0);
    for (plane, confidence, source) in pairs {
        x += confidence * (plane - source).cos();
        y += confidence * (plane - source).sin();
    }
    let clear = x.hypot(y);
    let offset = if clear > 1.0 {
        y.atan2(x)
    } else {
        resting.unwrap_or(0.0)
    };
    let mut before = 0.0;
    pairs
        .iter()
        .map(|(plane, confidence, source)| {
            let twist = source + offset + confidence * wrap(plane - source - offset);
            before += wrap(twist - before);
            before
        })
        .collect()
}

/// The hinge plane's twist where it is clear; between such frames linear in time, before and after them held;
/// `plain` (no twist against the hanging limb) where it never is.
fn twists_by_continuity(pairs: &[(f64, f64)], plain: &[f64]) -> Vec<f64> {
    let clear: Vec<usize> = (0..pairs.len()).filter(|&i| pairs[i].1 > 0.5).collect();
    let (Some(&first), Some(&last)) = (clear.first(), clear.last()) else {
        return plain.to_vec();
    };
    let mut bridged = vec![0.0; pairs.len()];
    let mut before: Option<(usize, f64)> = None;
    for &i in &clear {
        let value = match before {
            Some((_, b)) => b + wrap(pairs[i].0 - b),
            None => pairs[i].0,
        };
        if let Some((a, b)) = before {
            for (k, between) in bridged[a + 1..i].iter_mut().enumerate() {
                *between = b + (value - b) * (k + 1) as f64 / (i - a) as f64;
            }
        }
        bridged[i] = value;
        before = Some((i, value));
    }
    let (head, tail) = (bridged[first], bridged[last]);
    bridged[..first].fill(head);
    bridged[last + 1..].fill(tail);
    // Fade from the bridge to the plane as the plane becomes clear, so that nothing jumps at the threshold.
    bridged
        .iter()
        .zip(pairs)
        .map(|(b, (plane, confidence))| b + confidence * wrap(plane - b))
        .collect()
}
