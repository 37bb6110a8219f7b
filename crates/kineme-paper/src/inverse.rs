//! The inverse law: what a primitive makes is recognised as that primitive, at its phase and with its parameters.

use kineme::math::rotation::exp;
use kineme::primitive::{Observation, Primitive, Recogniser};
use kineme::{Skeleton, Vocabulary};
use nalgebra::{DMatrix, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::sets::Result;

/// Nearer to a start or end posture than so much (root mean square over the joints that the primitive moves), movements
/// cannot be told apart: they share their guard.
const APART_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// A joint moves if it turns by more than this.
const MOVES_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// Parameters are asked for where a unit of each changes the posture by so much.
const TOLD_RAD: f64 = 0.1;
/// The stream's rate.
const RATE_HZ: f64 = 60.0;
/// Another primitive in the same posture may be as probable, but for this.
const EQUAL: f64 = 1e-3;

/// What came of one place (p, τ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recovered {
    /// Whether the primitive was recognised.
    pub label: bool,
    /// How far its phase was off; 1 where it was not recognised.
    pub phase: f64,
    /// How far the parameter most wrong was off; `None` where the posture does not tell them.
    pub parameters: Option<f64>,
}

/// Streams each primitive from its start to random places, and asks what was seen: one list a primitive.
///
/// # Errors
/// When places far enough from start and end postures cannot be found.
pub fn inverse(
    recogniser: &dyn Recogniser,
    places: usize,
    seed: u64,
) -> Result<Vec<Vec<Recovered>>> {
    let vocabulary = recogniser.vocabulary();
    let primitives = vocabulary.primitives().iter().enumerate();
    primitives
        .map(|(k, primitive)| {
            let places = draw(vocabulary, primitive, places, seed)?;
            places
                .par_iter()
                .map(|(p, phase)| recovered(recogniser, k, p, *phase))
                .collect()
        })
        .collect()
}

fn recovered(recogniser: &dyn Recogniser, k: usize, p: &[f64], phase: f64) -> Result<Recovered> {
    let primitive = &recogniser.vocabulary().primitives()[k];
    let course = primitive.at(p)?;
    let until = course.secs_at(phase);
    let frames = (until * RATE_HZ).floor() as usize;
    let mut listener = recogniser.listen();
    let mut reading = None;
    for f in 0..=frames {
        let secs = until - (frames - f) as f64 / RATE_HZ;
        let pose = course.pose(course.phase_at(secs));
        reading = Some(listener.hear(&Observation {
            secs,
            pose: &pose,
            root: None,
            missing: &[],
        })?);
    }
    let reading = reading.ok_or("no frame")?;
    let posterior = &reading.posterior;
    let best = posterior
        .primitives
        .iter()
        .copied()
        .fold(posterior.rest.max(posterior.none), f64::max);
    let label = posterior.primitives[k] >= best - EQUAL;
    let place = reading.place.filter(|place| label && place.primitive == k);
    Ok(Recovered {
        label,
        phase: place
            .as_ref()
            .map_or(1.0, |place| (place.phase - phase).abs()),
        parameters: told(primitive, p, phase)?.then(|| {
            place.map_or(1.0, |place| {
                let off = place.parameters.iter().zip(p).map(|(a, b)| (a - b).abs());
                off.fold(0.0, f64::max)
            })
        }),
    })
}

/// Whether the posture tells the parameters.
fn told(primitive: &Primitive, p: &[f64], phase: f64) -> Result<bool> {
    let (pose, rows) = primitive.pose_gradient(p, phase)?;
    let jacobian = DMatrix::from_row_slice(p.len(), pose.len(), &rows);
    let least = jacobian
        .singular_values()
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    Ok(p.is_empty() || least >= TOLD_RAD)
}

/// Start and end postures are looked for at so many values of each parameter, evenly spaced.
const ENDS: usize = 4;

/// Start and end postures of a primitive: of its exemplars, and between them.
fn ends(primitive: &Primitive) -> Result<Vec<Vec<f64>>> {
    let m = primitive.parameters().dims();
    let mut ends = Vec::new();
    for phase in [0.0, 1.0] {
        ends.extend((0..primitive.exemplars().len()).map(|i| primitive.registered(i, phase).pose));
        for k in 0..ENDS.pow(m as u32) {
            let digit = |j: usize| k / ENDS.pow(j as u32) % ENDS;
            let p: Vec<f64> = (0..m)
                .map(|j| digit(j) as f64 / (ENDS - 1) as f64)
                .collect();
            ends.push(primitive.pose(&p, phase)?);
        }
    }
    Ok(ends)
}

/// Random places far from all start and end postures of the vocabulary, those of the same execution among them.
fn draw(
    vocabulary: &Vocabulary,
    primitive: &Primitive,
    places: usize,
    seed: u64,
) -> Result<Vec<(Vec<f64>, f64)>> {
    let body = vocabulary.body();
    let joints = moved(primitive);
    let mut all_ends = Vec::new();
    for other in vocabulary.primitives() {
        all_ends.extend(ends(other)?);
    }
    let mut random = Pcg64::seed_from_u64(seed);
    let mut drawn = Vec::new();
    for _ in 0..1000 * places {
        if drawn.len() == places {
            break;
        }
        let p: Vec<f64> = (0..primitive.parameters().dims())
            .map(|_| random.random_range(0.0..1.0))
            .collect();
        let phase = random.random_range(0.0..1.0);
        let pose = primitive.pose(&p, phase)?;
        let far = |end: &Vec<f64>| apart(body, &joints, &pose, end) > APART_RAD;
        let own = [primitive.pose(&p, 0.0)?, primitive.pose(&p, 1.0)?];
        if all_ends.iter().chain(&own).all(far) {
            drawn.push((p, phase));
        }
    }
    match drawn.len() == places {
        true => Ok(drawn),
        false => Err(format!("`{}` hardly leaves its start and end", primitive.name()).into()),
    }
}

/// The joints that a primitive's first exemplar moves.
fn moved(primitive: &Primitive) -> Vec<usize> {
    let body = primitive.body();
    let start = primitive.registered(0, 0.0).pose;
    let poses: Vec<Vec<f64>> = (1..=8)
        .map(|k| primitive.registered(0, f64::from(k) / 8.0).pose)
        .collect();
    (0..body.joints().len())
        .filter(|&j| {
            let turns = |pose: &Vec<f64>| angle(body, j, pose, &start) > MOVES_RAD;
            poses.iter().any(turns)
        })
        .collect()
}

fn apart(body: &Skeleton, joints: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let squared: f64 = joints.iter().map(|&j| angle(body, j, a, b).powi(2)).sum();
    (squared / joints.len().max(1) as f64).sqrt()
}

/// The angle between the rotations of a joint.
fn angle(body: &Skeleton, joint: usize, a: &[f64], b: &[f64]) -> f64 {
    let own = body.coordinates(joint);
    match own.len() {
        3 => {
            let turn = |pose: &[f64]| exp(&Vector3::from_column_slice(&pose[own.clone()]));
            turn(a).angle_to(&turn(b))
        }
        _ => own.map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max),
    }
}
