//! Clips of unseen people joined with dances between them, answered frame by frame.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use kineme::alignment::{Trim, resting_ends};
use kineme::evaluation::{Stream, StreamScores, StreamSettings, stream_scores};
use kineme::math::statistics::quantile;
use kineme::motion::landmark_dims;
use kineme::perception::{Alarm, AlarmSettings};
use kineme::primitive::{Observations, Reading, readings};
use kineme::{Motion, Root, Skeleton};
use nalgebra::{Rotation3, Vector3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::corpora::Corpus;
use super::known::{Known, Method};
use crate::sets::{IndexRow, Result, index, load};

/// How long one piece takes to become the next, seconds.
const BLEND_SECS: f64 = 0.3;
/// How long it is danced between two clips, seconds.
const DANCE_SECS: f64 = 2.0;
/// Clips of a class, and clips a stream.
const CLIPS: usize = 2;
const CLIPS_A_STREAM: usize = 12;

/// A recording made of clips and dances.
#[derive(Debug, Clone)]
pub struct Joined {
    /// What is seen.
    pub motion: Motion,
    /// The class of each frame; `None` at rest, in dances and blends.
    pub truth: Vec<Option<usize>>,
}

/// Salsa and Indian dance: whole-body movement that no class of ours names.
///
/// # Errors
/// When the corpus lacks a file.
pub fn dances(corpus: &Path, body: &Arc<Skeleton>) -> Result<Vec<Motion>> {
    let rows = index(corpus)?;
    let of = |r: &&IndexRow| r.archive == "cmu-daz.zip" && r.label == "dance";
    let picked: Vec<&IndexRow> = rows.iter().filter(of).collect();
    Ok(load(corpus, &picked, body, None, &|r| r.label.clone())?.motions)
}

/// The clips asked of a split, at most two a class, in drawn order with a dance before each.
///
/// # Errors
/// When motions are of different bodies, or no dance is long enough.
pub fn join(corpus: &Corpus, test: &[usize], dances: &[Motion], seed: u64) -> Result<Vec<Joined>> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut order = test.to_vec();
    order.shuffle(&mut random);
    let mut counts = vec![0; corpus.set.classes.len()];
    order.retain(|&i| {
        counts[corpus.set.labels[i]] += 1;
        counts[corpus.set.labels[i]] <= CLIPS
    });
    let rate = corpus.set.motions[order[0]].rate_hz();
    let dances: Vec<Motion> = dances
        .iter()
        .map(|d| Ok(d.resampled(rate)?))
        .collect::<Result<_>>()?;
    let danced = (DANCE_SECS * rate).round() as usize;
    let mut streams = Vec::new();
    for clips in order.chunks(CLIPS_A_STREAM) {
        let mut joined = Builder::new(rate);
        for &clip in clips {
            let dance = &dances[random.random_range(0..dances.len())];
            let last = dance
                .frames()
                .checked_sub(danced)
                .ok_or("a dance too short")?;
            let start = random.random_range(0..=last);
            joined.add(&dance.slice(start..start + danced)?, |_| None);
            let motion = &corpus.set.motions[clip];
            let dims = landmark_dims(motion.skeleton());
            let moving = resting_ends(&motion.landmarks(), dims, rate, &Trim::default());
            let label = corpus.set.labels[clip];
            joined.add(motion, |f| moving.contains(&f).then_some(label));
        }
        streams.push(joined.finish(corpus.set.motions[order[0]].skeleton())?);
    }
    Ok(streams)
}

/// Joins pieces: each begins where the last one stands and faces as it does.
struct Builder {
    rate_hz: f64,
    poses: Vec<f64>,
    roots: Vec<Root>,
    truth: Vec<Option<usize>>,
}

impl Builder {
    fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            poses: Vec::new(),
            roots: Vec::new(),
            truth: Vec::new(),
        }
    }

    fn add(&mut self, piece: &Motion, truth: impl Fn(usize) -> Option<usize>) {
        let dof = piece.skeleton().dof();
        let first = piece.root(0);
        let here = self.roots.last().copied().unwrap_or(*first);
        if let Some(begin) = self.poses.len().checked_sub(dof) {
            let from = self.poses[begin..].to_vec();
            let blend = (BLEND_SECS * self.rate_hz).round() as usize;
            for k in 1..=blend {
                let share = k as f64 / (blend + 1) as f64;
                let eased = share * share * (3.0 - 2.0 * share);
                let between = from.iter().zip(piece.pose(0));
                self.poses.extend(between.map(|(a, b)| a + eased * (b - a)));
                let mut root = here;
                root.position.z += eased * (first.position.z - here.position.z);
                self.roots.push(root);
                self.truth.push(None);
            }
        }
        let turn = here.yaw - first.yaw;
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
        for f in 0..piece.frames() {
            let root = piece.root(f);
            let mut position = turned * (root.position - first.position);
            position.x += here.position.x;
            position.y += here.position.y;
            position.z = root.position.z;
            self.poses.extend_from_slice(piece.pose(f));
            self.roots.push(Root {
                position,
                yaw: root.yaw + turn,
            });
            self.truth.push(truth(f));
        }
    }

    fn finish(self, body: &Arc<Skeleton>) -> Result<Joined> {
        let motion = Motion::new("joined", body.clone(), self.rate_hz, self.poses, self.roots)?;
        Ok(Joined {
            motion,
            truth: self.truth,
        })
    }
}

/// What each recogniser of a split thought of every frame, with the truth.
#[derive(Debug, Clone)]
pub struct Heard {
    rate_hz: f64,
    truth: Vec<Option<usize>>,
    readings: Vec<Reading>,
}

/// Readings of each method of every stream of a set.
///
/// # Errors
/// When a primitive cannot be learned.
pub fn hear(corpus: &Corpus, dances: &[Motion], methods: &[Method]) -> Result<Vec<Vec<Heard>>> {
    let mut all = vec![Vec::new(); methods.len()];
    for (seed, split) in corpus.splits.iter().enumerate() {
        let known = Known::learn(&corpus.set, &split.train)?;
        let streams = join(corpus, &split.test, dances, seed as u64)?;
        let primitive = |class: usize| known.class_of.iter().position(|c| *c == class);
        for (all, method) in all.iter_mut().zip(methods) {
            let recogniser = method.over(&known.vocabulary)?;
            let one = |s: &Joined| -> Result<Heard> {
                Ok(Heard {
                    rate_hz: s.motion.rate_hz(),
                    truth: s.truth.iter().map(|t| t.and_then(primitive)).collect(),
                    readings: readings(&*recogniser, &Observations::complete(s.motion.clone()))?,
                })
            };
            all.extend(streams.par_iter().map(one).collect::<Result<Vec<_>>>()?);
        }
    }
    Ok(all)
}

/// Scores of streams as they were answered.
///
/// # Errors
/// Without streams.
pub fn judge(heard: &[Heard]) -> Result<StreamScores> {
    let stream = |h: &Heard| Stream::of_readings(h.rate_hz, h.truth.clone(), &h.readings);
    let streams = heard
        .iter()
        .map(stream)
        .collect::<kineme::Result<Vec<_>>>()?;
    Ok(stream_scores(&streams, &StreamSettings::default())?)
}

/// Scores of what an alarm with its defaults announces, as whoever acts on a stream hears it.
///
/// # Errors
/// Without streams.
pub fn judge_announced(heard: &[Heard]) -> Result<StreamScores> {
    let stream = |h: &Heard| {
        let primitives = h.readings.first().ok_or("no frames")?;
        let primitives = primitives.posterior.primitives.len();
        let mut alarm = Alarm::new(primitives, &AlarmSettings::default())?;
        let frames = h.readings.iter().enumerate();
        let answers = frames.map(|(f, r)| alarm.hear(f as f64 / h.rate_hz, &r.posterior));
        let answers = answers.collect::<kineme::Result<Vec<_>>>()?;
        Ok(Stream::new(h.rate_hz, h.truth.clone(), answers)?)
    };
    let streams = heard.iter().map(stream).collect::<Result<Vec<_>>>()?;
    Ok(stream_scores(&streams, &StreamSettings::default())?)
}

/// Scores where what is more novel than a limit counts as none: that one of nineteen limits which serves best, known
/// in hindsight only. It gives a recogniser that knows no rest and nothing unknown the best it could have.
///
/// # Errors
/// Without streams.
pub fn judge_limited(heard: &[Heard]) -> Result<StreamScores> {
    let novelty = |h: &Heard| h.readings.iter().map(|r| r.novelty).collect::<Vec<_>>();
    let novelties: Vec<f64> = heard.iter().flat_map(novelty).collect();
    let mut best: Option<StreamScores> = None;
    for k in 1..20 {
        let limit = quantile(&novelties, f64::from(k) / 20.0).ok_or("no frames")?;
        let stream = |h: &Heard| {
            let answer = |r: &Reading| r.posterior.best().filter(|_| r.novelty <= limit);
            let answers = h.readings.iter().map(answer).collect();
            Stream::new(h.rate_hz, h.truth.clone(), answers)
        };
        let streams = heard
            .iter()
            .map(stream)
            .collect::<kineme::Result<Vec<_>>>()?;
        let scores = stream_scores(&streams, &StreamSettings::default())?;
        if best.is_none_or(|b| scores.balanced_accuracy > b.balanced_accuracy) {
            best = Some(scores);
        }
    }
    best.ok_or_else(|| "no streams".into())
}

/// Writes the table of a set.
///
/// # Errors
/// Without streams.
pub fn write_streams(
    out: &mut String,
    corpus: &Corpus,
    methods: &[Method],
    heard: &[Vec<Heard>],
) -> Result<()> {
    let first = judge(&heard[0])?;
    writeln!(
        out,
        "\n### {}, streams: {} clips with dances between them, {:.1} minutes\n\n| method | balanced accuracy of frames | onset, median | 90 % | never answered | false alarms a minute |\n| --- | --- | --- | --- | --- | --- |",
        corpus.name, first.spans, first.minutes
    )?;
    for (method, heard) in methods.iter().zip(heard) {
        write_row(out, method.name(), &judge(heard)?)?;
        if *method == Method::Filter {
            let name = format!("{}, as announced", method.name());
            write_row(out, &name, &judge_announced(heard)?)?;
        }
        if *method == Method::Dtw {
            let name = format!("{}, best limit in hindsight", method.name());
            write_row(out, &name, &judge_limited(heard)?)?;
        }
    }
    Ok(())
}

fn write_row(out: &mut String, name: &str, scores: &StreamScores) -> Result<()> {
    let (median, p90) = scores.onset.map_or(("-".into(), "-".into()), |o| {
        let secs = |s: f64| format!("{s:.2} s");
        (secs(o.median_secs), secs(o.p90_secs))
    });
    writeln!(
        out,
        "| {name} | {:.3} | {median} | {p90} | {} of {} | {:.1} |",
        scores.balanced_accuracy,
        scores.missed,
        scores.spans,
        scores.false_alarms_a_minute()
    )?;
    Ok(())
}
