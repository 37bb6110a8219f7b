//! [`Tally`]: right and wrong decisions of a clip, counted.

use kineme::evaluation::{Stream, StreamSettings, stream_scores};

use super::clip::Clip;
use super::mode::Decisions;
use crate::sets::Result;

/// Probabilities below this count as this much in the log loss.
const LEAST_PROBABILITY: f64 = 1e-15;

/// Decisions of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Shown and affirmed.
    pub hits: u64,
    /// Not shown and affirmed.
    pub false_alarms: u64,
    /// Shown and denied.
    pub misses: u64,
    /// Not shown and denied.
    pub rejections: u64,
}

impl Counts {
    fn count(&mut self, shown: bool, affirmed: bool) {
        let which = match (shown, affirmed) {
            (true, true) => &mut self.hits,
            (false, true) => &mut self.false_alarms,
            (true, false) => &mut self.misses,
            (false, false) => &mut self.rejections,
        };
        *which += 1;
    }
}

/// What came of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// Its frames.
    pub frames: u64,
    /// How long it is, seconds.
    pub secs: f64,
    /// Decisions of each behaviour.
    pub classes: Vec<Counts>,
    /// Of the question whether any of the behaviours is shown.
    pub any: Counts,
    /// Frames in which all behaviours were decided rightly.
    pub all_right: u64,
    /// Times that a behaviour was affirmed, for however many frames, that was not shown then nor within a quarter of a
    /// second.
    pub alarms: u64,
    /// Movements that were shown.
    pub spans: u64,
    /// Those in no frame of which their behaviour was affirmed.
    pub missed: u64,
    /// The sum over decisions of minus the logarithm of the truth's probability; `None` without probabilities.
    pub loss: Option<f64>,
}

impl Tally {
    /// Decisions of a clip, beside its truth, for so many behaviours.
    ///
    /// # Errors
    /// When there are not as many decisions as frames times behaviours.
    pub fn of(clip: &Clip, decisions: &Decisions, classes: usize) -> Result<Self> {
        let rate = clip.motion().rate_hz();
        let affirmed = &decisions.affirmed;
        if affirmed.len() != clip.truth.len() * classes {
            return Err("one decision a frame and behaviour".into());
        }
        let mut tally = Tally {
            frames: clip.truth.len() as u64,
            secs: clip.truth.len() as f64 / rate,
            classes: vec![Counts::default(); classes],
            any: Counts::default(),
            all_right: 0,
            alarms: 0,
            spans: 0,
            missed: 0,
            loss: None,
        };
        for (truth, affirmed) in clip.truth.iter().zip(affirmed.chunks_exact(classes)) {
            let shown = |k: usize| *truth == Some(k);
            for (k, counts) in tally.classes.iter_mut().enumerate() {
                counts.count(shown(k), affirmed[k]);
            }
            tally.any.count(truth.is_some(), affirmed.contains(&true));
            let right = affirmed.iter().enumerate().all(|(k, a)| *a == shown(k));
            tally.all_right += u64::from(right);
        }
        for k in 0..classes {
            let own = |truth: &Option<usize>| (*truth == Some(k)).then_some(0);
            let truth: Vec<Option<usize>> = clip.truth.iter().map(own).collect();
            let answers = affirmed.iter().skip(k).step_by(classes);
            let answers = answers.map(|a| a.then_some(0)).collect();
            let stream = Stream::new(rate, truth, answers)?;
            let scores = stream_scores(&[stream], &StreamSettings::default())?;
            tally.alarms += scores.false_alarms as u64;
            tally.spans += scores.spans as u64;
            tally.missed += scores.missed as u64;
        }
        if let Some(probable) = &decisions.probable {
            let mut sum = 0.0;
            for (truth, p) in clip.truth.iter().zip(probable.chunks_exact(classes)) {
                for (k, p) in p.iter().enumerate() {
                    let right = if *truth == Some(k) { *p } else { 1.0 - p };
                    sum -= right.max(LEAST_PROBABILITY).ln();
                }
            }
            tally.loss = Some(sum);
        }
        Ok(tally)
    }
}
