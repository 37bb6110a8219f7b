//! The document of `show --json`.

use kineme::interpolation::Method;
use kineme::primitive::ParameterSource;
use kineme::{Primitive, Vocabulary};
use serde::Serialize;

use super::{calibrated, durations};
use crate::failure::Failure;

#[derive(Serialize)]
struct Document<'a> {
    body: &'a str,
    dof: usize,
    primitives: Vec<PrimitiveLine<'a>>,
    behaviors: Vec<BehaviorLine<'a>>,
    transitions: Vec<TransitionLine<'a>>,
    /// Recognisers whose calibration it holds.
    calibrated: Vec<&'a str>,
}

#[derive(Serialize)]
struct PrimitiveLine<'a> {
    name: &'a str,
    cyclic: bool,
    /// Shortest and longest exemplar, seconds.
    duration: [f64; 2],
    parameters: Vec<ParameterLine<'a>>,
    /// `adverbs`, `principal`, or the effector whose place they are.
    parameters_from: &'a str,
    interpolation: MethodLine,
    trials: Vec<TrialLine>,
    leave_one_out: Option<ErrorLine>,
    members: Option<usize>,
    coherence: Option<f64>,
    exemplars: Vec<ExemplarLine<'a>>,
    notes: Vec<&'a str>,
}

#[derive(Serialize)]
struct ParameterLine<'a> {
    name: &'a str,
    low: f64,
    high: f64,
}

#[derive(Serialize)]
struct MethodLine {
    method: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    power: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nugget: Option<f64>,
}

#[derive(Serialize)]
struct TrialLine {
    #[serde(flatten)]
    method: MethodLine,
    parameters: usize,
    error_m: f64,
}

/// Errors of exemplars predicted from the others; those in `_m` but the wrists' are of landmarks all over the body.
#[derive(Serialize)]
struct ErrorLine {
    joint_rad: f64,
    wrist_m: f64,
    error_m: Option<f64>,
    nearest_m: f64,
    mean_m: f64,
}

#[derive(Serialize)]
struct ExemplarLine<'a> {
    motion: &'a str,
    start: f64,
    end: f64,
    blake3: Option<&'a str>,
    adverbs: Option<&'a [f64]>,
    /// In the parameters' own units.
    parameters: Vec<f64>,
}

#[derive(Serialize)]
struct BehaviorLine<'a> {
    name: &'a str,
    primitives: &'a [String],
}

#[derive(Serialize)]
struct TransitionLine<'a> {
    from: &'a str,
    to: &'a str,
    count: u32,
}

/// These primitives of a vocabulary.
pub(super) fn document(
    vocabulary: &Vocabulary,
    primitives: &[&Primitive],
) -> Result<String, Failure> {
    let shown = |name: &str| primitives.iter().any(|p| p.name() == name);
    let all = vocabulary.primitives();
    let transitions = vocabulary.transitions();
    let pairs = (0..all.len()).flat_map(|from| (0..all.len()).map(move |to| (from, to)));
    let document = Document {
        body: vocabulary.body().name(),
        dof: vocabulary.body().dof(),
        primitives: primitives.iter().map(|p| line(p)).collect(),
        behaviors: vocabulary
            .behaviors()
            .iter()
            .filter(|b| b.primitives.iter().any(|p| shown(p)))
            .map(|b| BehaviorLine {
                name: &b.name,
                primitives: &b.primitives,
            })
            .collect(),
        transitions: pairs
            .map(|(from, to)| TransitionLine {
                from: all[from].name(),
                to: all[to].name(),
                count: transitions.count(from, to),
            })
            .filter(|t| t.count > 0 && (shown(t.from) || shown(t.to)))
            .collect(),
        calibrated: calibrated(vocabulary).collect(),
    };
    let text = serde_json::to_string(&document).map_err(|e| Failure::failed(e.to_string()))?;
    Ok(format!("{text}\n"))
}

fn line(primitive: &Primitive) -> PrimitiveLine<'_> {
    let fit = primitive.fitted();
    let space = primitive.parameters();
    let exemplars = primitive.exemplars().iter().enumerate();
    PrimitiveLine {
        name: primitive.name(),
        cyclic: primitive.is_cyclic(),
        duration: durations(primitive),
        parameters: space
            .axes()
            .iter()
            .map(|a| ParameterLine {
                name: &a.name,
                low: a.low,
                high: a.high,
            })
            .collect(),
        parameters_from: match space.source() {
            ParameterSource::Adverbs => "adverbs",
            ParameterSource::Principal { .. } => "principal",
            ParameterSource::Effector { effector, .. } => effector,
        },
        interpolation: method_line(&fit.method),
        trials: fit
            .trials
            .iter()
            .map(|t| TrialLine {
                method: method_line(&t.method),
                parameters: t.dims,
                error_m: t.error_m,
            })
            .collect(),
        leave_one_out: fit.error.as_ref().map(|e| ErrorLine {
            joint_rad: e.joint_rad,
            wrist_m: e.wrist_m,
            error_m: fit.trials.first().map(|t| t.error_m),
            nearest_m: e.nearest_m,
            mean_m: e.mean_m,
        }),
        members: primitive.group().map(|g| g.members),
        coherence: primitive.group().and_then(|g| g.coherence),
        exemplars: exemplars
            .map(|(i, e)| ExemplarLine {
                motion: &e.provenance.motion,
                start: e.provenance.start_secs,
                end: e.provenance.end_secs,
                blake3: e.provenance.blake3.as_deref(),
                adverbs: e.adverbs.as_deref(),
                parameters: space.from_unit(primitive.point(i)),
            })
            .collect(),
        notes: primitive.notes().collect(),
    }
}

fn method_line(method: &Method) -> MethodLine {
    match *method {
        Method::Shepard { power } => MethodLine {
            method: "shepard",
            power: Some(power),
            nugget: None,
        },
        Method::Cardinal { nugget, .. } => MethodLine {
            method: "verbs-and-adverbs",
            power: None,
            nugget: Some(nugget),
        },
    }
}
