//! [`Plan`]: which behaviours move a body when, and who gives way to whom; and what no plan may ask for.

use std::fmt;

use super::manner::SPEEDS;
use super::mask::Mask;
use crate::primitive::{Primitive, Vocabulary};

/// Rates at which a plan may be run, hertz.
const RATES: std::ops::RangeInclusive<f64> = 1.0..=10_000.0;
/// How far beyond the exemplars a parameter may lie, as a share of their range: as far as interpolation goes.
const BEYOND: f64 = 0.1;

/// What a body is to do, and by which rule behaviours share it.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Commands a second, 1 to 10,000.
    pub rate_hz: f64,
    /// How long it lasts.
    pub seconds: f64,
    /// Who gets a joint that several behaviours want.
    pub arbitration: Arbitration,
    /// What is watched: a motion file, or `-` for a stream of postures.
    pub observed: Option<String>,
    /// Behaviours that begin at their time.
    pub behaviors: Vec<Planned>,
    /// Behaviours that begin when something is recognised.
    pub rules: Vec<Rule>,
}

/// Who gets a joint that several behaviours want.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Arbitration {
    /// The one of highest priority; of equals the one that has it.
    #[default]
    Priority,
    /// One behaviour has the whole body: the one of greatest activation, which is its weight while it runs. Another one
    /// must exceed it by a margin for a while. Priority decides between equals when nobody has the body.
    Winner,
    /// All of those of the highest priority, by their weights.
    Superposition,
}

/// One behaviour of a plan: a primitive, and how it is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// The primitive's name.
    pub primitive: String,
    /// When it begins, seconds: of a rule after what it waits for.
    pub start_secs: f64,
    /// How often it is done; of a cyclic one how many cycles.
    pub repeat: u32,
    /// Names of parts (`left_arm right_arm trunk head left_leg right_leg`) or joints; none: the parts that the primitive
    /// moves.
    pub joints: Vec<String>,
    /// Where to.
    pub aim: Aiming,
    /// How fast, times its own pace: 0.01 to 100.
    pub pace: f64,
    /// Its weight among others, positive.
    pub weight: f64,
    /// Who goes first; the higher.
    pub priority: i32,
}

impl Planned {
    /// The primitive of this name at time 0, once, as it is.
    pub fn new(primitive: impl Into<String>) -> Self {
        Self {
            primitive: primitive.into(),
            start_secs: 0.0,
            repeat: 1,
            joints: Vec::new(),
            aim: Aiming::Middle,
            pace: 1.0,
            weight: 1.0,
            priority: 0,
        }
    }
}

/// Which of its movements a primitive makes.
#[derive(Debug, Clone, PartialEq)]
pub enum Aiming {
    /// The one at the middle of its exemplars' parameters.
    Middle,
    /// The one at these parameters, in their own units.
    Parameters(Vec<f64>),
    /// The one that brings an effector nearest to a point.
    Reach {
        /// The effector's name.
        effector: String,
        /// Metres in the thorax frame: forward, left, up.
        at: [f64; 3],
    },
}

/// A behaviour that answers what is recognised: once each time that it is newly recognised.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// The primitive that is recognised.
    pub when: String,
    /// What is done then.
    pub then: Planned,
}

/// Where in a plan something stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Place {
    /// The plan itself.
    Plan,
    /// A behaviour, by its index.
    Behavior(usize),
    /// A rule, by its index.
    Rule(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Plan => f.write_str("plan"),
            Place::Behavior(i) => write!(f, "behavior {}", i + 1),
            Place::Rule(i) => write!(f, "rule {}", i + 1),
        }
    }
}

/// What is wrong with a plan, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Where.
    pub place: Place,
    /// What was found and what would be right.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl std::error::Error for Fault {}

impl Plan {
    /// Refuses what cannot be done: unknown names, numbers out of range, joints that a primitive does not move. Whether
    /// a point can be reached is not asked; [`super::Ran::miss_m`] tells how far it was missed.
    ///
    /// `observable` is the vocabulary by which observed movement is recognised, `None` when nothing is observed: then a
    /// rule waits for ever, which is refused.
    ///
    /// # Errors
    /// The first fault, the plan's own before its behaviours' before its rules'.
    pub fn check(
        &self,
        vocabulary: &Vocabulary,
        observable: Option<&Vocabulary>,
    ) -> Result<(), Fault> {
        let fault = |place: Place| move |message: String| Fault { place, message };
        self.check_times().map_err(fault(Place::Plan))?;
        for (i, behavior) in self.behaviors.iter().enumerate() {
            let found = fault(Place::Behavior(i));
            behavior.check(vocabulary).map_err(found)?;
            if behavior.start_secs >= self.seconds {
                return Err(found(format!(
                    "it begins at {} s, but the plan ends at {} s",
                    behavior.start_secs, self.seconds
                )));
            }
        }
        for (i, rule) in self.rules.iter().enumerate() {
            let found = fault(Place::Rule(i));
            let Some(observable) = observable else {
                return Err(found(
                    "a rule waits for what is observed, but nothing is".into(),
                ));
            };
            let known = observable.primitive(&rule.when);
            known.map_err(|e| found(format!("when: {e}")))?;
            rule.then.check(vocabulary).map_err(found)?;
        }
        Ok(())
    }

    fn check_times(&self) -> Result<(), String> {
        if !RATES.contains(&self.rate_hz) {
            return Err(format!(
                "rate_hz lies in {} to {}, found {}",
                RATES.start(),
                RATES.end(),
                self.rate_hz
            ));
        }
        if !(self.seconds.is_finite() && self.seconds > 0.0) {
            return Err(format!("seconds must be positive, found {}", self.seconds));
        }
        Ok(())
    }

    /// Where its behaviours stand, those of rules last, as everything that goes through them in order has them.
    pub(super) fn planned(&self) -> impl Iterator<Item = (Place, &Planned)> {
        let own = self.behaviors.iter().enumerate();
        let rules = self.rules.iter().enumerate();
        own.map(|(i, b)| (Place::Behavior(i), b))
            .chain(rules.map(|(i, r)| (Place::Rule(i), &r.then)))
    }
}

impl Planned {
    fn check(&self, vocabulary: &Vocabulary) -> Result<(), String> {
        let primitive = vocabulary
            .primitive(&self.primitive)
            .map_err(|e| e.to_string())?;
        if !(self.start_secs.is_finite() && self.start_secs >= 0.0) {
            return Err(format!(
                "start must not be negative, found {}",
                self.start_secs
            ));
        }
        if self.repeat == 0 {
            return Err("repeat is at least 1, found 0".into());
        }
        if !SPEEDS.contains(&self.pace) {
            return Err(format!(
                "pace lies in {} to {}, found {}",
                SPEEDS.start(),
                SPEEDS.end(),
                self.pace
            ));
        }
        if !(self.weight.is_finite() && self.weight > 0.0) {
            return Err(format!("weight must be positive, found {}", self.weight));
        }
        Mask::of(primitive, &self.joints).map_err(|e| e.to_string())?;
        self.aim.check(primitive)
    }
}

impl Aiming {
    pub(super) fn check(&self, primitive: &Primitive) -> Result<(), String> {
        match self {
            Aiming::Middle => Ok(()),
            Aiming::Parameters(values) => {
                let space = primitive.parameters();
                let places = space.to_unit(values).map_err(|e| e.to_string())?;
                for (axis, (value, place)) in space.axes().iter().zip(values.iter().zip(&places)) {
                    if !(-BEYOND..=1.0 + BEYOND).contains(place) {
                        return Err(format!(
                            "parameter `{}` of `{}` lies in {} to {}, found {value}",
                            axis.name,
                            primitive.name(),
                            axis.low,
                            axis.high
                        ));
                    }
                }
                Ok(())
            }
            Aiming::Reach { effector, at } => {
                let body = primitive.body();
                body.effector(effector).map_err(|e| e.to_string())?;
                if at.iter().any(|v| !v.is_finite()) {
                    return Err(format!("a point to reach is finite, found {at:?}"));
                }
                Ok(())
            }
        }
    }
}
