//! [`Synthesis`]: a whole motion of a course, the fold of a synthesizer's steps.

use std::sync::Arc;

use super::manner::{Manner, Pace};
use super::offset::Inertialization;
use super::state::State;
use super::synthesizer::Synthesizer;
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::primitive::Course;

/// Steps that a motion may have: some hours at the rate of any camera.
const MOST_STEPS: f64 = 1e6;

/// How a motion is made of a course.
#[derive(Debug, Clone, PartialEq)]
pub struct Synthesis {
    /// Frames a second.
    pub rate_hz: f64,
    /// Where the body begins; `None`: on the course, over the origin and facing forward, so that nothing is to be joined.
    pub from: Option<State>,
    /// How the course is run. A cyclic one is run once where `manner` does not say how often or how long.
    pub manner: Manner,
    /// How the body joins it.
    pub settings: Inertialization,
}

impl Default for Synthesis {
    fn default() -> Self {
        Self {
            rate_hz: 120.0,
            from: None,
            manner: Manner::default(),
            settings: Inertialization::default(),
        }
    }
}

/// A motion that was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Synthesized {
    /// The motion.
    pub motion: Motion,
    /// In how many of its frames joint limits hold a coordinate back.
    pub limited_frames: usize,
}

impl Synthesis {
    /// The motion of a course: exactly the commands of a [`Synthesizer`], from the first to the one that is finished. When
    /// the end falls between two frames the last frame is the one after it.
    ///
    /// # Errors
    /// As [`Synthesizer::new`] and [`Synthesizer::start`]; when the motion would have more than a million frames.
    pub fn motion(&self, name: &str, course: &Arc<Course>) -> Result<Synthesized> {
        self.manner.check()?;
        let mut manner = self.manner;
        if matches!(manner.pace, Pace::Times(_)) {
            manner.cycles = manner.cycles.or(Some(1));
        }
        let body = Arc::clone(course.body());
        let own;
        let from = match &self.from {
            Some(from) => from,
            None => {
                own = State::on_course(course, 0.0, manner.cycles_and_speed(course).1);
                &own
            }
        };
        let mut synthesizer =
            Synthesizer::new(Arc::clone(&body), self.rate_hz, from, self.settings)?;
        synthesizer.start(Arc::clone(course), &manner)?;
        let steps = synthesizer.remaining_secs() * self.rate_hz;
        if steps > MOST_STEPS {
            return Err(Error::invalid(format!(
                "`{name}` would have {steps:.0} frames at {} Hz, more than {MOST_STEPS:.0}",
                self.rate_hz
            )));
        }
        let first = synthesizer.command();
        let (mut poses, mut roots) = (first.pose.clone(), vec![first.root]);
        let mut limited_frames = usize::from(first.limited > 0);
        while !synthesizer.command().finished {
            let command = synthesizer.step();
            poses.extend_from_slice(&command.pose);
            roots.push(command.root);
            limited_frames += usize::from(command.limited > 0);
        }
        Ok(Synthesized {
            motion: Motion::new(name, body, self.rate_hz, poses, roots)?,
            limited_frames,
        })
    }
}
