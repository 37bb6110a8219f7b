//! How near the simulated bodies come to what they are told.

use std::f64::consts::TAU;
use std::sync::Arc;

use kineme::control::{Command, Robot};
use kineme::{Root, Skeleton};
use kineme_sim::{Servo, SimSettings, SimulatedRobot};

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

/// How far hinges that swing by half a radian once a second, each in a phase of its own, are from the middle of their
/// swing, and how fast they go.
fn sinus(count: usize, secs: f64) -> (Vec<f64>, Vec<f64>) {
    let phase = |i: usize| TAU * (secs + (0.618_033_988_749_895 * i as f64).fract());
    (
        (0..count).map(|i| 0.5 * phase(i).sin()).collect(),
        (0..count).map(|i| 0.5 * TAU * phase(i).cos()).collect(),
    )
}

/// Root mean square error (radians) over the hinges that swing about the neutral posture, from the first half second
/// on to the end of `secs`.
fn swinging(body: Skeleton, servo: Servo, secs: f64) -> f64 {
    let body = Arc::new(body);
    let settings = SimSettings {
        servo: Some(servo),
        torque_limits: false,
        joint_limits: false,
        ..SimSettings::default()
    };
    let mut robot = SimulatedRobot::humanoid(&body, &settings).expect("a robot");
    let hinges = robot.hinges().clone();
    let count = hinges.count();
    let middle = robot.plant().angles().to_vec();
    let at = |secs: f64| {
        let (mut angles, rates) = sinus(count, secs);
        angles.iter_mut().zip(&middle).for_each(|(a, m)| *a += m);
        (angles, rates)
    };
    let (mut pose, mut velocity) = (body.neutral(), vec![0.0; body.dof()]);
    let mut told = |secs: f64| {
        let (angles, rates) = at(secs);
        hinges.pose(&angles, &rates, &mut pose, &mut velocity);
        command(pose.clone(), velocity.clone())
    };
    let start = told(0.0);
    robot.reset(&start.pose, &start.velocity).expect("reset");
    let (mut sum, mut n) = (0.0, 0);
    for tick in 1..=(secs * RATE_HZ) as usize {
        let now = tick as f64 / RATE_HZ;
        robot.advance(&told(now), 1.0 / RATE_HZ).expect("stable");
        if now >= 0.5 {
            let wanted = at(now).0;
            let errors = wanted.iter().zip(robot.plant().angles());
            sum += errors.map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            n += count;
        }
    }
    (sum / n as f64).sqrt()
}

#[test]
fn hinges_follow_a_sinus_as_near_as_their_law_allows() {
    let adonis = || kineme::adonis().expect("adonis");
    let ares = || kineme::ares().expect("ares");
    let cases = [
        ("adonis PD", adonis(), Servo::Pd, 0.02),
        (
            "adonis feedforward",
            adonis(),
            Servo::FeedforwardFeedback,
            0.0006,
        ),
        (
            "adonis computed torque",
            adonis(),
            Servo::ComputedTorque,
            0.0006,
        ),
        (
            "ares feedforward",
            ares(),
            Servo::FeedforwardFeedback,
            0.002,
        ),
        (
            "ares computed torque",
            ares(),
            Servo::ComputedTorque,
            0.0006,
        ),
    ];
    for (name, body, servo, most) in cases {
        let rms = swinging(body, servo, 1.5);
        println!("{name}: {rms:.6} rad");
        assert!(rms <= most, "{name}: {rms} rad");
    }
}
