//! Laws of the loop through a body: what disturbs it is taken in and given back, and nothing grows.

use std::sync::Arc;

use kineme::control::{
    Command, ControlSettings, Controller, Effort, KinematicRobot, Plan, Planned, Robot, Sensed,
    State,
};
use kineme::{Result, Root, Skeleton, Vocabulary};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::plans::plan;
use crate::vocabulary::{gap, of_adonis, of_ares, posture, vocabulary_of};

/// Three degrees.
const NEAR: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// A robot whose joints go after their command as fast as they are away from it (first order), and can be kicked.
struct Laggard {
    body: Arc<Skeleton>,
    lag_secs: f64,
    sensed: Sensed,
}

impl Laggard {
    fn new(start: &State, body: &Arc<Skeleton>, lag_secs: f64) -> Self {
        Self {
            body: Arc::clone(body),
            lag_secs,
            sensed: Sensed {
                pose: start.pose.clone(),
                velocity: vec![0.0; start.pose.len()],
            },
        }
    }

    fn kick(&mut self, joint: &str, by: f64) {
        let at = self
            .body
            .coordinates(self.body.joint(joint).expect("a joint"));
        self.sensed.pose[at].iter_mut().for_each(|x| *x += by);
    }
}

impl Robot for Laggard {
    fn body(&self) -> &Arc<Skeleton> {
        &self.body
    }

    fn is_physical(&self) -> bool {
        true
    }

    fn reset(&mut self, pose: &[f64], velocity: &[f64]) -> Result<()> {
        self.sensed.pose.copy_from_slice(pose);
        self.sensed.velocity.copy_from_slice(velocity);
        Ok(())
    }

    fn sensed(&self) -> &Sensed {
        &self.sensed
    }

    fn advance(&mut self, command: &Command, secs: f64) -> Result<()> {
        let share = 1.0 - (-secs / self.lag_secs).exp();
        let sensed = self.sensed.pose.iter_mut().zip(&mut self.sensed.velocity);
        for ((x, v), goal) in sensed.zip(&command.pose) {
            *v = (goal - *x) * share / secs;
            *x += (goal - *x) * share;
        }
        Ok(())
    }

    fn effort(&self) -> Effort {
        Effort::default()
    }
}

fn controller<'v>(vocabulary: &'v Vocabulary, plan: &Plan, start: &State) -> Controller<'v> {
    Controller::new(vocabulary, plan, start, &ControlSettings::default()).expect("a plan")
}

/// What a plan asks of a robot, and where the robot is, tick by tick; kicked at a tick.
fn run(
    vocabulary: &Vocabulary,
    plan: &Plan,
    start: &State,
    robot: &mut Laggard,
    kick: Option<(u64, &str, f64)>,
) -> (Vec<Vec<f64>>, Vec<Vec<f64>>, f64) {
    let mut c = controller(vocabulary, plan, start);
    let (mut told, mut been) = (Vec::new(), Vec::new());
    let mut end = 0.0;
    let mut tick = 0;
    while !c.finished() {
        if let Some((at, joint, by)) = kick
            && at == tick
        {
            robot.kick(joint, by);
        }
        let sensed = robot.sensed().clone();
        let command = c.tick(Some(&sensed), None);
        robot
            .advance(command, 1.0 / plan.rate_hz)
            .expect("a command");
        told.push(command.pose.clone());
        been.push(robot.sensed().pose.clone());
        if !command.finished {
            end = c.secs();
        }
        tick += 1;
    }
    assert!(c.ran().iter().all(|r| r.completed), "{:?}", c.ran());
    (told, been, end)
}

#[test]
fn a_body_that_is_where_it_is_told_to_be_feeds_nothing_back() {
    for primitives in [of_adonis(), of_ares()] {
        let vocabulary = vocabulary_of(primitives);
        let body = vocabulary.body();
        let start = State::resting(body.neutral(), Root::ORIGIN);
        let asked = Plan {
            seconds: 3.0,
            ..plan(vec![Planned::new("wave"), Planned::new("raise")])
        };
        let mut open = controller(&vocabulary, &asked, &start);
        let mut closed = controller(&vocabulary, &asked, &start);
        let mut robot = KinematicRobot::new(Arc::clone(body));
        robot
            .reset(&start.pose, &start.velocity)
            .expect("a posture");
        while !open.finished() {
            let command = closed.tick(Some(robot.sensed()), None).clone();
            robot.advance(&command, 1.0 / 120.0).expect("a command");
            assert_eq!(*open.tick(None, None), command);
        }
    }
}

#[test]
fn what_is_felt_that_is_no_posture_of_the_body_does_not_count() {
    let vocabulary = vocabulary_of(of_adonis());
    let start = State::resting(vocabulary.body().neutral(), Root::ORIGIN);
    let asked = plan(vec![Planned::new("wave")]);
    let mut open = controller(&vocabulary, &asked, &start);
    let mut closed = open.clone();
    for pose in [
        vec![],
        vec![f64::NAN; start.pose.len()],
        vec![f64::INFINITY; start.pose.len()],
    ] {
        let sensed = Sensed {
            velocity: pose.clone(),
            pose,
        };
        assert_eq!(open.tick(None, None), closed.tick(Some(&sensed), None));
    }
}

#[test]
fn lag_alone_is_no_disturbance_and_nothing_grows() {
    for (primitives, lags) in [
        (of_adonis(), &[0.01, 0.05, 0.12, 0.3][..]),
        (of_ares(), &[0.05][..]),
    ] {
        let vocabulary = vocabulary_of(primitives);
        let start = State::resting(vocabulary.body().neutral(), Root::ORIGIN);
        for name in ["reach", "wave", "walk"] {
            let asked = Plan {
                seconds: 12.0,
                ..plan(vec![Planned {
                    repeat: 3,
                    ..Planned::new(name)
                }])
            };
            let mut calm = controller(&vocabulary, &asked, &start);
            let mut free = Vec::new();
            let mut secs = 0.0;
            while !calm.finished() {
                let command = calm.tick(None, None);
                free.push(command.pose.clone());
                if !command.finished {
                    secs = calm.secs();
                }
            }
            for &lag in lags {
                let mut robot = Laggard::new(&start, vocabulary.body(), lag);
                let (told, been, end) = run(&vocabulary, &asked, &start, &mut robot, None);
                let what = format!("{name}, lag {lag}");
                if lag <= 0.05 {
                    let most = told
                        .iter()
                        .zip(&free)
                        .map(|(a, b)| gap(a, b))
                        .fold(0.0, f64::max);
                    assert!(most < 0.02, "{what}: {most}");
                    assert!(end < secs + 0.02, "{what}: {end} instead of {secs}");
                }
                // A robot that lags by more slows the flow down, at most to a quarter.
                assert!(end < 4.0 * secs, "{what}: {end} instead of {secs}");
                // Movements that are over leave nothing behind, and the third is no larger than the first.
                let last = told.len() - 1;
                assert!(gap(&told[last], &free[last]) < 1e-9, "{what}");
                assert!(gap(&been[last], &free[last]) < 1e-3, "{what}");
                let widest = |rows: &[Vec<f64>]| {
                    let far = rows.iter().map(|row| gap(row, &free[0]));
                    far.fold(0.0, f64::max)
                };
                assert!(widest(&told) < 1.02 * widest(&free) + 0.02, "{what}");
            }
        }
    }
}

#[test]
fn a_push_is_over_within_half_a_second_and_the_movement_completes() {
    for (primitives, step) in [(of_adonis(), 1), (of_ares(), 4)] {
        let vocabulary = vocabulary_of(primitives);
        let start = State::resting(vocabulary.body().neutral(), Root::ORIGIN);
        let (name, joint) = ("reach", "right_shoulder");
        let asked = Plan {
            seconds: 4.0,
            ..plan(vec![Planned::new(name)])
        };
        let mut calm = Laggard::new(&start, vocabulary.body(), 0.05);
        let (free, free_been, secs) = run(&vocabulary, &asked, &start, &mut calm, None);
        for phase in (0..10).step_by(step) {
            let tick = (secs * 120.0 * (0.05 + 0.1 * f64::from(phase))) as u64;
            for by in [0.3, -0.6] {
                let mut robot = Laggard::new(&start, vocabulary.body(), 0.05);
                let kick = Some((tick, joint, by));
                let (told, been, end) = run(&vocabulary, &asked, &start, &mut robot, kick);
                let what = format!("{by} at {tick}");
                let given = told
                    .iter()
                    .zip(&free)
                    .map(|(a, b)| gap(a, b))
                    .fold(0.0, f64::max);
                assert!(given > 1e-4, "{what}: nothing was taken in");
                assert!(end < secs + 0.3, "{what}: {end} instead of {secs}");
                // Half a second later the robot is where one that was never kicked is at some moment near.
                let after = tick as usize + 60;
                let near = (after.saturating_sub(30)..=after)
                    .map(|f| gap(&been[after], &free_been[f]))
                    .fold(f64::INFINITY, f64::min);
                assert!(near < NEAR, "{what}: {near}");
                let mut jump = 0.0_f64;
                for pair in told.windows(2) {
                    jump = jump.max(gap(&pair[0], &pair[1]));
                }
                assert!(jump < 0.12, "{what}: {jump}");
            }
        }
    }
}

#[test]
fn from_any_posture_every_movement_completes_through_a_body_that_lags() {
    let vocabulary = vocabulary_of(of_adonis());
    let mut random = Pcg64::seed_from_u64(17);
    for primitive in vocabulary.primitives() {
        for n in 0..25 {
            let start = State::resting(posture(vocabulary.body(), &mut random), Root::ORIGIN);
            let asked = Plan {
                seconds: 7.0,
                ..plan(vec![Planned::new(primitive.name())])
            };
            let mut robot = Laggard::new(&start, vocabulary.body(), 0.05);
            let (told, been, end) = run(&vocabulary, &asked, &start, &mut robot, None);
            let last = told.len() - 1;
            assert!(end < 6.0, "{} from {n}: {end}", primitive.name());
            assert!(gap(&told[last], &been[last]) < 1e-6);
        }
    }
}
