//! [`Session`]: a plan on a robot, tick by tick.

use super::performance::{Noticed, Performance, Record};
use crate::control::{Command, Controller, Percept, Plan, Robot, Sensed, State};
use crate::error::{Error, Result};
use crate::perception::{Alarm, AlarmSettings};
use crate::primitive::{Listener, Observation, Observations, Reading, Recogniser, Vocabulary};
use crate::retargeting::Transfer;
use crate::skeleton::Root;

/// How a session goes.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionSettings {
    /// When what is watched is worth an answer. Surer than an alarm by itself is: a wrong answer costs a movement.
    pub alarm: AlarmSettings,
}

impl Default for SessionSettings {
    fn default() -> Self {
        Self {
            alarm: AlarmSettings {
                raise: 0.6,
                release: 0.3,
                ..AlarmSettings::default()
            },
        }
    }
}

/// What is watched, and what of it is announced.
struct Watching<'a> {
    listener: Box<dyn Listener + 'a>,
    alarm: Alarm,
}

/// A robot of another body than the vocabulary's: commands go one way, what it feels the other.
struct Bodies {
    to_robot: Transfer,
    /// What is felt, and what would be felt if the robot were where it was told to be: not every posture survives the
    /// way there and back, and what is lost on it is no deviation.
    felt: Transfer,
    expected: Transfer,
}

/// A plan that is carried out.
///
/// Each [`Self::tick`] is one of the controller's: what the robot feels and what was noticed go in, the command comes out
/// and is carried out. [`Self::observe`] takes what is watched in between, up to the moment of the next tick; what comes
/// later than that waits for nobody, so that a recording and a live stream are treated alike.
pub struct Session<'a> {
    controller: Controller<'a>,
    robot: &'a mut dyn Robot,
    bodies: Option<Bodies>,
    watching: Option<Watching<'a>>,
    noticed: Option<usize>,
    told: Command,
    root: Root,
    record: Record,
    rate_hz: f64,
    ticks: u64,
}

impl<'a> Session<'a> {
    /// The robot takes the controller's posture at rest; with a recogniser it watches.
    ///
    /// # Errors
    /// When the robot's body shows none of the joints that the plan moves, when a setting is out of its range, or when
    /// the robot cannot take the posture.
    pub fn new(
        controller: Controller<'a>,
        robot: &'a mut dyn Robot,
        recogniser: Option<&'a dyn Recogniser>,
        settings: &SessionSettings,
    ) -> Result<Self> {
        let watching = match recogniser {
            Some(recogniser) => Some(Watching {
                listener: recogniser.listen(),
                alarm: Alarm::new(recogniser.vocabulary().primitives().len(), &settings.alarm)?,
            }),
            None => None,
        };
        let body = controller.body();
        let bodies = if **robot.body() == **body {
            None
        } else {
            let back = Transfer::between(robot.body(), body)?;
            Some(Bodies {
                to_robot: Transfer::between(body, robot.body())?,
                felt: back.clone(),
                expected: back,
            })
        };
        let rate_hz = controller.rate_hz();
        let record = Record::new(robot.body().clone(), rate_hz);
        let first = controller.command().clone();
        let mut session = Self {
            controller,
            robot,
            bodies,
            watching,
            noticed: None,
            told: first.clone(),
            root: first.root,
            record,
            rate_hz,
            ticks: 0,
        };
        session.told = session.for_robot(first);
        session
            .robot
            .reset(&session.told.pose, &session.told.velocity)?;
        Ok(session)
    }

    /// Joints of the controller's body that the robot has no counterpart for.
    pub fn without_counterpart(&self) -> &[usize] {
        match &self.bodies {
            Some(bodies) => bodies.to_robot.without_counterpart(),
            None => &[],
        }
    }

    /// Seconds since the beginning.
    pub fn secs(&self) -> f64 {
        self.ticks as f64 / self.rate_hz
    }

    /// Whether the plan has come to its end.
    pub fn finished(&self) -> bool {
        self.controller.finished()
    }

    /// The controller, for whoever shows what goes on.
    pub fn controller(&self) -> &Controller<'a> {
        &self.controller
    }

    /// Watches a posture.
    ///
    /// # Errors
    /// Without a recogniser, or when the posture is not of its body or not later than the one before.
    pub fn observe(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let watching = self
            .watching
            .as_mut()
            .ok_or_else(|| Error::invalid("nothing recognises what is watched"))?;
        let reading = watching.listener.hear(seen)?;
        let now = watching.alarm.hear(seen.secs, &reading.posterior)?;
        if now != self.noticed {
            self.noticed = now;
            self.record.noticed.push(Noticed {
                secs: seen.secs,
                primitive: now,
            });
        }
        Ok(reading)
    }

    /// One tick of the controller, carried out by the robot.
    ///
    /// # Errors
    /// When the robot cannot: a simulation that diverges.
    pub fn tick(&mut self) -> Result<()> {
        let percept = self.watching.is_some().then_some(Percept {
            primitive: self.noticed,
        });
        let sensed = self.felt();
        let command = self
            .controller
            .tick(Some(&sensed), percept.as_ref())
            .clone();
        self.told = self.for_robot(command);
        self.robot.advance(&self.told, 1.0 / self.rate_hz)?;
        // A simulated pelvis is held where it began.
        let root = match self.robot.is_physical() {
            true => self.root,
            false => self.told.root,
        };
        self.record
            .tick(&self.told.pose, &self.robot.sensed().pose, root);
        self.ticks += 1;
        Ok(())
    }

    /// Carries the plan out to its end while a recording is watched, each posture at its time; `hear` is told the
    /// seconds after every tick.
    ///
    /// # Errors
    /// As [`Self::observe`] and [`Self::tick`].
    pub fn run(&mut self, watched: Option<&Observations>, hear: &mut dyn FnMut(f64)) -> Result<()> {
        let frames = watched.map_or(0, |w| w.motion().frames());
        let mut next = 0;
        while !self.finished() {
            while let Some(watched) = watched.filter(|_| next < frames) {
                let seen = watched.at(next);
                if seen.secs > self.secs() {
                    break;
                }
                self.observe(&seen)?;
                next += 1;
            }
            self.tick()?;
            hear(self.secs());
        }
        Ok(())
    }

    /// What was done.
    ///
    /// # Errors
    /// When nothing was.
    pub fn performance(self, name: &str) -> Result<Performance> {
        let ran = self.controller.ran().to_vec();
        self.record.performance(name, ran, self.robot.effort())
    }

    /// What the robot feels, in the controller's joints.
    fn felt(&mut self) -> Sensed {
        let sensed = self.robot.sensed();
        let Some(bodies) = &mut self.bodies else {
            return sensed.clone();
        };
        let still = vec![0.0; sensed.pose.len()];
        let command = self.controller.command();
        let felt = bodies.felt.command(&sensed.pose, &sensed.velocity, &still);
        let expected = bodies
            .expected
            .command(&self.told.pose, &self.told.velocity, &still);
        let moved = |told: &[f64], felt: &[f64], expected: &[f64]| -> Vec<f64> {
            let off = felt.iter().zip(expected).map(|(f, e)| f - e);
            told.iter().zip(off).map(|(t, off)| t + off).collect()
        };
        Sensed {
            pose: moved(&command.pose, &felt.pose, &expected.pose),
            velocity: moved(&command.velocity, &felt.velocity, &expected.velocity),
        }
    }

    /// A command in the robot's joints.
    fn for_robot(&mut self, command: Command) -> Command {
        let Some(bodies) = &mut self.bodies else {
            return command;
        };
        let moved =
            bodies
                .to_robot
                .command(&command.pose, &command.velocity, &command.acceleration);
        Command {
            pose: moved.pose.clone(),
            velocity: moved.velocity.clone(),
            acceleration: moved.acceleration.clone(),
            ..command
        }
    }
}

/// The state in which a body begins a plan: standing in its neutral pose, as high as the plan's first movement has it.
///
/// # Errors
/// When the plan's first behaviour is of no primitive of the vocabulary.
pub fn standing(vocabulary: &Vocabulary, plan: &Plan) -> Result<State> {
    let rules = plan.rules.iter().map(|rule| &rule.then);
    let mut root = Root::ORIGIN;
    if let Some(first) = plan.behaviors.iter().chain(rules).next() {
        let primitive = vocabulary.primitive(&first.primitive)?;
        let sample = primitive.sample(&primitive.middle(), 0.0)?;
        root.position.z = sample.travel.height;
    }
    Ok(State::resting(vocabulary.body().neutral(), root))
}
