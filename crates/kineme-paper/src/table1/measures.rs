//! What is read off counted decisions, with intervals over clips.

use kineme::evaluation::{Bootstrap, Estimate};

use super::tally::{Counts, Tally};
use crate::sets::Result;

/// What is measured. The paper does not say how it pooled its five classifiers; the first three are the ways there are.
/// Since every frame is put to each of the five, the mean of their accuracies is also that of all decisions pooled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Accuracy, the mean over the behaviours; the same as of all decisions pooled.
    Accuracy,
    /// Accuracy of "any of the behaviours or none".
    AccuracyAny,
    /// Frames in which all behaviours were decided rightly.
    AccuracyEvery,
    /// What always denying has, mean over the behaviours.
    Never,
    /// What always denying has of "any or none".
    NeverAny,
    /// The mean over behaviours of the mean of the shares of shown and of other frames that were decided rightly.
    Balanced,
    /// Precision of all decisions pooled.
    Precision,
    /// Recall of all decisions pooled.
    Recall,
    /// The harmonic mean of the two.
    F1,
    /// Precision, the mean over behaviours that were affirmed.
    MeanPrecision,
    /// Recall, the mean over behaviours that were shown.
    MeanRecall,
    /// F1, the mean over behaviours that were shown.
    MeanF1,
    /// Recall of "any or none".
    RecallAny,
    /// Minus the natural logarithm of the truth's probability, a decision.
    LogLoss,
}

/// All of them, in the order of the columns.
pub const MEASURES: [(Measure, &str); 14] = [
    (Measure::Accuracy, "accuracy"),
    (Measure::AccuracyAny, "accuracy_any"),
    (Measure::AccuracyEvery, "accuracy_every"),
    (Measure::Never, "never"),
    (Measure::NeverAny, "never_any"),
    (Measure::Balanced, "balanced_accuracy"),
    (Measure::Precision, "precision"),
    (Measure::Recall, "recall"),
    (Measure::F1, "f1"),
    (Measure::MeanPrecision, "mean_precision"),
    (Measure::MeanRecall, "mean_recall"),
    (Measure::MeanF1, "mean_f1"),
    (Measure::RecallAny, "recall_any"),
    (Measure::LogLoss, "log_loss"),
];

/// The measures of a collection of clips with their intervals, in the order of [`MEASURES`]; `None` where undefined:
/// recall where nothing is shown, precision where nothing is affirmed.
///
/// # Errors
/// Without clips.
pub fn measures(tallies: &[Tally]) -> Result<[Option<Estimate>; MEASURES.len()]> {
    let statistics = |counts: &[u32]| of_collection(tallies, counts);
    Ok(Bootstrap::default().estimates(tallies.len(), statistics)?)
}

#[derive(Clone, Copy, Default)]
struct Sum {
    hits: f64,
    false_alarms: f64,
    misses: f64,
    rejections: f64,
}

impl Sum {
    fn add(&mut self, c: &Counts, times: f64) {
        self.hits += times * c.hits as f64;
        self.false_alarms += times * c.false_alarms as f64;
        self.misses += times * c.misses as f64;
        self.rejections += times * c.rejections as f64;
    }

    fn all(&self) -> f64 {
        self.hits + self.false_alarms + self.misses + self.rejections
    }

    fn accuracy(&self) -> f64 {
        (self.hits + self.rejections) / self.all()
    }

    fn never(&self) -> f64 {
        (self.false_alarms + self.rejections) / self.all()
    }

    fn precision(&self) -> Option<f64> {
        share(self.hits, self.hits + self.false_alarms)
    }

    fn recall(&self) -> Option<f64> {
        share(self.hits, self.hits + self.misses)
    }

    fn f1(&self) -> Option<f64> {
        self.recall()?;
        let both = 2.0 * self.hits + self.false_alarms + self.misses;
        share(2.0 * self.hits, both)
    }

    fn balanced(&self) -> Option<f64> {
        let denied = share(self.rejections, self.false_alarms + self.rejections)?;
        Some(0.5 * (self.recall()? + denied))
    }
}

fn share(part: f64, whole: f64) -> Option<f64> {
    (whole > 0.0).then(|| part / whole)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    share(values.iter().sum(), values.len() as f64)
}

fn of_collection(tallies: &[Tally], counts: &[u32]) -> [Option<f64>; MEASURES.len()] {
    let classes = tallies[0].classes.len();
    let mut own = vec![Sum::default(); classes];
    let (mut pooled, mut any) = (Sum::default(), Sum::default());
    let (mut frames, mut all_right, mut loss) = (0.0, 0.0, Some(0.0));
    for (tally, &count) in tallies.iter().zip(counts) {
        let times = f64::from(count);
        for (sum, c) in own.iter_mut().zip(&tally.classes) {
            sum.add(c, times);
            pooled.add(c, times);
        }
        any.add(&tally.any, times);
        frames += times * tally.frames as f64;
        all_right += times * tally.all_right as f64;
        loss = loss.zip(tally.loss).map(|(sum, l)| sum + times * l);
    }
    let over = |of: &dyn Fn(&Sum) -> Option<f64>| mean(own.iter().filter_map(of));
    MEASURES.map(|(measure, _)| match measure {
        Measure::Accuracy => over(&|s| Some(s.accuracy())),
        Measure::AccuracyAny => Some(any.accuracy()),
        Measure::AccuracyEvery => share(all_right, frames),
        Measure::Never => over(&|s| Some(s.never())),
        Measure::NeverAny => Some(any.never()),
        Measure::Balanced => over(&Sum::balanced),
        Measure::Precision => pooled.precision(),
        Measure::Recall => pooled.recall(),
        Measure::F1 => pooled.f1(),
        Measure::MeanPrecision => over(&Sum::precision),
        Measure::MeanRecall => over(&Sum::recall),
        Measure::MeanF1 => over(&Sum::f1),
        Measure::RecallAny => any.recall(),
        Measure::LogLoss => loss.and_then(|l| share(l, frames * classes as f64)),
    })
}

/// The exact interval of 95 in 100 for the mean of a Poisson distribution of which `count` was drawn (Garwood 1936).
pub fn garwood(count: u64) -> (f64, f64) {
    let k = count as f64;
    // The probability of at most `most` events where `mean` are expected.
    let at_most = |most: u64, mean: f64| -> f64 {
        let mut log_term = -mean;
        let mut sum = log_term.exp();
        for i in 1..=most {
            log_term += (mean / i as f64).ln();
            sum += log_term.exp();
        }
        sum
    };
    let solve = |above: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (1e-12, k + 10.0 * (k + 1.0).sqrt() + 10.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if above(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    };
    let low = match count {
        0 => 0.0,
        _ => solve(&|mean| 1.0 - at_most(count - 1, mean) > 0.025),
    };
    (low, solve(&|mean| at_most(count, mean) < 0.025))
}
