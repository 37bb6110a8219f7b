//! The nearest posture, whatever came before it: what of recognition needs no movement.

use super::features::{Extractor, Features, LastSeen};
use super::typical::{spread, typical_distance};
use super::{Which, exemplars, least_of_each, positive, softmax, some_primitives, whole};
use crate::error::Result;
use crate::motion::Motion;
use crate::primitive::{
    Listener, Observation, Observations, Posterior, Reading, Recogniser, Recognition, Vocabulary,
};

/// How many postures are compared with all others to find their usual distance.
const COMPARED: usize = 300;

/// How [`NearestPosture`] compares.
#[derive(Debug, Clone, PartialEq)]
pub struct NearestPostureSettings {
    /// What postures are compared by.
    pub features: Features,
    /// Temperature of the softmax that makes probabilities of distances, in usual distances of postures of one
    /// primitive. A plain choice, not fitted to anybody.
    pub temperature: f64,
    /// Postures a second that are taken from exemplars and clips, at most their own rate.
    pub rate_hz: f64,
    /// How many postures are kept at most, but one an exemplar; where there are more, each exemplar gives fewer.
    pub most_postures: usize,
}

impl Default for NearestPostureSettings {
    fn default() -> Self {
        Self {
            features: Features::Landmarks,
            temperature: 0.2,
            rate_hz: 15.0,
            most_postures: 5000,
        }
    }
}

/// Names the primitive whose exemplars hold the nearest posture; in a clip frames vote with their
/// probabilities.
///
/// Probabilities are the softmax of the distances of each primitive's nearest posture. Novelty is the least distance over
/// the usual one: the median over postures of that to the nearest of another exemplar of the same primitive; of a clip,
/// the mean over its frames.
#[derive(Debug, Clone)]
pub struct NearestPosture<'a> {
    vocabulary: &'a Vocabulary,
    temperature: f64,
    rate_hz: f64,
    extractor: Extractor,
    of: Vec<Which>,
    /// Features, one posture after the other.
    postures: Vec<f64>,
    typical: f64,
}

impl<'a> NearestPosture<'a> {
    /// The postures of a vocabulary's exemplars, ready to be compared with.
    ///
    /// # Errors
    /// When the vocabulary has no primitives or its body lacks the features, and when a number is not above 0.
    pub fn new(vocabulary: &'a Vocabulary, settings: &NearestPostureSettings) -> Result<Self> {
        some_primitives(vocabulary)?;
        positive(&[
            ("the temperature", settings.temperature),
            ("the rate", settings.rate_hz),
        ])?;
        let extractor = Extractor::new(vocabulary.body(), &settings.features)?;
        let all = exemplars(vocabulary);
        let motion =
            |w: &Which| &vocabulary.primitives()[w.primitive].exemplars()[w.exemplar].motion;
        let secs: f64 = all.iter().map(|w| motion(w).duration_secs()).sum();
        let spare = settings.most_postures.saturating_sub(all.len()).max(1);
        let rate_hz = settings.rate_hz.min(spare as f64 / secs.max(1e-9));
        let (mut of, mut postures) = (Vec::new(), Vec::new());
        for which in &all {
            let motion = motion(which);
            let mut poses = Vec::new();
            for f in picked(motion, rate_hz) {
                poses.extend_from_slice(motion.pose(f));
                of.push(*which);
            }
            postures.extend(extractor.of_poses(poses)?);
        }
        let mut nearest = Self {
            vocabulary,
            temperature: settings.temperature,
            rate_hz: settings.rate_hz,
            typical: 1.0,
            extractor,
            of,
            postures,
        };
        let queries = spread(nearest.of.len(), COMPARED);
        let dims = nearest.extractor.dims();
        let rows: Vec<Vec<f64>> = queries
            .iter()
            .map(|q| nearest.distances(&nearest.postures[q * dims..(q + 1) * dims]))
            .collect();
        let fallback = nearest.extractor.decimetre();
        nearest.typical = typical_distance(&nearest.of, &queries, &rows, fallback);
        Ok(nearest)
    }

    /// Distances of a posture to all that are known.
    fn distances(&self, posture: &[f64]) -> Vec<f64> {
        let known = self.postures.chunks_exact(self.extractor.dims());
        known
            .map(|k| {
                let squares = k.iter().zip(posture).map(|(a, b)| (a - b) * (a - b));
                squares.sum::<f64>().sqrt()
            })
            .collect()
    }

    /// What a posture is, and where among the known ones each primitive's nearest is.
    fn read(&self, posture: &[f64]) -> (Reading, Vec<usize>) {
        let relative = self
            .distances(posture)
            .into_iter()
            .map(|d| d / self.typical);
        let least = least_of_each(self.vocabulary.primitives().len(), &self.of, relative);
        let (distances, nearest): (Vec<f64>, Vec<usize>) = least.into_iter().unzip();
        let reading = Reading {
            posterior: softmax(&distances, self.temperature),
            place: None,
            novelty: distances.iter().copied().fold(f64::INFINITY, f64::min),
        };
        (reading, nearest)
    }
}

impl Recogniser for NearestPosture<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.vocabulary
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(Eye {
            last: LastSeen::new(self.vocabulary.body()),
            nearest: self,
        })
    }

    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        let features = self.extractor.of_seen(seen)?;
        let primitives = self.vocabulary.primitives();
        let dims = self.extractor.dims();
        let picked = picked(seen.motion(), self.rate_hz);
        let frames = picked.len() as f64;
        let mut sums = vec![0.0; primitives.len()];
        let mut novelty = 0.0;
        // How often each exemplar was the nearest of its primitive.
        let mut votes: Vec<Vec<usize>> = primitives
            .iter()
            .map(|p| vec![0; p.exemplars().len()])
            .collect();
        for f in picked {
            let (reading, nearest) = self.read(&features[f * dims..(f + 1) * dims]);
            for (sum, p) in sums.iter_mut().zip(&reading.posterior.primitives) {
                *sum += p / frames;
            }
            novelty += reading.novelty / frames;
            for which in nearest.iter().map(|&i| self.of[i]) {
                votes[which.primitive][which.exemplar] += 1;
            }
        }
        let posterior = Posterior {
            primitives: sums,
            rest: 0.0,
            none: 0.0,
        };
        let leading = posterior.leading().map_or(0, |(i, _)| i);
        let most = votes[leading].iter().max();
        let exemplar = votes[leading].iter().position(|v| Some(v) == most);
        let parameters = primitives[leading].point(exemplar.unwrap_or(0)).to_vec();
        Ok(whole(seen, posterior, parameters, novelty))
    }
}

/// Frames at a rate of at most `rate_hz`, from the first on. Whole ones: what lies between two was never seen.
fn picked(motion: &Motion, rate_hz: f64) -> Vec<usize> {
    let step = (motion.rate_hz() / rate_hz).max(1.0);
    let frames = (0..motion.frames()).map(|k| (k as f64 * step).round() as usize);
    frames.take_while(|f| *f < motion.frames()).collect()
}

/// Watches a stream.
struct Eye<'a> {
    nearest: &'a NearestPosture<'a>,
    last: LastSeen,
}

impl Listener for Eye<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let pose = self.last.see(seen)?.to_vec();
        let features = self.nearest.extractor.of_poses(pose)?;
        Ok(self.nearest.read(&features).0)
    }
}
