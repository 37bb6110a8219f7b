//! The tables of `docs/control.md`, and those of `docs/benchmarks.md`, as Markdown.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use kineme::control::{Arbitration, ControlSettings, Controller, Plan, Planned};
use kineme::interaction::standing;
use kineme::{Skeleton, Vocabulary};
use kineme_sim::{Servo, SimSettings, SimulatedRobot};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::disturbance::{BACK_RAD, begun, posture, pushed};
use super::robots::{beyond_limits, robot, routine};
use super::speed::speed;
use super::tracking::{Errors, RATE_HZ, performing, swinging};
use crate::choreographies::{SCRIPTS, choreography, everything};
use crate::sets::Result;
use crate::sparring::{self, Sparring};

/// Seconds that hinges swing.
const SWING_SECS: f64 = 4.0;
/// Postures from which Adonis begins, and Ares, who takes longer.
const POSTURES: [(&str, usize); 2] = [("adonis", 100), ("ares", 10)];
/// Movements that are pushed, and the wrist.
const PUSHED: [(&str, &str); 5] = [
    ("jab", "right_wrist"),
    ("punch-out", "right_wrist"),
    ("wave-up", "right_wrist"),
    ("wave-across", "right_wrist"),
    ("twist-left", "right_wrist"),
];
/// Rate at which transitions are looked at.
const FINE_HZ: f64 = 250.0;

fn quantile(values: &[f64], q: f64) -> f64 {
    kineme::math::statistics::quantile(values, q).unwrap_or(f64::NAN)
}

fn bodies() -> Result<[Arc<Skeleton>; 2]> {
    Ok([Arc::new(kineme::adonis()?), Arc::new(kineme::ares()?)])
}

/// All that needs no corpus but the sparring with real people, which is left out without one. `g1` is the robot's file.
///
/// # Errors
/// When a simulation fails, the corpus lacks a file, or the robot's file cannot be read.
pub fn control_tables(
    corpus: &Path,
    g1: Option<&Path>,
    watch: &mut dyn FnMut(&str),
) -> Result<String> {
    let mut out = String::new();
    watch("swings");
    swings(&mut out)?;
    watch("primitives");
    primitives(&mut out)?;
    watch("transitions");
    transitions(&mut out)?;
    watch("pushes");
    pushes(&mut out)?;
    watch("beginnings");
    beginnings(&mut out)?;
    watch("sparring");
    sparring(&mut out, corpus)?;
    watch("the robot");
    real_robot(&mut out, g1)?;
    Ok(out)
}

fn swings(out: &mut String) -> Result<()> {
    let [adonis, ares] = bodies()?;
    out.push_str(
        "\n### Every hinge swings by half a radian once a second\n\nRoot mean square over all hinges after the first half \
         second, radians; 1 ms steps, 8 Hz, limits of joints and torques off.\n\n| body | law | error | asked |\n| --- | \
         --- | --- | --- |\n",
    );
    for (body, law, servo, asked) in [
        (&adonis, "PD", Servo::Pd, "0.02"),
        (&adonis, "feedforward + PD", Servo::FeedforwardFeedback, ""),
        (&adonis, "computed torque", Servo::ComputedTorque, ""),
        (&ares, "PD", Servo::Pd, ""),
        (
            &ares,
            "feedforward + PD",
            Servo::FeedforwardFeedback,
            "0.002",
        ),
        (&ares, "computed torque", Servo::ComputedTorque, "0.0006"),
    ] {
        let errors = swinging(body, servo, SWING_SECS)?;
        writeln!(
            out,
            "| {} | {law} | {:.1e} | {asked} |",
            body.name(),
            errors.rms_rad()
        )?;
    }
    Ok(())
}

fn primitives(out: &mut String) -> Result<()> {
    let bodies = bodies()?;
    out.push_str(
        "\n### Every primitive of the paper's movements, limits on\n\nAngles of joints, root mean square over joints and frames \
         (at most), degrees; parameters in the middle and at every exemplar. Adonis by PD (asked: 2), Ares by feedforward \
         and PD (asked: 0.5).\n\n| primitive | Adonis | Ares |\n| --- | --- | --- |\n",
    );
    let mut robots = Vec::new();
    for body in &bodies {
        robots.push(SimulatedRobot::humanoid(body, &SimSettings::default())?);
    }
    let mut all = [Errors::default(); 2];
    for (name, text) in SCRIPTS {
        let made: Vec<Vocabulary> = bodies
            .iter()
            .map(|body| choreography(name, text, body))
            .collect::<Result<_>>()?;
        for k in 0..made[0].primitives().len() {
            let mut cells = Vec::new();
            for ((vocabulary, robot), all) in made.iter().zip(&mut robots).zip(&mut all) {
                let primitive = &vocabulary.primitives()[k];
                let mut errors = Errors::default();
                let points = (0..primitive.exemplars().len()).map(|i| primitive.point(i).to_vec());
                for p in points.chain([primitive.middle()]) {
                    let course = Arc::new(primitive.at(&p)?);
                    errors = errors.and(performing(robot, &course)?);
                }
                *all = all.and(errors);
                cells.push(degrees(&errors));
            }
            let primitive = made[0].primitives()[k].name();
            writeln!(out, "| {primitive} | {} |", cells.join(" | "))?;
        }
    }
    let cells = all.map(|errors| degrees(&errors));
    writeln!(out, "| **all** | {} |", cells.join(" | "))?;
    Ok(())
}

fn degrees(errors: &Errors) -> String {
    format!(
        "{:.3} ({:.2})",
        errors.rms_rad().to_degrees(),
        errors.max_rad.to_degrees()
    )
}

/// Every primitive takes over from every other in its midst.
fn transitions(out: &mut String) -> Result<()> {
    out.push_str(
        "\n### Every primitive takes over from every other\n\nThe second begins when the first is half done, with a higher \
         priority, on all joints. Accelerations of coordinates, rad/s², beside the greatest that either has by itself; the \
         greatest jump of a command beyond what its velocities explain, radians.\n\n| body | pairs | greatest | median | \
         alone, greatest | greatest jump |\n| --- | --- | --- | --- | --- | --- |\n",
    );
    for body in bodies()? {
        let vocabulary = everything(&body)?;
        let mut found: Vec<[f64; 3]> = Vec::new();
        for first in vocabulary.primitives() {
            for second in vocabulary.primitives() {
                let secs = first.at(&first.middle())?.duration_secs();
                let planned = |name: &str, start_secs: f64, priority: i32| Planned {
                    start_secs,
                    priority,
                    ..Planned::new(name)
                };
                let both = vec![
                    planned(first.name(), 0.0, 0),
                    planned(second.name(), 0.5 * secs, 1),
                ];
                let [together, jump] = accelerations(&vocabulary, both)?;
                let mut alone = 0.0_f64;
                for name in [first.name(), second.name()] {
                    alone = alone.max(accelerations(&vocabulary, vec![planned(name, 0.0, 0)])?[0]);
                }
                found.push([together, alone, jump]);
            }
        }
        let column = |k: usize| -> Vec<f64> { found.iter().map(|f| f[k]).collect() };
        writeln!(
            out,
            "| {} | {} | {:.0} | {:.0} | {:.0} | {:.1e} |",
            body.name(),
            found.len(),
            quantile(&column(0), 1.0),
            quantile(&column(0), 0.5),
            quantile(&column(1), 1.0),
            quantile(&column(2), 1.0)
        )?;
    }
    Ok(())
}

/// The greatest acceleration, and the greatest step of a coordinate that its velocities do not explain.
fn accelerations(vocabulary: &Vocabulary, behaviors: Vec<Planned>) -> Result<[f64; 2]> {
    let plan = Plan {
        rate_hz: FINE_HZ,
        seconds: 4.0,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors,
        rules: Vec::new(),
    };
    let start = standing(vocabulary, &plan)?;
    let mut controller = Controller::new(vocabulary, &plan, &start, &ControlSettings::default())?;
    let (mut most, mut jump) = (0.0_f64, 0.0_f64);
    let mut before = controller.command().clone();
    while !controller.finished() {
        let now = controller.tick(None, None).clone();
        for c in 0..now.pose.len() {
            most = most.max(now.acceleration[c].abs());
            let explained = 0.5 * (before.velocity[c] + now.velocity[c]) / FINE_HZ;
            jump = jump.max((now.pose[c] - before.pose[c] - explained).abs());
        }
        before = now;
    }
    Ok([most, jump])
}

fn pushes(out: &mut String) -> Result<()> {
    writeln!(
        out,
        "\n### A push of 50 N for 0.1 s at the wrist, sideways, at ten phases\n\nServos of 8 Hz are stiff: \
         the joint turned away most, median of the phases, is *farthest*. Left: the joint that is farthest from the flow half a second after the push, median and \
         worst, degrees (asked: 3).\n\n| body | movement | farthest | left, median | left, worst | within {:.0} | completed \
         |\n| --- | --- | --- | --- | --- | --- | --- |",
        BACK_RAD.to_degrees()
    )?;
    for body in bodies()? {
        let vocabulary = everything(&body)?;
        let mut robot = SimulatedRobot::humanoid(&body, &SimSettings::default())?;
        for (primitive, wrist) in PUSHED {
            let mut found = Vec::new();
            for k in 0..10 {
                let phase = 0.05 + 0.09 * f64::from(k);
                found.push(pushed(&mut robot, &vocabulary, primitive, wrist, phase)?);
            }
            let left: Vec<f64> = found.iter().map(|p| p.left_rad.to_degrees()).collect();
            let away: Vec<f64> = found.iter().map(|p| p.away_rad.to_degrees()).collect();
            writeln!(
                out,
                "| {} | {primitive} | {:.1} | {:.2} | {:.2} | {} of 10 | {} of 10 |",
                body.name(),
                quantile(&away, 0.5),
                quantile(&left, 0.5),
                quantile(&left, 1.0),
                found.iter().filter(|p| p.left_rad <= BACK_RAD).count(),
                found.iter().filter(|p| p.completed).count()
            )?;
        }
    }
    Ok(())
}

fn beginnings(out: &mut String) -> Result<()> {
    out.push_str(
        "\n### Begun in random postures within the joints' limits, in physics\n\n| body | postures | begun | completed | \
         farthest from the course's end, median / worst, degrees |\n| --- | --- | --- | --- | --- |\n",
    );
    for (name, postures) in POSTURES {
        let body = Arc::new(kineme::body(name)?);
        let vocabulary = everything(&body)?;
        let mut robot = SimulatedRobot::humanoid(&body, &SimSettings::default())?;
        let mut random = Pcg64::seed_from_u64(0);
        let (mut off, mut count) = (Vec::new(), 0);
        for _ in 0..postures {
            let from = posture(&body, &mut random);
            for primitive in vocabulary.primitives() {
                count += 1;
                let end = begun(&mut robot, &vocabulary, primitive.name(), &from)?;
                off.extend(end.map(f64::to_degrees));
            }
        }
        writeln!(
            out,
            "| {name} | {postures} | {count} | {} | {:.2} / {:.2} |",
            off.len(),
            quantile(&off, 0.5),
            quantile(&off, 1.0)
        )?;
    }
    Ok(())
}

fn sparring(out: &mut String, corpus: &Path) -> Result<()> {
    out.push_str(
        "\n### Sparring: Adonis in physics watches and answers with a shield\n\nOnset: from the beginning of the attack to \
         the moment when the answer begins. A false answer is one to anything else.\n\n| attacker | attacks | answered | \
         onset, median / p90, s | false answers | watched, minutes |\n| --- | --- | --- | --- | --- | --- |\n",
    );
    let [adonis, ares] = bodies()?;
    let mut robot = SimulatedRobot::humanoid(&adonis, &SimSettings::default())?;
    for (who, sparring) in sparring::choreographed(&ares, &mut robot)? {
        row(out, &who, &sparring)?;
    }
    for (who, sparring) in sparring::recorded(corpus, &ares, &mut robot)? {
        row(out, &who, &sparring)?;
    }
    Ok(())
}

fn row(out: &mut String, who: &str, sparring: &Sparring) -> Result<()> {
    let attacks = sparring.delays.len() + sparring.missed;
    writeln!(
        out,
        "| {who} | {attacks} | {} | {} | {} | {:.1} |",
        sparring.delays.len(),
        match attacks {
            0 => "-".into(),
            _ => format!(
                "{:.2} / {:.2}",
                quantile(&sparring.delays, 0.5),
                quantile(&sparring.delays, 0.9)
            ),
        },
        sparring.false_answers,
        sparring.seconds / 60.0
    )?;
    Ok(())
}

fn real_robot(out: &mut String, g1: Option<&Path>) -> Result<()> {
    out.push_str("\n### Unitree G1, pelvis welded\n\n");
    let Some(path) = g1.filter(|path| path.exists()) else {
        out.push_str("The robot was not there: `cargo xtask setup --robots` fetches it.\n");
        return Ok(());
    };
    let [_, ares] = bodies()?;
    let vocabulary = everything(&ares)?;
    let mut robot = robot(path)?;
    out.push_str(
        "| movements | seconds | error, degrees (at most) | torques at their limit | farthest beyond a joint's limit, \
         degrees |\n| --- | --- | --- | --- | --- |\n",
    );
    for (what, primitives) in [
        (
            "waves",
            &["wave-up", "wave-down", "wave-across", "wave-return"][..],
        ),
        ("jabs", &["jab", "hook", "uppercut", "jab"]),
        ("twists", &["twist-left", "twist-right", "twist-left"]),
    ] {
        let done = routine(&vocabulary, primitives, &mut robot)?;
        writeln!(
            out,
            "| {what} | {:.1} | {:.3} ({:.2}) | {:.2} % | {:.3} |",
            done.done.duration_secs(),
            done.tracking.rms_rad.to_degrees(),
            done.tracking.max_rad.to_degrees(),
            100.0 * done.effort.saturated as f64 / done.effort.torques.max(1) as f64,
            beyond_limits(&done.done).max(0.0).to_degrees()
        )?;
    }
    Ok(())
}

/// How fast bodies are simulated and how long our own work takes: of the machine that runs it.
///
/// # Errors
/// When a simulation fails.
pub fn speed_table() -> Result<String> {
    let mut out = String::from(
        "| body | x real time, physics included | our work of a tick, median / p99 / greatest, µs |\n| --- | --- | --- |\n",
    );
    for body in bodies()? {
        let found = speed(&body)?;
        let [median, p99, most] = found.tick_us;
        writeln!(
            out,
            "| {} ({} DOF) | {:.1} | {median:.1} / {p99:.1} / {most:.1} |",
            body.name(),
            body.dof(),
            found.real_time_factor
        )?;
    }
    writeln!(
        out,
        "\nThree behaviors share the body at {RATE_HZ} Hz: a wave of one arm, a twist of the trunk, jabs of the other arm. \
         Physics steps of 1 ms; one thread."
    )?;
    Ok(out)
}
