//! [`Connection`]: what one behaviour does to another; [`Percept`]: what was recognised.

use super::behavior::{Aimed, Behavior};
use super::plan::{Aiming, Place};
use crate::error::{Error, Result};
use crate::primitive::Vocabulary;

/// What was just recognised, as a recogniser tells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Percept {
    /// The primitive, by its place in the vocabulary that recognises; `None` when nothing is recognised.
    pub primitive: Option<usize>,
}

/// A wire between two behaviours of a plan: what happens to one when the other runs (Figure 3; the wires are those of
/// the subsumption architecture, Brooks 1986).
#[derive(Debug, Clone, PartialEq)]
pub struct Connection {
    /// The behaviour that acts: not [`Place::Plan`].
    pub from: Place,
    /// The behaviour that it acts on, another one.
    pub to: Place,
    /// What it does.
    pub effect: Effect,
}

/// What a behaviour does to another.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// While it runs the other's output is not heard. The other runs on; one that has not begun waits.
    Inhibit,
    /// For so many seconds from its beginning the other stands still; then it goes on where it was.
    Suppress {
        /// The seconds.
        secs: f64,
    },
    /// When it has come to its end the other begins, again if need be.
    Select,
    /// When it begins, the other makes this of its movements from then on; if it runs, at the phase where it is.
    Aim(Aiming),
}

/// An [`Effect`] made ready.
#[derive(Debug, Clone)]
pub(super) enum Wire {
    Inhibit,
    Suppress(u64),
    Select,
    Aim(Aimed),
}

impl Wire {
    /// A connection between behaviours of the plan, what it aims at made ready.
    pub fn of(
        connection: &Connection,
        vocabulary: &Vocabulary,
        behaviors: &[Behavior],
        ticks: &impl Fn(f64) -> u64,
    ) -> Result<(usize, usize, Wire)> {
        let number = |place: Place| {
            let found = behaviors.iter().position(|b| b.place == place);
            found.ok_or_else(|| {
                Error::invalid(format!(
                    "a connection of {place}, which is no behavior of the plan"
                ))
            })
        };
        let (from, to) = (number(connection.from)?, number(connection.to)?);
        if from == to {
            return Err(Error::invalid(format!(
                "{} is connected to itself",
                connection.from
            )));
        }
        let wire = match &connection.effect {
            Effect::Inhibit => Wire::Inhibit,
            Effect::Select => Wire::Select,
            Effect::Suppress { secs } if secs.is_finite() && *secs >= 0.0 => {
                Wire::Suppress(ticks(*secs))
            }
            Effect::Suppress { secs } => {
                return Err(Error::invalid(format!(
                    "suppression must not be negative, found {secs} s"
                )));
            }
            Effect::Aim(aim) => {
                let primitive = &vocabulary.primitives()[behaviors[to].primitive];
                aim.check(primitive).map_err(Error::invalid)?;
                Wire::Aim(Aimed::of(primitive, aim)?)
            }
        };
        Ok((from, to, wire))
    }
}
