//! The out-and-back test: a wave that returns through the postures that it left by, followed by both kinds of field.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use kineme::choreography::{Key, Script, ScriptExemplar, perform};
use kineme::primitive::{Course, Exemplar, FlowSettings, Flowfield, Memory, Modelling, Primitive};
use kineme::skeleton::Skeleton;
use kineme::{Role, Root};
use kineme_formats::script;
use nalgebra::Vector3;

use crate::sets::Result;

const WAVES: &str = include_str!("../../../choreography/horizontal-waving.toml");
/// Rate of the exemplars and of the steps.
const RATE_HZ: f64 = 60.0;
/// A wave that has not come back after so many times its duration has stalled.
const PATIENCE: f64 = 2.0;
/// Share of the way that the wrist must have gone out, and of it that may be left when it is back.
const OUT: f64 = 0.8;
const BACK: f64 = 0.2;

/// How a wave comes back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Return {
    /// As people wave: by the script's return, in which the hand stays behind the arm to the other side.
    Choreographed,
    /// Through the very postures that it left by, in reverse.
    Reversed,
}

/// What became of waves that were followed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Waves {
    /// How many.
    pub followed: usize,
    /// Those whose wrist went out at least 80 % of the way and came back within 20 %, in twice the wave's duration.
    pub completed: usize,
    /// Those whose wrist never went out 80 % of the way.
    pub never_out: usize,
    /// Mean over waves of how far out the wrist was, as a share of the way, at most 1.
    pub reached: f64,
}

/// Waves across and back as one movement: those of the script, in its order, each with its return.
///
/// # Errors
/// When a wave across has no return.
pub fn waves(back: Return) -> Result<Vec<Exemplar>> {
    let script = script::parse("horizontal-waving.toml", WAVES.as_bytes())?;
    let body = Arc::new(kineme::body(&script.body)?);
    joined(&script, back)?
        .into_iter()
        .map(|wave| {
            let motion = perform("wave", &wave.keys, &body, RATE_HZ)?;
            let adverbs = wave.parameters.into_values().collect();
            Ok(Exemplar::whole(motion, Some(adverbs)))
        })
        .collect()
}

/// A wave across with its return behind it.
struct Wave {
    parameters: BTreeMap<String, f64>,
    keys: Vec<Key>,
}

/// Each wave across of the script with a return.
fn joined(script: &Script, back: Return) -> Result<Vec<Wave>> {
    let (across, home): (Vec<_>, Vec<_>) = script
        .exemplars
        .iter()
        .partition(|e| e.primitive == "wave-across");
    let join = |out: &&ScriptExemplar| {
        let turn = out.keys.last().map_or(0.0, |k| k.time);
        let mut keys = out.keys.clone();
        match back {
            Return::Choreographed => {
                let own = home.iter().find(|h| h.parameters == out.parameters);
                let own = own.ok_or("a wave across without its return")?;
                keys.extend(own.keys.iter().skip(1).map(|k| Key {
                    time: turn + k.time,
                    ..k.clone()
                }));
            }
            Return::Reversed => {
                keys.extend(whole(&out.keys).into_iter().rev().skip(1).map(|k| Key {
                    time: 2.0 * turn - k.time,
                    ..k
                }))
            }
        }
        Ok(Wave {
            parameters: out.parameters.clone(),
            keys,
        })
    };
    across.iter().map(join).collect()
}

/// Keys that say every angle, also where it has not changed.
fn whole(keys: &[Key]) -> Vec<Key> {
    let mut angles = BTreeMap::new();
    let filled = keys.iter().map(|k| {
        angles.extend(k.angles.clone());
        Key {
            time: k.time,
            angles: angles.clone(),
        }
    });
    filled.collect()
}

/// Follows the field of this kind from the first posture of waves, told which wave is wanted: each exemplar left out of
/// the model in turn, and a lattice of parameters of the model of all.
///
/// # Errors
/// When a model cannot be made.
pub fn follow_waves(back: Return, memory: Memory) -> Result<Waves> {
    let exemplars = waves(back)?;
    let settings = FlowSettings {
        memory,
        ..FlowSettings::default()
    };
    let modelling = Modelling {
        cyclic: Some(false),
        ..Modelling::default()
    };
    let mut rollouts = Vec::new();
    for i in 0..exemplars.len() {
        let mut others = exemplars.clone();
        let left_out = others.remove(i);
        let primitive = Primitive::learn("wave", others, &modelling)?;
        let field = Flowfield::of(&primitive, &settings)?;
        let adverbs = left_out.adverbs.as_deref().unwrap_or_default();
        let p = primitive.parameters().to_unit(adverbs)?;
        rollouts.push(rollout(
            &field,
            &primitive.at(&p)?,
            left_out.motion.pose(0),
        )?);
    }
    let primitive = Primitive::learn("wave", exemplars, &modelling)?;
    let field = Flowfield::of(&primitive, &settings)?;
    for k in 0..25 {
        let course = primitive.at(&[0.25 * (k / 5) as f64, 0.25 * (k % 5) as f64])?;
        rollouts.push(rollout(&field, &course, &course.pose(0.0))?);
    }
    let count = |f: &dyn Fn(&(f64, bool)) -> bool| rollouts.iter().filter(|r| f(r)).count();
    Ok(Waves {
        followed: rollouts.len(),
        completed: count(&|r| r.1),
        never_out: count(&|r| r.0 < OUT),
        reached: rollouts.iter().map(|r| r.0.min(1.0)).sum::<f64>() / rollouts.len() as f64,
    })
}

/// From this posture along the course that is wanted: how far out the wrist went as a share of the course's way, and
/// whether it came back then.
fn rollout(field: &Flowfield, course: &Course, start: &[f64]) -> Result<(f64, bool)> {
    let body = field.body();
    let end = wrist(body, &course.pose(1.0));
    let away = |pose: &[f64]| (wrist(body, pose) - end).norm();
    let phases = (0..=100).map(|i| 0.01 * i as f64);
    let whole = phases
        .map(|phase| away(&course.pose(phase)))
        .fold(0.0, f64::max);
    let state = field.enter(start)?.with_parameters(course.parameters())?;
    let (mut out, mut back) = (0.0_f64, false);
    for state in field.predict(&state, PATIENCE * course.duration_secs(), RATE_HZ)? {
        let share = away(state.pose()) / whole;
        out = out.max(share);
        back |= out >= OUT && share <= BACK;
    }
    Ok((out, back))
}

/// The right wrist against the root, metres.
fn wrist(body: &Skeleton, pose: &[f64]) -> Vector3<f64> {
    let frames = body.frames(pose, &Root::ORIGIN);
    let joint = body.joints_of(Role::RightHand).first().copied();
    frames[joint.unwrap_or(0)].position
}

/// Writes the table of the out-and-back test.
///
/// # Errors
/// When a model cannot be made.
pub fn out_and_back_table(out: &mut String) -> Result<()> {
    writeln!(
        out,
        "\n### Out and back: the horizontal wave, across and back as one movement\n\n| way back | field | waves | completed | stalled | of these never out 80 % of the way | mean way out |\n| --- | --- | --- | --- | --- | --- | --- |"
    )?;
    for (way, back) in [
        ("choreographed", Return::Choreographed),
        ("the same, reversed", Return::Reversed),
    ] {
        for (name, memory) in [("**phase**", Memory::Phase), ("`paper`", Memory::None)] {
            let w = follow_waves(back, memory)?;
            let stalled = w.followed - w.completed;
            writeln!(
                out,
                "| {way} | {name} | {} | {} | {stalled} ({:.0} %) | {} | {:.0} % |",
                w.followed,
                w.completed,
                100.0 * stalled as f64 / w.followed as f64,
                w.never_out,
                100.0 * w.reached
            )?;
        }
    }
    Ok(())
}
