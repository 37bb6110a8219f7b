//! [`Manner`]: how a course is run.

use std::ops::RangeInclusive;

use super::entry::Entry;
use crate::error::{Error, Result};
use crate::primitive::Course;

/// What times its own pace a course may be run at.
pub(super) const SPEEDS: RangeInclusive<f64> = 0.01..=100.0;

/// How fast a course is run through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// At its own pace times this.
    Times(f64),
    /// So that everything, joining it included, takes so many seconds. A body that is too far away for that joins
    /// faster than [`super::Inertialization::max_speed`].
    Secs(f64),
}

/// How a course is run: where it is joined, how fast, how often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Manner {
    /// Where it is joined.
    pub entry: Entry,
    /// How fast.
    pub pace: Pace,
    /// How many cycles of a cyclic course, each from the phase where it was joined; `None`: on and on, or with
    /// [`Pace::Secs`] as many as fit best.
    pub cycles: Option<u32>,
}

impl Default for Manner {
    fn default() -> Self {
        Self {
            entry: Entry::Start,
            pace: Pace::Times(1.0),
            cycles: None,
        }
    }
}

impl Manner {
    pub(super) fn check(&self) -> Result<()> {
        self.entry.check()?;
        let (Pace::Times(pace) | Pace::Secs(pace)) = self.pace;
        if !(pace.is_finite() && pace > 0.0) {
            return Err(Error::invalid(format!(
                "the pace of a course must be positive, found {pace}"
            )));
        }
        if self.cycles == Some(0) {
            return Err(Error::invalid("no cycle at all is no movement"));
        }
        Ok(())
    }

    /// How many cycles are run, infinitely many when nobody said, and at how many times the course's own pace where
    /// there is nothing to join. A course that is no cycle counts as one.
    pub(super) fn cycles_and_speed(&self, course: &Course) -> (f64, f64) {
        let cycle = course.duration_secs();
        let cycles = match (course.is_cyclic(), self.cycles, self.pace) {
            (false, _, _) => 1.0,
            (true, Some(n), _) => f64::from(n),
            (true, None, Pace::Secs(secs)) => (secs / cycle).round().max(1.0),
            (true, None, Pace::Times(_)) => f64::INFINITY,
        };
        match self.pace {
            Pace::Times(speed) => (cycles, speed),
            Pace::Secs(secs) => (cycles, cycles * cycle / secs),
        }
    }
}
