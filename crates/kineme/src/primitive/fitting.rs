//! From exemplars to a [`Fit`]: trim, register, parametrise, choose the interpolator.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::curve::Curve;
use super::exemplar::Exemplar;
use super::judge::Judge;
use super::modelling::{
    Fit, Interpolation, LeaveOneOut, Mismatched, Modelling, Parameterisation, Trial, Used,
};
use super::parametrising::{adverbs, effector_space, principal_space};
use super::registered::curves;
use super::selection::{Points, Selection, clearly_best, select};
use super::space::{ParameterSource, ParameterSpace};
use super::structure::{cycles_of, foreign};
use crate::alignment::{Registered, Registration, Trim, Warp, resample, resting_ends};
use crate::error::{Error, Result};
use crate::interpolation::Method;
use crate::math::statistics::median;
use crate::motion::landmark_dims;
use crate::skeleton::Skeleton;

/// Phases at which the shape of an exemplar is taken for principal coordinates and for choosing an interpolator.
pub const SHAPE_PHASES: usize = 16;
/// Exemplars that a primitive may have: its interpolator takes time with their cube.
pub(super) const MOST_EXEMPLARS: usize = 1000;
/// Knots of a curve a second of movement: twice the rate that 6 Hz, the most of gross movement, asks for, and more.
const KNOTS_PER_SEC: f64 = 40.0;
/// Bounds of the number of knots.
const KNOTS: [usize; 2] = [64, 256];

/// Fits a primitive named `name` in messages; the exemplars that it keeps, and what was fitted to them.
pub(super) fn fit(
    name: &str,
    mut exemplars: Vec<Exemplar>,
    modelling: &Modelling,
) -> Result<(Vec<Exemplar>, Fit)> {
    check(name, &exemplars)?;
    let mut notes = Vec::new();
    let phased = loop {
        let phased = phased(&exemplars, modelling)?;
        let found = foreign(&exemplars, &phased)?;
        let told = |(i, what): &(usize, &str)| format!("{} {what}", exemplars[*i].label());
        if found.refused.is_empty() {
            notes.extend(found.told.iter().map(told));
            break phased;
        }
        let refused: Vec<String> = found.refused.iter().map(told).collect();
        if modelling.mismatched == Mismatched::Refuse {
            return Err(Error::invalid(format!(
                "exemplars of `{name}` are not of one structure: {}; give such a movement a name of its own",
                refused.join("; ")
            )));
        }
        notes.extend(refused.into_iter().map(|t| format!("left out: {t}")));
        let mut index = 0;
        exemplars.retain(|_| {
            index += 1;
            found.refused.iter().all(|(i, _)| *i != index - 1)
        });
    };
    let in_phase = InPhase {
        cyclic: phased.cyclic,
        used: phased.used,
        sequences: phased.sequences,
        warps: phased.registered.warps,
        mean: phased.registered.mean,
    };
    let fit = modelled(&exemplars, in_phase, None, modelling, notes)?;
    Ok((exemplars, fit))
}

/// Another interpolator for exemplars that have been registered.
pub(super) fn interpolated(
    exemplars: &[Exemplar],
    fitted: &Fit,
    interpolation: Interpolation,
) -> Result<Fit> {
    let dims = landmark_dims(exemplars[0].motion.skeleton());
    let sequence =
        |(e, part): (&Exemplar, &Used)| part_of(&e.motion.landmarks(), dims, part, fitted.cyclic);
    let sequences = exemplars.iter().zip(&fitted.used).map(sequence).collect();
    let known = match fitted.space.source() {
        ParameterSource::Principal { .. } => None,
        _ => Some((fitted.space.clone(), fitted.points.clone())),
    };
    let modelling = Modelling {
        parameterisation: Parameterisation::Principal,
        interpolation,
        ..Modelling::default()
    };
    let in_phase = InPhase {
        cyclic: fitted.cyclic,
        used: fitted.used.clone(),
        sequences,
        warps: fitted.warps.clone(),
        mean: fitted.reference.clone(),
    };
    modelled(exemplars, in_phase, known, &modelling, fitted.notes.clone())
}

/// Exemplars on the way to phase.
pub(super) struct Phased {
    cyclic: bool,
    used: Vec<Used>,
    /// Landmarks of the part that is used.
    pub sequences: Vec<Vec<f64>>,
    pub registration: Registration,
    pub registered: Registered,
}

/// Exemplars of one phase, ready to be parametrised.
struct InPhase {
    cyclic: bool,
    used: Vec<Used>,
    sequences: Vec<Vec<f64>>,
    warps: Vec<Warp>,
    /// Registered mean landmarks.
    mean: Vec<f64>,
}

/// Cuts out cycles or trims rests, and registers.
fn phased(exemplars: &[Exemplar], modelling: &Modelling) -> Result<Phased> {
    let dims = landmark_dims(exemplars[0].motion.skeleton());
    let landmarks: Vec<Vec<f64>> = exemplars.iter().map(|e| e.motion.landmarks()).collect();
    let cycles = cycles_of(exemplars, &landmarks, modelling.cyclic)?;
    let cyclic = cycles.is_some();
    let used = cycles.unwrap_or_else(|| {
        let pairs = exemplars.iter().zip(&landmarks);
        pairs
            .map(|(e, seen)| moving(seen, dims, e.motion.rate_hz(), &modelling.trim))
            .collect()
    });
    let sequences: Vec<Vec<f64>> = landmarks
        .iter()
        .zip(&used)
        .map(|(seen, part)| part_of(seen, dims, part, cyclic))
        .collect();
    let borrowed: Vec<&[f64]> = sequences.iter().map(Vec::as_slice).collect();
    let registration = Registration {
        cyclic,
        ..modelling.registration.clone()
    };
    let registered = registration.register(&borrowed, dims)?;
    Ok(Phased {
        cyclic,
        used,
        sequences,
        registration,
        registered,
    })
}

/// The part of a stroke between the rests at its ends.
pub(super) fn moving(landmarks: &[f64], dims: usize, rate_hz: f64, trim: &Trim) -> Used {
    let range = resting_ends(landmarks, dims, rate_hz, trim);
    Used {
        start: range.start as f64,
        end: (range.end - 1) as f64,
        shift: 0.0,
    }
}

/// Parametrises, unless space and points are known, and chooses the interpolator.
fn modelled(
    exemplars: &[Exemplar],
    in_phase: InPhase,
    known: Option<(ParameterSpace, Vec<f64>)>,
    modelling: &Modelling,
    mut notes: Vec<String>,
) -> Result<Fit> {
    let body = exemplars[0].motion.skeleton();
    let dims = landmark_dims(body);
    let InPhase {
        cyclic,
        used,
        sequences,
        warps,
        mean,
    } = in_phase;
    let seconds: Vec<f64> = exemplars
        .iter()
        .zip(&used)
        .map(|(e, part)| (part.end - part.start) / e.motion.rate_hz())
        .collect();
    let knots = (KNOTS_PER_SEC * median(&seconds).unwrap_or(0.0)).ceil() as usize + 1;
    let knots = knots.clamp(KNOTS[0], KNOTS[1]);
    let shapes: Vec<Vec<f64>> = sequences
        .iter()
        .zip(&warps)
        .map(|(s, warp)| shape(s, dims, warp))
        .collect();
    let n = exemplars.len();
    let gram = DMatrix::from_fn(n, n, |i, j| dot(&shapes[i], &shapes[j]));
    let per_landmark = (SHAPE_PHASES * dims / 3) as f64;

    let mut fit = Fit {
        cyclic,
        used,
        warps,
        reference: mean,
        knots,
        space: ParameterSpace::new(Vec::new(), ParameterSource::Adverbs)?,
        points: Vec::new(),
        method: Method::Shepard { power: 2.0 },
        trials: Vec::new(),
        error: None,
        notes: Vec::new(),
    };
    let curves = curves(exemplars, &fit);
    let given = match &modelling.parameterisation {
        _ if known.is_some() => known,
        Parameterisation::Automatic => adverbs(exemplars, modelling, &mut notes)?,
        Parameterisation::Principal => None,
        Parameterisation::Effector(effector) => {
            let places = super::aim::extreme_places(body, effector, &curves, cyclic)?;
            Some(effector_space(effector, &places, &mut notes)?)
        }
    };
    let points = match &given {
        Some((space, points)) => Points::Given(points, space.dims()),
        None => Points::Principal,
    };
    let selection = select(&gram, per_landmark, &points, modelling.interpolation)?;
    let judged = judged(body, &curves, selection)?;
    fit.space = match given {
        Some((space, _)) => space,
        None => principal_space(&shapes, &gram, judged.dims)?,
    };
    // Exemplars that do not differ span fewer directions than were asked for.
    let kept = fit.space.dims();
    let rows = judged.points.chunks(judged.dims.max(1));
    fit.points = rows.flat_map(|row| &row[..kept]).copied().collect();
    fit.method = judged.method;
    fit.trials = judged.trials;
    fit.error = judged.error;
    fit.notes = notes;
    Ok(fit)
}

/// The interpolator that blends postures best.
struct Judged {
    method: Method,
    dims: usize,
    points: Vec<f64>,
    trials: Vec<Trial>,
    error: Option<LeaveOneOut>,
}

/// Chooses among the finalists by the postures that they blend: far exemplars, or weights below 0, make other postures
/// than the landmarks let expect.
fn judged(body: &Arc<Skeleton>, curves: &[Curve], selection: Selection) -> Result<Judged> {
    let Selection {
        folds,
        mut finalists,
        mean,
    } = selection;
    let (mut chosen, mut error) = (0, None);
    if !folds.is_empty() {
        let judge = Judge::new(body, curves)?;
        for f in &mut finalists {
            f.trial.error_m = judge.landmark_m(&folds, &f.weights)?;
        }
        let errors: Vec<f64> = finalists.iter().map(|f| f.trial.error_m).collect();
        chosen = clearly_best(&errors).unwrap_or(0);
        let best = &finalists[chosen];
        let (joint_rad, wrist_m) = judge.joint_rad_and_wrist_m(&folds, &best.weights);
        error = Some(LeaveOneOut {
            joint_rad,
            wrist_m,
            nearest_m: judge.landmark_m(&folds, &best.nearest)?,
            mean_m: judge.landmark_m(&folds, &mean)?,
        });
    }
    let best = finalists.remove(chosen);
    let mut trials = Vec::new();
    if error.is_some() {
        trials.push(best.trial.clone());
        trials.extend(finalists.into_iter().map(|f| f.trial));
    }
    Ok(Judged {
        method: best.trial.method,
        dims: best.trial.dims,
        points: best.points,
        trials,
        error,
    })
}

fn check(name: &str, exemplars: &[Exemplar]) -> Result<()> {
    let Some(first) = exemplars.first() else {
        return Err(Error::invalid(format!(
            "primitive `{name}` has no exemplar"
        )));
    };
    if exemplars.len() > MOST_EXEMPLARS {
        return Err(Error::unsupported(format!(
            "primitive `{name}` has {} exemplars, more than {MOST_EXEMPLARS}: choose among them",
            exemplars.len()
        )));
    }
    for e in exemplars {
        if **e.motion.skeleton() != **first.motion.skeleton() {
            return Err(Error::invalid(format!(
                "exemplars of `{name}` are of the bodies `{}` and `{}`",
                first.motion.skeleton().name(),
                e.motion.skeleton().name()
            )));
        }
        if e.motion.frames() < 2 {
            return Err(Error::invalid(format!(
                "{}, an exemplar of `{name}`, is a single frame: a movement has at least two",
                e.label()
            )));
        }
        let count = |e: &Exemplar| e.adverbs.as_ref().map(Vec::len);
        if count(e) != count(first) {
            return Err(Error::invalid(format!(
                "{}, an exemplar of `{name}`, has {} adverbs, {} has {}",
                e.label(),
                count(e).unwrap_or(0),
                first.label(),
                count(first).unwrap_or(0)
            )));
        }
        if let Some(v) = e.adverbs.iter().flatten().find(|v| !v.is_finite()) {
            return Err(Error::invalid(format!(
                "{}, an exemplar of `{name}`, has the adverb {v}; adverbs are finite",
                e.label()
            )));
        }
    }
    Ok(())
}

/// The frames of the part of a sequence that is used, as many as it has at least; of a closed one, a cycle, the gap is
/// spread over it, so that its last frame is its first.
pub(super) fn part_of(sequence: &[f64], dims: usize, part: &Used, closed: bool) -> Vec<f64> {
    let last = (sequence.len() / dims - 1) as f64;
    let count = (part.end - part.start).ceil().max(1.0);
    let place = |i: usize| i as f64 / count;
    let at = |i: usize| part.frame(place(i)) / last;
    let places: Vec<f64> = (0..=count as usize).map(at).collect();
    let mut frames = resample(sequence, dims, &places);
    if closed {
        let ends = resample(sequence, dims, &[part.start / last, part.end / last]);
        for (i, row) in frames.chunks_exact_mut(dims).enumerate() {
            let share = part.share(place(i)) - 0.5;
            for (v, (a, b)) in row.iter_mut().zip(ends.iter().zip(&ends[dims..])) {
                *v -= share * (b - a);
            }
        }
    }
    frames
}

/// Landmarks of an exemplar at evenly spaced phases, joined.
pub(super) fn shape(sequence: &[f64], dims: usize, warp: &Warp) -> Vec<f64> {
    let phase = |k: usize| k as f64 / (SHAPE_PHASES - 1) as f64;
    let places: Vec<f64> = (0..SHAPE_PHASES).map(|k| warp.place(phase(k))).collect();
    resample(sequence, dims, &places)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
