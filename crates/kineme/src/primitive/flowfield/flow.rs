//! Following the field: where it goes from a posture, step by step and over a horizon.

use super::field::Flowfield;
use super::local::{Place, Point};
use super::samples::{LANES, MOST_AXES, Match, Prior};
use super::settings::Memory;
use crate::error::{Error, Result};
use crate::primitive::course::Travel;

/// The phase at which a movement that is no cycle has come to its end.
pub(super) const END: f64 = 0.98;
/// How fast phase and posture settle at the end at most, as a share of what is left, 1/s.
const SETTLING_RATE: f64 = 25.0;
/// How fast the phase goes to where the posture is, 1/s.
const PHASE_GAIN: f64 = 4.0;
/// Bounds of the phase's rate, as multiples of the field's own: it never stands, so that every movement ends.
const PHASE_RATES: [f64; 2] = [0.5, 2.0];
/// The phase is lost where the posture is this many times as far from the manifold there as elsewhere ...
const LOST: f64 = 1.5;
/// ... and this much, radians.
const LOST_RAD: f64 = 0.03;
/// Bounds of a pace that is learned from observation.
const PACES: [f64; 2] = [0.5, 2.0];
/// A difference of velocities counts as much as that of postures this much later, seconds.
const VELOCITY_SECS: f64 = 0.15;
/// What entering at the end of a movement costs more than at its beginning, radians: where both are the same posture,
/// one begins.
const LATE_RAD: f64 = 0.05;
/// Steps longer than this are taken in parts, seconds.
const LONGEST_STEP: f64 = 0.034;
/// States that a prediction may have.
const MOST_STATES: f64 = 1e6;

/// Where a movement is: a posture and, unless the field is memoryless, the phase and the parameters that go with it.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowState {
    pub(super) pose: Vec<f64>,
    pub(super) phase: f64,
    pub(super) parameters: Vec<f64>,
    pub(super) pace: f64,
    /// How far the phase has come since the last observation.
    pub(super) advanced: f64,
}

impl FlowState {
    /// Joint coordinates.
    pub fn pose(&self) -> &[f64] {
        &self.pose
    }

    /// Phase in [0, 1].
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Parameters of the primitive, about [0, 1]^m: kept while the field is followed, learned from what is observed.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// How fast the movement is taken, as a multiple of the exemplars' own speed.
    pub fn pace(&self) -> f64 {
        self.pace
    }

    /// The same with other parameters.
    ///
    /// # Errors
    /// When there are not as many as the primitive has, or one is not finite.
    pub fn with_parameters(self, parameters: &[f64]) -> Result<Self> {
        if parameters.len() != self.parameters.len() || parameters.iter().any(|p| !p.is_finite()) {
            return Err(Error::invalid(format!(
                "{} finite parameters, found {parameters:?}",
                self.parameters.len()
            )));
        }
        Ok(Self {
            parameters: parameters.to_vec(),
            ..self
        })
    }

    /// The same, taken faster or more slowly: 0.1 to 10 times the exemplars' speed.
    pub fn paced(self, pace: f64) -> Self {
        let pace = if pace.is_nan() { 1.0 } else { pace };
        Self {
            pace: pace.clamp(0.1, 10.0),
            ..self
        }
    }
}

/// What the field says of a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// Velocity of the joint coordinates, radians a second: along the movement, and toward the manifold.
    pub velocity: Vec<f64>,
    /// The part of it along the movement.
    pub tangent: Vec<f64>,
    /// Phase a second, never negative.
    pub phase_rate: f64,
    /// The phase at which the primitive is nearest to the posture; [`FlowState::phase`] is drawn to it.
    pub phase: f64,
    /// Parameters of the primitive there: the kernel mean of the near samples, moved to where the posture is.
    pub parameters: Vec<f64>,
    /// Weights of the primitive's exemplars there.
    pub weights: Vec<f64>,
    /// The primitive's posture there: the nearest of the manifold, as far as the samples tell.
    pub nearest: Vec<f64>,
    /// How the root travels there.
    pub travel: Travel,
    /// Distance of the posture from the manifold: weighted root mean square, radians ([`Flowfield::distance_rad`]).
    pub distance_rad: f64,
    /// Whether that is farther than the field vouches for: [`Flowfield::approach`] leads back.
    pub out_of_basin: bool,
    /// Whether the movement has come to its end; a cycle never does.
    pub finished: bool,
}

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

    /// Where the field goes from a state.
    ///
    /// # Panics
    /// When the state is of another body.
    pub fn update(&self, state: &FlowState) -> Update {
        match self.settings.memory {
            Memory::Phase => self.with_phase(state),
            Memory::None => self.without_phase(state),
        }
    }

    fn with_phase(&self, state: &FlowState) -> Update {
        let place = self.near(&state.pose, state.phase, &state.parameters);
        let point = self.point(&place.shares, place.phase);
        let rate = state.pace / point.secs_per_phase;
        let gap = Gap::between(self, &state.pose, &point);
        // The posture is so far from the blended one along the movement: no more than one sample's place.
        let most = 1.0 / self.samples.pieces() as f64;
        let phase = place.phase + gap.ahead.clamp(-most, most);
        let drawn = rate + PHASE_GAIN * (phase - state.phase);
        let mut phase_rate = drawn.clamp(PHASE_RATES[0] * rate, PHASE_RATES[1] * rate);
        let mut tangent: Vec<f64> = point.slope.iter().map(|s| s * rate).collect();
        let pull = self.settings.correction;
        let mut velocity: Vec<f64> = gap.normal.iter().map(|r| pull * r).collect();
        let rest = SETTLING_RATE * (1.0 - state.phase);
        if !self.cyclic && rest < phase_rate {
            // The flow dies down to a goal attractor; the phase comes to its end as the movement does.
            let left = (rest / phase_rate).max(0.0);
            phase_rate *= left;
            let end = self.point(&place.shares, 1.0).pose;
            for (t, (v, (e, x))) in tangent
                .iter_mut()
                .zip(velocity.iter_mut().zip(end.iter().zip(&state.pose)))
            {
                *t *= left;
                *v = left * *v + (1.0 - left) * pull * (e - x);
            }
        }
        for (v, t) in velocity.iter_mut().zip(&tangent) {
            *v += t;
        }
        Update {
            velocity,
            tangent,
            phase_rate,
            phase: self.on_curve(phase),
            parameters: place.parameters,
            weights: place.shares,
            nearest: point.pose,
            travel: point.travel,
            distance_rad: gap.distance_rad,
            out_of_basin: gap.distance_rad > self.settings.basin_rad,
            finished: !self.cyclic && state.phase >= END,
        }
    }

    /// The place on the manifold near a posture whose phase and parameters are about these.
    fn near(&self, pose: &[f64], phase: f64, parameters: &[f64]) -> Place {
        let query = self.query(pose);
        let window = self.samples.around(phase, self.settings.window);
        let prior = Prior {
            phase,
            stiffness: (self.settings.sigma_rad / self.settings.sigma).powi(2),
        };
        let most = self.settings.neighbours + 1;
        let own = |block| self.parameter_cost(block, parameters);
        let matches = self.samples.nearest_to(&query, window, most, own, prior);
        self.place(&query, parameters, &matches)
    }

    /// Takes a state `dt_secs` further: the midpoint rule (Runge and Kutta's second order), in parts of at most 34 ms.
    /// Returns what the field said of the state before. Postures out of the basin are drawn back by the correction alone;
    /// [`Self::approach`] is the smooth way.
    ///
    /// A duration that is not positive and finite does nothing.
    ///
    /// # Panics
    /// When the state is of another body.
    pub fn step(&self, state: &mut FlowState, dt_secs: f64) -> Update {
        let first = self.update(state);
        if !(dt_secs.is_finite() && dt_secs > 0.0) {
            return first;
        }
        let parts = (dt_secs / LONGEST_STEP - 1e-9).ceil().clamp(1.0, 1e6);
        let dt = dt_secs / parts;
        for part in 0..parts as usize {
            let again;
            let here = if part == 0 {
                &first
            } else {
                again = self.update(state);
                &again
            };
            let middle = self.update(&self.moved(state, here, 0.5 * dt));
            *state = self.moved(state, &middle, dt);
        }
        first
    }

    fn moved(&self, state: &FlowState, by: &Update, secs: f64) -> FlowState {
        let pairs = state.pose.iter().zip(&by.velocity);
        let pose: Vec<f64> = pairs.map(|(x, v)| x + secs * v).collect();
        let phase = match self.settings.memory {
            Memory::Phase => self.on_curve(state.phase + secs * by.phase_rate),
            Memory::None => by.phase,
        };
        FlowState {
            pose,
            phase,
            parameters: match self.settings.memory {
                Memory::Phase => state.parameters.clone(),
                Memory::None => by.parameters.clone(),
            },
            pace: state.pace,
            advanced: state.advanced + secs * by.phase_rate,
        }
    }

    /// The states at `rate_hz` over the next `horizon_secs`, the one after the given first: the fold of [`Self::step`].
    ///
    /// # Errors
    /// When horizon or rate are not positive and finite, or would make more than a million states.
    ///
    /// # Panics
    /// When the state is of another body.
    pub fn predict(
        &self,
        state: &FlowState,
        horizon_secs: f64,
        rate_hz: f64,
    ) -> Result<Vec<FlowState>> {
        let count = (horizon_secs * rate_hz + 1e-9).floor();
        let positive = |v: f64| v.is_finite() && v > 0.0;
        if !(positive(horizon_secs) && positive(rate_hz) && count <= MOST_STATES) {
            return Err(Error::invalid(format!(
                "no prediction over {horizon_secs} s at {rate_hz} Hz"
            )));
        }
        let mut state = state.clone();
        let mut states = Vec::with_capacity(count as usize);
        for _ in 0..count as usize {
            self.step(&mut state, 1.0 / rate_hz);
            states.push(state.clone());
        }
        Ok(states)
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

/// From a posture to the manifold.
pub(super) struct Gap {
    /// The way there, without its part along the movement.
    pub normal: Vec<f64>,
    /// How far the posture is ahead along the movement, in phase.
    pub ahead: f64,
    pub distance_rad: f64,
}

impl Gap {
    pub fn between(field: &Flowfield, pose: &[f64], point: &Point) -> Self {
        let mut normal: Vec<f64> = point.pose.iter().zip(pose).map(|(m, x)| m - x).collect();
        let product = |a: &[f64], b: &[f64]| -> f64 {
            let pairs = a.iter().zip(b).zip(&field.weights);
            pairs.map(|((a, b), w)| w * a * b).sum()
        };
        // Where nothing moves, nothing is along the movement.
        const STILL: f64 = 1e-6;
        let along = product(&point.slope, &normal) / (product(&point.slope, &point.slope) + STILL);
        for (r, s) in normal.iter_mut().zip(&point.slope) {
            *r -= along * s;
        }
        let distance_rad = product(&normal, &normal).sqrt();
        Self {
            normal,
            ahead: -along,
            distance_rad,
        }
    }
}
