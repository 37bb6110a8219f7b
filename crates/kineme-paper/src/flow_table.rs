//! The flowfield tables of `docs/model.md`: where exemplars that were left out are a moment later.

use std::fmt::Write as _;

use kineme::alignment::{Trim, resting_ends};
use kineme::motion::landmark_dims;
use kineme::primitive::{FlowSettings, Flowfield, Primitive};
use kineme::{Motion, Skeleton};

use crate::interpolation_table::LEAST_CLIPS;
use crate::intervals::{average, interval};
use crate::models::Fold;
use crate::postures::{Errors, Postures};
use crate::sets::{LabelledSet, Result};

/// Rate at which the truth is read; every [`STRIDE`]th frame is observed.
const RATE_HZ: f64 = 60.0;
/// Frames between two observations: 30 a second, of which the slower set has no more.
const STRIDE: usize = 2;
/// How far ahead is predicted, frames: 0.1, 0.25 and 0.5 s.
pub const HORIZONS: [usize; 3] = [6, 15, 30];
/// Frames between two starts of predictions, and before the first.
const STARTS: usize = 12;
const WARM_UP: usize = 6;
/// Share of the way to what is observed that the state goes.
const GAIN: f64 = 0.5;

/// Who predicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Predictor {
    /// The posture stays.
    Hold,
    /// Every joint turns on as it did over the last 1/30 s.
    Velocity,
    /// The field of the paper, without memory.
    Paper,
    /// The field that carries phase.
    Phase,
}

impl Predictor {
    /// All of them, in the order of the tables.
    pub const ALL: [Predictor; 4] = [
        Predictor::Hold,
        Predictor::Velocity,
        Predictor::Paper,
        Predictor::Phase,
    ];

    /// The heading of its column.
    pub fn name(self) -> &'static str {
        match self {
            Predictor::Hold => "constant posture",
            Predictor::Velocity => "constant velocity",
            Predictor::Paper => "`paper`",
            Predictor::Phase => "**phase**",
        }
    }
}

/// What came of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Its class.
    pub class: usize,
    /// Whether the class was taken for a cycle.
    pub cyclic: bool,
    /// Predictions made.
    pub starts: usize,
    /// Mean errors over the starts: of each predictor of [`Predictor::ALL`] at each of [`HORIZONS`].
    pub errors: [[Errors; 3]; 4],
}

/// Follows the clip that was left out by the flowfields of a fold's primitive. One that ends within half a second of its
/// first start has no starts.
///
/// # Errors
/// When the clip cannot be followed.
pub fn follow(
    set: &LabelledSet,
    fold: &Fold,
    primitive: &Primitive,
    settings: &FlowSettings,
) -> Result<Followed> {
    let truth = set.motions[fold.left_out].resampled(RATE_HZ)?;
    let starts = starts(&truth, primitive.is_cyclic());
    let phase = Flowfield::of(primitive, settings)?;
    let paper = Flowfield::of(primitive, &FlowSettings::paper())?;
    // Of each predictor, the postures at all horizons of all starts in turn.
    let mut poses: [Vec<f64>; 4] = Default::default();
    let begin = first_frame(&truth, primitive.is_cyclic());
    let velocity = |t: usize| -> Vec<f64> {
        let pairs = truth.pose(t).iter().zip(truth.pose(t - STRIDE));
        let rate = RATE_HZ / STRIDE as f64;
        pairs.map(|(now, before)| (now - before) * rate).collect()
    };
    let mut now = begin;
    let mut state = phase.enter_moving(truth.pose(now), &velocity(now))?;
    for &start in &starts {
        while now < start {
            phase.step(&mut state, STRIDE as f64 / RATE_HZ);
            now += STRIDE;
            phase.observe(&mut state, truth.pose(now), GAIN)?;
        }
        let here = truth.pose(start);
        let from = phase
            .enter_at(here, state.phase())?
            .with_parameters(state.parameters())?
            .paced(state.pace());
        let secs = HORIZONS[2] as f64 / RATE_HZ;
        let ahead = phase.predict(&from, secs, RATE_HZ)?;
        let drawn = paper.predict(&paper.enter(here)?, secs, RATE_HZ)?;
        for h in HORIZONS {
            poses[0].extend_from_slice(here);
            let factor = h as f64 / STRIDE as f64;
            let turned = turned_on(truth.skeleton(), truth.pose(start - STRIDE), here, factor);
            poses[1].extend(turned);
            poses[2].extend_from_slice(drawn[h - 1].pose());
            poses[3].extend_from_slice(ahead[h - 1].pose());
        }
    }
    let mut errors = [[Errors::default(); 3]; 4];
    if !starts.is_empty() {
        let seen = Postures::of_motion(&truth);
        for (own, poses) in errors.iter_mut().zip(poses) {
            let guesses = Postures::of_poses(truth.skeleton(), poses)?;
            for (i, h) in HORIZONS.into_iter().enumerate() {
                let at = |(s, start): (usize, &usize)| guesses.at(3 * s + i, &seen, start + h);
                own[i] = mean(&starts.iter().enumerate().map(at).collect::<Vec<_>>());
            }
        }
    }
    Ok(Followed {
        class: fold.class,
        cyclic: primitive.is_cyclic(),
        starts: starts.len(),
        errors,
    })
}

/// The frame where a movement begins, the rest before it trimmed, a frame with one observed before it; cycles begin with
/// the clip.
fn first_frame(truth: &Motion, cyclic: bool) -> usize {
    let first = if cyclic { 0 } else { moving(truth).start };
    first.next_multiple_of(STRIDE).max(STRIDE)
}

fn moving(truth: &Motion) -> std::ops::Range<usize> {
    let dims = landmark_dims(truth.skeleton());
    resting_ends(&truth.landmarks(), dims, RATE_HZ, &Trim::default())
}

/// Frames from which is predicted: at regular times while the clip moves, with the whole horizon inside the clip.
fn starts(truth: &Motion, cyclic: bool) -> Vec<usize> {
    let end = if cyclic {
        truth.frames()
    } else {
        moving(truth).end
    };
    (first_frame(truth, cyclic) + WARM_UP..end)
        .step_by(STARTS)
        .filter(|t| t + HORIZONS[2] < truth.frames())
        .collect()
}

/// The pose after `factor` times as long again, every joint turning on as it did between two poses.
fn turned_on(body: &Skeleton, before: &[f64], now: &[f64], factor: f64) -> Vec<f64> {
    let mut pose = now.to_vec();
    for j in 0..body.joints().len() {
        let at = body.coordinates(j);
        let (a, b) = (
            body.rotation(j, &before[at.clone()]),
            body.rotation(j, &now[at.clone()]),
        );
        let turn = (a.inverse() * b).scaled_axis() * factor;
        let turned = b * nalgebra::UnitQuaternion::from_scaled_axis(turn);
        body.set_rotation(&mut pose, j, &turned, Some(now));
    }
    pose
}

fn mean(errors: &[Errors]) -> Errors {
    let of = |f: &dyn Fn(&Errors) -> f64| average(&errors.iter().map(f).collect::<Vec<_>>());
    Errors {
        joint_deg: of(&|e| e.joint_deg),
        wrist_cm: of(&|e| e.wrist_cm),
        landmark_cm: of(&|e| e.landmark_cm),
    }
}

/// Writes the tables of followed clips.
///
/// # Errors
/// Never: writing to a string does not fail.
pub fn write_flow(
    out: &mut String,
    name: &str,
    classes: &[String],
    followed: &[Followed],
) -> Result<()> {
    for (measure, place) in [("landmark error, cm", 2), ("joint error, degrees", 0)] {
        write!(
            out,
            "\n### {name}, flowfield: {measure}\n\n| class | starts |"
        )?;
        for secs in ["0.1 s", "0.25 s", "0.5 s"] {
            for p in Predictor::ALL {
                write!(out, " {secs}: {} |", p.name())?;
            }
        }
        writeln!(out, "\n|{}", " --- |".repeat(14))?;
        let values = |class: usize, h: usize, p: usize| -> Vec<f64> {
            let own = followed.iter().filter(|f| f.class == class && f.starts > 0);
            own.map(|f| f.errors[p][h].values()[place]).collect()
        };
        let columns: Vec<(usize, usize)> =
            (0..3).flat_map(|h| (0..4).map(move |p| (h, p))).collect();
        for (c, class) in classes.iter().enumerate() {
            let own: Vec<&Followed> = followed.iter().filter(|f| f.class == c).collect();
            let mark = if own.iter().any(|f| f.cyclic) {
                " (cycle)"
            } else {
                ""
            };
            let starts: usize = own.iter().map(|f| f.starts).sum();
            write!(out, "| {class}{mark} | {starts} |")?;
            for &(h, p) in &columns {
                write!(out, " {:.1} |", average(&values(c, h, p)))?;
            }
            writeln!(out)?;
        }
        let large = |f: &dyn Fn(usize) -> Vec<f64>| -> Vec<Vec<f64>> {
            let all = (0..classes.len()).map(f);
            all.filter(|v| v.len() >= LEAST_CLIPS).collect()
        };
        write!(out, "| **mean over classes** | |")?;
        for &(h, p) in &columns {
            let i = interval(&large(&|c| values(c, h, p)));
            write!(out, " **{:.2}** ({:.2} to {:.2}) |", i.mean, i.low, i.high)?;
        }
        write!(out, "\n| less than this, phase has | |")?;
        for &(h, p) in &columns {
            if p == 3 {
                write!(out, " |")?;
                continue;
            }
            let less = |c: usize| -> Vec<f64> {
                let pairs = values(c, h, p).into_iter().zip(values(c, h, 3));
                pairs.map(|(a, b)| a - b).collect()
            };
            let i = interval(&large(&less));
            write!(out, " {:.2} ({:.2} to {:.2}) |", i.mean, i.low, i.high)?;
        }
        writeln!(out)?;
    }
    Ok(())
}
