//! Questions put to recognisers, and their answers judged.

use kineme::Motion;
use kineme::evaluation::{Bootstrap, Estimate, Judged};
use kineme::primitive::{Observations, Posterior, Recogniser};
use rayon::prelude::*;

use super::known::Known;
use crate::sets::{LabelledSet, Result};

/// Answers to whole clips as `seen` shows them, in classes of the set; what the vocabulary lacks is impossible, and a
/// clip of such a class is none of them.
///
/// # Errors
/// When a clip is of another body.
pub fn answers(
    recogniser: &dyn Recogniser,
    known: &Known,
    set: &LabelledSet,
    clips: &[usize],
    seen: &(dyn Fn(usize, &Motion) -> Result<Observations> + Sync),
) -> Result<Vec<Judged>> {
    let ask = |&clip: &usize| -> Result<Judged> {
        let label = set.labels[clip];
        let truth = known.class_of.contains(&label).then_some(label);
        let answer = recogniser.recognise(&seen(clip, &set.motions[clip])?)?;
        let mut judged = Judged::new(truth, &answer);
        let of_primitives = std::mem::take(&mut judged.posterior.primitives);
        let mut of_classes = vec![0.0; known.classes];
        for (p, &class) in of_primitives.into_iter().zip(&known.class_of) {
            of_classes[class] = p;
        }
        judged.posterior.primitives = of_classes;
        Ok(judged)
    };
    clips.par_iter().map(ask).collect()
}

/// A clip as it was recorded.
///
/// # Errors
/// None: it stands for what may fail.
pub fn as_recorded(_: usize, motion: &Motion) -> Result<Observations> {
    Ok(Observations::complete(motion.clone()))
}

/// Answers where it is known beforehand that each clip shows one of the primitives: rest and none are ruled out. A
/// recogniser that found every primitive impossible has no answer, which is wrong. Binary judgements are not made to
/// sum to one.
pub fn among_known(judged: &[Judged], binary: bool) -> Vec<Judged> {
    let rule_out = |j: &Judged| {
        let p = &j.posterior.primitives;
        let sum: f64 = p.iter().sum();
        let (primitives, none) = match (binary, sum > 0.0) {
            (true, _) => (p.clone(), 0.0),
            (false, true) => (p.iter().map(|v| v / sum).collect(), 0.0),
            (false, false) => (p.clone(), 1.0),
        };
        Judged {
            posterior: Posterior {
                primitives,
                rest: 0.0,
                none,
            },
            ..j.clone()
        }
    };
    judged.iter().map(rule_out).collect()
}

/// 1 for each right answer, 0 for each wrong one.
pub fn rights(judged: &[Judged]) -> Vec<f64> {
    let right = |j: &Judged| f64::from(u8::from(j.answer() == j.truth));
    judged.iter().map(right).collect()
}

/// The mean of values with its interval, drawn over `blocks` of successive values (1: over the values themselves).
///
/// # Errors
/// Without values.
pub fn mean(values: &[f64], blocks: usize) -> Result<Estimate> {
    let items: Vec<&[f64]> = values.chunks(blocks.max(1)).collect();
    let statistics = |counts: &[u32]| {
        let (mut sum, mut all) = (0.0, 0.0);
        for (item, &count) in items.iter().zip(counts) {
            sum += f64::from(count) * item.iter().sum::<f64>();
            all += f64::from(count) * item.len() as f64;
        }
        [Some(sum / all)]
    };
    let [estimate] = Bootstrap::default().estimates(items.len(), statistics)?;
    Ok(estimate.ok_or("no values")?)
}
