//! Floor 5: moving a body along courses: entry from any posture, transitions without a jump, walking about.

mod clock;
mod entry;
mod manner;
mod offset;
mod state;
mod synthesis;
mod synthesizer;

pub use entry::Entry;
pub use manner::{Manner, Pace};
pub use offset::Inertialization;
pub use state::State;
pub use synthesis::{Synthesis, Synthesized};
pub use synthesizer::{Command, Synthesizer};
