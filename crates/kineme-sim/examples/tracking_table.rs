//! How near Adonis and Ares come to the primitives of `choreography/` when they are told them at 120 Hz, and how much
//! faster than real time the median tick is: a line a primitive and law. Run it from the root of the workspace.

use std::sync::Arc;
use std::time::Instant;

use kineme::control::{Inertialization, Robot as _, State};
use kineme::{Modelling, Root, Skeleton, Synthesizer, Vocabulary};
use kineme_sim::{Servo, SimSettings, SimulatedRobot};

const SCRIPTS: [&str; 5] = [
    "boxing",
    "punching",
    "vertical-waving",
    "horizontal-waving",
    "twist",
];
const RATE_HZ: f64 = 120.0;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Sums over movements.
#[derive(Default)]
struct Sum {
    squares: f64,
    count: usize,
    worst: f64,
    /// Seconds that each tick took.
    ticks: Vec<f64>,
    saturated: u64,
    torques: u64,
}

impl Sum {
    /// How much faster than real time the median tick is.
    fn speed(&self) -> f64 {
        let mut ticks = self.ticks.clone();
        ticks.sort_by(f64::total_cmp);
        ticks
            .get(ticks.len() / 2)
            .map_or(0.0, |t| 1.0 / RATE_HZ / t)
    }

    fn print(&self, name: &str) {
        println!(
            "{name:45} rms {:7.4} deg  worst {:7.3} deg  saturated {:.5}  {:6.1} x real time",
            (self.squares / self.count.max(1) as f64)
                .sqrt()
                .to_degrees(),
            self.worst.to_degrees(),
            self.saturated as f64 / self.torques.max(1) as f64,
            self.speed(),
        );
    }

    fn add(&mut self, other: &Sum) {
        self.squares += other.squares;
        self.count += other.count;
        self.worst = self.worst.max(other.worst);
        self.ticks.extend(&other.ticks);
        self.saturated += other.saturated;
        self.torques += other.torques;
    }
}

/// One primitive at the parameters of its first exemplar and in the middle of its parameters.
fn run(robot: &mut SimulatedRobot, vocabulary: &Vocabulary, k: usize) -> Outcome<Sum> {
    let body = Arc::clone(vocabulary.body());
    let primitive = &vocabulary.primitives()[k];
    let mut sum = Sum::default();
    for p in [primitive.point(0).to_vec(), primitive.middle()] {
        let course = Arc::new(primitive.at(&p)?);
        let state = State::resting(course.pose(0.0), Root::ORIGIN);
        let blending = Inertialization::default();
        let mut synthesizer = Synthesizer::new(Arc::clone(&body), RATE_HZ, &state, blending)?;
        let start = synthesizer.command().clone();
        robot.reset(&start.pose, &start.velocity)?;
        synthesizer.start(
            Arc::clone(&course),
            &kineme::control::Manner {
                cycles: course.is_cyclic().then_some(2),
                ..Default::default()
            },
        )?;
        loop {
            let command = synthesizer.step();
            let begun = Instant::now();
            robot.advance(command, 1.0 / RATE_HZ)?;
            sum.ticks.push(begun.elapsed().as_secs_f64());
            let sensed = robot.sensed();
            for j in 0..body.joints().len() {
                let at = body.coordinates(j);
                if at.is_empty() {
                    continue;
                }
                let (told, is) = (&command.pose[at.clone()], &sensed.pose[at]);
                let angle = body.rotation(j, told).angle_to(&body.rotation(j, is));
                sum.squares += angle * angle;
                sum.count += 1;
                sum.worst = sum.worst.max(angle);
            }
            if command.finished {
                break;
            }
        }
        sum.saturated += robot.effort().saturated;
        sum.torques += robot.effort().torques;
    }
    Ok(sum)
}

fn main() -> Outcome<()> {
    let bodies: [(Skeleton, &[Servo]); 2] = [
        (kineme::adonis()?, &[Servo::Pd, Servo::FeedforwardFeedback]),
        (
            kineme::ares()?,
            &[Servo::FeedforwardFeedback, Servo::ComputedTorque],
        ),
    ];
    for (body, servos) in bodies {
        let body = Arc::new(body);
        for &servo in servos {
            let settings = SimSettings {
                servo: Some(servo),
                ..SimSettings::default()
            };
            let mut robot = SimulatedRobot::humanoid(&body, &settings)?;
            let mut all = Sum::default();
            for script in SCRIPTS {
                let file = format!("choreography/{script}.toml");
                let parsed = kineme_formats::script::parse(&file, &std::fs::read(&file)?)?;
                let vocabulary = parsed.vocabulary(&body, &Modelling::default(), (&file, None))?;
                for (k, primitive) in vocabulary.primitives().iter().enumerate() {
                    let sum = run(&mut robot, &vocabulary, k)?;
                    sum.print(&format!(
                        "{} {servo:?} {script} {}",
                        body.name(),
                        primitive.name()
                    ));
                    all.add(&sum);
                }
            }
            all.print(&format!("{} {servo:?} ALL", body.name()));
        }
    }
    Ok(())
}
