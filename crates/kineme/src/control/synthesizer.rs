//! [`Synthesizer`]: moves a body along courses, step by step.

use std::sync::Arc;

use super::clock::Clock;
use super::command::Command;
use super::manner::{Manner, Pace, SPEEDS};
use super::offset::{Inertialization, Offset};
use super::state::{Moving, State, rise};
use crate::error::{Error, Result};
use crate::primitive::Course;
use crate::skeleton::Skeleton;

/// How near its end (seconds) a course is at its end: less than any rounding of times matters, more than it makes.
const AT_END_SECS: f64 = 1e-9;

/// What a body follows.
#[derive(Debug, Clone)]
enum Target {
    /// Coordinates and height that are held.
    Posture(Vec<f64>),
    Course {
        course: Arc<Course>,
        /// Seconds from phase 0 at which it was joined, at its own pace.
        from_secs: f64,
        /// Factor on its own pace.
        speed: f64,
        clock: Clock,
    },
}

/// Moves a body along courses at a fixed rate: position and velocity are continuous whatever is begun at whatever moment.
///
/// It knows where the body is, how it moves and what it follows; each [`Self::step`] is one tick of the rate. The
/// difference between the body and a course decays as [`Inertialization`] says; the end of a course is held, and what
/// velocity the course ends with decays in the same way. Joint limits are kept by what is emitted, not by what is
/// followed: they are smooth, so that they spoil no continuity.
#[derive(Debug, Clone)]
pub struct Synthesizer {
    body: Arc<Skeleton>,
    rate_hz: f64,
    settings: Inertialization,
    /// Coordinates of each joint of each part of the body, for the speed of joining.
    parts: Vec<Vec<Vec<usize>>>,
    /// Which coordinates, and the root last, join a course; the others are taken to be on it.
    joining: Option<Vec<bool>>,
    target: Target,
    offset: Offset,
    /// Steps since the target was set, and what the time since then is more than these.
    steps: u64,
    late_secs: f64,
    /// How fast its time went at the last step, as a share of the clock's.
    flow: f64,
    /// Before joint limits; the height's velocity without that of what is followed, which is costly and seldom needed.
    now: Moving,
    command: Command,
}

impl Synthesizer {
    /// A body in a state, to be moved at so many steps a second; it holds its posture until a course is begun.
    ///
    /// # Errors
    /// When the state is of another body or not finite, when the rate or a setting is not positive.
    pub fn new(
        body: Arc<Skeleton>,
        rate_hz: f64,
        state: &State,
        settings: Inertialization,
    ) -> Result<Self> {
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Error::invalid(format!(
                "a rate must be positive, found {rate_hz} Hz"
            )));
        }
        settings.check()?;
        state.check(&body)?;
        let mut now = Moving::of(state);
        now.named_within_limits(&body);
        let target = Moving::still(now.values.clone());
        let offset = Offset::between(&now, &target, settings.blend_secs, settings.blend_secs);
        let dof = body.dof();
        let mut new = Self {
            parts: parts(&body),
            body,
            rate_hz,
            settings,
            joining: None,
            target: Target::Posture(target.values),
            offset,
            steps: 0,
            late_secs: 0.0,
            flow: 1.0,
            now,
            command: Command {
                pose: vec![0.0; dof],
                velocity: vec![0.0; dof],
                acceleration: vec![0.0; dof],
                root: state.root,
                phase: 0.0,
                finished: true,
                limited: 0,
            },
        };
        new.command.emit(&new.body, &new.now, rate_hz);
        new.command.acceleration.fill(0.0);
        Ok(new)
    }

    /// The body that it moves.
    pub fn body(&self) -> &Arc<Skeleton> {
        &self.body
    }

    /// Steps a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// What the body is to do now.
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// Begins a course, whatever the body does now.
    ///
    /// # Errors
    /// When the course is of another body, when the pace is not positive, for no cycles at all or a latest phase out of
    /// range.
    pub fn start(&mut self, course: Arc<Course>, manner: &Manner) -> Result<()> {
        if !Arc::ptr_eq(&self.body, course.body()) && *self.body != **course.body() {
            return Err(Error::invalid(format!(
                "a course of `{}` does not move `{}`",
                course.body().name(),
                self.body.name()
            )));
        }
        manner.check()?;
        let mut now = self.now_whole();
        let renamed = now.named_near(&self.body, &course.pose(0.0));
        let (cycles, natural) = manner.cycles_and_speed(&course);
        let joining = self.joining.as_deref();
        let phase = manner.entry.phase(&course, &now, natural, joining);
        let from_secs = course.secs_at(phase);
        let left_secs = if course.is_cyclic() {
            cycles * course.duration_secs()
        } else {
            course.duration_secs() - from_secs
        };
        let sample = course.sample(phase);
        let height_slope = rise(&course, phase) / sample.secs_per_phase;
        let place = |rate: f64| {
            let mut goal = Moving::along(&sample, rate);
            goal.velocities[self.body.dof()] = height_slope * rate;
            goal
        };
        // What it would run at with nothing to join: if it were then in step with the body, there is nothing to join.
        let direct = match manner.pace {
            Pace::Times(speed) => speed,
            Pace::Secs(secs) => left_secs / secs,
        };
        let direct = place(direct);
        now.elsewhere_as(&direct, joining);
        let join = if Offset::between(&now, &direct, 1.0, 1.0).is_none() {
            0.0
        } else {
            self.settings.secs(&now, &place(0.0), &self.parts)
        };
        let (join, speed) = match manner.pace {
            Pace::Times(speed) => (join, speed),
            Pace::Secs(secs) => {
                let join = join.min(secs);
                let run = secs - join + join.min(self.settings.blend_secs);
                (join, left_secs / run)
            }
        };
        if !SPEEDS.contains(&speed) {
            return Err(Error::invalid(format!(
                "a movement of {left_secs:.2} s is run at {} to {} times its own pace, {:.2} to {:.0} s, not at {}",
                SPEEDS.start(),
                SPEEDS.end(),
                left_secs / SPEEDS.end(),
                left_secs / SPEEDS.start(),
                match manner.pace {
                    Pace::Times(_) => format!("{speed} times"),
                    Pace::Secs(secs) => format!("{secs} s"),
                }
            )));
        }
        let whole = left_secs / speed;
        let clock = Clock {
            join,
            blend: join.min(self.settings.blend_secs).min(whole),
            whole,
        };
        let goal = place(speed * clock.at(0.0).1);
        now.elsewhere_as(&goal, joining);
        self.offset = Offset::between(&now, &goal, join, self.settings.blend_secs);
        self.target = Target::Course {
            course,
            from_secs,
            speed,
            clock,
        };
        (self.steps, self.late_secs, self.flow) = (0, 0.0, 1.0);
        now.velocities[self.body.dof()] -= goal.velocities[self.body.dof()];
        self.now = now;
        if renamed {
            let acceleration = self.command.acceleration.clone();
            self.command.emit(&self.body, &self.now, self.rate_hz);
            self.command.acceleration = acceleration;
        }
        self.command.phase = phase;
        self.command.finished = false;
        Ok(())
    }

    /// Lets a cyclic course end with the cycle that runs, counted from where it was joined. Other courses end by themselves.
    pub fn finish(&mut self) {
        let t = self.elapsed_secs();
        if let Target::Course {
            course,
            speed,
            clock,
            ..
        } = &mut self.target
            && course.is_cyclic()
        {
            let cycle = course.duration_secs() / *speed;
            let least = clock.at(t).0.max(clock.blend).max(cycle);
            clock.whole = clock.whole.min((least / cycle).ceil() * cycle);
        }
    }

    /// Seconds until the course has come to its end: 0 when it has, infinite for a cyclic one that goes on and on.
    pub fn remaining_secs(&self) -> f64 {
        match &self.target {
            Target::Posture(_) => 0.0,
            Target::Course { clock, .. } => (clock.end() - self.elapsed_secs()).max(0.0),
        }
    }

    /// One step of the rate: where the body is to be next.
    pub fn step(&mut self) -> &Command {
        let travel = self.now.travel;
        self.advance(1.0);
        let command = &mut self.command;
        command.travel(travel, &self.now, 1.0 / self.rate_hz);
        command.emit(&self.body, &self.now, self.rate_hz);
        &self.command
    }

    /// One step of the rate, of which only the share `flow` passes for what is followed; no command is given.
    pub(super) fn advance(&mut self, flow: f64) {
        self.steps += 1;
        self.late_secs -= (1.0 - flow) / self.rate_hz;
        self.flow = flow;
        let mut t = self.elapsed_secs();
        if let Target::Course { clock, .. } = &self.target
            && t >= clock.end() - AT_END_SECS
        {
            let end = clock.end();
            self.hold(end);
            (self.steps, self.late_secs) = (0, (t - end).max(0.0));
            t = self.late_secs;
        }
        self.follow(t);
        if flow != 1.0 {
            self.now.slowed(flow);
        }
    }

    /// Seconds since the target was set.
    fn elapsed_secs(&self) -> f64 {
        self.steps as f64 / self.rate_hz + self.late_secs
    }

    /// Where the body is `t` seconds after the target was set.
    fn follow(&mut self, t: f64) {
        self.now = match &self.target {
            Target::Posture(held) => Moving::still(held.clone()),
            Target::Course {
                course,
                from_secs,
                speed,
                clock,
            } => {
                let (ran, rate) = clock.at(t);
                let mut phase = course.phase_at(from_secs + speed * ran);
                if !course.is_cyclic() {
                    // While the course waits, rounding must not take it back.
                    phase = phase.max(self.command.phase);
                }
                self.command.phase = phase;
                Moving::along(&course.sample(phase), speed * rate)
            }
        };
        self.offset.add(t, &mut self.now);
    }

    /// Holds the posture at the end of the course, which is reached `end` seconds after its beginning.
    fn hold(&mut self, end: f64) {
        self.follow(end);
        let Target::Course { course, .. } = &self.target else {
            return;
        };
        if !course.is_cyclic() {
            self.command.phase = 1.0;
        }
        self.now.velocities[self.body.dof()] += self.rise_at(end);
        let last = course.sample(self.command.phase);
        let goal = Moving::still(Moving::along(&last, 0.0).values);
        let blend = self.settings.blend_secs;
        self.offset = Offset::between(&self.now, &goal, blend, blend);
        self.target = Target::Posture(goal.values);
        self.command.finished = true;
    }

    /// Vertical velocity of what is followed, `t` seconds after it was set, metres a second.
    fn rise_at(&self, t: f64) -> f64 {
        match &self.target {
            Target::Posture(_) => 0.0,
            Target::Course {
                course,
                from_secs,
                speed,
                clock,
            } => {
                let (ran, rate) = clock.at(t);
                let phase = course.phase_at(from_secs + speed * ran);
                let per_sec = speed * rate / course.sample(phase).secs_per_phase;
                rise(course, phase) * per_sec
            }
        }
    }

    /// Puts the body where it is said to be, whatever it did; its height's velocity with that of what it follows. It
    /// holds that posture.
    pub(super) fn place(&mut self, now: Moving) {
        let still = Moving::still(now.values.clone());
        self.offset = Offset::between(
            &now,
            &still,
            self.settings.blend_secs,
            self.settings.blend_secs,
        );
        self.target = Target::Posture(still.values);
        (self.steps, self.late_secs, self.flow) = (0, 0.0, 1.0);
        self.now = now;
    }

    /// Only these coordinates, and the root last, join what is begun from now on.
    pub(super) fn joins(&mut self, joining: Vec<bool>) {
        self.joining = Some(joining);
    }

    /// Where the body is before joint limits; the height's velocity without that of what is followed.
    pub(super) fn now(&self) -> &Moving {
        &self.now
    }

    /// The same with the height's whole velocity, which costs more.
    pub(super) fn now_whole(&self) -> Moving {
        let mut now = self.now.clone();
        now.velocities[self.body.dof()] += self.rise_at(self.elapsed_secs()) * self.flow;
        now
    }

    /// The posture that is held, the height last.
    pub(super) fn held(&self) -> Option<&[f64]> {
        match &self.target {
            Target::Posture(held) => Some(held),
            Target::Course { .. } => None,
        }
    }
}

/// The coordinates of the joints that move, joints of the trunk together, those of the neck together.
pub(super) fn parts(body: &Skeleton) -> Vec<Vec<Vec<usize>>> {
    let coordinates = |joints: &[usize]| -> Vec<Vec<usize>> {
        joints
            .iter()
            .map(|&j| body.coordinates(j).collect())
            .collect()
    };
    let (trunk, neck) = (body.trunk(), body.neck());
    let single = |j: &usize| !trunk.contains(j) && !neck.contains(j);
    let singles = (0..body.joints().len()).filter(single);
    let mut parts: Vec<_> = singles.map(|j| coordinates(&[j])).collect();
    parts.push(coordinates(&trunk));
    parts.push(coordinates(&neck));
    parts
}
