//! The evidence on real people: its arithmetic on made-up answers, each kind of row on a few recordings.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::evaluation::Judged;
use kineme::primitive::Posterior;
use kineme::{Motion, Root, ares};
use kineme_paper::recognition::answers::{among_known, mean, rights};
use kineme_paper::recognition::calibration::{Calibrated, line, write_calibration};
use kineme_paper::recognition::clips::{Asked, lines, write_clips};
use kineme_paper::recognition::corpora::{
    BANDAI_NAMCO, Corpus, HDM05, MSR, Part, Split, UTD, corpora,
};
use kineme_paper::recognition::damage::{DAMAGES, Damage, costs};
use kineme_paper::recognition::exercises::Exercises;
use kineme_paper::recognition::few_shots::few_shots;
use kineme_paper::recognition::known::Method;
use kineme_paper::recognition::latency::Fast;
use kineme_paper::recognition::open_set::{rejections, write_rejections};
use kineme_paper::recognition::peers::Peers;
use kineme_paper::recognition::streams::{hear, join, judge, judge_limited};
use kineme_paper::recognition::summary::{Aim, Line, write_lines};
use kineme_paper::recognition::trials::{few, halves};
use kineme_paper::sets::LabelledSet;

fn answered(truth: usize, primitives: &[f64], rest: f64, none: f64) -> Judged {
    Judged {
        truth: Some(truth),
        posterior: Posterior {
            primitives: primitives.to_vec(),
            rest,
            none,
        },
        novelty: 0.0,
    }
}

#[test]
fn where_all_is_known_rest_and_none_are_no_answers() {
    // The answer, whether it is right as it is, and among the known.
    let cases = [
        (answered(0, &[0.2, 0.1], 0.1, 0.6), 0.0, 1.0),
        (answered(1, &[0.2, 0.1], 0.1, 0.6), 0.0, 0.0),
        (answered(0, &[0.7, 0.1], 0.1, 0.1), 1.0, 1.0),
        (answered(0, &[0.0, 0.0], 0.0, 1.0), 0.0, 0.0),
    ];
    for (judged, open, closed) in cases {
        let judged = [judged];
        assert_eq!(rights(&judged), [open], "{judged:?}");
        for binary in [false, true] {
            assert_eq!(
                rights(&among_known(&judged, binary)),
                [closed],
                "{judged:?}"
            );
        }
        let p = &among_known(&judged, false)[0].posterior;
        let sum: f64 = p.primitives.iter().sum::<f64>() + p.rest + p.none;
        assert!((sum - 1.0).abs() < 1e-12, "{p:?}");
    }
}

#[test]
fn steps_that_fall_together_make_wider_intervals() {
    let runs: Vec<f64> = (0..200)
        .map(|k| f64::from(u8::from(k / 20 % 3 > 0)))
        .collect();
    let (single, blocks) = (
        mean(&runs, 1).expect("a mean"),
        mean(&runs, 20).expect("a mean"),
    );
    assert_eq!(single.value, blocks.value);
    assert!(blocks.high - blocks.low > 2.0 * (single.high - single.low));
    assert!(mean(&[], 1).is_err());
}

#[test]
fn misses_are_called_misses() {
    let line = |ours: f64, baseline: f64, aim| {
        Line::of("row", &[ours; 9], &[baseline; 9], 1, aim).expect("a row")
    };
    let peers = Peers::kept().expect("the peers' table");
    let cases = [
        (
            line(0.9, 0.8, Some(Aim::alone(0.85))),
            "| 0.85 | met |",
            "on no row below",
        ),
        (
            line(0.9, 0.8, Some(Aim::beside(0.95, 0.87))),
            "| 0.95 (0.870) | **missed** |",
            "as far above 1NN-DTW as aimed: 1 of 1",
        ),
        (
            line(0.9, 0.8, Some(Aim::beside(0.95, 0.84))),
            "| **missed** |",
            "as far above 1NN-DTW as aimed: 0 of 1",
        ),
        (
            line(0.7, 0.8, None),
            "| - |",
            "**below it by more than the interval: row**",
        ),
    ];
    for (line, verdict, must) in cases {
        let mut out = String::new();
        write_lines(&mut out, "filter", "1NN-DTW", &[line], &peers).expect("written");
        assert!(out.contains(verdict) && out.contains(must), "{out}");
    }
    assert!(Line::of("row", &[1.0], &[1.0, 0.0], 1, None).is_err());
}

/// A motion of `frames` in which every coordinate goes its own way.
fn swaying(frames: usize) -> Motion {
    let body = Arc::new(ares().expect("a body"));
    let neutral = body.neutral();
    let pose = |f: usize| {
        let sway = move |(c, v): (usize, &f64)| v + 0.2 * (0.1 * f as f64 + c as f64).sin();
        neutral.iter().enumerate().map(sway).collect::<Vec<f64>>()
    };
    let poses = (0..frames).flat_map(pose).collect();
    Motion::new(
        "swaying",
        body.clone(),
        30.0,
        poses,
        vec![Root::ORIGIN; frames],
    )
    .expect("a motion")
}

/// Twelve clips of three classes by two people.
fn made_up() -> Corpus {
    let clips = 12;
    Corpus {
        name: "made up",
        set: LabelledSet {
            motions: (0..clips).map(|i| swaying(20 + i)).collect(),
            labels: (0..clips).map(|i| i % 3).collect(),
            classes: ["a", "b", "c"].map(String::from).to_vec(),
        },
        subjects: (0..clips).map(|i| (i / 6).to_string()).collect(),
        splits: vec![Split {
            train: (0..6).collect(),
            test: (6..clips).collect(),
        }],
        pooled: Vec::new(),
    }
}

#[test]
fn damage_is_what_it_is_called() {
    let motion = swaying(200);
    let body = motion.skeleton();
    let joints = body.joints().len();
    let missing = |d: Damage| -> Vec<bool> {
        let seen = d.of(3, &motion).expect("damaged");
        (0..seen.motion().frames())
            .flat_map(|f| seen.at(f).missing.to_vec())
            .collect()
    };
    for d in DAMAGES {
        let (once, again) = (
            d.of(3, &motion).expect("damaged"),
            d.of(3, &motion).expect("damaged"),
        );
        assert_eq!(once, again, "{d:?}");
        let ratio = motion.frames() as f64 / once.motion().frames() as f64;
        let speed = if let Damage::Speed(times) = d {
            times
        } else {
            1.0
        };
        assert!((ratio - speed).abs() < 0.02, "{d:?}: {ratio}");
        assert_eq!(once.motion().rate_hz(), motion.rate_hz());
    }
    let noisy = Damage::NoiseDeg(5.0).of(3, &motion).expect("damaged");
    let off: Vec<f64> = noisy
        .motion()
        .poses()
        .iter()
        .zip(motion.poses())
        .map(|(a, b)| a - b)
        .collect();
    let deviation = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
    assert!((deviation.to_degrees() - 5.0).abs() < 0.2, "{deviation}");
    let share = missing(Damage::Missing(0.2)).iter().filter(|m| **m).count() as f64;
    assert!((share / (200 * joints) as f64 - 0.2).abs() < 0.02);
    assert_eq!(missing(Damage::Lost).iter().filter(|m| **m).count(), 200);
    let stuck = Damage::Stuck.of(3, &motion).expect("damaged");
    let differs = |c: &usize| stuck.motion().pose(7)[*c] != motion.pose(7)[*c];
    assert!((1..=3).contains(&(0..body.dof()).filter(differs).count()));
}

#[test]
fn nobody_is_asked_who_was_learned_from() {
    let corpus = made_up();
    let classes = |clips: &[usize]| {
        let mut of: Vec<usize> = clips.iter().map(|&i| corpus.set.labels[i]).collect();
        of.sort_unstable();
        of
    };
    let half = halves(&corpus);
    assert_eq!((half.splits.len(), half.open), (10, true));
    for split in &half.splits {
        assert_eq!(
            classes(&split.train).chunk_by(|a, b| a == b).count(),
            1,
            "{split:?}"
        );
        assert!(split.train.iter().all(|i| !split.test.contains(i)));
        assert_eq!(split.test.len(), 2);
    }
    let drawn = few(&corpus, 1);
    for split in &drawn.splits {
        assert_eq!(classes(&split.train), [0, 1, 2], "{split:?}");
    }
    let mut asked: Vec<usize> = drawn.splits.iter().flat_map(|s| s.test.clone()).collect();
    asked.sort_unstable();
    assert_eq!(asked, corpus.splits[0].test, "everybody once");
    assert!(
        drawn.splits.windows(2).any(|w| w[0] != w[1]),
        "drawn alike each time"
    );
}

#[test]
fn joined_streams_go_on_from_where_they_are() {
    let corpus = made_up();
    let streams = join(&corpus, &corpus.splits[0].test, &[swaying(90)], 0).expect("joined");
    assert_eq!(streams.len(), 1);
    let joined = &streams[0];
    assert_eq!(joined.truth.len(), joined.motion.frames());
    // A dance and a clip, six times, and a blend of nine frames before each but the first.
    let clips: usize = (6..12).map(|i| 20 + i).sum();
    assert_eq!(joined.motion.frames(), 6 * 60 + clips + 11 * 9);
    assert!(joined.truth.iter().flatten().count() <= clips);
    let step = |f: usize| {
        let pairs = joined.motion.pose(f).iter().zip(joined.motion.pose(f + 1));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let largest = (0..joined.motion.frames() - 1)
        .map(step)
        .fold(0.0, f64::max);
    assert!(largest < 0.1, "a jump of {largest} rad");
}

fn corpus() -> Option<PathBuf> {
    let data = match std::env::var_os("KINEME_DATA") {
        Some(data) => PathBuf::from(data),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
    };
    let corpus = data.join("mocap");
    let there = corpus.join("index.csv").exists();
    if !there {
        println!("skipped: no recordings at {}", corpus.display());
    }
    there.then_some(corpus)
}

/// A few clips of a few classes.
fn part(corpus: &Path, name: &str, classes: usize, clips: usize) -> Corpus {
    let body = Arc::new(ares().expect("a body"));
    let part = Part { classes, clips };
    corpora(corpus, &body, &[name], part)
        .expect("recordings")
        .remove(0)
}

#[test]
fn every_set_is_split_between_people_or_styles() {
    let Some(folder) = corpus() else { return };
    for (name, splits) in [(UTD, 1), (MSR, 1), (HDM05, 3), (BANDAI_NAMCO, 2)] {
        let c = part(&folder, name, 2, 1);
        assert_eq!(c.splits.len(), splits, "{name}");
        for split in &c.splits {
            assert!(!split.train.is_empty() && !split.test.is_empty(), "{name}");
            let known = |i: &usize| split.train.iter().any(|t| c.subjects[*t] == c.subjects[*i]);
            assert!(!split.test.iter().any(known), "{name}");
        }
    }
}

#[test]
fn pooled_splits_ask_every_clip_equally_often_of_strangers() {
    let Some(folder) = corpus() else { return };
    // Splits, subjects learned, and how often each clip is asked.
    for (name, splits, learned, asked) in [
        (UTD, 6, 2, 3),
        (MSR, 10, 3, 4),
        (HDM05, 0, 0, 0),
        (BANDAI_NAMCO, 7, 3, 4),
    ] {
        let c = part(&folder, name, 2, 1);
        assert_eq!(c.pooled.len(), splits, "{name}");
        let mut counts = vec![0; c.subjects.len()];
        let mut sets = Vec::new();
        for split in &c.pooled {
            let mut known: Vec<&String> = split.train.iter().map(|t| &c.subjects[*t]).collect();
            known.sort();
            known.dedup();
            assert_eq!(known.len(), learned, "{name}");
            assert_eq!(split.train.len() + split.test.len(), counts.len(), "{name}");
            for t in &split.test {
                assert!(!known.contains(&&c.subjects[*t]), "{name}");
                counts[*t] += 1;
            }
            assert!(!sets.contains(&known), "{name}: {known:?} twice");
            sets.push(known);
        }
        assert!(counts.iter().all(|n| *n == asked), "{name}: {counts:?}");
    }
}

#[test]
fn calibration_is_told_of_one_split_and_of_all() {
    let Some(folder) = corpus() else { return };
    let c = part(&folder, UTD, 3, 2);
    let asked = Asked::of(&c, &PAIR[..1]).expect("asked");
    let of = line(&c, &asked).expect("a line");
    let counts = |c: &Calibrated| (c.splits, c.clips, c.answers);
    assert_eq!(counts(&of.single), (1, 12, 12));
    assert_eq!(counts(&of.pooled), (6, 24, 72));
    assert!(of.pooled.chance.mean < of.single.chance.mean, "{of:?}");
    let mut out = String::new();
    write_calibration(&mut out, &[of]).expect("written");
    assert!(out.contains("72 answers to 24 clips, 6 splits"), "{out}");
    let all = Corpus {
        pooled: Vec::new(),
        ..c
    };
    let of = line(&all, &asked).expect("a line");
    assert_eq!(of.single, of.pooled, "no other splits");
}

const PAIR: [Method; 2] = [Method::Filter, Method::Dtw];

#[test]
fn whole_clips_few_exemplars_and_damage_have_their_rows() {
    let Some(folder) = corpus() else { return };
    let c = part(&folder, UTD, 3, 2);
    let methods = [PAIR[0], PAIR[1], Method::Encode, Method::DtwHands];
    let asked = Asked::of(&c, &methods).expect("asked");
    let [all, hands] = lines(&c, &asked).expect("lines");
    // A swipe to the left, one to the right, a wave: nobody should confuse them.
    assert!(all.ours.value > 0.7 && all.baseline.value > 0.7, "{all:?}");
    assert!(hands.ours.value > 0.5, "{hands:?}");
    let mut out = String::new();
    write_clips(&mut out, &c, &asked).expect("written");
    assert!(
        out.contains("12 clips asked, 3 classes") && out.contains("| encode |"),
        "{out}"
    );
    let line = few_shots(&c, 1, PAIR[0], PAIR[1]).expect("few");
    assert!(line.ours.value > 0.5, "{line:?}");
    let hurt = costs(&c, &PAIR[..1], 3).expect("damaged");
    assert!(hurt[0].iter().all(|right| right.len() == 4), "{hurt:?}");
}

#[test]
fn unknown_classes_and_streams_have_their_rows() {
    let Some(folder) = corpus() else { return };
    let c = part(&folder, UTD, 4, 2);
    let all = rejections(&c, &PAIR).expect("asked");
    let mut out = String::new();
    let lines = write_rejections(&mut out, &c, &PAIR, &all).expect("written");
    assert_eq!(all[0].len(), 10);
    assert!(
        lines.iter().all(|l| (0.0..=1.0).contains(&l.ours.value)),
        "{lines:?}"
    );
    // A class of the set stands for a dance: it is long enough at half speed.
    let dance = Damage::Speed(0.5)
        .of(0, &c.set.motions[0])
        .expect("slow")
        .motion()
        .clone();
    let heard = hear(&c, &[dance], &PAIR).expect("heard");
    for heard in &heard {
        let (plain, limited) = (
            judge(heard).expect("judged"),
            judge_limited(heard).expect("judged"),
        );
        assert_eq!(plain.spans, 8, "two a class");
        assert!(
            plain.missed < plain.spans && plain.balanced_accuracy > 0.0,
            "{plain:?}"
        );
        assert!(limited.balanced_accuracy > 0.0, "{limited:?}");
    }
    let mut ticks = 0.0;
    let mut clock = || {
        ticks += 1.0;
        ticks
    };
    let latency = Fast::of(&c)
        .expect("learned")
        .latency(Method::Constant, &mut clock);
    let latency = latency.expect("timed");
    assert_eq!((latency.median_secs, latency.p99_secs), (1.0, 1.0));
}

#[test]
fn exercises_are_cut_and_watched() {
    let Some(folder) = corpus() else { return };
    let body = Arc::new(ares().expect("a body"));
    let e = Exercises::read(&folder, &body).expect("recordings");
    assert_eq!((e.truth.len(), e.pieces.classes.len()), (251, 7));
    assert_eq!((e.frame(0), e.frame(250)), (11, 3011));
    let longest = e
        .pieces
        .motions
        .iter()
        .map(Motion::duration_secs)
        .fold(0.0, f64::max);
    assert!(longest < 4.1, "{longest} s");
    // Two recordings are cut whole, up to what is left of a run after its last repetition.
    let begun = &e.begin_secs;
    assert_eq!(begun.len(), e.pieces.motions.len());
    let joined = |i: &usize| {
        let end = begun[i - 1] + e.pieces.motions[i - 1].duration_secs();
        (begun[*i] - end).abs() < 0.1
    };
    let (twice, all) = (
        begun.windows(2).filter(|w| w[1] < w[0]).count(),
        begun.len(),
    );
    assert_eq!(twice, 1, "{begun:?}");
    assert!(2 * (1..all).filter(joined).count() > all, "{begun:?}");
    for class in 0..7 {
        assert!(e.pieces.labels.contains(&class), "{class}");
    }
}
