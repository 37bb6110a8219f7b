//! [`Course`]: f(p, ·), one movement of a primitive, over phase and over time.

use std::sync::Arc;

use super::curve::Curve;
use crate::skeleton::Skeleton;

/// Channels of a curve beside the pose: forward and leftward velocity, height, yaw rate, logarithm of seconds per phase.
pub(super) const EXTRA: usize = 5;
/// Offset of the logarithm of seconds per unit phase behind the pose.
pub(super) const LOG_SECS: usize = 4;

/// How the root travels at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Travel {
    /// Velocity forward, in the direction that the body faces, metres a second.
    pub forward: f64,
    /// Velocity to the left, metres a second.
    pub left: f64,
    /// Height of the root over the ground, metres.
    pub height: f64,
    /// Turning to the left, radians a second.
    pub yaw_rate: f64,
}

/// What a primitive is at one place of its manifold: parameters and phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Joint coordinates.
    pub pose: Vec<f64>,
    /// Their derivative by phase.
    pub slope: Vec<f64>,
    /// Seconds that a unit of phase would take at this pace; always positive.
    pub secs_per_phase: f64,
    /// How the root travels.
    pub travel: Travel,
}

/// One movement of a primitive: its parameters fixed, its posture a function of phase and phase a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    body: Arc<Skeleton>,
    parameters: Vec<f64>,
    cyclic: bool,
    curve: Curve,
    /// Seconds from phase 0 to each knot.
    clock: Vec<f64>,
}

impl Course {
    pub(super) fn new(
        body: Arc<Skeleton>,
        parameters: Vec<f64>,
        cyclic: bool,
        curve: Curve,
    ) -> Self {
        let knots = curve.knots();
        let mut course = Self {
            body,
            parameters,
            cyclic,
            curve,
            clock: vec![0.0; knots],
        };
        for k in 1..knots {
            let pieces = (knots - 1) as f64;
            let piece = course.quadrature((k - 1) as f64 / pieces, k as f64 / pieces);
            course.clock[k] = course.clock[k - 1] + piece;
        }
        course
    }

    /// The body that moves.
    pub fn body(&self) -> &Arc<Skeleton> {
        &self.body
    }

    /// The parameters in [0, 1]^m that were asked for, brought near the exemplars' hull.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Whether the end joins the beginning: phase wraps from 1 to 0.
    pub fn is_cyclic(&self) -> bool {
        self.cyclic
    }

    /// Seconds from phase 0 to phase 1; of a cyclic movement, of one cycle.
    pub fn duration_secs(&self) -> f64 {
        self.clock[self.clock.len() - 1]
    }

    /// The posture at a phase.
    pub fn pose(&self, phase: f64) -> Vec<f64> {
        let mut pose = vec![0.0; self.body.dof()];
        self.curve.add(self.on_curve(phase), 1.0, 0, &mut pose);
        pose
    }

    /// Everything at a phase.
    pub fn sample(&self, phase: f64) -> Sample {
        sample([(&self.curve, 1.0)], self.body.dof(), self.on_curve(phase))
    }

    /// Seconds from phase 0 to a phase in [0, 1].
    pub fn secs_at(&self, phase: f64) -> f64 {
        let pieces = (self.clock.len() - 1) as f64;
        let phase = phase.clamp(0.0, 1.0);
        let k = ((phase * pieces).floor() as usize).min(self.clock.len() - 2);
        self.clock[k] + self.quadrature(k as f64 / pieces, phase)
    }

    /// The phase after so many seconds from phase 0: at most 1; of a cyclic movement wrapped into [0, 1).
    pub fn phase_at(&self, secs: f64) -> f64 {
        let whole = self.duration_secs();
        let secs = if self.cyclic {
            secs.rem_euclid(whole)
        } else {
            secs.clamp(0.0, whole)
        };
        let pieces = self.clock.len() - 1;
        let k = self.clock.partition_point(|&c| c <= secs).clamp(1, pieces) - 1;
        let (low, high) = (k as f64 / pieces as f64, (k + 1) as f64 / pieces as f64);
        let rest = secs - self.clock[k];
        // Newton on a rising function whose slope is known; its start is the chord.
        let mut phase = low + (high - low) * rest / (self.clock[k + 1] - self.clock[k]);
        for _ in 0..4 {
            let beyond = self.quadrature(low, phase) - rest;
            phase = (phase - beyond / self.secs_per_phase(phase)).clamp(low, high);
        }
        phase
    }

    /// The phase `secs` after a phase, never before it but where a cycle wraps.
    pub fn advance(&self, phase: f64, secs: f64) -> f64 {
        let next = self.phase_at(self.secs_at(phase) + secs);
        if self.cyclic || secs < 0.0 {
            next
        } else {
            next.max(phase.min(1.0))
        }
    }

    fn on_curve(&self, phase: f64) -> f64 {
        if self.cyclic {
            phase.rem_euclid(1.0)
        } else {
            phase
        }
    }

    fn secs_per_phase(&self, phase: f64) -> f64 {
        self.curve.channel(phase, self.body.dof() + LOG_SECS).exp()
    }

    /// Seconds between two phases of one piece: Gauss and Legendre's rule of three points.
    fn quadrature(&self, from: f64, to: f64) -> f64 {
        const NODES: [(f64, f64); 3] = [
            (0.112_701_665_379_258_31, 5.0 / 18.0),
            (0.5, 8.0 / 18.0),
            (0.887_298_334_620_741_7, 5.0 / 18.0),
        ];
        let sum: f64 = NODES
            .iter()
            .map(|(at, weight)| weight * self.secs_per_phase(from + (to - from) * at))
            .sum();
        sum * (to - from)
    }
}

/// The weighted sum of curves at a phase, told apart.
pub(super) fn sample<'a>(
    curves: impl IntoIterator<Item = (&'a Curve, f64)>,
    dof: usize,
    phase: f64,
) -> Sample {
    let mut pose = vec![0.0; dof];
    let mut slope = vec![0.0; dof];
    let mut extra = [0.0; EXTRA];
    for (curve, weight) in curves {
        curve.add(phase, weight, 0, &mut pose);
        curve.add_slope(phase, weight, 0, &mut slope);
        curve.add(phase, weight, dof, &mut extra);
    }
    Sample {
        pose,
        slope,
        secs_per_phase: extra[LOG_SECS].exp(),
        travel: Travel {
            forward: extra[0],
            left: extra[1],
            height: extra[2],
            yaw_rate: extra[3],
        },
    }
}
