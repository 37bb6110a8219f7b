//! Laws of the loop from what is watched to what is done.

#[path = "../control/vocabulary.rs"]
#[allow(dead_code, reason = "every test uses its part")]
mod vocabulary;

use std::sync::Arc;

use kineme::control::{
    Arbitration, ControlSettings, Controller, KinematicRobot, Place, Plan, Planned, Robot, Rule,
    Sensed,
};
use kineme::interaction::{Performance, Session, SessionSettings, standing};
use kineme::perception::AlarmSettings;
use kineme::primitive::{
    Listener, Observation, Observations, Posterior, Reading, Recogniser, Recognition,
};
use kineme::{Motion, Result, Root, Vocabulary, adonis, ares};
use vocabulary::{gap, of_adonis, of_ares, vocabulary_of};

/// Sees the primitive whose number stands in the first coordinate of a posture; none below zero.
struct Told<'v>(&'v Vocabulary);

struct Hearing(usize);

impl Recogniser for Told<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.0
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(Hearing(self.0.primitives().len()))
    }

    fn recognise(&self, _: &Observations) -> Result<Recognition> {
        unreachable!("a session listens")
    }
}

impl Listener for Hearing {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let mut primitives = vec![0.0; self.0];
        let shown = seen.pose[0].round();
        if shown >= 0.0 {
            primitives[shown as usize] = 0.9;
        }
        let none = 1.0 - primitives.iter().sum::<f64>();
        Ok(Reading {
            posterior: Posterior {
                primitives,
                rest: 0.0,
                none,
            },
            place: None,
            novelty: 0.0,
        })
    }
}

/// What is shown, ten times a second: numbers of primitives.
fn shown(vocabulary: &Vocabulary, numbers: &[f64]) -> Observations {
    let body = vocabulary.body();
    let mut poses = vec![0.0; numbers.len() * body.dof()];
    for (pose, number) in poses.chunks_mut(body.dof()).zip(numbers) {
        pose[0] = *number;
    }
    let roots = vec![Root::ORIGIN; numbers.len()];
    let motion = Motion::new("shown", Arc::clone(body), 10.0, poses, roots);
    Observations::complete(motion.expect("a motion"))
}

fn plan(behaviors: Vec<Planned>, rules: Vec<Rule>) -> Plan {
    Plan {
        rate_hz: 100.0,
        seconds: 3.0,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors,
        rules,
    }
}

fn perform(
    vocabulary: &Vocabulary,
    plan: &Plan,
    robot: &mut dyn Robot,
    watched: Option<&Observations>,
) -> Performance {
    let told = Told(vocabulary);
    let start = standing(vocabulary, plan).expect("a start");
    let settings = ControlSettings::default();
    let controller = Controller::new(vocabulary, plan, &start, &settings).expect("a plan");
    let recogniser = watched.map(|_| &told as &dyn Recogniser);
    let mut session = Session::new(controller, robot, recogniser, &SessionSettings::default())
        .expect("a session");
    session.run(watched, &mut |_| {}).expect("a run");
    session.performance("test").expect("a performance")
}

#[test]
fn what_lasts_is_answered_once_each_time_and_soon() {
    let vocabulary = vocabulary_of(of_adonis());
    // Wave (2) from .5 to 1.0 s, a flicker of reach (0), wave again from 2.0 s.
    let mut numbers = vec![-1.0; 30];
    numbers[5..10].fill(2.0);
    numbers[13] = 0.0;
    numbers[20..30].fill(2.0);
    let watched = shown(&vocabulary, &numbers);
    let rules = ["wave", "reach"].map(|when| Rule {
        when: when.into(),
        then: Planned::new("raise"),
    });
    let plan = plan(Vec::new(), rules.into());
    let mut robot = KinematicRobot::new(Arc::clone(vocabulary.body()));
    let performance = perform(&vocabulary, &plan, &mut robot, Some(&watched));
    let answers: Vec<(Place, f64)> = performance
        .ran
        .iter()
        .map(|ran| (ran.planned, ran.start_secs))
        .collect();
    let tick = 1.0 / plan.rate_hz;
    assert_eq!(answers.len(), 2, "{answers:?}");
    for ((place, at), shown) in answers.into_iter().zip([0.5, 2.0]) {
        assert_eq!(place, Place::Rule(0));
        assert!((shown..shown + 0.2 + 2.0 * tick).contains(&at), "{at}");
    }
    let noticed: Vec<Option<usize>> = performance.noticed.iter().map(|n| n.primitive).collect();
    assert_eq!(noticed, [Some(2), None, Some(2)]);
}

#[test]
fn without_physics_a_robot_does_what_it_is_told_and_any_two_runs_are_alike() {
    let vocabulary = vocabulary_of(of_ares());
    let plan = plan(vec![Planned::new("reach")], Vec::new());
    let run = || {
        let mut robot = KinematicRobot::new(Arc::clone(vocabulary.body()));
        perform(&vocabulary, &plan, &mut robot, None)
    };
    let one = run();
    assert!(one.tracking.max_rad < 1e-12, "{:?}", one.tracking);
    assert_eq!(one.commanded.poses(), one.done.poses());
    assert_eq!(one.done.frames(), 300);
    assert!(one.ran[0].completed);
    assert_eq!(one, run());
}

#[test]
fn a_robot_of_another_body_does_the_same_with_its_arm() {
    let (ares, adonis) = (ares().expect("ares"), Arc::new(adonis().expect("adonis")));
    let vocabulary = vocabulary_of(of_ares());
    assert_eq!(**vocabulary.body(), ares);
    let plan = plan(vec![Planned::new("reach")], Vec::new());
    let mut own = KinematicRobot::new(Arc::clone(vocabulary.body()));
    let mut other = KinematicRobot::new(Arc::clone(&adonis));
    let as_ares = perform(&vocabulary, &plan, &mut own, None).done;
    let as_adonis = perform(&vocabulary, &plan, &mut other, None);
    // Feedback through both transfers must not take what is lost on the way for a push.
    assert!(as_adonis.ran[0].completed);
    let direction = |motion: &Motion, frame: usize| {
        let frames = motion.frames_at(frame);
        let body = motion.skeleton();
        let at = |role| frames[body.joints_of(role)[0]].position;
        (at(kineme::Role::RightHand) - at(kineme::Role::RightLowerArm)).normalize()
    };
    for frame in (0..300).step_by(10) {
        let (a, b) = (
            direction(&as_ares, frame),
            direction(&as_adonis.done, frame),
        );
        assert!(a.angle(&b) < 0.02, "{frame}: {}", a.angle(&b));
    }
}

/// Lags behind what it is told, and is pushed once.
struct Pushed {
    body: Arc<kineme::Skeleton>,
    sensed: Sensed,
    ticks: usize,
}

impl Robot for Pushed {
    fn body(&self) -> &Arc<kineme::Skeleton> {
        &self.body
    }

    fn is_physical(&self) -> bool {
        true
    }

    fn reset(&mut self, pose: &[f64], velocity: &[f64]) -> Result<()> {
        self.sensed.pose = pose.to_vec();
        self.sensed.velocity = velocity.to_vec();
        Ok(())
    }

    fn sensed(&self) -> &Sensed {
        &self.sensed
    }

    fn advance(&mut self, command: &kineme::control::Command, _: f64) -> Result<()> {
        self.ticks += 1;
        for (x, told) in self.sensed.pose.iter_mut().zip(&command.pose) {
            *x += 0.5 * (told - *x);
        }
        self.sensed.velocity.copy_from_slice(&command.velocity);
        if self.ticks == 60 {
            let joint = self.body.joint("right_elbow")?;
            self.sensed.pose[self.body.coordinates(joint).start] += 0.5;
        }
        Ok(())
    }

    fn effort(&self) -> kineme::control::Effort {
        kineme::control::Effort::default()
    }
}

#[test]
fn a_robot_of_another_body_that_is_pushed_comes_back_and_completes() {
    let adonis = Arc::new(adonis().expect("adonis"));
    let vocabulary = vocabulary_of(of_ares());
    let plan = plan(vec![Planned::new("wave")], Vec::new());
    let undisturbed = {
        let mut robot = KinematicRobot::new(Arc::clone(&adonis));
        perform(&vocabulary, &plan, &mut robot, None)
    };
    let mut robot = Pushed {
        sensed: Sensed {
            pose: adonis.neutral(),
            velocity: vec![0.0; adonis.dof()],
        },
        body: Arc::clone(&adonis),
        ticks: 0,
    };
    let performance = perform(&vocabulary, &plan, &mut robot, None);
    assert!(performance.ran[0].completed);
    assert!(performance.tracking.max_rad > 0.1, "it was pushed");
    let last = performance.done.frames() - 1;
    assert!(gap(performance.done.pose(last), undisturbed.done.pose(last)) < 0.02);
}

#[test]
fn a_session_that_cannot_be_is_refused() {
    let vocabulary = vocabulary_of(of_adonis());
    let plan = plan(vec![Planned::new("reach")], Vec::new());
    let start = standing(&vocabulary, &plan).expect("a start");
    let settings = ControlSettings::default();
    for (memory_secs, raise, release) in [(0.1, 1.5, 0.3), (0.1, 0.6, 0.9), (0.0, 0.6, 0.3)] {
        let alarm = AlarmSettings {
            memory_secs,
            raise,
            release,
        };
        let controller = Controller::new(&vocabulary, &plan, &start, &settings).expect("a plan");
        let mut robot = KinematicRobot::new(Arc::clone(vocabulary.body()));
        let told = Told(&vocabulary);
        let made = Session::new(
            controller,
            &mut robot,
            Some(&told),
            &SessionSettings { alarm },
        );
        assert!(made.is_err(), "{memory_secs} {raise} {release}");
    }
    let controller = Controller::new(&vocabulary, &plan, &start, &settings).expect("a plan");
    let mut robot = KinematicRobot::new(Arc::clone(vocabulary.body()));
    let mut session =
        Session::new(controller, &mut robot, None, &SessionSettings::default()).expect("a session");
    let seen = shown(&vocabulary, &[0.0]);
    assert!(session.observe(&seen.at(0)).is_err(), "nothing recognises");
}
