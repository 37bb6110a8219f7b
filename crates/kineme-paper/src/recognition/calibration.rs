//! Whether probabilities come true: of one split, and of many pooled, beside what chance does.

use std::fmt::Write as _;

use kineme::evaluation::{
    Bootstrap, ByChance, Judged, Scores, calibration_by_chance, pooled_scores,
};

use super::answers::{answers, as_recorded};
use super::clips::Asked;
use super::corpora::{Corpus, Split};
use super::known::{Known, Method};
use super::summary::{shown, verdict};
use crate::sets::Result;

/// What the calibration error should be at most.
pub const AIM: f64 = 0.05;

/// How well probabilities of a number of answers came true.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibrated {
    /// Splits that were learned.
    pub splits: usize,
    /// Clips asked.
    pub clips: usize,
    /// Answers to them, rest and none among these.
    pub answers: usize,
    /// Their scores; intervals are over clips.
    pub scores: Scores,
    /// What exactly right probabilities would show on these answers by chance.
    pub chance: ByChance,
}

impl Calibrated {
    /// Of answers to clips, each clip in as many of `splits` as asked it.
    ///
    /// # Errors
    /// Without answers, and when they are no probabilities.
    pub fn of(splits: usize, clips: &[&[Judged]]) -> Result<Self> {
        let bootstrap = Bootstrap::default();
        Ok(Self {
            splits,
            clips: clips.len(),
            answers: clips.iter().map(|c| c.len()).sum(),
            scores: pooled_scores(clips, &bootstrap)?,
            chance: calibration_by_chance(clips, &bootstrap)?.ok_or("no probabilities")?,
        })
    }
}

/// The calibration of the filter on a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The set's name.
    pub set: &'static str,
    /// On the splits of all other rows, each clip once.
    pub single: Calibrated,
    /// On the pooled splits, all answers together; as `single` where there are no others.
    pub pooled: Calibrated,
}

/// The line of a set, of which the splits of the rows were `asked`; the pooled ones are learned and asked here.
///
/// # Errors
/// When the filter was not asked, a primitive cannot be learned or a clip not be recognised.
pub fn line(corpus: &Corpus, asked: &Asked) -> Result<Line> {
    let alone: Vec<&[Judged]> = asked.of_method(Method::Filter)?.chunks(1).collect();
    let single = Calibrated::of(corpus.splits.len(), &alone)?;
    let pooled = match corpus.pooled.as_slice() {
        [] => single,
        splits => {
            let of_clips = of_clips(corpus, splits, Method::Filter)?;
            let of_clips: Vec<&[Judged]> = of_clips.iter().map(Vec::as_slice).collect();
            Calibrated::of(splits.len(), &of_clips)?
        }
    };
    Ok(Line {
        set: corpus.name,
        single,
        pooled,
    })
}

/// The answers to each clip that is asked in any split.
///
/// # Errors
/// As for [`fn@line`].
pub fn of_clips(corpus: &Corpus, splits: &[Split], method: Method) -> Result<Vec<Vec<Judged>>> {
    let mut of_clips: Vec<Vec<Judged>> = vec![Vec::new(); corpus.set.motions.len()];
    for split in splits {
        let known = Known::learn(&corpus.set, &split.train)?;
        let recogniser = method.over(&known.vocabulary)?;
        let of = answers(&*recogniser, &known, &corpus.set, &split.test, &as_recorded)?;
        for (&clip, judged) in split.test.iter().zip(of) {
            of_clips[clip].push(judged);
        }
    }
    of_clips.retain(|answers| !answers.is_empty());
    Ok(of_clips)
}

/// What chance does, in the mean and in 95 of 100 cases at most.
pub fn by_chance(chance: &ByChance) -> String {
    format!("{:.3}, {:.3}", chance.mean, chance.high)
}

/// Writes the table of calibration.
///
/// # Errors
/// When scores have no calibration error.
pub fn write_calibration(out: &mut String, lines: &[Line]) -> Result<()> {
    writeln!(
        out,
        "\n### Aims: calibration error of `filter`, rest and none among the answers\n\n| set | one answer a clip: ECE | by chance | pooled | ECE | by chance | log loss | accuracy | aim, at most | |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    )?;
    for Line {
        set,
        single,
        pooled,
    } in lines
    {
        let error = |of: &Calibrated| of.scores.calibration_error.ok_or("no probabilities");
        let loss = pooled.scores.log_loss.ok_or("no probabilities")?;
        let ece = error(pooled)?;
        writeln!(
            out,
            "| {set} | {:.3} | {} | {} answers to {} clips, {} splits | {} | {} | {} | {} | {AIM} | {} |",
            error(single)?.value,
            by_chance(&single.chance),
            pooled.answers,
            pooled.clips,
            pooled.splits,
            shown(&ece),
            by_chance(&pooled.chance),
            shown(&loss),
            shown(&pooled.scores.accuracy),
            verdict(-ece.value, Some(-AIM))
        )?;
    }
    writeln!(
        out,
        "\nBy chance: what exactly right probabilities would show on the same answers, in the mean, and in 95 of 100 cases at most."
    )?;
    Ok(())
}
