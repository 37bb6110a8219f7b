//! The out-and-back test: a wave that returns through the postures that it left by, followed by both kinds of field.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use kineme::choreography::{Key, Script, perform};
use kineme::primitive::{Exemplar, FlowSettings, Flowfield, Memory, Modelling, Primitive};
use kineme::skeleton::Skeleton;
use kineme::{Role, Root};
use kineme_formats::script;
use nalgebra::Vector3;

use crate::models::exemplar;
use crate::sets::Result;

const WAVES: &str = include_str!("../../../choreography/horizontal-waving.toml");
/// Rate of the exemplars and of the steps.
const RATE_HZ: f64 = 60.0;
/// A wave that has not come back after so many times its duration has stalled.
const PATIENCE: f64 = 2.0;
/// Share of the way that the wrist must have gone out, and of it that may be left when it is back.
const OUT: f64 = 0.8;
const BACK: f64 = 0.2;

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

/// Waves across and back as one movement: the script's exemplars joined by their parameters, in the order of the script.
///
/// # Errors
/// When a wave across has no return.
pub fn waves() -> Result<Vec<Exemplar>> {
    let script = script::parse("horizontal-waving.toml", WAVES.as_bytes())?;
    let body = Arc::new(kineme::body(&script.body)?);
    joined(&script)?
        .into_iter()
        .map(|(parameters, keys)| {
            let motion = perform("wave", &keys, &body, RATE_HZ)?;
            Ok(Exemplar {
                adverbs: Some(parameters.into_values().collect()),
                ..exemplar(&motion)
            })
        })
        .collect()
}

/// Parameters and keys of each wave across with its return behind it.
fn joined(script: &Script) -> Result<Vec<(BTreeMap<String, f64>, Vec<Key>)>> {
    let (across, back): (Vec<_>, Vec<_>) = script
        .exemplars
        .iter()
        .partition(|e| e.primitive == "wave-across");
    let join = |out: &&kineme::choreography::ScriptExemplar| {
        let home = back.iter().find(|b| b.parameters == out.parameters);
        let home = home.ok_or("a wave across without its return")?;
        let mut keys = out.keys.clone();
        let turn = keys.last().map_or(0.0, |k| k.time);
        keys.extend(home.keys.iter().skip(1).map(|k| Key {
            time: k.time + turn,
            ..k.clone()
        }));
        Ok((out.parameters.clone(), keys))
    };
    across.iter().map(join).collect()
}

/// Follows the field of this kind from the first posture of waves: each exemplar left out of the model in turn, and a
/// lattice of parameters of the model of all.
///
/// # Errors
/// When a model cannot be made.
pub fn follow_waves(memory: Memory) -> Result<Waves> {
    let exemplars = waves()?;
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
        let motion = &left_out.motion;
        let truth: Vec<&[f64]> = (0..motion.frames()).map(|f| motion.pose(f)).collect();
        rollouts.push(rollout(&field, &truth, motion.duration_secs())?);
    }
    let primitive = Primitive::learn("wave", exemplars, &modelling)?;
    let field = Flowfield::of(&primitive, &settings)?;
    for k in 0..25 {
        let p = [0.25 * (k / 5) as f64, 0.25 * (k % 5) as f64];
        let course = primitive.at(&p)?;
        let poses: Vec<Vec<f64>> = (0..=100).map(|i| course.pose(0.01 * i as f64)).collect();
        let truth: Vec<&[f64]> = poses.iter().map(Vec::as_slice).collect();
        rollouts.push(rollout(&field, &truth, course.duration_secs())?);
    }
    let count = |f: &dyn Fn(&(f64, bool)) -> bool| rollouts.iter().filter(|r| f(r)).count();
    Ok(Waves {
        followed: rollouts.len(),
        completed: count(&|r| r.1),
        never_out: count(&|r| r.0 < OUT),
        reached: rollouts.iter().map(|r| r.0.min(1.0)).sum::<f64>() / rollouts.len() as f64,
    })
}

/// How far out the wrist went as a share of the way, and whether it came back then.
fn rollout(field: &Flowfield, truth: &[&[f64]], secs: f64) -> Result<(f64, bool)> {
    let body = field.body();
    let start = wrist(body, truth[0]);
    let away = |pose: &[f64]| (wrist(body, pose) - start).norm();
    let whole = truth.iter().map(|p| away(p)).fold(0.0, f64::max);
    let state = field.enter(truth[0])?;
    let (mut out, mut back) = (0.0_f64, false);
    for state in field.predict(&state, PATIENCE * secs, RATE_HZ)? {
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
        "\n### Out and back: the horizontal wave, across and return as one movement\n\n| field | waves | completed | stalled | of these never out 80 % of the way | mean way out |\n| --- | --- | --- | --- | --- | --- |"
    )?;
    for (name, memory) in [("**phase**", Memory::Phase), ("`paper`", Memory::None)] {
        let w = follow_waves(memory)?;
        writeln!(
            out,
            "| {name} | {} | {} | {} ({:.0} %) | {} | {:.0} % |",
            w.followed,
            w.completed,
            w.followed - w.completed,
            100.0 * (w.followed - w.completed) as f64 / w.followed as f64,
            w.never_out,
            100.0 * w.reached
        )?;
    }
    Ok(())
}
