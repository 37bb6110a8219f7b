//! Floor 4: exemplars written by hand, as key postures and times.

mod perform;
mod script;
mod vocabulary;

pub use perform::perform;
pub use script::{Key, Script, ScriptAnimation, ScriptExemplar};
pub use vocabulary::PERFORMED_HZ;
