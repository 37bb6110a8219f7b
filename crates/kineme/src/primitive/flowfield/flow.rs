//! Following the field: where it goes from a posture, step by step and over a horizon.

use super::field::Flowfield;
use super::local::Place;
use super::samples::Prior;
use super::settings::Memory;
use crate::error::{Error, Result};
use crate::primitive::course::{Sample, Travel};

/// The phase at which a movement that is no cycle has come to its end.
pub(super) const END: f64 = 0.98;
/// How fast phase and posture settle at the end at most, as a share of what is left, 1/s.
const SETTLING_RATE: f64 = 25.0;
/// How fast the phase goes to where the posture is, 1/s.
const PHASE_GAIN: f64 = 4.0;
/// Bounds of the phase's rate, as multiples of the field's own: it never stands, so that every movement ends.
const PHASE_RATES: [f64; 2] = [0.5, 2.0];
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
    pub(super) fn near(&self, pose: &[f64], phase: f64, parameters: &[f64]) -> Place {
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
    pub fn between(field: &Flowfield, pose: &[f64], point: &Sample) -> Self {
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
