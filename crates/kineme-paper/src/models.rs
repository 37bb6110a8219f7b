//! Classes of labelled recordings as primitives, each judged on an exemplar that it has not seen.

use kineme::alignment::{Registration, Trim, cycle, period, resting_ends};
use kineme::motion::landmark_dims;
use kineme::primitive::{
    Exemplar, Fit, Interpolation, Mismatched, Modelling, ParameterSource, ParameterSpace,
    Primitive, Used,
};
use kineme::{Motion, interpolation::Method};

use crate::postures::{Errors, Postures};
use crate::sets::{LabelledSet, Result};

/// Phases at which movements are compared: the knots of the registration.
const PHASES: usize = 64;

/// A clip of a class, left out of it.
#[derive(Debug, Clone)]
pub struct Fold {
    /// The class, an index into those of the set.
    pub class: usize,
    /// The clip that is left out, an index into the motions of the set.
    pub left_out: usize,
    /// All other clips of the class.
    pub others: Vec<usize>,
}

/// Every clip of every class left out once, class by class.
pub fn folds(set: &LabelledSet) -> Vec<Fold> {
    let of_class = |class: usize| {
        let members: Vec<usize> = (0..set.labels.len())
            .filter(|&i| set.labels[i] == class)
            .collect();
        (0..members.len()).map(move |k| {
            let mut others = members.clone();
            Fold {
                class,
                left_out: others.remove(k),
                others,
            }
        })
    };
    (0..set.classes.len()).flat_map(of_class).collect()
}

/// The primitive of a fold's other clips. Those that are of another structure are left out, as nobody labelled structure.
///
/// # Errors
/// As [`Primitive::learn`].
pub fn learn(set: &LabelledSet, fold: &Fold, modelling: &Modelling) -> Result<Primitive> {
    let exemplars = fold
        .others
        .iter()
        .map(|&i| Exemplar::whole(set.motions[i].clone(), None));
    let modelling = Modelling {
        mismatched: Mismatched::LeaveOut,
        ..modelling.clone()
    };
    let name = &set.classes[fold.class];
    Ok(Primitive::learn(name, exemplars.collect(), &modelling)?)
}

/// Who predicts the clip that is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rival {
    /// The mean of the registered exemplars.
    ClassMean,
    /// The exemplar nearest in the parameters of the interpolator chosen.
    Nearest,
    /// The exemplar that comes nearest to the truth: it looks, and is no rival but a mark.
    NearestInTruth,
    /// Inverse distances.
    Shepard,
    /// Verbs and Adverbs, exact.
    VerbsAndAdverbs,
    /// What the primitive chooses by itself.
    Chosen,
}

impl Rival {
    /// All of them, in the order of the tables.
    pub const ALL: [Rival; 6] = [
        Rival::ClassMean,
        Rival::Nearest,
        Rival::NearestInTruth,
        Rival::Shepard,
        Rival::VerbsAndAdverbs,
        Rival::Chosen,
    ];

    /// The heading of its column.
    pub fn name(self) -> &'static str {
        match self {
            Rival::ClassMean => "class mean",
            Rival::Nearest => "nearest",
            Rival::NearestInTruth => "(best single)",
            Rival::Shepard => "Shepard",
            Rival::VerbsAndAdverbs => "Verbs and Adverbs",
            Rival::Chosen => "**chosen**",
        }
    }
}

/// What came of a fold.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The class.
    pub class: usize,
    /// Errors in the order of [`Rival::ALL`].
    pub errors: [Errors; 6],
    /// Whether the class was taken for a cycle.
    pub cyclic: bool,
    /// Exemplars of another structure that were left out of the model.
    pub foreign: usize,
    /// The interpolator chosen.
    pub method: Method,
    /// How many parameters it has.
    pub dims: usize,
}

/// Judges the primitive of a fold by the clip that was left out.
///
/// # Errors
/// When the clip cannot be registered to it.
pub fn judge(set: &LabelledSet, fold: &Fold, primitive: &Primitive) -> Result<Judged> {
    let truth = Truth::of(&set.motions[fold.left_out]);
    let n = primitive.exemplars().len();
    let p = primitive.parameters_of(truth.motion)?;
    let exemplars = registered(primitive);
    let reading = truth.reading(primitive)?;
    let mut errors = [Errors::default(); 6];
    for (error, rival) in errors.iter_mut().zip(Rival::ALL) {
        let poses = match rival {
            Rival::ClassMean => blended(&exemplars, &vec![1.0 / n as f64; n]),
            Rival::Nearest => exemplars[nearest(primitive, &p)].clone(),
            Rival::NearestInTruth => {
                let own = |poses: &Vec<f64>| truth.errors(primitive, &reading, poses.clone());
                let singles: Vec<Errors> = exemplars.iter().map(own).collect::<Result<_>>()?;
                let best = |e: &&Errors, f: &&Errors| e.landmark_cm.total_cmp(&f.landmark_cm);
                *error = *singles.iter().min_by(best).ok_or("no exemplars")?;
                continue;
            }
            Rival::Shepard => {
                let other = primitive.interpolated(Interpolation::Shepard)?;
                blended(&exemplars, &weights(&other, &truth)?)
            }
            Rival::VerbsAndAdverbs => {
                let other = primitive.interpolated(Interpolation::VerbsAndAdverbs)?;
                blended(&exemplars, &weights(&other, &truth)?)
            }
            Rival::Chosen => blended(&exemplars, &weights(primitive, &truth)?),
        };
        *error = truth.errors(primitive, &reading, poses)?;
    }
    Ok(Judged {
        class: fold.class,
        errors,
        cyclic: primitive.is_cyclic(),
        foreign: fold.others.len() - n,
        method: primitive.fitted().method,
        dims: primitive.parameters().dims(),
    })
}

/// The weights that a primitive gives its exemplars where the clip lies.
fn weights(primitive: &Primitive, truth: &Truth) -> Result<Vec<f64>> {
    let p = primitive.parameters_of(truth.motion)?;
    let interpolator = primitive.interpolator();
    let mut weights = vec![0.0; primitive.exemplars().len()];
    interpolator.weights(&interpolator.clamped(&p), &mut weights);
    Ok(weights)
}

/// The poses of each exemplar at the phases compared.
fn registered(primitive: &Primitive) -> Vec<Vec<f64>> {
    let poses = |i: usize| {
        let pose = |k: usize| primitive.registered(i, phase(k)).pose;
        (0..PHASES).flat_map(pose).collect()
    };
    (0..primitive.exemplars().len()).map(poses).collect()
}

fn phase(k: usize) -> f64 {
    // Phase 1 of a cycle is phase 0 again: the least below it stands for the end.
    (k as f64 / (PHASES - 1) as f64).min(1.0 - 1e-12)
}

fn blended(exemplars: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; exemplars[0].len()];
    for (poses, w) in exemplars.iter().zip(weights) {
        for (s, v) in sum.iter_mut().zip(poses) {
            *s += w * v;
        }
    }
    sum
}

fn nearest(primitive: &Primitive, p: &[f64]) -> usize {
    let squared = |i: usize| -> f64 {
        let pairs = primitive.point(i).iter().zip(p);
        pairs.map(|(a, b)| (a - b) * (a - b)).sum()
    };
    (0..primitive.exemplars().len())
        .min_by(|&a, &b| squared(a).total_cmp(&squared(b)))
        .unwrap_or(0)
}

/// The clip that is to be predicted.
struct Truth<'a> {
    motion: &'a Motion,
    landmarks: Vec<f64>,
    dims: usize,
}

/// The part of the clip that is compared, the same for all rivals.
struct Reading {
    used: Used,
    /// Its landmarks.
    sequence: Vec<f64>,
}

impl<'a> Truth<'a> {
    fn of(motion: &'a Motion) -> Self {
        Self {
            motion,
            landmarks: motion.landmarks(),
            dims: landmark_dims(motion.skeleton()),
        }
    }

    /// Its rests trimmed; of a cyclic primitive one cycle in step with it.
    fn reading(&self, primitive: &Primitive) -> Result<Reading> {
        let (dims, rate) = (self.dims, self.motion.rate_hz());
        if !primitive.is_cyclic() {
            let range = resting_ends(&self.landmarks, dims, rate, &Trim::default());
            return Ok(Reading {
                used: Used {
                    start: range.start as f64,
                    end: (range.end - 1) as f64,
                    shift: 0.0,
                },
                sequence: self.landmarks[range.start * dims..range.end * dims].to_vec(),
            });
        }
        let expected = primitive.at(&primitive.middle())?.duration_secs() * rate;
        let frames = period(&self.landmarks, dims, rate)?.map_or(expected, |p| {
            p.frames / (p.frames / expected).round().max(1.0)
        });
        let reference = &primitive.fitted().reference;
        let found = cycle(&self.landmarks, dims, frames.max(2.0), Some(reference))?;
        let phases = found.frames.ceil() as usize + 1;
        Ok(Reading {
            used: Used {
                start: found.start,
                end: found.start + found.frames,
                shift: found.shift,
            },
            sequence: found.sample(&self.landmarks, dims, phases)?,
        })
    }

    /// The errors of predicted poses: the clip is warped to them, which costs no rival more than another.
    fn errors(&self, primitive: &Primitive, reading: &Reading, poses: Vec<f64>) -> Result<Errors> {
        let guess = Postures::of_poses(primitive.body(), poses)?;
        let registration = Registration {
            knots: PHASES,
            cyclic: primitive.is_cyclic(),
            ..Registration::default()
        };
        let aligned = registration.register_to(guess.landmarks(), &reading.sequence, self.dims)?;
        // A primitive of this clip alone reads it as those of the class are read.
        let fit = Fit {
            used: vec![reading.used],
            warps: vec![aligned.warp],
            knots: PHASES,
            space: ParameterSpace::new(Vec::new(), ParameterSource::Adverbs)?,
            points: Vec::new(),
            method: Method::Shepard { power: 2.0 },
            ..primitive.fitted().clone()
        };
        let exemplar = Exemplar::whole(self.motion.clone(), None);
        let alone = Primitive::from_fit("left out", vec![exemplar], fit, None)?;
        let truth = registered(&alone).swap_remove(0);
        Ok(guess.against(&Postures::of_poses(primitive.body(), truth)?))
    }
}
