//! Few exemplars a class.

use super::answers::{among_known, answers, as_recorded, rights};
use super::corpora::{Corpus, UTD};
use super::known::{Known, Method};
use super::summary::{Aim, Line};
use super::trials::{SHOTS, few};
use crate::sets::Result;

/// The row of `method` beside `baseline` with so many exemplars a class; a clip counts as the mean over the draws.
///
/// # Errors
/// When a primitive cannot be learned or a clip not be recognised.
pub fn few_shots(corpus: &Corpus, shots: usize, method: Method, baseline: Method) -> Result<Line> {
    let clips = corpus.set.motions.len();
    let mut sums = [vec![0.0; clips], vec![0.0; clips]];
    let mut asked = vec![0.0; clips];
    let trials = few(corpus, shots);
    for split in &trials.splits {
        let known = Known::learn(&corpus.set, &split.train)?;
        for (sums, who) in sums.iter_mut().zip([method, baseline]) {
            let recogniser = who.over(&known.vocabulary)?;
            let judged = answers(&*recogniser, &known, &corpus.set, &split.test, &as_recorded)?;
            let right = rights(&among_known(&judged, recogniser.is_binary()));
            for (&i, right) in split.test.iter().zip(right) {
                sums[i] += right;
            }
        }
        split.test.iter().for_each(|&i| asked[i] += 1.0);
    }
    let means = |sums: &[f64]| -> Vec<f64> {
        let of = sums.iter().zip(&asked).filter(|(_, n)| **n > 0.0);
        of.map(|(s, n)| s / n).collect()
    };
    let at = SHOTS.iter().position(|s| *s == shots);
    let aims = [(0.88, 0.826), (0.92, 0.863), (0.94, 0.893)].map(|(a, b)| Aim::beside(a, b));
    let aim = at.filter(|_| corpus.name == UTD).map(|k| aims[k]);
    Line::of(&trials.row, &means(&sums[0]), &means(&sums[1]), 1, aim)
}
