//! `kineme evaluate`: how well a vocabulary recognises labelled motion, beside the baselines.

mod clips;
mod methods;
mod told;

use std::time::Instant;

use kineme::Vocabulary;
use kineme::evaluation::{
    Bootstrap, ByChance, Judged, Scores, calibration_by_chance, differences, scores,
};
use kineme::primitive::Recogniser;
use rayon::prelude::*;

use crate::args::{EvaluateArgs, Global, MethodName};
use crate::failure::{Failure, print};
use crate::progress;
use crate::vocabularies::to_recognise;
use clips::{Clip, clips};
use methods::{name, recogniser};

/// How many frames are timed: enough for the slowest one in a hundred.
const TIMED_FRAMES: usize = 2000;

/// What came of a method.
struct Outcome {
    method: MethodName,
    /// Its answers, in the order of the clips.
    judged: Vec<Judged>,
    scores: Scores,
    /// The calibration error that exactly right probabilities would show on these clips.
    by_chance: Option<ByChance>,
    /// How much better the first method is.
    behind: Scores,
    /// The median and the 99th percentile of the time a frame takes, microseconds.
    decision_us: Option<[f64; 2]>,
}

pub fn run(args: &EvaluateArgs, global: &Global) -> Result<u8, Failure> {
    if [&args.vocabulary, &args.manifest]
        .iter()
        .all(|p| p.as_os_str() == "-")
    {
        return Err(Failure::usage(
            "stdin cannot be both the vocabulary and the manifest",
        ));
    }
    let vocabulary = to_recognise(&args.vocabulary)?;
    let mut found = clips(&vocabulary, args)?;
    let clips = std::mem::take(&mut found.items);
    let bootstrap = Bootstrap {
        seed: global.seed,
        ..Bootstrap::default()
    };
    let mut methods: Vec<MethodName> = Vec::new();
    for method in &args.methods {
        if !methods.contains(method) {
            methods.push(*method);
        }
    }
    let bar = progress::bar(methods.len() * clips.len(), "recognising");
    let mut outcomes: Vec<Outcome> = Vec::new();
    for method in methods {
        let recogniser = recogniser(method, &vocabulary)?;
        let answers: Vec<kineme::Result<Judged>> = clips
            .par_iter()
            .with_max_len(1)
            .map(|clip| {
                let answer = recogniser.recognise(&clip.seen)?;
                bar.inc(1);
                Ok(Judged::new(clip.truth, &answer))
            })
            .collect();
        let judged = answers
            .into_iter()
            .collect::<kineme::Result<Vec<Judged>>>()?;
        let first = outcomes.first().map_or(&judged, |first| &first.judged);
        let decision_us = args
            .timings
            .then(|| times(&*recogniser, &clips))
            .transpose()?;
        outcomes.push(Outcome {
            method,
            scores: scores(&judged, &bootstrap)?,
            by_chance: calibration_by_chance(&judged.chunks(1).collect::<Vec<_>>(), &bootstrap)?,
            behind: differences(first, &judged, &bootstrap)?,
            judged,
            decision_us,
        });
    }
    bar.finish_and_clear();
    let told = match global.json {
        true => told::document(&vocabulary, &clips, &outcomes)?,
        false => told::tables(&vocabulary, &clips, &outcomes, &bootstrap, args)?,
    };
    print(told.as_bytes())?;
    Ok(found.print_skipped())
}

/// How long a recogniser takes for one more frame of a stream, microseconds: the median and the 99th percentile.
fn times(recogniser: &dyn Recogniser, clips: &[Clip]) -> Result<[f64; 2], Failure> {
    let mut times = Vec::new();
    for clip in clips {
        let mut listener = recogniser.listen();
        for f in 0..clip.seen.motion().frames() {
            let begun = Instant::now();
            listener.hear(&clip.seen.at(f))?;
            times.push(1e6 * begun.elapsed().as_secs_f64());
        }
        if times.len() >= TIMED_FRAMES {
            break;
        }
    }
    let at = |q: f64| kineme::math::statistics::quantile(&times, q).unwrap_or(0.0);
    Ok([at(0.5), at(0.99)])
}

/// The name of a class: a primitive, or none of them.
fn class(vocabulary: &Vocabulary, class: Option<usize>) -> &str {
    class.map_or("none", |i| vocabulary.primitives()[i].name())
}
