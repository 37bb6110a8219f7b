//! Floor 4: exemplars written by hand, as key postures and times.

mod script;

pub use script::{Key, Script, ScriptAnimation, ScriptExemplar};
