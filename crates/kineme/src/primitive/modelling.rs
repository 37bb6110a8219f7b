//! [`Modelling`]: how exemplars become a primitive; [`Fit`]: the numbers that come of it.

use super::space::ParameterSpace;
use crate::alignment::{Registration, Trim, Warp};
use crate::interpolation::Method;

/// What the parameters of a primitive are.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Parameterisation {
    /// The exemplars' adverbs where they have some, else [`Parameterisation::Principal`].
    #[default]
    Automatic,
    /// Principal coordinates of the registered exemplars, at most three: as many as leave-one-out asks for.
    Principal,
    /// The place of this effector at its extreme.
    Effector(String),
}

/// How exemplars are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// Verbs and Adverbs, exact, where leave-one-out finds nothing better: else with a nugget, or Shepard.
    #[default]
    Automatic,
    /// Verbs and Adverbs (Rose, Cohen and Bodenheimer 1998), exact.
    VerbsAndAdverbs,
    /// Inverse distances (Shepard 1968).
    Shepard,
}

/// What becomes of an exemplar of another structure than the others: their mirror image, the opposite foot first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mismatched {
    /// An error that names it: somebody labelled it so.
    #[default]
    Refuse,
    /// It is left out, and a note names it: nobody chose it.
    LeaveOut,
}

/// How exemplars become a primitive.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Modelling {
    /// What the parameters are.
    pub parameterisation: Parameterisation,
    /// Names of the adverbs; `p1`, `p2`, ... where there are none.
    pub adverbs: Vec<String>,
    /// How exemplars are weighted.
    pub interpolation: Interpolation,
    /// Whether the movement is a cycle, such as walking; `None`: what most exemplars are.
    pub cyclic: Option<bool>,
    /// What becomes of exemplars that are of another structure.
    pub mismatched: Mismatched,
    /// How exemplars are registered to phase.
    pub registration: Registration,
    /// How rests at both ends are found.
    pub trim: Trim,
}

/// The part of an exemplar that the primitive uses, in frames that need not be whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Used {
    /// First frame.
    pub start: f64,
    /// Last frame, after the first.
    pub end: f64,
    /// Where in that part phase 0 is, as a share of it, in [0, 1): 0 but for cycles read round their end.
    pub shift: f64,
}

impl Used {
    /// The share of the part, in [0, 1], at a place: the place itself but for cycles read round their end.
    pub fn share(&self, place: f64) -> f64 {
        let share = place + self.shift;
        if share > 1.0 { share - 1.0 } else { share }
    }

    /// The frame at a place in [0, 1].
    pub fn frame(&self, place: f64) -> f64 {
        self.start + (self.end - self.start) * self.share(place)
    }
}

/// An interpolator that was tried: each exemplar predicted from the others.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The interpolator.
    pub method: Method,
    /// How many parameters it had.
    pub dims: usize,
    /// Root mean square distance of a landmark from its true place, metres, the mean over exemplars.
    pub error_m: f64,
}

/// How well exemplars are predicted from the others, by the interpolator chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeaveOneOut {
    /// Root mean square angle between joint rotations, radians, the mean over exemplars.
    pub joint_rad: f64,
    /// Root mean square distance of the wrists, metres, the mean over exemplars.
    pub wrist_m: f64,
    /// Landmark error of the exemplar nearest in parameters, metres.
    pub nearest_m: f64,
    /// Landmark error of the mean of the others, metres.
    pub mean_m: f64,
}

/// Everything that was fitted, as plain numbers: with the exemplars it is the primitive.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Whether phase wraps.
    pub cyclic: bool,
    /// The part of each exemplar that is used.
    pub used: Vec<Used>,
    /// Phase to place in that part, for each exemplar.
    pub warps: Vec<Warp>,
    /// Registered mean landmarks ([`crate::motion::landmark_dims`] numbers at each of the warps' knots), metres: what
    /// further exemplars are registered to.
    pub reference: Vec<f64>,
    /// Knots of the curves over phase, at least two.
    pub knots: usize,
    /// What the parameters mean.
    pub space: ParameterSpace,
    /// The parameters of each exemplar, row-major, exemplars x parameters, in [0, 1].
    pub points: Vec<f64>,
    /// The interpolator.
    pub method: Method,
    /// What was tried, the chosen one first.
    pub trials: Vec<Trial>,
    /// The error of the chosen one; `None` with a single exemplar.
    pub error: Option<LeaveOneOut>,
    /// What a user should know: degenerate cases and what was done.
    pub notes: Vec<String>,
}
