//! The sparring loop: an attacker is watched, recognised and answered.

use std::path::Path;
use std::sync::Arc;

use kineme::alignment::{Trim, resting_ends};
use kineme::choreography::perform;
use kineme::control::{
    Arbitration, ControlSettings, Controller, Inertialization, Manner, Place, Plan, Planned, Robot,
    Rule, State, Synthesizer,
};
use kineme::interaction::{Session, SessionSettings};
use kineme::motion::landmark_dims;
use kineme::perception::{Filter, FilterSettings, calibrated};
use kineme::primitive::{Observations, Recogniser, Transitions};
use kineme::{Motion, Root, Skeleton, Vocabulary};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::choreographies::{SCRIPTS, choreography};
use crate::recognition::corpora::{Part, UTD, corpora};
use crate::recognition::known::primitives;
use crate::sets::Result;

const ANIMATIONS: &str = include_str!("../../../choreography/animations.toml");

/// Frames a second at which attackers are seen.
const SEEN_HZ: f64 = 60.0;
/// Frames a second at which the answering body is told what to do.
const TOLD_HZ: f64 = 120.0;
/// Attackers rest between attacks for so long, seconds, least and most.
const PAUSES_SECS: [f64; 2] = [0.6, 1.4];
/// An answer belongs to an attack until so long after its end, seconds.
const LATE_SECS: f64 = 0.5;

/// An attack, as the attacker knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Attack {
    /// Which primitive.
    pub primitive: String,
    /// When it begins, seconds.
    pub start_secs: f64,
    /// When it ends.
    pub end_secs: f64,
}

/// Somebody who is watched.
#[derive(Debug, Clone)]
pub struct Attacker {
    /// What is seen.
    pub seen: Observations,
    /// What is to be answered; nothing else is.
    pub attacks: Vec<Attack>,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sparring {
    /// Of each attack that was answered, seconds from its onset to the answer's.
    pub delays: Vec<f64>,
    /// Attacks that were not answered.
    pub missed: usize,
    /// Answers to nothing.
    pub false_answers: usize,
    /// How long was watched, seconds.
    pub seconds: f64,
}

/// An attacker who does so many of these primitives, each as often as the others, drawn with their parameters, from a
/// posture and back to it, with pauses between.
///
/// # Errors
/// When the vocabulary has no such primitive.
pub fn attacker(
    vocabulary: &Vocabulary,
    primitives: &[&str],
    attacks: usize,
    seed: u64,
) -> Result<Attacker> {
    let mut random = Pcg64::seed_from_u64(seed);
    let pause = |random: &mut Pcg64| {
        let secs = random.random_range(PAUSES_SECS[0]..PAUSES_SECS[1]);
        (secs * SEEN_HZ).round() as usize
    };
    let body = vocabulary.body();
    let guard = vocabulary.primitive(primitives[0])?;
    let guard = guard.at(&guard.middle())?.pose(0.0);
    let start = State::resting(guard, Root::ORIGIN);
    let mut synthesizer = Synthesizer::new(
        Arc::clone(body),
        SEEN_HZ,
        &start,
        Inertialization::default(),
    )?;
    let mut poses = synthesizer.command().pose.clone();
    let mut roots = vec![synthesizer.command().root];
    let mut tick = |synthesizer: &mut Synthesizer| {
        let command = synthesizer.step();
        poses.extend_from_slice(&command.pose);
        roots.push(command.root);
        roots.len() as f64 / SEEN_HZ
    };
    let (mut done, mut deck) = (Vec::new(), Vec::new());
    for _ in 0..attacks {
        let mut now = 0.0;
        for _ in 0..pause(&mut random) {
            now = tick(&mut synthesizer);
        }
        if deck.is_empty() {
            deck = primitives.to_vec();
            deck.shuffle(&mut random);
        }
        let Some(name) = deck.pop() else {
            break;
        };
        let primitive = vocabulary.primitive(name)?;
        let p: Vec<f64> = primitive.middle().iter().map(|_| random.random()).collect();
        synthesizer.start(Arc::new(primitive.at(&p)?), &Manner::default())?;
        let start_secs = now;
        while !synthesizer.command().finished {
            now = tick(&mut synthesizer);
        }
        done.push(Attack {
            primitive: name.into(),
            start_secs,
            end_secs: now,
        });
    }
    for _ in 0..pause(&mut random) {
        tick(&mut synthesizer);
    }
    let motion = Motion::new("attacker", Arc::clone(body), SEEN_HZ, poses, roots)?;
    Ok(Attacker {
        seen: Observations::complete(motion),
        attacks: done,
    })
}

/// Rules that answer each of these primitives with another one.
pub fn rules(attacks: &[&str], answer: &str) -> Vec<Rule> {
    let then = Planned::new(answer);
    let rule = |when: &&str| Rule {
        when: (*when).into(),
        then: then.clone(),
    };
    attacks.iter().map(rule).collect()
}

/// Lets a robot watch somebody and answer by the rules.
///
/// # Errors
/// When the rules name no primitives of the vocabulary, or the robot cannot do what it is told.
pub fn spar(
    vocabulary: &Vocabulary,
    recogniser: &dyn Recogniser,
    rules: &[Rule],
    attacker: &Attacker,
    robot: &mut dyn Robot,
) -> Result<Sparring> {
    let seconds = attacker.seen.motion().duration_secs();
    let plan = Plan {
        rate_hz: TOLD_HZ,
        seconds,
        arbitration: Arbitration::Priority,
        observed: None,
        behaviors: Vec::new(),
        rules: rules.to_vec(),
    };
    plan.check(vocabulary, Some(recogniser.vocabulary()))?;
    let start = State::resting(vocabulary.body().neutral(), Root::ORIGIN);
    let controller = Controller::new(vocabulary, &plan, &start, &ControlSettings::default())?;
    let mut session = Session::new(
        controller,
        robot,
        Some(recogniser),
        &SessionSettings::default(),
    )?;
    session.run(Some(&attacker.seen), &mut |_| {})?;
    let performance = session.performance("sparring")?;
    let answers: Vec<f64> = performance
        .ran
        .iter()
        .filter(|ran| matches!(ran.planned, Place::Rule(_)))
        .map(|ran| ran.start_secs)
        .collect();
    Ok(judged(&attacker.attacks, &answers, seconds))
}

/// Answers beside attacks: the first answer from an attack's onset until shortly after its end answers it.
fn judged(attacks: &[Attack], answers: &[f64], seconds: f64) -> Sparring {
    let mut sparring = Sparring {
        seconds,
        ..Sparring::default()
    };
    let mut used = vec![false; answers.len()];
    for (k, attack) in attacks.iter().enumerate() {
        let next = attacks.get(k + 1).map_or(f64::INFINITY, |a| a.start_secs);
        let until = (attack.end_secs + LATE_SECS).min(next);
        let mut found = None;
        for (answer, used) in answers.iter().zip(&mut used) {
            if (attack.start_secs..until).contains(answer) {
                // A second answer to the same attack is not a false one.
                *used = true;
                found = found.or(Some(answer - attack.start_secs));
            }
        }
        match found {
            Some(delay) => sparring.delays.push(delay),
            None => sparring.missed += 1,
        }
    }
    sparring.false_answers = used.iter().filter(|u| !**u).count();
    sparring
}

/// What attackers of the boxing vocabulary do, and what answers them.
const ATTACKS: [&str; 4] = ["jab", "hook", "uppercut", "elbow"];
const ANSWER: &str = "shield";
/// Choreographed attackers, and attacks of each.
const ATTACKERS: u64 = 5;
const ATTACKS_EACH: usize = 20;

/// Attackers who box as the choreography does with parameters of their own, and the animations, which are no attack.
///
/// # Errors
/// When the robot cannot do what it is told.
pub fn choreographed(
    body: &Arc<Skeleton>,
    robot: &mut dyn Robot,
) -> Result<Vec<(String, Sparring)>> {
    let (name, text) = SCRIPTS[0];
    let vocabulary = calibrated(choreography(name, text, body)?, None)?;
    let filter = Filter::new(&vocabulary, &FilterSettings::default())?;
    let rules = rules(&ATTACKS, ANSWER);
    let mut boxing = Sparring::default();
    for seed in 0..ATTACKERS {
        let attacker = attacker(&vocabulary, &ATTACKS, ATTACKS_EACH, seed)?;
        boxing = boxing.and(spar(&vocabulary, &filter, &rules, &attacker, robot)?);
    }
    let file = "animations.toml";
    let script = kineme_formats::script::parse(file, ANIMATIONS.as_bytes())?;
    let mut others = Sparring::default();
    for animation in &script.animations {
        let motion = perform(&animation.name, &animation.keys, body, SEEN_HZ)?;
        let nobody = Attacker {
            seen: Observations::complete(motion),
            attacks: Vec::new(),
        };
        others = others.and(spar(&vocabulary, &filter, &rules, &nobody, robot)?);
    }
    Ok(vec![
        ("choreographed boxing".into(), boxing),
        (
            format!("{} animations that are no attack", script.animations.len()),
            others,
        ),
    ])
}

/// People of UTD-MHAD who were not learned from: those who box attack, those who do anything else do not.
///
/// # Errors
/// When the corpus lacks a file, or the robot cannot do what it is told.
pub fn recorded(
    corpus: &Path,
    body: &Arc<Skeleton>,
    robot: &mut dyn Robot,
) -> Result<Vec<(String, Sparring)>> {
    const BOXING: &str = "boxing";
    let utd = corpora(corpus, body, &[UTD], Part::WHOLE)?.remove(0);
    let split = &utd.splits[0];
    let mut known: Vec<_> = primitives(&utd.set, &split.train)?
        .into_iter()
        .flatten()
        .collect();
    let (name, text) = SCRIPTS[0];
    known.push(choreography(name, text, body)?.primitive(ANSWER)?.clone());
    let transitions = Transitions::none(known.len());
    let vocabulary = Vocabulary::new(Arc::clone(body), known, Vec::new(), transitions)?;
    let vocabulary = calibrated(vocabulary, None)?;
    let filter = Filter::new(&vocabulary, &FilterSettings::default())?;
    let rules = rules(&[BOXING], ANSWER);
    let (mut boxing, mut others) = (Sparring::default(), Sparring::default());
    for &clip in &split.test {
        let motion = &utd.set.motions[clip];
        let attacks = if utd.set.classes[utd.set.labels[clip]] == BOXING {
            let dims = landmark_dims(motion.skeleton());
            let rate = motion.rate_hz();
            let moving = resting_ends(&motion.landmarks(), dims, rate, &Trim::default());
            vec![Attack {
                primitive: BOXING.into(),
                start_secs: moving.start as f64 / rate,
                end_secs: moving.end as f64 / rate,
            }]
        } else {
            Vec::new()
        };
        let attacker = Attacker {
            seen: Observations::complete(motion.clone()),
            attacks,
        };
        let came = spar(&vocabulary, &filter, &rules, &attacker, robot)?;
        match attacker.attacks.is_empty() {
            false => boxing = boxing.and(came),
            true => others = others.and(came),
        }
    }
    Ok(vec![
        ("people boxing (UTD-MHAD, subjects 5 and 7)".into(), boxing),
        ("the same people, 26 other actions".into(), others),
    ])
}

impl Sparring {
    /// Both together.
    pub fn and(mut self, other: Sparring) -> Sparring {
        self.delays.extend(other.delays);
        self.missed += other.missed;
        self.false_answers += other.false_answers;
        self.seconds += other.seconds;
        self
    }
}
