//! Floor 3: the model: exemplars, primitives, the vocabulary.

mod exemplar;
mod vocabulary;

pub use exemplar::{Exemplar, Provenance};
pub use vocabulary::{Behavior, Primitive, Transitions, Vocabulary};
