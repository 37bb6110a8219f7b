//! Entering the field, and following what is observed.

use super::field::Flowfield;
use super::flow::FlowState;
use super::local::Place;
use super::samples::{LANES, MOST_AXES, Match};
use super::settings::Memory;
use crate::error::{Error, Result};

/// Bounds of a pace that is learned from observation.
const PACES: [f64; 2] = [0.5, 2.0];
/// The phase is lost where the posture is this many times as far from the manifold there as elsewhere ...
const LOST: f64 = 1.5;
/// ... and this much, radians.
const LOST_RAD: f64 = 0.03;
/// A difference of velocities counts as much as that of postures this much later, seconds.
const VELOCITY_SECS: f64 = 0.15;
/// What entering at the end of a movement costs more than at its beginning, radians: where both are the same posture,
/// one begins.
const LATE_RAD: f64 = 0.05;

impl Flowfield {
    /// The state nearest to a posture: of two places with the same posture the earlier one.
    ///
    /// # Errors
    /// When the posture has not the body's coordinates, or one is not finite.
    pub fn enter(&self, pose: &[f64]) -> Result<FlowState> {
        self.entry(pose, None)
    }

    /// The state nearest to a posture that moves; a difference of velocities counts as that of postures 0.15 s later.
    ///
    /// # Errors
    /// As [`Self::enter`].
    pub fn enter_moving(&self, pose: &[f64], velocity: &[f64]) -> Result<FlowState> {
        self.check(velocity)?;
        self.entry(pose, Some(velocity))
    }

    /// The state of a posture at a phase that is known.
    ///
    /// # Errors
    /// As [`Self::enter`], and when the phase is not finite.
    pub fn enter_at(&self, pose: &[f64], phase: f64) -> Result<FlowState> {
        self.check(pose)?;
        if !phase.is_finite() {
            return Err(Error::invalid(format!("a phase is finite, found {phase}")));
        }
        Ok(self.state(self.named(pose), self.on_curve(phase)))
    }

    /// A state with the parameters that its posture tells; where it tells nothing, those in the exemplars' middle.
    fn state(&self, pose: Vec<f64>, phase: f64) -> FlowState {
        FlowState {
            parameters: self.near(&pose, phase, &self.centre).parameters,
            pose,
            phase,
            pace: 1.0,
            advanced: 0.0,
        }
    }

    fn entry(&self, pose: &[f64], velocity: Option<&[f64]>) -> Result<FlowState> {
        self.check(pose)?;
        let pose = self.named(pose);
        let found = self.nearest_entry(&pose, velocity);
        let phase = self.on_curve(self.samples.phase(&found));
        Ok(self.state(pose, phase))
    }

    /// The nearest place of all courses to a posture, and to a velocity where one is known.
    fn nearest_entry(&self, pose: &[f64], velocity: Option<&[f64]>) -> Match {
        let query = self.query(pose);
        let moving = velocity.map(|v| self.direction(v));
        let pieces = self.samples.pieces() as f64;
        let late = if self.cyclic { 0.0 } else { LATE_RAD / pieces };
        let found = self.samples.nearest(
            &query,
            self.samples.everywhere(),
            1,
            |block| self.parameter_cost(block, &self.centre),
            |block, place| {
                let mut cost = [(late * place as f64).powi(2); LANES];
                if let Some(v) = &moving {
                    self.add_velocity_gap(v, block, place, &mut cost);
                }
                cost
            },
        );
        found.as_slice()[0]
    }

    /// Adds what the velocity of the samples at a place differs from `velocity`.
    fn add_velocity_gap(
        &self,
        velocity: &[f64; MOST_AXES],
        block: usize,
        place: i64,
        cost: &mut [f64; LANES],
    ) {
        let end = self.samples.pieces() as i64;
        let (before, after) = if self.cyclic {
            (place - 1, place + 1)
        } else {
            ((place - 1).max(0), (place + 1).min(end))
        };
        let rows = self.samples.lanes(block, after);
        let earlier = self.samples.lanes(block, before);
        let paces = self.paces(block, place);
        for ((a, b), v) in rows.iter().zip(earlier).zip(velocity) {
            for lane in 0..LANES {
                // Lanes without a course are infinitely far anyway.
                let rise = if a[lane].is_finite() {
                    a[lane] - b[lane]
                } else {
                    0.0
                };
                let own = rise / (after - before) as f64 * paces[lane];
                cost[lane] += (VELOCITY_SECS * (own - v)).powi(2);
            }
        }
    }

    /// Blends a measured posture into a state: posture, phase and parameters go the share `gain` (0 to 1) of the way from
    /// what the field predicted to what was measured, and the pace follows. With 1 the lag of whatever follows the field would stall it, with 0 nothing
    /// is learned of disturbances; 0.2 serves a robot, 0.5 an observer. Where the posture is clearly nearer to the manifold
    /// at another phase, the phase was lost, and the state is entered anew.
    ///
    /// # Errors
    /// As [`Self::enter`], and when the gain is not in [0, 1].
    pub fn observe(&self, state: &mut FlowState, measured: &[f64], gain: f64) -> Result<()> {
        self.check(measured)?;
        if !(0.0..=1.0).contains(&gain) {
            return Err(Error::invalid(format!(
                "a gain lies in [0, 1], found {gain}"
            )));
        }
        let measured = self.named(measured);
        if self.settings.memory == Memory::Phase {
            let seen = self.near(&measured, state.phase, &state.parameters);
            if let Some(phase) = self.elsewhere(&measured, &seen) {
                *state = self.state(measured, phase);
                return Ok(());
            }
            let ahead = seen.phase - state.phase;
            if self.settings.learn_pace && state.advanced > 0.0 {
                // The gains of a tracker of place and velocity (Benedict and Bordner 1962).
                let faster = 1.0 + gain * gain / (2.0 - gain) * ahead / state.advanced;
                state.pace = (state.pace * faster).clamp(PACES[0], PACES[1]);
            }
            state.advanced = 0.0;
            state.phase = self.on_curve(state.phase + gain * ahead);
            for (p, q) in state.parameters.iter_mut().zip(&seen.parameters) {
                *p += gain * (q - *p);
            }
        }
        for (x, m) in state.pose.iter_mut().zip(&measured) {
            *x += gain * (m - *x);
        }
        Ok(())
    }

    /// The phase at which a posture is clearly nearer to the manifold than at the place where it was sought.
    fn elsewhere(&self, pose: &[f64], sought: &Place) -> Option<f64> {
        let there = self.point(&sought.shares, sought.phase).pose;
        let far = self.distance_rad(pose, &there);
        if far <= LOST_RAD {
            return None;
        }
        let found = self.nearest_entry(pose, None);
        let lost = far > LOST * found.cost.sqrt() + LOST_RAD;
        lost.then(|| self.on_curve(self.samples.phase(&found)))
    }

    fn check(&self, coordinates: &[f64]) -> Result<()> {
        let dof = self.body.dof();
        if coordinates.len() != dof || coordinates.iter().any(|v| !v.is_finite()) {
            return Err(Error::invalid(format!(
                "{} coordinates, or some not finite, are none of the body `{}`, which has {dof}",
                coordinates.len(),
                self.body.name()
            )));
        }
        Ok(())
    }
}
