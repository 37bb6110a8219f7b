//! The show of the demo: two bodies perform a routine, one spars, and both classifiers read what they see.

use std::sync::Arc;

use kineme::control::{ControlSettings, Controller, KinematicRobot, Plan, Robot};
use kineme::interaction::{Performance, Session, SessionSettings, standing};
use kineme::perception::encoding::{EffectorPaths, Encoder, Encoding, EncodingSettings};
use kineme::perception::{Filter, FilterSettings, Restriction, calibrated};
use kineme::primitive::{Observations, Reading, Recogniser, readings};
use kineme::{Motion, Root, Skeleton, Vocabulary};
use rayon::prelude::*;

use crate::choreographies::{SCRIPTS, choreography, everything};
use crate::sets::Result;
use crate::sparring::{Attacker, attacker};

const ROUTINE: &str = include_str!("../../../choreography/plans/routine.toml");
const SPARRING: &str = include_str!("../../../choreography/plans/sparring.toml");
/// What the sparring partner attacks with, and how often.
const ATTACKS: [&str; 4] = ["jab", "hook", "uppercut", "elbow"];
const ATTACKS_COUNT: usize = 4;
/// How far apart partners stand, metres.
const APART_M: f64 = 1.3;

/// What the show needs to know of, as it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Act {
    /// Primitives of the written exemplars.
    Learning,
    /// The routine.
    Routine,
    /// The sparring.
    Sparring,
    /// What the classifiers make of it.
    Reading,
}

impl Act {
    /// As a line of progress says it.
    pub fn name(self) -> &'static str {
        match self {
            Act::Learning => "making primitives of written exemplars",
            Act::Routine => "moving Adonis and Ares",
            Act::Sparring => "sparring",
            Act::Reading => "reading back what was seen",
        }
    }
}

/// A show, as it came out.
#[derive(Debug, Clone)]
pub struct Show {
    /// The primitives of the paper's movements, of Ares.
    pub movements: Vocabulary,
    /// Those of boxing.
    pub boxing: Vocabulary,
    /// Whether bodies were simulated; else they were where they were told to be.
    pub physics: bool,
    /// The routine by Adonis and by Ares.
    pub routine: [Performance; 2],
    /// What the filter thought of Ares' routine, frame by frame.
    pub readings: Vec<Reading>,
    /// The same part by part.
    pub parts: Vec<PartRead>,
    /// The same routine by its hands alone.
    pub encoding: Encoding,
    /// Who attacked.
    pub attacker: Attacker,
    /// What Adonis did about it.
    pub bout: Performance,
    /// What the filter thought of the attacker.
    pub heard: Vec<Reading>,
}

/// What was read of a part of the body.
#[derive(Debug, Clone)]
pub struct PartRead {
    /// The names of its parts, as the plan has them.
    pub names: Vec<String>,
    /// The primitives that move it, restricted to it.
    pub vocabulary: Vocabulary,
    /// What the filter thought of it, frame by frame.
    pub readings: Vec<Reading>,
}

/// The plans of the show: what their files are called, and what they say.
pub const PLANS: [(&str, &str); 2] = [("routine.toml", ROUTINE), ("sparring.toml", SPARRING)];

/// A body in physics where that is built in.
fn robot(body: &Arc<Skeleton>) -> Result<Box<dyn Robot>> {
    if cfg!(feature = "sim") {
        #[cfg(feature = "sim")]
        return Ok(Box::new(kineme_sim::SimulatedRobot::humanoid(
            body,
            &kineme_sim::SimSettings::default(),
        )?));
    }
    Ok(Box::new(KinematicRobot::new(Arc::clone(body))))
}

fn plan((file, text): (&str, &str)) -> Result<Plan> {
    Ok(kineme_formats::plan::parse(file, text.as_bytes())?.plan)
}

/// Puts the show on; `watch` hears of every act as it begins.
///
/// # Errors
/// When an embedded script or plan is not sound, or a simulation fails.
pub fn show(seed: u64, watch: &mut dyn FnMut(Act)) -> Result<Show> {
    watch(Act::Learning);
    let ares = Arc::new(kineme::ares()?);
    let adonis = Arc::new(kineme::adonis()?);
    let movements = calibrated(everything(&ares)?, None)?;
    let (name, text) = SCRIPTS[0];
    let boxing = calibrated(choreography(name, text, &ares)?, None)?;

    watch(Act::Routine);
    let routine = plan(PLANS[0])?;
    let mut performed = Vec::new();
    let mut physics = true;
    for body in [&adonis, &ares] {
        let mut robot = robot(body)?;
        physics &= robot.is_physical();
        performed.push(perform(
            &movements,
            &routine,
            &mut *robot,
            None,
            body.name(),
        )?);
    }
    let [by_adonis, by_ares]: [Performance; 2] = performed.try_into().map_err(|_| "two bodies")?;

    watch(Act::Sparring);
    let attacker = facing(attacker(&boxing, &ATTACKS, ATTACKS_COUNT, seed)?)?;
    let filter = Filter::new(&boxing, &FilterSettings::default())?;
    let mut bout = plan(PLANS[1])?;
    bout.seconds = attacker.seen.motion().duration_secs();
    let watched = Some((&filter as &dyn Recogniser, &attacker.seen));
    let bout = perform(&boxing, &bout, &mut *robot(&adonis)?, watched, "adonis")?;
    let heard = readings(&filter, &attacker.seen)?;

    watch(Act::Reading);
    let seen = Observations::complete(by_ares.done.clone());
    let whole = || -> Result<Vec<Reading>> {
        let filter = Filter::new(&movements, &seldom())?;
        Ok(readings(&filter, &seen)?)
    };
    let of_parts = || -> Result<Vec<PartRead>> {
        let parts = parts_of(&routine).into_par_iter();
        parts.map(|names| read(&movements, names, &seen)).collect()
    };
    let (readings, parts) = rayon::join(whole, of_parts);
    let (readings, parts) = (readings?, parts?);
    let settings = EncodingSettings::default();
    let encoder = Encoder::new(&movements, &settings)?;
    let paths =
        EffectorPaths::of_motion(&by_ares.done, &settings.effectors, settings.heading_secs)?;
    let encoding = encoder.encode("routine", &paths)?;
    Ok(Show {
        physics,
        routine: [by_adonis, by_ares],
        readings,
        parts,
        encoding,
        attacker,
        bout,
        heard,
        movements: movements.clone(),
        boxing: boxing.clone(),
    })
}

/// The parts of the body to which a plan gives movements of their own, in its order.
fn parts_of(plan: &Plan) -> Vec<Vec<String>> {
    let mut parts: Vec<Vec<String>> = Vec::new();
    for planned in &plan.behaviors {
        if !planned.joints.is_empty() && !parts.contains(&planned.joints) {
            parts.push(planned.joints.clone());
        }
    }
    parts
}

/// Half as many looks as usual: thirteen primitives are looked for time and again, and nobody acts on the answers.
fn seldom() -> FilterSettings {
    let usual = FilterSettings::default();
    FilterSettings {
        clock_hz: 0.5 * usual.clock_hz,
        ..usual
    }
}

/// What is recognised of a part of the body.
fn read(vocabulary: &Vocabulary, names: Vec<String>, seen: &Observations) -> Result<PartRead> {
    // Of what is learned by leaving exemplars out a stream needs but one number, for which the usual one serves; to learn
    // it takes longer than all that is asked here.
    let restriction = Restriction::new(vocabulary, &names)?;
    let filter = Filter::new(restriction.vocabulary(), &seldom())?;
    let readings = readings(&restriction.recogniser(Box::new(filter)), seen)?;
    Ok(PartRead {
        names,
        vocabulary: restriction.vocabulary().clone(),
        readings,
    })
}

fn perform(
    vocabulary: &Vocabulary,
    plan: &Plan,
    robot: &mut dyn Robot,
    watched: Option<(&dyn Recogniser, &Observations)>,
    name: &str,
) -> Result<Performance> {
    let start = standing(vocabulary, plan)?;
    let controller = Controller::new(vocabulary, plan, &start, &ControlSettings::default())?;
    let recogniser = watched.map(|(recogniser, _)| recogniser);
    let mut session = Session::new(controller, robot, recogniser, &SessionSettings::default())?;
    session.run(watched.map(|(_, seen)| seen), &mut |_| {})?;
    Ok(session.performance(name)?)
}

/// The attacker opposite whoever stands at the origin.
fn facing(attacker: Attacker) -> Result<Attacker> {
    let motion = attacker.seen.motion();
    let roots = (0..motion.frames()).map(|f| {
        let mut root = *motion.root(f);
        root.position.x = APART_M - root.position.x;
        root.position.y = -root.position.y;
        root.yaw += std::f64::consts::PI;
        root
    });
    let roots: Vec<Root> = roots.collect();
    let turned = Motion::new(
        motion.name(),
        Arc::clone(motion.skeleton()),
        motion.rate_hz(),
        motion.poses().to_vec(),
        roots,
    )?;
    Ok(Attacker {
        seen: Observations::complete(turned),
        ..attacker
    })
}
