//! How near the simulated bodies come to what they are told.

use std::sync::Arc;

use kineme::control::{Command, Robot};
use kineme::{Root, Skeleton};
use kineme_sim::{Servo, SimSettings, SimulatedRobot};
use rand::{RngExt as _, SeedableRng};
use rand_pcg::Pcg64;

/// Ticks of control a second.
const RATE_HZ: f64 = 120.0;

fn command(pose: Vec<f64>, velocity: Vec<f64>) -> Command {
    Command {
        acceleration: vec![0.0; pose.len()],
        pose,
        velocity,
        root: Root::ORIGIN,
        phase: 0.0,
        finished: false,
        limited: 0,
    }
}

/// The squares of the angles (radians) between the joints of two postures, of those joints that move.
fn squares(body: &Skeleton, one: &[f64], other: &[f64]) -> Vec<f64> {
    let joints = (0..body.joints().len()).filter(|&j| !body.coordinates(j).is_empty());
    joints
        .map(|j| {
            let at = body.coordinates(j);
            let rotation = body.rotation(j, &one[at.clone()]);
            rotation.angle_to(&body.rotation(j, &other[at])).powi(2)
        })
        .collect()
}

/// From any posture within limits to any other in a second, the arms through wherever the hinges of a shoulder lock.
#[test]
fn any_posture_is_reached_from_any_other() {
    let body = Arc::new(kineme::adonis().expect("adonis"));
    let mut random = Pcg64::seed_from_u64(4);
    let mut posture = || {
        let mut pose: Vec<f64> = (0..body.dof())
            .map(|_| random.random_range(-2.0..2.0))
            .collect();
        body.limited(&mut pose);
        pose
    };
    let settings = SimSettings {
        servo: Some(Servo::FeedforwardFeedback),
        ..SimSettings::default()
    };
    let mut robot = SimulatedRobot::humanoid(&body, &settings).expect("a robot");
    let mut before = posture();
    robot.reset(&before, &vec![0.0; body.dof()]).expect("reset");
    let (mut all, mut ends) = (Vec::new(), 0.0_f64);
    for _ in 0..20 {
        let after = posture();
        let ticks = 120;
        for tick in 1..=ticks {
            let t = f64::from(tick) / f64::from(ticks);
            // Least jerk (Flash and Hogan 1985).
            let share = t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t);
            let rate = 30.0 * t * t * (1.0 - t).powi(2);
            let pairs = before.iter().zip(&after);
            let pose = pairs.clone().map(|(a, b)| a + share * (b - a)).collect();
            let velocity = pairs.map(|(a, b)| rate * (b - a)).collect();
            let told = command(pose, velocity);
            robot.advance(&told, 1.0 / RATE_HZ).expect("stable");
            all.extend(squares(&body, &told.pose, &robot.sensed().pose));
        }
        let left = squares(&body, &after, &robot.sensed().pose);
        ends = left.into_iter().fold(ends, f64::max);
        before = after;
    }
    let rms = (all.iter().sum::<f64>() / all.len() as f64)
        .sqrt()
        .to_degrees();
    let worst = all.iter().copied().fold(0.0, f64::max).sqrt().to_degrees();
    let ends = ends.sqrt().to_degrees();
    println!(
        "between any postures: rms {rms:.3}, worst {worst:.2}, at their ends {ends:.3} degrees"
    );
    println!("{:?}", robot.effort());
    assert!(rms < 2.0 && ends < 3.0, "{rms} and {ends} degrees");
}
