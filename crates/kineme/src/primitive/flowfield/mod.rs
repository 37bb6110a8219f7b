//! Flowfields: a primitive as a field of velocities over postures, which carries phase.
//!
//! The field is sampled (paper, section III-C): courses of the primitive at many parameters, each at many phases. At a
//! posture the nearest courses are blended into a local model of the manifold; its flow carries the posture on, its
//! distance draws the posture back. What is "near" counts the phase, so that a movement that comes back through the same
//! postures is followed out and back; the memoryless field of the paper, which stalls there, is [`Memory::None`].

mod approach;
mod entry;
mod field;
mod flow;
mod local;
mod memoryless;
mod samples;
mod scan;
mod settings;

pub use approach::Approach;
pub use field::Flowfield;
pub use flow::{FlowState, Update};
pub use settings::{FlowSettings, Memory, Metric};
