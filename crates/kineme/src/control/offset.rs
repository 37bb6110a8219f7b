//! What is left of a body's own posture and velocity while it joins a course (inertialization, Bollo 2018).
//!
//! A body joins a course with a difference x in its coordinates and a difference v in their velocities. The course is
//! followed at once, and the difference, which decays, is added to it: x A(t / T) + v S B(t / S), with quintics of one
//! value or one slope at the beginning and of value, slope and curvature zero at the end. Position and velocity are
//! continuous; after T nothing is left, to the last bit.
//!
//! A ball's difference is one of rotation vectors, the chart in which exemplars are blended, and not a relative
//! rotation: the straight way between two postures stays within the joint's box of limits and in the ball where the
//! chart has no singularity, which the shortest arc between the rotations need not do.

use super::state::Moving;
use crate::error::{Error, Result};

/// The greatest slope of A: how much faster than its mean a difference decays at most.
pub(super) const STEEPEST: f64 = 1.875;
/// Differences below this (radians, metres, a second) are none.
const NONE: f64 = 1e-9;

/// How the difference between a body and the course that it joins decays.
///
/// Per joint, the speed added to the course's is at most `1.875 x / T + v`, the acceleration at most
/// `5.78 x / T^2 + 3.94 v / S`, and the body overshoots by at most `0.198 v S`, where x and v are the differences in
/// position (radians) and velocity at entry, S is `blend_secs`, and T is S or as much longer as `max_speed` asks for:
/// with the defaults no more than 31 + 9.9 v rad/s^2. While T is longer than S, or the course too short for S, the
/// course waits; that changes its velocity by at most the share `0.75 / S` a second (S then being no longer than the
/// seconds that it has left). Where a joint limit holds back a joint of speed u, its smooth bend adds at most
/// `0.77 u^2 / w`, w being the limit's transition, 3 degrees or less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertialization {
    /// Seconds until nothing is left of a difference; half of it is gone after half of them.
    pub blend_secs: f64,
    /// The speed (radians a second) that a difference in posture adds at most to any joint; of joints that share a part
    /// of the body, such as vertebrae, to all of them together. A large difference takes longer than `blend_secs`.
    pub max_speed: f64,
    /// The same for the root's height, metres a second.
    pub max_rise: f64,
}

impl Default for Inertialization {
    fn default() -> Self {
        Self {
            blend_secs: 0.4,
            max_speed: 4.0,
            max_rise: 1.0,
        }
    }
}

impl Inertialization {
    pub(super) fn check(&self) -> Result<()> {
        for (name, value) in [
            ("blend_secs", self.blend_secs),
            ("max_speed", self.max_speed),
            ("max_rise", self.max_rise),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::invalid(format!(
                    "{name} must be positive, found {value}"
                )));
            }
        }
        Ok(())
    }

    /// Seconds that a difference needs. `parts` are the coordinates of joints that count together; the last coordinate
    /// is the root's height.
    pub(super) fn secs(&self, now: &Moving, goal: &Moving, parts: &[Vec<Vec<usize>>]) -> f64 {
        let difference = |c: usize| now.values[c] - goal.values[c];
        let height = now.values.len() - 1;
        let mut secs = self
            .blend_secs
            .max(STEEPEST * difference(height).abs() / self.max_rise);
        for part in parts {
            let joints = part.iter().map(|joint| {
                let square: f64 = joint.iter().map(|&c| difference(c).powi(2)).sum();
                square.sqrt()
            });
            secs = secs.max(STEEPEST * joints.sum::<f64>() / self.max_speed);
        }
        secs
    }
}

/// A difference that decays.
#[derive(Debug, Clone)]
pub(super) struct Offset {
    values: Vec<f64>,
    velocities: Vec<f64>,
    travel: [f64; 3],
    /// Until nothing is left of the values.
    secs: f64,
    /// Until nothing is left of the velocities; not longer.
    velocity_secs: f64,
}

impl Offset {
    /// The difference of `now` from `goal`, gone after `secs`; what comes of velocities after `velocity_secs`.
    pub fn between(now: &Moving, goal: &Moving, secs: f64, velocity_secs: f64) -> Self {
        let minus =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(x, y)| x - y).collect() };
        let mut travel = now.travel;
        for (t, goal) in travel.iter_mut().zip(goal.travel) {
            *t -= goal;
        }
        let mut offset = Self {
            values: minus(&now.values, &goal.values),
            velocities: minus(&now.velocities, &goal.velocities),
            travel,
            secs,
            velocity_secs: velocity_secs.min(secs),
        };
        if offset.is_none() {
            offset.secs = 0.0;
        }
        offset
    }

    /// True when there is no difference to speak of.
    pub fn is_none(&self) -> bool {
        let all = self.values.iter().chain(&self.velocities);
        all.chain(&self.travel).all(|v| v.abs() < NONE)
    }

    /// True when nothing is left after `t` seconds.
    pub fn is_over(&self, t: f64) -> bool {
        t >= self.secs
    }

    /// Adds what is left after `t` seconds.
    pub fn add(&self, t: f64, to: &mut Moving) {
        if self.is_over(t) {
            return;
        }
        let sums = to.values.iter_mut().zip(&mut to.velocities);
        for ((value, velocity), (x, v)) in sums.zip(self.left(t)) {
            *value += x;
            *velocity += v;
        }
        for (sum, v) in to.travel.iter_mut().zip(self.travel_left(t)) {
            *sum += v;
        }
    }

    /// What is left of values and velocities before it is over.
    pub fn left(&self, t: f64) -> impl Iterator<Item = (f64, f64)> {
        let (fade, fading) = fade(t / self.secs);
        let fading = fading / self.secs;
        let (mut brake, mut braking) = (0.0, 0.0);
        if t < self.velocity_secs {
            (brake, braking) = self::brake(t / self.velocity_secs);
            brake *= self.velocity_secs;
        }
        let differences = self.values.iter().zip(&self.velocities);
        differences.map(move |(x, v)| (x * fade + v * brake, x * fading + v * braking))
    }

    /// What is left of the root's travel before it is over.
    pub fn travel_left(&self, t: f64) -> [f64; 3] {
        let (fade, _) = fade(t / self.secs);
        self.travel.map(|v| v * fade)
    }
}

/// A: from 1 to 0, slopes and curvatures zero at both ends; and its slope.
fn fade(s: f64) -> (f64, f64) {
    let (s2, r) = (s * s, 1.0 - s);
    // 1 - 10 s^3 + 15 s^4 - 6 s^5 and its derivative, in factors that keep the end exact.
    let value = r * r * r * (1.0 + 3.0 * s + 6.0 * s2);
    (value, -30.0 * s2 * r * r)
}

/// B: zero at both ends, slope 1 at the beginning and 0 at the end, curvatures zero; and its slope.
fn brake(s: f64) -> (f64, f64) {
    let r = 1.0 - s;
    // s - 6 s^3 + 8 s^4 - 3 s^5 and its derivative.
    let value = s * r * r * r * (1.0 + 3.0 * s);
    (value, r * r * (1.0 + 2.0 * s - 15.0 * s * s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounds_that_are_stated_hold_and_are_met() {
        let steps = 100_000;
        let h = 1.0 / f64::from(steps);
        let (mut steepest, mut bent) = (0.0_f64, [0.0_f64; 2]);
        let mut farthest = 0.0_f64;
        for k in 0..steps {
            let (s, next) = (f64::from(k) * h, f64::from(k + 1) * h);
            for (i, f) in [fade as fn(f64) -> (f64, f64), brake].iter().enumerate() {
                let ((a, da), (b, db)) = (f(s), f(next));
                assert!(((b - a) / h - 0.5 * (da + db)).abs() < 1e-8);
                bent[i] = bent[i].max(((db - da) / h).abs());
            }
            steepest = steepest.max(fade(s).1.abs());
            farthest = farthest.max(brake(s).0);
            assert!(brake(s).1.abs() <= 1.0);
        }
        assert!((steepest - STEEPEST).abs() < 1e-6);
        assert!(bent[0] <= 5.78 && bent[0] > 5.77, "{bent:?}");
        assert!(bent[1] <= 3.941 && bent[1] > 3.94, "{bent:?}");
        assert!(farthest <= 0.198 && farthest > 0.197, "{farthest}");
        assert_eq!(fade(0.0), (1.0, -0.0));
        assert_eq!(brake(0.0), (0.0, 1.0));
        assert_eq!(fade(1.0).0, 0.0);
        assert_eq!(brake(1.0).0, 0.0);
    }
}
