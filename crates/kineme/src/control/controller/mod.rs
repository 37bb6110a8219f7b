//! [`Controller`]: behaviours, what they do to one another, and the arbitrator that makes one command of them (Figure 3).

mod flow;
mod hands;

use std::sync::Arc;

use super::arbiter::{Arbiter, Shares};
use super::behavior::{Behavior, Status};
use super::command::Command;
use super::connection::{Connection, Percept, Wire};
use super::feedback::{Feedback, Yielding};
use super::offset::Inertialization;
use super::plan::{Place, Plan};
use super::robot::Sensed;
use super::state::{Moving, State};
use super::synthesizer::{Synthesizer, parts};
use super::transition::Transitions;
use crate::error::{Error, Result};
use crate::primitive::Vocabulary;
use crate::skeleton::Skeleton;

/// Rounding of times that is no time, in ticks.
const NO_TICK: f64 = 1e-6;

/// How a plan is run.
///
/// No command jumps: pose and velocity are continuous. A joint's acceleration is at most the greatest of the flows that
/// share it (each the course's own at its pace, and what joining it adds), what changing hands adds, and what feedback
/// adds: with the defaults twice `31 + 9.9 v` rad/s^2, v being the difference in velocity that is to be overcome, and
/// with a body that is pushed about 28 more ([`Inertialization`], [`Feedback`]).
#[derive(Debug, Clone, PartialEq)]
pub struct ControlSettings {
    /// How behaviours join their movements, and joints change hands.
    pub inertialization: Inertialization,
    /// What a body that is not where it was told to be does to the flow.
    pub feedback: Feedback,
    /// By how much activation must exceed the winner's ...
    pub winning_margin: f64,
    /// ... for how long, seconds, before the body changes hands ([`super::Arbitration::Winner`]).
    pub winning_secs: f64,
    /// Joints that nobody wants hold their posture; after so many seconds they go back to the posture that the body
    /// began with. `None`: they hold it on and on.
    pub rest_secs: Option<f64>,
    /// What behaviours do to one another.
    pub connections: Vec<Connection>,
}

impl Default for ControlSettings {
    fn default() -> Self {
        Self {
            inertialization: Inertialization::default(),
            feedback: Feedback::default(),
            winning_margin: 0.1,
            winning_secs: 0.1,
            rest_secs: None,
            connections: Vec::new(),
        }
    }
}

/// A stretch of time in which a behaviour ran; one that was interrupted has several.
#[derive(Debug, Clone, PartialEq)]
pub struct Ran {
    /// When it began or went on, seconds.
    pub start_secs: f64,
    /// When it ended or was interrupted, seconds; of one that runs, now.
    pub end_secs: f64,
    /// The primitive's name.
    pub primitive: String,
    /// The parts and joints that it wants.
    pub joints: Vec<String>,
    /// Where it stands in the plan.
    pub planned: Place,
    /// Whether it has come to its end.
    pub completed: bool,
    /// How far from its target the effector stays at best, metres; `None` without a target.
    pub miss_m: Option<f64>,
}

/// A behaviour that is under way.
#[derive(Debug, Clone, PartialEq)]
pub struct Active<'v> {
    /// Where it stands in the plan.
    pub planned: Place,
    /// The primitive's name.
    pub primitive: &'v str,
    /// The phase of its movement, in [0, 1].
    pub phase: f64,
    /// Its mean share in the joints that it wants, in [0, 1]; 0 while it waits or is not heard.
    pub weight: f64,
}

/// Runs a plan: at each tick the behaviours' flows go on, the arbitrator makes one command of them.
///
/// It works in the coordinates of the vocabulary's body, and computes the same for the same calls.
#[derive(Debug, Clone)]
pub struct Controller<'v> {
    vocabulary: &'v Vocabulary,
    settings: ControlSettings,
    rate_hz: f64,
    tick: u64,
    last: u64,
    /// Those of rules behind those of the plan.
    behaviors: Vec<Behavior>,
    /// What rules wait for, by primitive of the vocabulary that recognises.
    whens: Vec<usize>,
    recognised: Option<usize>,
    wires: Vec<(usize, usize, Wire)>,
    arbiter: Arbiter,
    contending: Vec<bool>,
    /// Who moves each joint and, last, the root.
    shares: Vec<Shares>,
    begun: u64,
    /// What is held where nobody moves, since when, and the posture of the beginning.
    held: Vec<f64>,
    free_since: Vec<Option<u64>>,
    rest: Vec<f64>,
    transitions: Transitions,
    yielding: Yielding,
    /// Where the flows would have the body: before feedback and joint limits.
    now: Moving,
    measured: Vec<f64>,
    command: Command,
    ran: Vec<Ran>,
}

impl<'v> Controller<'v> {
    /// Everything made ready for a plan (courses, reaches): ticks only follow it. What is observed is recognised by the
    /// same vocabulary.
    ///
    /// # Errors
    /// When the plan does not pass [`Plan::check`], the state is of another body, a setting is out of range, or a
    /// connection is of behaviours that the plan has not.
    pub fn new(
        vocabulary: &'v Vocabulary,
        plan: &Plan,
        start: &State,
        settings: &ControlSettings,
    ) -> Result<Self> {
        Self::observing(vocabulary, vocabulary, plan, start, settings)
    }

    /// The same where another vocabulary recognises what is observed.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn observing(
        vocabulary: &'v Vocabulary,
        observable: &Vocabulary,
        plan: &Plan,
        start: &State,
        settings: &ControlSettings,
    ) -> Result<Self> {
        plan.check(vocabulary, Some(observable))
            .map_err(|fault| Error::invalid(fault.to_string()))?;
        settings.feedback.check()?;
        let rate_hz = plan.rate_hz;
        let ticks = |secs: f64| (secs * rate_hz - NO_TICK).ceil().max(0.0) as u64;
        for (name, secs) in [
            ("winning_secs", settings.winning_secs),
            ("winning_margin", settings.winning_margin),
            ("rest_secs", settings.rest_secs.unwrap_or(0.0)),
        ] {
            if !(secs.is_finite() && secs >= 0.0) {
                return Err(Error::invalid(format!(
                    "{name} must not be negative, found {secs}"
                )));
            }
        }
        let body = vocabulary.body();
        let still = Synthesizer::new(Arc::clone(body), rate_hz, start, settings.inertialization)?;
        let primitive = |name: &str| -> Result<usize> {
            let primitives = vocabulary.primitives().iter();
            let mut numbered = primitives.enumerate().filter(|(_, p)| p.name() == name);
            let found = numbered.next().map(|(i, _)| i);
            found.map_or_else(|| vocabulary.primitive(name).map(|_| 0), Ok)
        };
        let mut behaviors = Vec::new();
        for (place, planned) in plan.planned() {
            let number = primitive(&planned.primitive)?;
            let own = &vocabulary.primitives()[number];
            let mut behavior = Behavior::new(place, planned, (number, own), still.clone())?;
            behavior.delay = ticks(planned.start_secs);
            if matches!(place, Place::Behavior(_)) {
                behavior.due = Some(behavior.delay);
            }
            behaviors.push(behavior);
        }
        let recognised = observable.primitives();
        let whens = plan.rules.iter().flat_map(|rule| {
            let named = |p: &crate::primitive::Primitive| p.name() == rule.when;
            recognised.iter().position(named)
        });
        let whens = whens.collect();
        let wires = settings
            .connections
            .iter()
            .map(|connection| Wire::of(connection, vocabulary, &behaviors, &ticks))
            .collect::<Result<_>>()?;
        let joints = body.joints().len();
        let now = still.now().clone();
        let root = body.dof();
        let mut transitions = Transitions::new(parts(body), root, settings.inertialization);
        let rest = Moving::still(now.values.clone());
        transitions.begin(&vec![true; root + 1], &now, &rest, 0);
        Ok(Self {
            vocabulary,
            settings: settings.clone(),
            rate_hz,
            tick: 0,
            last: ticks(plan.seconds),
            contending: vec![false; behaviors.len()],
            behaviors,
            whens,
            recognised: None,
            wires,
            arbiter: Arbiter::new(
                plan.arbitration,
                settings.winning_margin,
                ticks(settings.winning_secs),
            ),
            shares: vec![Shares::new(); joints + 1],
            begun: 0,
            held: rest.values.clone(),
            free_since: vec![Some(0); joints + 1],
            rest: rest.values,
            transitions,
            yielding: Yielding::new(settings.feedback, rate_hz, root),
            now,
            measured: Vec::with_capacity(root),
            command: still.command().clone(),
            ran: Vec::new(),
        })
    }

    /// The body that it moves.
    pub fn body(&self) -> &Arc<Skeleton> {
        self.vocabulary.body()
    }

    /// Ticks a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Seconds since the beginning, to which [`Self::command`] belongs.
    pub fn secs(&self) -> f64 {
        self.tick as f64 / self.rate_hz
    }

    /// What the body is to do now: the answer of the last tick. Its phase is that of the behaviour that moves most
    /// joints; it is finished when no behaviour is under way.
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// Whether the plan's time is over.
    pub fn finished(&self) -> bool {
        self.tick >= self.last
    }

    /// The behaviours that are under way, in the order of the plan.
    pub fn active(&self) -> Vec<Active<'v>> {
        let under_way = self.behaviors.iter().enumerate();
        let under_way = under_way.filter(|(_, b)| b.status != Status::Idle);
        let active = under_way.map(|(i, b)| Active {
            planned: b.place,
            primitive: self.vocabulary.primitives()[b.primitive].name(),
            phase: b.phase(),
            weight: self.weight(i) / b.mask.joints.iter().filter(|held| **held).count() as f64,
        });
        active.collect()
    }

    /// What has run and what runs, in the order of beginnings.
    pub fn ran(&self) -> &[Ran] {
        &self.ran
    }

    /// One tick: what the body felt of itself now (`None`: it is where it was told to be) and what was newly seen
    /// (`None`: nothing new) become what it is to do at the next tick. What was felt counts only if it is of this body
    /// and finite.
    pub fn tick(&mut self, sensed: Option<&Sensed>, percept: Option<&Percept>) -> &Command {
        if let Some(percept) = percept {
            self.listen(percept);
        }
        self.arbitrate();
        self.feel(sensed);
        self.advance();
        &self.command
    }
}
