//! [`Entry`]: at which phase a body joins a course.

use super::state::Moving;
use crate::error::{Error, Result};
use crate::primitive::Course;

/// Phases at which a course is compared with the body.
const PLACES: usize = 64;
/// Seconds by which a difference in velocity counts as much as one in posture.
const VELOCITY_SECS: f64 = 0.15;
/// Golden-section steps: a hundredth of a hundredth of the distance between places.
const STEPS: usize = 20;

/// At which phase a body joins a course.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Entry {
    /// At its beginning, phase 0.
    #[default]
    Start,
    /// Where posture and velocity of the course come nearest the body's, so that a wave that begins in mid-swing is
    /// joined in mid-swing: at any phase of a cyclic course, else at most at phase `latest` in [0, 0.9].
    Matched {
        /// The latest phase.
        latest: f64,
    },
}

impl Entry {
    /// Where posture and velocity match in the first half of the course.
    pub const MATCHED: Entry = Entry::Matched { latest: 0.5 };

    pub(super) fn check(&self) -> Result<()> {
        match self {
            Entry::Matched { latest } if !(0.0..=0.9).contains(latest) => Err(Error::invalid(
                format!("the latest phase to join a course lies in [0, 0.9], found {latest}"),
            )),
            _ => Ok(()),
        }
    }

    /// The phase at which a body that moves so joins the course, run through at its own pace times `speed`;
    /// coordinates that do not join it do not count.
    pub(super) fn phase(
        &self,
        course: &Course,
        now: &Moving,
        speed: f64,
        joining: Option<&[bool]>,
    ) -> f64 {
        let Entry::Matched { latest } = *self else {
            return 0.0;
        };
        let latest = if course.is_cyclic() { 1.0 } else { latest };
        let joints = now.values.len() - 1;
        let cost = |phase: f64| -> f64 {
            let mut goal = Moving::along(&course.sample(phase), speed);
            if let Some(joining) = joining {
                goal.elsewhere_as(now, Some(joining));
            }
            let apart = |a: &[f64], b: &[f64]| -> f64 {
                let pairs = a[..joints].iter().zip(&b[..joints]);
                pairs.map(|(x, y)| (x - y) * (x - y)).sum()
            };
            apart(&now.values, &goal.values)
                + VELOCITY_SECS * VELOCITY_SECS * apart(&now.velocities, &goal.velocities)
        };
        let place = |k: usize| latest * k as f64 / PLACES as f64;
        let (mut best, mut least) = (0, cost(0.0));
        for k in 1..=PLACES {
            let found = cost(place(k));
            if found < least {
                (best, least) = (k, found);
            }
        }
        let one = place(1);
        let (mut low, mut high) = (place(best) - one, place(best) + one);
        if !course.is_cyclic() {
            (low, high) = (low.max(0.0), high.min(latest));
        }
        let share = 0.5 * (5.0_f64.sqrt() - 1.0);
        for _ in 0..STEPS {
            let (a, b) = (high - share * (high - low), low + share * (high - low));
            if cost(a) <= cost(b) {
                high = b;
            } else {
                low = a;
            }
        }
        let between = 0.5 * (low + high);
        // What is met exactly stays exact.
        let phase = if cost(between) < least {
            between
        } else {
            place(best)
        };
        if course.is_cyclic() {
            phase.rem_euclid(1.0)
        } else {
            phase
        }
    }
}
