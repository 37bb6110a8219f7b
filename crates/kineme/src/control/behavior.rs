//! [`Behavior`]: a module around one primitive, which generates its joints' trajectories (Figure 3).

use std::sync::Arc;

use nalgebra::Vector3;

use super::entry::Entry;
use super::manner::{Manner, Pace};
use super::mask::Mask;
use super::plan::{Aiming, Place, Planned};
use super::state::Moving;
use super::synthesizer::Synthesizer;
use crate::error::Result;
use crate::primitive::{Course, Primitive};

/// The latest phase at which an interrupted movement is gone on with.
const LATEST: f64 = 0.9;
/// Where a behaviour that is told to begin again while it runs joins its movement at the latest.
const AGAIN: f64 = 0.5;

/// What a behaviour is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Status {
    /// Nothing: its time has not come, or is over.
    Idle,
    /// It has yet to get a joint.
    Waiting,
    /// It moves joints, or would if it were heard.
    Running,
    /// It has lost all its joints, and goes on when it gets one.
    Paused,
}

/// One of a primitive's movements.
#[derive(Debug, Clone)]
pub(super) struct Aimed {
    pub course: Arc<Course>,
    /// How far from its target the effector stays, metres.
    pub miss_m: Option<f64>,
}

impl Aimed {
    pub fn of(primitive: &Primitive, aim: &Aiming) -> Result<Self> {
        let (parameters, miss_m) = match aim {
            Aiming::Middle => (primitive.middle(), None),
            Aiming::Parameters(values) => (primitive.parameters().to_unit(values)?, None),
            Aiming::Reach { effector, at } => {
                let reached = primitive.aim(effector)?.at(&Vector3::from(*at));
                (reached.parameters, Some(reached.miss_m))
            }
        };
        Ok(Self {
            course: Arc::new(primitive.at(&parameters)?),
            miss_m,
        })
    }
}

/// A behaviour of a plan, as it runs.
#[derive(Debug, Clone)]
pub(super) struct Behavior {
    pub place: Place,
    /// The primitive's number.
    pub primitive: usize,
    pub mask: Mask,
    pub priority: i32,
    pub weight: f64,
    pub aimed: Aimed,
    pub status: Status,
    /// How many had begun when it began.
    pub order: u64,
    /// The tick at which it is to begin.
    pub due: Option<u64>,
    /// How many ticks it waits when a rule calls it.
    pub delay: u64,
    /// Until this tick it is suppressed.
    pub suppressed: u64,
    /// The share of its pace at which it goes.
    pub speed: f64,
    /// Where what it does is written down.
    pub run: usize,
    repeat: u32,
    pace: f64,
    left: u32,
    flow: Synthesizer,
}

impl Behavior {
    pub fn new(
        place: Place,
        planned: &Planned,
        (number, primitive): (usize, &Primitive),
        mut flow: Synthesizer,
    ) -> Result<Self> {
        let body = primitive.body();
        let mask = Mask::of(primitive, &planned.joints)?;
        let mut joins = vec![false; body.dof() + 1];
        for (j, _) in mask.joints.iter().enumerate().filter(|(_, held)| **held) {
            joins[body.coordinates(j)].fill(true);
        }
        joins[body.dof()] = mask.root;
        flow.joins(joins);
        Ok(Self {
            place,
            primitive: number,
            mask,
            priority: planned.priority,
            weight: planned.weight,
            aimed: Aimed::of(primitive, &planned.aim)?,
            status: Status::Idle,
            order: 0,
            due: None,
            delay: 0,
            suppressed: 0,
            speed: 1.0,
            run: 0,
            repeat: planned.repeat,
            pace: planned.pace,
            left: planned.repeat,
            flow,
        })
    }

    /// Where it would have the body.
    pub fn now(&self) -> &Moving {
        self.flow.now()
    }

    /// The same with the height's whole velocity, which costs more.
    pub fn now_whole(&self) -> Moving {
        self.flow.now_whole()
    }

    /// The phase of its movement.
    pub fn phase(&self) -> f64 {
        self.flow.command().phase
    }

    /// The posture that it came to when it ended, the height last.
    pub fn held(&self) -> Option<&[f64]> {
        self.flow.held()
    }

    /// Told to begin: it wants its joints, from the first movement on.
    pub fn called(&mut self, order: u64) {
        self.left = self.repeat;
        match self.status {
            Status::Running => self.join(AGAIN, self.flow.now_whole()),
            Status::Paused => {}
            Status::Idle | Status::Waiting => {
                self.status = Status::Waiting;
                self.order = order;
            }
        }
    }

    /// Begins, or goes on, from where the body is.
    pub fn begin(&mut self, now: Moving) {
        let latest = match self.status {
            Status::Paused => self.phase(),
            _ => 0.0,
        };
        self.join(latest, now);
        self.status = Status::Running;
    }

    /// Loses its joints.
    pub fn pause(&mut self) {
        if self.aimed.course.is_cyclic() {
            let cycle = self.aimed.course.duration_secs() / self.pace;
            let cycles = (self.flow.remaining_secs() / cycle).ceil().max(1.0);
            self.left = self.left.min(cycles as u32);
        }
        self.status = Status::Paused;
    }

    /// Makes another of its movements from now on.
    pub fn aim(&mut self, aimed: Aimed) {
        self.aimed = aimed;
        if self.status == Status::Running {
            self.join(self.phase(), self.flow.now_whole());
        }
    }

    /// A tick on. True when it has come to its end.
    pub fn advance(&mut self) -> bool {
        self.flow.advance(self.speed);
        if !self.flow.command().finished {
            return false;
        }
        self.left -= if self.aimed.course.is_cyclic() {
            self.left
        } else {
            1
        };
        if self.left > 0 {
            self.join(0.0, self.flow.now_whole());
            return false;
        }
        self.status = Status::Idle;
        true
    }

    /// Joins its movement from a posture, not later than at a phase; a cycle anywhere.
    fn join(&mut self, latest: f64, now: Moving) {
        let cyclic = self.aimed.course.is_cyclic();
        let manner = Manner {
            entry: if cyclic || latest > 0.0 {
                Entry::Matched {
                    latest: latest.clamp(0.0, LATEST),
                }
            } else {
                Entry::Start
            },
            pace: Pace::Times(self.pace),
            cycles: cyclic.then_some(self.left),
        };
        self.speed = 1.0;
        self.flow.place(now);
        let begun = self.flow.start(Arc::clone(&self.aimed.course), &manner);
        begun.expect("the plan was checked against this vocabulary");
    }
}
