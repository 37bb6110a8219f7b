//! Answers to whole clips, judged.

use super::bootstrap::{Bootstrap, Estimate};
use super::measures::{MEASURES, Sample};
use crate::error::{Error, Result};
use crate::primitive::{Posterior, Recognition};

/// An answer to a clip, beside the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The primitive that it is, an index into the vocabulary; `None`: none of them, a *negative*.
    pub truth: Option<usize>,
    /// What was answered.
    pub posterior: Posterior,
    /// How unlike everything known the clip was found.
    pub novelty: f64,
}

impl Judged {
    /// The answer of a recogniser to a clip.
    pub fn new(truth: Option<usize>, answer: &Recognition) -> Self {
        Self {
            truth,
            posterior: answer.posterior.clone(),
            novelty: answer.novelty,
        }
    }

    /// The primitive that was answered; `None` where rest or none was at least as probable.
    pub fn answer(&self) -> Option<usize> {
        self.posterior.best()
    }
}

/// How well clips were recognised, or how much better than by another. Negatives are a class of their own, beside the
/// primitives; rest and none are one answer to them. What is undefined is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scores {
    /// The share of clips answered rightly.
    pub accuracy: Estimate,
    /// The mean over the classes that are present of the share of their clips answered rightly.
    pub balanced_accuracy: Estimate,
    /// The mean over the classes that are present of F1, the harmonic mean of precision and recall.
    pub macro_f1: Estimate,
    /// The mean of minus the natural logarithm of the truth's probability, which counts as at least 1e-15. `None` where
    /// posteriors do not sum to 1, as those of binary recognisers.
    pub log_loss: Option<Estimate>,
    /// The expected calibration error (Naeini, Cooper and Hauskrecht 2015): over ten equal bins of the answer's
    /// probability, the mean gap between it and the share of right answers. `None` as for the log loss.
    pub calibration_error: Option<Estimate>,
    /// The probability that a negative is found more novel than a positive, ties half: the area under the curve of
    /// rejection. `None` without negatives or without positives.
    pub auroc: Option<Estimate>,
    /// The share of negatives that are more novel than the least limit that keeps 95 % of the positives. The limit is
    /// known in hindsight only: what rejection could do, not what it does. `None` as for the area.
    pub unknowns_found: Option<Estimate>,
}

impl Scores {
    fn of(estimates: [Option<Estimate>; MEASURES]) -> Result<Self> {
        let [
            Some(accuracy),
            Some(balanced_accuracy),
            Some(macro_f1),
            log_loss,
            calibration_error,
            auroc,
            unknowns_found,
        ] = estimates
        else {
            return Err(Error::invalid("nothing to judge: no clips"));
        };
        Ok(Self {
            accuracy,
            balanced_accuracy,
            macro_f1,
            log_loss,
            calibration_error,
            auroc,
            unknowns_found,
        })
    }
}

/// How well clips were recognised, with intervals over clips.
///
/// # Errors
/// Without clips, when posteriors are of different numbers of primitives, a truth is none of these, a probability lies
/// outside [0, 1] or a novelty is no number; when the bootstrap cannot be drawn.
pub fn scores(clips: &[Judged], bootstrap: &Bootstrap) -> Result<Scores> {
    let sample = Sample::new(clips)?;
    Scores::of(bootstrap.estimates(clips.len(), |counts| sample.measures(counts))?)
}

/// The same of clips that were asked several times, in one split after another: `clips` holds the answers to each clip,
/// at least one. Every answer counts alike; intervals are over clips, with all answers to them.
///
/// # Errors
/// As for [`scores`].
pub fn pooled_scores(clips: &[&[Judged]], bootstrap: &Bootstrap) -> Result<Scores> {
    let sample = Sample::new(&clips.concat())?;
    let pooled = |counts: &[u32]| {
        let pairs = clips.iter().zip(counts);
        let of_answers: Vec<u32> = pairs
            .flat_map(|(answers, &count)| answers.iter().map(move |_| count))
            .collect();
        sample.measures(&of_answers)
    };
    Scores::of(bootstrap.estimates(clips.len(), pooled)?)
}

/// How much larger the scores of one recogniser are than those of another on the same clips, in the same order; the
/// interval is that of the difference, both resampled together.
///
/// # Errors
/// As for [`scores`], and when the clips are not the same.
pub fn differences(one: &[Judged], other: &[Judged], bootstrap: &Bootstrap) -> Result<Scores> {
    let truths =
        |clips: &[Judged]| -> Vec<Option<usize>> { clips.iter().map(|c| c.truth).collect() };
    if truths(one) != truths(other) {
        return Err(Error::invalid(format!(
            "two recognisers are compared on the same clips, found {} and {} or other truths",
            one.len(),
            other.len()
        )));
    }
    let clips = one.len();
    let (one, other) = (Sample::new(one)?, Sample::new(other)?);
    let differ = |counts: &[u32]| {
        let (a, b) = (one.measures(counts), other.measures(counts));
        std::array::from_fn(|i| Some(a[i]? - b[i]?))
    };
    Scores::of(bootstrap.estimates(clips, differ)?)
}

/// How often each class was answered for each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Confusion {
    /// How many primitives there are; the class after the last is none of them.
    pub primitives: usize,
    /// Row-major, truth by answer, one more each than there are primitives.
    pub counts: Vec<usize>,
}

impl Confusion {
    /// The confusion of clips among `primitives` primitives.
    ///
    /// # Errors
    /// When a truth or an answer is none of the primitives.
    pub fn new(primitives: usize, clips: &[Judged]) -> Result<Self> {
        let classes = primitives + 1;
        let mut counts = vec![0; classes * classes];
        for clip in clips {
            let (truth, answer) = (clip.truth, clip.answer());
            if truth.max(answer).is_some_and(|c| c >= primitives) {
                return Err(Error::invalid(format!(
                    "{truth:?} answered as {answer:?} among {primitives} primitives"
                )));
            }
            let of = |class: Option<usize>| class.unwrap_or(primitives);
            counts[of(truth) * classes + of(answer)] += 1;
        }
        Ok(Self { primitives, counts })
    }

    /// How many clips of one class were answered as another; `None`: none of the primitives.
    ///
    /// # Panics
    /// When one is no primitive.
    pub fn count(&self, truth: Option<usize>, answer: Option<usize>) -> usize {
        let of = |class: Option<usize>| class.unwrap_or(self.primitives);
        assert!(of(truth).max(of(answer)) <= self.primitives, "a primitive");
        self.counts[of(truth) * (self.primitives + 1) + of(answer)]
    }
}
