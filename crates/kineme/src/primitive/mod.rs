//! Floor 3: the model: exemplars, primitives f(p, τ), the vocabulary.

mod aim;
mod calibration;
mod course;
mod curve;
mod exemplar;
mod fitting;
mod flowfield;
mod judge;
mod model;
mod modelling;
mod moved;
mod parametrising;
mod recognition;
mod registered;
mod selection;
mod space;
mod structure;
mod vocabulary;

pub use aim::{Aim, Reached};
pub use calibration::Calibration;
pub use course::{Course, Sample, Travel};
pub use exemplar::{Exemplar, Provenance};
pub use fitting::SHAPE_PHASES;
pub use flowfield::{Approach, FlowSettings, FlowState, Flowfield, Memory, Metric, Update};
pub use model::{Group, Primitive};
pub use modelling::{
    Fit, Interpolation, LeaveOneOut, Mismatched, Modelling, Parameterisation, Trial, Used,
};
pub(crate) use moved::MOVES_RAD;
pub use moved::Moved;
pub use recognition::{
    Listener, Observation, Observations, Place, Posterior, Reading, Recogniser, Recognition, Span,
    readings,
};
pub use space::{ParameterAxis, ParameterSource, ParameterSpace};
pub use vocabulary::{Behavior, Transitions, Vocabulary};
