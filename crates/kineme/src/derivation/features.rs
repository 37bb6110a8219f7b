//! What segments are compared by: landmarks (joint positions against the pelvis, heading removed) and how the body travels.

use nalgebra::{UnitQuaternion, Vector3};

use crate::motion::{Motion, landmark_dims};
use crate::skeleton::Skeleton;

/// How motions become feature sequences.
#[derive(Debug, Clone, PartialEq)]
pub struct Features {
    /// Weight of the root's velocity (m/s) and yaw rate (rad/s) beside positions (m), seconds.
    pub velocity_secs: f64,
    /// Frames that each segment is resampled to.
    pub frames: usize,
    /// Share of each segment's mean posture that is removed, in [0, 1]: 0 compares postures, 1 only their changes.
    pub shape: f64,
    /// Width of the warping band as a share of the segment.
    pub band: f64,
}

impl Default for Features {
    fn default() -> Self {
        Self {
            velocity_secs: 0.3,
            frames: 32,
            shape: 0.0,
            band: 0.15,
        }
    }
}

/// Seconds on either side over which the root's velocity is taken.
const VELOCITY_SPAN_SECS: f64 = 0.1;

/// Numbers a frame of [`Features::of`].
pub fn dims(body: &Skeleton) -> usize {
    landmark_dims(body) + 4
}

impl Features {
    /// The features of every frame of a motion, frame-major, [`dims`] a frame, metres.
    pub fn of(&self, motion: &Motion) -> Vec<f64> {
        let body = motion.skeleton();
        let landmarks = motion.landmarks();
        let dims = landmark_dims(body);
        let last = motion.frames() - 1;
        let span = ((VELOCITY_SPAN_SECS * motion.rate_hz()).round() as usize).max(1);
        let mut features = Vec::with_capacity(motion.frames() * (dims + 4));
        for f in 0..motion.frames() {
            let root = motion.root(f);
            let upright = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -root.yaw);
            features.extend_from_slice(&landmarks[f * dims..(f + 1) * dims]);
            let (a, b) = (f.saturating_sub(span), (f + span).min(last));
            let secs = (b - a).max(1) as f64 / motion.rate_hz();
            let (ra, rb) = (motion.root(a), motion.root(b));
            let velocity = upright * (rb.position - ra.position) * (self.velocity_secs / secs);
            features.extend_from_slice(velocity.as_slice());
            features.push((rb.yaw - ra.yaw) * self.velocity_secs / secs);
        }
        features
    }

    /// Frames `range` of a feature sequence resampled linearly to [`Features::frames`], less the share of its mean.
    pub fn segment(
        &self,
        sequence: &[f64],
        dims: usize,
        range: std::ops::Range<usize>,
    ) -> Vec<f64> {
        let n = self.frames;
        let length = range.len();
        let row = |f: usize| &sequence[(range.start + f) * dims..(range.start + f + 1) * dims];
        let mut out = Vec::with_capacity(n * dims);
        for i in 0..n {
            let place = i as f64 * (length - 1) as f64 / (n.max(2) - 1) as f64;
            let a = (place.floor() as usize).min(length - 1);
            let b = (a + 1).min(length - 1);
            let s = place - a as f64;
            out.extend(row(a).iter().zip(row(b)).map(|(x, y)| x + (y - x) * s));
        }
        if self.shape > 0.0 {
            for d in 0..dims {
                let mean = out.iter().skip(d).step_by(dims).sum::<f64>() / n as f64;
                out.iter_mut()
                    .skip(d)
                    .step_by(dims)
                    .for_each(|v| *v -= self.shape * mean);
            }
        }
        out
    }
}
