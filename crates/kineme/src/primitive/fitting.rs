//! From exemplars to a [`Fit`]: trim, register, parametrise, choose the interpolator.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::curve::Curve;
use super::exemplar::Exemplar;
use super::judge::Judge;
use super::modelling::{
    Fit, Interpolation, LeaveOneOut, Mismatched, Modelling, Parameterisation, Trial, Used,
};
use super::registered::curves;
use super::selection::{Points, Selection, clearly_best, leading, select, unit};
use super::space::{ParameterAxis, ParameterSource, ParameterSpace};
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
/// An effector's coordinate that varies less, metres, is no parameter.
const LEAST_SPREAD: f64 = 0.02;

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
        let registration = Registration {
            cyclic: phased.cyclic,
            ..modelling.registration.clone()
        };
        let found = foreign(&exemplars, &phased, &registration)?;
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
    pub cyclic: bool,
    used: Vec<Used>,
    /// Landmarks of the part that is used.
    pub sequences: Vec<Vec<f64>>,
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
        method: crate::interpolation::Method::Shepard { power: 2.0 },
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

/// The space of the exemplars' adverbs; `None` where they have none. An adverb that all exemplars share is dropped.
fn adverbs(
    exemplars: &[Exemplar],
    modelling: &Modelling,
    notes: &mut Vec<String>,
) -> Result<Option<(ParameterSpace, Vec<f64>)>> {
    let n = exemplars.len();
    let Some(count) = exemplars[0].adverbs.as_ref().map(Vec::len) else {
        return Ok(None);
    };
    let values: Vec<f64> = exemplars
        .iter()
        .flat_map(|e| e.adverbs.iter().flatten().copied())
        .collect();
    let name = |d: usize| match modelling.adverbs.get(d) {
        Some(name) => name.clone(),
        None => format!("p{}", d + 1),
    };
    let found = spaced(&values, count, n, name, 0.0, notes);
    let space = ParameterSpace::new(found.axes, ParameterSource::Adverbs)?;
    Ok(Some((space, found.points)))
}

/// Columns of values as parameters.
struct Spaced {
    axes: Vec<ParameterAxis>,
    /// In [0, 1], row-major.
    points: Vec<f64>,
    /// The columns that vary.
    kept: Vec<usize>,
}

/// Axes and unit points of columns that vary by more than `least`; the others are dropped and noted.
fn spaced(
    values: &[f64],
    count: usize,
    n: usize,
    name: impl Fn(usize) -> String,
    least: f64,
    notes: &mut Vec<String>,
) -> Spaced {
    let (_, ranges) = unit(values, count, count, n);
    let (kept, dropped): (Vec<usize>, Vec<usize>) =
        (0..count).partition(|&d| ranges[d][1] - ranges[d][0] > least);
    for d in dropped {
        notes.push(format!(
            "`{}` is {:.4} in all exemplars: no parameter",
            name(d),
            ranges[d][0]
        ));
    }
    let axes = kept.iter().map(|&d| ParameterAxis {
        name: name(d),
        low: ranges[d][0],
        high: ranges[d][1],
    });
    let columns: Vec<f64> = (0..n)
        .flat_map(|i| kept.iter().map(move |&d| values[i * count + d]))
        .collect();
    let (points, _) = unit(&columns, kept.len(), kept.len(), n);
    Spaced {
        axes: axes.collect(),
        points,
        kept,
    }
}

/// The space of an effector's places, `x, y, z` an exemplar.
fn effector_space(
    effector: &str,
    places: &[[f64; 3]],
    notes: &mut Vec<String>,
) -> Result<(ParameterSpace, Vec<f64>)> {
    const COORDINATES: [&str; 3] = ["forward", "left", "up"];
    let values: Vec<f64> = places.iter().flatten().copied().collect();
    let name = |d: usize| format!("{effector}-{}", COORDINATES[d]);
    let found = spaced(&values, 3, places.len(), name, LEAST_SPREAD, notes);
    let source = ParameterSource::Effector {
        effector: effector.into(),
        coordinates: found.kept,
    };
    Ok((ParameterSpace::new(found.axes, source)?, found.points))
}

/// The space of the first principal coordinates: metres, root mean square over landmarks and phases.
fn principal_space(
    shapes: &[Vec<f64>],
    gram: &DMatrix<f64>,
    dims: usize,
) -> Result<ParameterSpace> {
    let n = shapes.len();
    let length = shapes[0].len();
    let mut mean = vec![0.0; length];
    for s in shapes {
        for (m, v) in mean.iter_mut().zip(s) {
            *m += v / n as f64;
        }
    }
    let rows: Vec<f64> = (0..n).map(|a| gram.row(a).sum() / n as f64).collect();
    let all = rows.iter().sum::<f64>() / n as f64;
    let centred = DMatrix::from_fn(n, n, |a, b| gram[(a, b)] - rows[a] - rows[b] + all);
    let mut directions = Vec::with_capacity(dims * length);
    let mut axes = Vec::with_capacity(dims);
    for (d, (_, vector)) in leading(centred, dims).into_iter().enumerate() {
        let mut direction = DVector::zeros(length);
        for (a, s) in shapes.iter().enumerate() {
            for (x, (v, m)) in direction.iter_mut().zip(s.iter().zip(&mean)) {
                *x += vector[a] * (v - m);
            }
        }
        if direction.normalize_mut() <= f64::EPSILON {
            break;
        }
        let along = |s: &Vec<f64>| -> f64 {
            let offset = s.iter().zip(&mean).map(|(v, m)| v - m);
            offset.zip(direction.iter()).map(|(o, x)| o * x).sum()
        };
        let (low, high) = shapes
            .iter()
            .map(along)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        if high <= low {
            break;
        }
        axes.push(ParameterAxis {
            name: format!("shape-{}", d + 1),
            low,
            high,
        });
        directions.extend(direction.iter());
    }
    ParameterSpace::new(axes, ParameterSource::Principal { mean, directions })
}
