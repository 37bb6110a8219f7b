//! How long one frame takes, by whoever has a clock.

use kineme::math::statistics::quantile;
use kineme::primitive::Observations;

use super::corpora::Corpus;
use super::known::{Known, Method};
use crate::sets::Result;

/// The rate at which frames come.
pub const RATE_HZ: f64 = 120.0;
/// Clips that are heard.
const CLIPS: usize = 40;

/// How long frames took, seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Latency {
    /// Frames that were timed.
    pub frames: usize,
    /// The median.
    pub median_secs: f64,
    /// What 99 of 100 stay below.
    pub p99_secs: f64,
}

/// The first split of a set at 120 Hz, exemplars and clips.
#[derive(Debug, Clone)]
pub struct Fast {
    known: Known,
    clips: Vec<Observations>,
}

impl Fast {
    /// Learns it.
    ///
    /// # Errors
    /// When a primitive cannot be learned.
    pub fn of(corpus: &Corpus) -> Result<Self> {
        let split = corpus.splits.first().ok_or("a set without splits")?;
        let mut set = corpus.set.clone();
        for motion in &mut set.motions {
            *motion = motion.resampled(RATE_HZ)?;
        }
        let step = split.test.len().div_ceil(CLIPS).max(1);
        let asked = split.test.iter().step_by(step);
        Ok(Self {
            known: Known::learn(&set, &split.train)?,
            clips: asked
                .map(|&i| Observations::complete(set.motions[i].clone()))
                .collect(),
        })
    }

    /// How many primitives are known.
    pub fn primitives(&self) -> usize {
        self.known.vocabulary.primitives().len()
    }

    /// Listens to the clips on this thread; `clock` tells seconds.
    ///
    /// # Errors
    /// When the method cannot be made of the vocabulary.
    pub fn latency(&self, method: Method, clock: &mut dyn FnMut() -> f64) -> Result<Latency> {
        let recogniser = method.over(&self.known.vocabulary)?;
        let mut took = Vec::new();
        for clip in &self.clips {
            let mut listener = recogniser.listen();
            for frame in 0..clip.motion().frames() {
                let begun = clock();
                listener.hear(&clip.at(frame))?;
                took.push(clock() - begun);
            }
        }
        let at = |share: f64| quantile(&took, share).ok_or("no frames");
        Ok(Latency {
            frames: took.len(),
            median_secs: at(0.5)?,
            p99_secs: at(0.99)?,
        })
    }
}
