//! Exemplars as curves over phase, on common knots.

use nalgebra::{Rotation2, Vector2, Vector3};

use super::course::{EXTRA, LOG_SECS};
use super::curve::Curve;
use super::exemplar::Exemplar;
use super::modelling::{Fit, Used};
use crate::alignment::Warp;
use crate::math::rotation::{exp, log_near};
use crate::motion::Motion;

/// The registered exemplars: pose, travel and pace over phase.
pub(super) fn curves(exemplars: &[Exemplar], fit: &Fit) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::with_capacity(exemplars.len());
    let mut first_poses: Vec<f64> = Vec::new();
    for ((exemplar, used), warp) in exemplars.iter().zip(&fit.used).zip(&fit.warps) {
        let channels = exemplar.motion.skeleton().dof() + EXTRA;
        let mut values = knots(&exemplar.motion, used, warp, fit.knots);
        same_branch(&mut values, channels, &exemplar.motion, &first_poses);
        if first_poses.is_empty() {
            first_poses = values[..channels].to_vec();
        }
        if fit.cyclic {
            let ends = ends(&exemplar.motion, used, &values[..channels]);
            close(&mut values, &ends, used, warp);
        }
        curves.push(Curve::through(values, channels, fit.cyclic));
    }
    curves
}

/// Pose, travel and pace at evenly spaced phases.
fn knots(motion: &Motion, used: &Used, warp: &Warp, count: usize) -> Vec<f64> {
    let dof = motion.skeleton().dof();
    let rate = motion.rate_hz();
    let length = used.end - used.start;
    let mut values = Vec::with_capacity(count * (dof + EXTRA));
    for k in 0..count {
        let phase = k as f64 / (count - 1) as f64;
        let frame = used.frame(warp.place(phase));
        pose_between(motion, frame, &mut values);
        values.extend(travel(motion, frame));
        values.push((warp.slope(phase) * length / rate).ln());
    }
    debug_assert_eq!(EXTRA, LOG_SECS + 1);
    values
}

/// The pose at a frame that need not be whole: a cubic through four frames (Catmull and Rom 1974), each ball's rotation
/// vector continued from the frame before.
fn pose_between(motion: &Motion, frame: f64, values: &mut Vec<f64>) {
    let last = motion.frames() - 1;
    let at = (frame.floor().max(0.0) as usize).min(last);
    let s = (frame - at as f64).clamp(0.0, 1.0);
    if s == 0.0 {
        values.extend_from_slice(motion.pose(at));
        return;
    }
    let four = [
        at.saturating_sub(1),
        at,
        (at + 1).min(last),
        (at + 2).min(last),
    ];
    let basis = catmull_rom(s);
    let first = values.len();
    for c in 0..motion.skeleton().dof() {
        values.push((0..4).map(|i| basis[i] * motion.pose(four[i])[c]).sum());
    }
    for joint in 0..motion.skeleton().joints().len() {
        let ball = motion.skeleton().coordinates(joint);
        if ball.len() != 3 {
            continue;
        }
        let given = |f: usize| Vector3::from_column_slice(&motion.pose(f)[ball.clone()]);
        let middle = given(at);
        let turns = four.map(given);
        if turns
            .iter()
            .all(|v| (v - middle).norm() < std::f64::consts::PI)
        {
            continue;
        }
        // A rotation vector that changes its name between frames is followed under the name that it has here.
        let sum: Vector3<f64> = (0..4)
            .map(|i| log_near(&exp(&turns[i]), &middle) * basis[i])
            .sum();
        values[first + ball.start..first + ball.end].copy_from_slice(sum.as_slice());
    }
}

fn catmull_rom(s: f64) -> [f64; 4] {
    let (s2, s3) = (s * s, s * s * s);
    [
        0.5 * (-s + 2.0 * s2 - s3),
        0.5 * (2.0 - 5.0 * s2 + 3.0 * s3),
        0.5 * (s + 4.0 * s2 - 3.0 * s3),
        0.5 * (s3 - s2),
    ]
}

/// Forward and leftward velocity, height and yaw rate at a frame that need not be whole.
fn travel(motion: &Motion, frame: f64) -> [f64; 4] {
    let last = (motion.frames() - 1) as f64;
    let rate = motion.rate_hz();
    let place = |frame: f64| {
        let at = (frame.floor() as usize).min(motion.frames() - 1);
        let next = (at + 1).min(motion.frames() - 1);
        let s = frame - at as f64;
        let (a, b) = (motion.root(at), motion.root(next));
        (
            a.position + (b.position - a.position) * s,
            a.yaw + (b.yaw - a.yaw) * s,
        )
    };
    let (before, after) = ((frame - 1.0).max(0.0), (frame + 1.0).min(last));
    let secs = (after - before) / rate;
    let ((p0, y0), (p1, y1)) = (place(before), place(after));
    let (here, yaw) = place(frame);
    let v = Rotation2::new(-yaw) * Vector2::new(p1.x - p0.x, p1.y - p0.y) / secs;
    [v.x, v.y, here.z, (y1 - y0) / secs]
}

/// Names each ball's rotation vectors so that they follow one another, and begin as those of the first exemplar do.
fn same_branch(values: &mut [f64], channels: usize, motion: &Motion, first: &[f64]) {
    let body = motion.skeleton();
    for joint in 0..body.joints().len() {
        let ball = body.coordinates(joint);
        if ball.len() != 3 {
            continue;
        }
        let mut before = match first.get(ball.clone()) {
            Some(v) => Vector3::from_column_slice(v),
            None => Vector3::from_column_slice(&values[ball.clone()]),
        };
        for row in values.chunks_exact_mut(channels) {
            let v = Vector3::from_column_slice(&row[ball.clone()]);
            // Only a jump is renamed: what continues keeps its numbers to the last bit.
            if (v - before).norm() > std::f64::consts::PI {
                let named = log_near(&exp(&v), &before);
                row[ball.clone()].copy_from_slice(named.as_slice());
                before = named;
            } else {
                before = v;
            }
        }
    }
}

/// What a cycle leaves open: pose and travel at its end less those at its beginning; the pace closes by itself.
fn ends(motion: &Motion, used: &Used, like: &[f64]) -> Vec<f64> {
    let mut both = Vec::with_capacity(2 * like.len());
    for frame in [used.start, used.end] {
        pose_between(motion, frame, &mut both);
        both.extend(travel(motion, frame));
        both.push(0.0);
    }
    same_branch(&mut both, like.len(), motion, like);
    let (start, end) = both.split_at(like.len());
    start.iter().zip(end).map(|(a, b)| b - a).collect()
}

/// Spreads what is left open over the whole cycle, so that its last knot is its first.
fn close(values: &mut [f64], gap: &[f64], used: &Used, warp: &Warp) {
    let channels = gap.len();
    let knots = values.len() / channels;
    for (k, row) in values.chunks_exact_mut(channels).enumerate() {
        let place = warp.place(k as f64 / (knots - 1) as f64).clamp(0.0, 1.0);
        let share = used.share(place) - 0.5;
        for (v, g) in row.iter_mut().zip(gap) {
            *v -= share * g;
        }
    }
    // Rounding and the pace apart, they are equal already.
    let (start, end) = values.split_at_mut((knots - 1) * channels);
    end.copy_from_slice(&start[..channels]);
}
