//! The frame of a limb's upper segment: its bone's direction and its twist about it.
//!
//! The twist follows the hinge plane of elbow or knee. Near a straight limb, or one folded up, the plane is lost in
//! noise; there the twist comes from the source's own, else from smooth passage between the frames where it is known,
//! drawn slowly toward what is usual for the limb. All twists are angles about the bone against a frame that the
//! direction alone fixes, of the middle of the joint's range, so that anatomy keeps them well inside (-pi, pi).

use nalgebra::{UnitQuaternion, Vector3};

use crate::math::rotation::{shortest, twist_angle, wrap};
use crate::math::statistics::median;

/// Flexion (radians) below which the hinge plane says nothing, and above which that of a clean source says all.
const STRAIGHT: f64 = 0.17;
const BENT: f64 = 0.44;
/// Noise of the plane's twist (radians) at which the plane is worth as much as the smoothed passage.
const NOISE_HALF: f64 = 0.09;
/// Seconds over which noise of the plane is smoothed, and in which a straight limb comes back to its usual twist.
const SMOOTHING_SECS: f64 = 0.1;
const RETURN_SECS: f64 = 3.0;
/// The same return where the source's own twist, or the foot of a straight leg, says what the twist is.
const FOLLOW_SECS: f64 = 0.3;

/// Bend (radians) from which a single hinge begins to bind the twist to its plane, and from which it does so wholly.
const HINGE_FREE: f64 = 0.02;
const HINGE_BOUND: f64 = 0.1;

/// One frame of a limb as it was observed, all in world axes.
#[derive(Debug, Clone, Copy)]
pub struct LimbSample {
    /// Orientation of the part that carries the limb (thorax or pelvis).
    pub carrier: UnitQuaternion<f64>,
    /// Unit direction of the upper segment, outward.
    pub upper: Vector3<f64>,
    /// Unit direction of the lower segment, outward.
    pub lower: Vector3<f64>,
    /// Unit direction of the foot, toward the toes, for a leg.
    pub toes: Option<Vector3<f64>>,
    /// The source's orientation of the upper segment, its bone along -z, if it has one.
    pub source: Option<UnitQuaternion<f64>>,
}

/// Which way a limb's hinge bends and where its ball joint rests.
#[derive(Debug, Clone, Copy)]
pub struct LimbKind {
    /// True for the arm (the forearm comes forward), false for the leg.
    pub bends_forward: bool,
    /// The middle of the range of the joint between carrier and upper segment.
    pub reference: UnitQuaternion<f64>,
    /// Whether the body's lower joint is one hinge: then only the twist can turn the lower segment out of its plane.
    pub single_hinge: bool,
    /// The constant twist from the source's orientation to the anatomy, known from its zero pose.
    pub resting: Option<f64>,
}

/// Frames of a limb's two segments.
#[derive(Debug, Clone, PartialEq)]
pub struct LimbFrames {
    /// Orientation of the upper segment: bone along -z, hinge axis along y.
    pub upper: Vec<UnitQuaternion<f64>>,
    /// Orientation of the lower segment: a pure hinge away from the upper.
    pub lower: Vec<UnitQuaternion<f64>>,
}

/// What one frame says of the twist, all angles against `base` and, where there is one, the source's twist.
struct Reading {
    /// The frame of twist zero: the shortest way from the reference to the bone's direction.
    base: UnitQuaternion<f64>,
    /// Twist of the source, 0 without one.
    source: f64,
    /// Twist of the hinge plane.
    plane: f64,
    /// Bend of the hinge, radians in [0, pi].
    flexion: f64,
    /// Trust in the plane, in [0, 1].
    trust: f64,
    /// Usual twist where the plane is silent, and how firmly it draws (1/frames^2, relative).
    usual: f64,
    pull: f64,
}

/// Frames of a limb over time, `rate_hz` samples a second.
pub fn limb_frames(samples: &[LimbSample], kind: &LimbKind, rate_hz: f64) -> LimbFrames {
    let noise = direction_noise(samples);
    let has_source = samples.iter().all(|s| s.source.is_some());
    let mut readings: Vec<Reading> = samples
        .iter()
        .map(|s| read(s, kind, has_source, rate_hz))
        .collect();
    let center = center(&readings, kind.resting.filter(|_| has_source));
    if has_source {
        for r in &mut readings {
            r.usual = center;
            r.pull = pull(FOLLOW_SECS, rate_hz);
        }
    }
    let planes = follow(&mut readings, center);
    let smoothed = smooth(&readings, &planes, center, rate_hz);
    let z = Vector3::z_axis();
    let upper: Vec<UnitQuaternion<f64>> = readings
        .iter()
        .zip(planes.iter().zip(&smoothed))
        .map(|(r, (plane, smoothed))| {
            let noise = noise / r.flexion.sin().max(1e-9);
            let share = r.trust / (1.0 + (noise / NOISE_HALF).powi(2));
            let mut twist = smoothed + share * (plane - smoothed);
            if kind.single_hinge {
                // One hinge reaches the lower segment only in its plane, bent either way: noise or not, the bone counts.
                let half_turns = ((twist - plane) / std::f64::consts::PI).round();
                let in_plane = plane + half_turns * std::f64::consts::PI;
                let bend = r.flexion.min(std::f64::consts::PI - r.flexion);
                twist += smoothstep(HINGE_FREE, HINGE_BOUND, bend) * (in_plane - twist);
            }
            let twist = twist + r.source;
            r.base * UnitQuaternion::from_axis_angle(&z, twist)
        })
        .collect();
    let lower = upper
        .iter()
        .zip(samples)
        .map(|(u, s)| shortest(&(u * -Vector3::z()), &s.lower) * u)
        .collect();
    LimbFrames { upper, lower }
}

fn read(s: &LimbSample, kind: &LimbKind, has_source: bool, rate_hz: f64) -> Reading {
    let down = -Vector3::z();
    let z = Vector3::z_axis();
    let direction = s.carrier.inverse() * s.upper;
    let reference = kind.reference * down;
    let untwisted = |d: &Vector3<f64>| shortest(&reference, d) * kind.reference;
    let base = s.carrier * untwisted(&direction);
    let about = |axis: &Vector3<f64>| {
        let local = base.inverse() * axis;
        (-local.x).atan2(local.y)
    };
    let source = match s.source {
        Some(q) if has_source => twist_angle(&(base.inverse() * q), &z),
        _ => 0.0,
    };
    let normal = s.upper.cross(&s.lower) * if kind.bends_forward { -1.0 } else { 1.0 };
    let flexion = normal.norm().atan2(s.upper.dot(&s.lower));
    // A limb folded up has no plane either; but folded joints are better hinges than straight ones.
    let open = flexion.min(2.0 * (std::f64::consts::PI - flexion));
    // Straight down the usual frame is the neutral one, elsewhere the middle of the range.
    let hanging = twist_angle(&untwisted(&down).inverse(), &z) * direction.dot(&down).max(0.0);
    let mut usual = wrap(hanging - source);
    let mut firmness = pull(RETURN_SECS, rate_hz);
    if let Some(toes) = s.toes {
        let axis = toes.cross(&s.lower);
        let clear = axis.norm_squared();
        if clear > 0.1 {
            usual = wrap(about(&axis) - source);
            firmness = pull(FOLLOW_SECS, rate_hz) * clear;
        }
    }
    Reading {
        base,
        source,
        plane: wrap(about(&normal) - source),
        flexion,
        trust: smoothstep(STRAIGHT, BENT, open),
        usual,
        pull: firmness,
    }
}

/// Standard deviation (radians) of the noise in the angle between the two segments, from third differences in time,
/// in which movement is small: the median of their lengths is 1.177 sqrt(20) deviations.
fn direction_noise(samples: &[LimbSample]) -> f64 {
    let deviation = |at: fn(&LimbSample) -> Vector3<f64>| {
        let third: Vec<f64> = samples
            .windows(4)
            .map(|w| (at(&w[3]) - 3.0 * at(&w[2]) + 3.0 * at(&w[1]) - at(&w[0])).norm())
            .collect();
        median(&third).unwrap_or(0.0) / (1.177 * 20f64.sqrt())
    };
    deviation(|s| s.upper).hypot(deviation(|s| s.lower))
}

/// The mean twist where the plane is clear; else the known offset of the zero pose, else the mean of what is usual.
fn center(readings: &[Reading], resting: Option<f64>) -> f64 {
    let mean = |of: &dyn Fn(&Reading) -> (f64, f64)| {
        readings.iter().fold((0.0, 0.0), |(x, y), r| {
            let (weight, angle) = of(r);
            (x + weight * angle.cos(), y + weight * angle.sin())
        })
    };
    let (x, y) = mean(&|r| (r.trust, r.plane));
    if x.hypot(y) > 1.0 {
        return y.atan2(x);
    }
    resting.unwrap_or_else(|| {
        let (x, y) = mean(&|r| (1.0, r.usual));
        y.atan2(x)
    })
}

/// The planes' twists without jumps of a full turn. A plane opposite to the ones before, in a limb hardly bent, is one
/// bent the wrong way (a hyperextended knee or elbow, or noise): its trust is taken back.
fn follow(readings: &mut [Reading], center: f64) -> Vec<f64> {
    let mut before = center;
    readings
        .iter_mut()
        .map(|r| {
            let off = wrap(r.plane - before);
            let likely = smoothstep(-0.5, 0.0, off.cos());
            r.trust *= likely.max(smoothstep(0.45, 0.8, r.flexion));
            let plane = before + off;
            before += r.trust * off;
            plane
        })
        .collect()
}

/// The twist that is near the planes where they are clear, near the usual one where they are not, and smooth: the
/// least squares of Whittaker (1923), one tridiagonal system.
fn smooth(readings: &[Reading], planes: &[f64], center: f64, rate_hz: f64) -> Vec<f64> {
    let stiffness = (SMOOTHING_SECS * rate_hz).powi(2).max(1e-6);
    let n = readings.len();
    let mut upper = vec![0.0; n];
    let mut twist = vec![0.0; n];
    // The usual twist is named on the turn where the planes last were.
    let mut near = center;
    for (i, r) in readings.iter().enumerate() {
        near += r.trust * (planes[i] - near);
        let usual = near + wrap(r.usual - near);
        let clear = r.trust * r.flexion.sin().powi(2);
        let neighbours = f64::from(i > 0) + f64::from(i + 1 < n);
        let diagonal = clear + stiffness * (r.pull + neighbours);
        let right = clear * planes[i] + stiffness * r.pull * usual;
        let (carried, left) = match i {
            0 => (0.0, 0.0),
            _ => (stiffness * upper[i - 1], stiffness * twist[i - 1]),
        };
        upper[i] = stiffness / (diagonal - carried);
        twist[i] = (right + left) / (diagonal - carried);
    }
    for i in (0..n.saturating_sub(1)).rev() {
        twist[i] += upper[i] * twist[i + 1];
    }
    twist
}

/// The pull toward a value, relative to the stiffness, that is felt within `secs`.
fn pull(secs: f64, rate_hz: f64) -> f64 {
    (secs * rate_hz).max(1.0).powi(-2)
}

fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let s = ((x - low) / (high - low)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}
