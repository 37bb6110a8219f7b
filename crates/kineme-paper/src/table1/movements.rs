//! The first data set: what Ares did when it was told to make movements of the five behaviours, one after the other.

use std::sync::Arc;

use kineme::control::{
    Aiming, Arbitration, ControlSettings, Controller, Place, Plan, Planned, Robot,
};
use kineme::interaction::{Session, SessionSettings, standing};
use kineme::primitive::{Course, Observations, Primitive};
use kineme::{Skeleton, Vocabulary};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::clip::Clip;
use crate::sets::Result;

/// Commands a second, and frames of what comes of them.
pub const RATE_HZ: f64 = 120.0;
/// Drawn parameters are at least so far from every exemplar's in one of them, of a range of 1.
pub const APART: f64 = 0.05;
/// A movement is joined once every joint is so near to f(p, phase), degrees.
pub const JOINED_DEG: f64 = 5.0;
/// Of those who follow one another, so many wait for a rest of so many seconds, and so many do not wait for the end.
const RESTING: f64 = 0.25;
const RESTS_SECS: [f64; 2] = [0.2, 1.0];
const INTERRUPTING: f64 = 0.25;
const INTERRUPTED_AT: [f64; 2] = [0.5, 0.9];

/// How much is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovementSettings {
    /// Plans.
    pub clips: usize,
    /// Movements of each.
    pub movements: usize,
    /// Seed of what is drawn.
    pub seed: u64,
}

/// Parameters in [0, 1]^m that are those of no exemplar.
pub fn drawn(primitive: &Primitive, random: &mut Pcg64) -> Vec<f64> {
    loop {
        let p: Vec<f64> = primitive.middle().iter().map(|_| random.random()).collect();
        let apart = |e: usize| {
            let gaps = primitive.point(e).iter().zip(&p);
            gaps.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) >= APART
        };
        if (0..primitive.exemplars().len()).all(apart) {
            return p;
        }
    }
}

/// A plan of so many movements, drawn with their parameters. Half of them begin as soon as the one before has ended, a
/// quarter after a rest, and a quarter interrupt the one before, which then goes on where it was.
///
/// # Errors
/// Of no valid vocabulary.
pub fn plan(vocabulary: &Vocabulary, movements: usize, random: &mut Pcg64) -> Result<Plan> {
    let primitives = vocabulary.primitives();
    let mut behaviors: Vec<Planned> = Vec::new();
    // When all that was planned so far is over, about: who comes early waits, for priorities are equal.
    let mut over = 0.8;
    let (mut begun, mut lasts) = (0.3, 0.0);
    for k in 0..movements {
        let primitive = &primitives[random.random_range(0..primitives.len())];
        let p = drawn(primitive, random);
        let secs = primitive.at(&p)?.duration_secs();
        let draw: f64 = random.random();
        let interrupts = k > 0 && draw < INTERRUPTING;
        let start_secs = if interrupts {
            begun + lasts * random.random_range(INTERRUPTED_AT[0]..INTERRUPTED_AT[1])
        } else if k > 0 && draw < INTERRUPTING + RESTING {
            over + random.random_range(RESTS_SECS[0]..RESTS_SECS[1])
        } else {
            over.max(begun)
        };
        behaviors.push(Planned {
            start_secs,
            aim: Aiming::Parameters(primitive.parameters().from_unit(&p)),
            priority: i32::from(interrupts),
            ..Planned::new(primitive.name())
        });
        // Joining from another posture takes about half a second more.
        over = if interrupts {
            over + secs + 1.0
        } else {
            start_secs + secs + f64::from(u8::from(k == 0)) * 0.5
        };
        (begun, lasts) = (start_secs, secs);
    }
    Ok(Plan {
        rate_hz: RATE_HZ,
        seconds: over + 1.0,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors,
        rules: Vec::new(),
    })
}

/// Carries a plan out. What the body really did, and which behaviour each frame belongs to: the one that moves most of
/// its joints, from the moment on at which every joint was told to be within 5 degrees of f(p, phase). What comes
/// before that (the way from another movement's midst, or from standing) is a transition, and nothing is running in a
/// rest: both are none of the behaviours.
///
/// # Errors
/// When the robot cannot do what it is told.
pub fn perform(
    name: &str,
    vocabulary: &Vocabulary,
    plan: &Plan,
    robot: &mut dyn Robot,
) -> Result<Clip> {
    let mut movements = Vec::new();
    for planned in &plan.behaviors {
        let number = vocabulary
            .primitives()
            .iter()
            .position(|p| p.name() == planned.primitive)
            .ok_or("a behaviour of another vocabulary")?;
        let primitive = &vocabulary.primitives()[number];
        let p = match &planned.aim {
            Aiming::Parameters(values) => primitive.parameters().to_unit(values)?,
            _ => primitive.middle(),
        };
        movements.push(Movement {
            primitive: number,
            course: primitive.at(&p)?,
            joined: false,
        });
    }
    let start = standing(vocabulary, plan)?;
    let controller = Controller::new(vocabulary, plan, &start, &ControlSettings::default())?;
    let mut session = Session::new(controller, robot, None, &SessionSettings::default())?;
    let mut truth = Vec::new();
    while !session.finished() {
        session.tick()?;
        truth.push(running(session.controller(), &mut movements));
    }
    Ok(Clip {
        name: name.into(),
        seen: Observations::complete(session.performance(name)?.done),
        truth,
    })
}

struct Movement {
    primitive: usize,
    course: Course,
    joined: bool,
}

/// The primitive that runs and has been joined.
fn running(controller: &Controller, movements: &mut [Movement]) -> Option<usize> {
    let mut shown = None;
    let mut heard = vec![false; movements.len()];
    for active in controller.active() {
        let Place::Behavior(i) = active.planned else {
            continue;
        };
        if active.weight <= 0.5 {
            continue;
        }
        heard[i] = true;
        let movement = &mut movements[i];
        let goal = movement.course.pose(active.phase);
        let told = &controller.command().pose;
        movement.joined |= farthest(controller.body(), told, &goal) <= JOINED_DEG.to_radians();
        if movement.joined {
            shown = Some(movement.primitive);
        }
    }
    for (movement, heard) in movements.iter_mut().zip(heard) {
        movement.joined &= heard;
    }
    shown
}

/// The greatest angle between the joints of two postures.
fn farthest(body: &Skeleton, a: &[f64], b: &[f64]) -> f64 {
    let joints = (0..body.joints().len()).map(|j| body.coordinates(j));
    let angles = joints.enumerate().filter(|(_, at)| !at.is_empty());
    angles
        .map(|(j, at)| {
            let one = body.rotation(j, &a[at.clone()]);
            one.angle_to(&body.rotation(j, &b[at]))
        })
        .fold(0.0, f64::max)
}

/// The first data set: plans that are drawn, each carried out by a robot of its own.
///
/// # Errors
/// When a robot cannot do what it is told.
pub fn movements(
    vocabulary: &Vocabulary,
    settings: &MovementSettings,
    robot: &(dyn Fn() -> Result<Box<dyn Robot>> + Sync),
) -> Result<Vec<Clip>> {
    let one = |k: usize| -> Result<Clip> {
        let mut random = Pcg64::seed_from_u64(settings.seed ^ ((k as u64) << 32));
        let plan = plan(vocabulary, settings.movements, &mut random)?;
        perform(&format!("movements {k}"), vocabulary, &plan, &mut *robot()?)
    };
    (0..settings.clips).into_par_iter().map(one).collect()
}

/// A robot of this body: in physics where that is built in, else one that is where it is told to be.
///
/// # Errors
/// When the engine refuses the body.
pub fn ready_made(body: &Arc<Skeleton>) -> Result<Box<dyn Robot>> {
    #[cfg(feature = "sim")]
    let robot = kineme_sim::SimulatedRobot::humanoid(body, &kineme_sim::SimSettings::default())?;
    #[cfg(not(feature = "sim"))]
    let robot = kineme::control::KinematicRobot::new(Arc::clone(body));
    Ok(Box::new(robot))
}
