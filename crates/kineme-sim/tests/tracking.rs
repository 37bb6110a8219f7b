//! How near the simulated bodies come to what they are told.

use std::f64::consts::TAU;
use std::sync::Arc;

use kineme::control::{Command, Inertialization, Manner, Robot, State};
use kineme::{Modelling, Root, Skeleton, Synthesizer};
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
            1e-5,
        ),
        (
            "adonis computed torque",
            adonis(),
            Servo::ComputedTorque,
            1e-5,
        ),
        ("ares feedforward", ares(), Servo::FeedforwardFeedback, 1e-4),
        ("ares computed torque", ares(), Servo::ComputedTorque, 1e-5),
    ];
    for (name, body, servo, most) in cases {
        let rms = swinging(body, servo, 1.5);
        println!("{name}: {rms:.6} rad");
        assert!(rms <= most, "{name}: {rms} rad");
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

/// Root mean square angle (degrees) over joints and frames while primitives of a script are performed, limits on.
fn performing(body: &Arc<Skeleton>, script: &str, names: &[&str]) -> f64 {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../choreography")
        .join(script);
    let bytes = std::fs::read(path).expect("a script");
    let parsed = kineme_formats::script::parse(script, &bytes).expect("a valid script");
    let vocabulary = parsed
        .vocabulary(body, &Modelling::default(), (script, None))
        .expect("a vocabulary");
    let mut robot = SimulatedRobot::humanoid(body, &SimSettings::default()).expect("a robot");
    let mut all = Vec::new();
    for name in names {
        let primitive = vocabulary.primitive(name).expect("a primitive");
        let course = Arc::new(primitive.at(&primitive.middle()).expect("a course"));
        let state = State::resting(course.pose(0.0), Root::ORIGIN);
        let blending = Inertialization::default();
        let mut synthesizer =
            Synthesizer::new(Arc::clone(body), RATE_HZ, &state, blending).expect("a synthesizer");
        let start = synthesizer.command().clone();
        robot.reset(&start.pose, &start.velocity).expect("reset");
        synthesizer
            .start(course, &Manner::default())
            .expect("begun");
        loop {
            let told = synthesizer.step();
            robot.advance(told, 1.0 / RATE_HZ).expect("stable");
            all.extend(squares(body, &told.pose, &robot.sensed().pose));
            if told.finished {
                break;
            }
        }
        assert_eq!(robot.effort().saturated, 0, "{name}");
    }
    (all.iter().sum::<f64>() / all.len() as f64)
        .sqrt()
        .to_degrees()
}

#[test]
fn primitives_are_performed() {
    let adonis = Arc::new(kineme::adonis().expect("adonis"));
    let ares = Arc::new(kineme::ares().expect("ares"));
    let cases: [(_, &str, &[&str], f64); 3] = [
        (&adonis, "boxing.toml", &["jab", "uppercut"], 2.0),
        (&adonis, "vertical-waving.toml", &["wave-up"], 2.0),
        (&ares, "twist.toml", &["twist-left"], 0.5),
    ];
    for (body, script, names, most) in cases {
        let rms = performing(body, script, names);
        println!("{} {script}: {rms:.4} degrees", body.name());
        assert!(rms <= most, "{} {script}: {rms} degrees", body.name());
    }
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
