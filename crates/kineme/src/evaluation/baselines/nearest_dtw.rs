//! The nearest exemplar by time warping: the baseline that little data makes hard to beat.

use super::features::{Extractor, Features, LastSeen};
use super::typical::{spread, typical_distance};
use super::windows::{Recent, windows};
use super::{Which, exemplars, least_of_each, positive, softmax, some_primitives, whole};
use crate::alignment::{Band, Sequences, distances_to_query, resample};
use crate::error::{Error, Result};
use crate::motion::Motion;
use crate::primitive::{
    Listener, Observation, Observations, Posterior, Reading, Recogniser, Recognition, Vocabulary,
};

/// How many windows are compared with all others to find their usual distance.
const COMPARED: usize = 100;
/// Numbers of a route in a frame.
const ROUTE_DIMS: usize = 3;

/// How [`NearestDtw`] compares.
#[derive(Debug, Clone, PartialEq)]
pub struct NearestDtwSettings {
    /// What postures are compared by.
    pub features: Features,
    /// The share of a movement's mean posture that is disregarded, 0 to 1: with more of it shapes are compared in place of
    /// postures, which helps between people who stand differently. Customarily 0.
    pub shape: f64,
    /// Whether frames of whole movements also tell how far the movement has led ([`Motion::travelled`]), a radian like a
    /// metre. Customarily not.
    pub route: bool,
    /// Frames to which whole movements are resampled, at least 2.
    pub samples: usize,
    /// The band of Sakoe and Chiba (1978), a share of the frames; 0.1 is customary.
    pub band: f64,
    /// Temperature of the softmax that makes probabilities of distances, in usual distances of exemplars of one
    /// primitive. A plain choice, not fitted to anybody.
    pub temperature: f64,
    /// The window by which a stream is judged, seconds.
    pub window_secs: f64,
    /// Frames to which it is resampled, at least 2.
    pub window_samples: usize,
    /// How often a stream is judged, seconds; between, the last answer stands.
    pub stride_secs: f64,
    /// Windows of exemplars with which it is compared: about so many at most, but one an exemplar.
    pub most_windows: usize,
}

impl Default for NearestDtwSettings {
    fn default() -> Self {
        Self {
            features: Features::Landmarks,
            shape: 0.0,
            route: false,
            samples: 64,
            band: 0.1,
            temperature: 0.15,
            window_secs: 1.0,
            window_samples: 16,
            stride_secs: 0.1,
            most_windows: 1000,
        }
    }
}

/// Names the exemplar with the least banded warping distance (1NN-DTW): of the whole movement in a clip, of the last
/// second in a stream.
///
/// A primitive's distance is that of its nearest exemplar; probabilities are the softmax of these. Novelty is the least
/// distance over the usual one: the median over exemplars of that to the nearest other of the same primitive.
#[derive(Debug, Clone)]
pub struct NearestDtw<'a> {
    vocabulary: &'a Vocabulary,
    settings: NearestDtwSettings,
    extractor: Extractor,
    clips: Known,
    windows: Known,
}

/// Sequences with what they are of.
#[derive(Debug, Clone)]
struct Known {
    of: Vec<Which>,
    sequences: Sequences,
    radius: usize,
    /// The usual distance between those of one primitive.
    typical: f64,
}

/// What is nearest.
struct Found {
    posterior: Posterior,
    novelty: f64,
    exemplar: Which,
}

impl<'a> NearestDtw<'a> {
    /// The exemplars of a vocabulary, ready to be compared with.
    ///
    /// # Errors
    /// When the vocabulary has no primitives or its body lacks the features, when a length is below 2 frames, the
    /// shape not from 0 to 1, another number not above 0.
    pub fn new(vocabulary: &'a Vocabulary, settings: &NearestDtwSettings) -> Result<Self> {
        some_primitives(vocabulary)?;
        positive(&[
            ("the band", settings.band),
            ("the temperature", settings.temperature),
            ("the window", settings.window_secs),
            ("the stride", settings.stride_secs),
        ])?;
        if settings.samples.min(settings.window_samples) < 2 {
            return Err(Error::invalid(format!(
                "movements are compared by 2 frames or more, found {} and {}",
                settings.samples, settings.window_samples
            )));
        }
        if !(0.0..=1.0).contains(&settings.shape) {
            return Err(Error::invalid(format!(
                "the shape is a share from 0 to 1, found {}",
                settings.shape
            )));
        }
        let extractor = Extractor::new(vocabulary.body(), &settings.features)?;
        let dims = extractor.dims();
        let all = exemplars(vocabulary);
        let mut clips = Vec::new();
        let (mut window_of, mut window_values) = (Vec::new(), Vec::new());
        let motion =
            |w: &Which| &vocabulary.primitives()[w.primitive].exemplars()[w.exemplar].motion;
        let secs: f64 = all.iter().map(|w| motion(w).duration_secs()).sum();
        let stride = settings
            .stride_secs
            .max(secs / settings.most_windows.max(1) as f64);
        for which in &all {
            let motion = motion(which);
            let features = extractor.of_poses(motion.poses().to_vec())?;
            clips.extend(clip(&features, motion, settings));
            let recent = Recent::new(settings.window_secs, settings.window_samples);
            let cut = windows(&features, dims, motion.rate_hz(), recent, stride);
            window_of.extend(std::iter::repeat_n(*which, cut.len()));
            let shape = |window| shaped(window, dims, settings.shape);
            window_values.extend(cut.into_iter().flat_map(shape));
        }
        let everyone: Vec<usize> = (0..all.len()).collect();
        let known = |of: Vec<Which>, values: &[f64], shape: (usize, usize), queries: &[usize]| {
            let fallback = extractor.decimetre() * (shape.0 as f64).sqrt();
            Known::new(of, values, shape, settings.band, queries, fallback)
        };
        let clip_dims = dims + if settings.route { ROUTE_DIMS } else { 0 };
        let compared = spread(window_of.len(), COMPARED);
        Ok(Self {
            clips: known(all, &clips, (settings.samples, clip_dims), &everyone)?,
            windows: known(
                window_of,
                &window_values,
                (settings.window_samples, dims),
                &compared,
            )?,
            vocabulary,
            settings: settings.clone(),
            extractor,
        })
    }
}

impl Known {
    fn new(
        of: Vec<Which>,
        values: &[f64],
        (frames, dims): (usize, usize),
        band: f64,
        queries: &[usize],
        fallback: f64,
    ) -> Result<Self> {
        let sequences = Sequences::new(values, frames, dims)?;
        let radius = Band::radius(band, frames);
        let mut rows = Vec::with_capacity(queries.len());
        let size = frames * dims;
        for &q in queries {
            let query = &values[q * size..(q + 1) * size];
            rows.push(distances_to_query(&sequences, query, radius)?);
        }
        let typical = typical_distance(&of, queries, &rows, fallback);
        Ok(Self {
            of,
            sequences,
            radius,
            typical,
        })
    }

    /// What is nearest to a sequence.
    fn find(&self, query: &[f64], primitives: usize, temperature: f64) -> Result<Found> {
        let distances = distances_to_query(&self.sequences, query, self.radius)?;
        let relative = distances.iter().map(|d| d / self.typical);
        let least = least_of_each(primitives, &self.of, relative);
        let distances: Vec<f64> = least.iter().map(|(d, _)| *d).collect();
        let nearest = least.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let (novelty, at) = nearest.copied().unwrap_or((f64::INFINITY, 0));
        Ok(Found {
            posterior: softmax(&distances, temperature),
            novelty,
            exemplar: self.of[at],
        })
    }
}

impl Recogniser for NearestDtw<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.vocabulary
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(Ear {
            recent: Recent::new(self.settings.window_secs, self.settings.window_samples),
            last: LastSeen::new(self.vocabulary.body()),
            answered: None,
            nearest: self,
        })
    }

    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        let features = self.extractor.of_seen(seen)?;
        let query = clip(&features, seen.motion(), &self.settings);
        let primitives = self.vocabulary.primitives();
        let found = self
            .clips
            .find(&query, primitives.len(), self.settings.temperature)?;
        let Which {
            primitive,
            exemplar,
        } = found.exemplar;
        let parameters = primitives[primitive].point(exemplar).to_vec();
        Ok(whole(seen, found.posterior, parameters, found.novelty))
    }
}

/// Listens to a stream.
struct Ear<'a> {
    nearest: &'a NearestDtw<'a>,
    last: LastSeen,
    recent: Recent,
    /// The last answer and when it was given, seconds.
    answered: Option<(f64, Reading)>,
}

impl Listener for Ear<'_> {
    fn hear(&mut self, seen: &Observation<'_>) -> Result<Reading> {
        let NearestDtw {
            vocabulary,
            settings,
            extractor,
            windows,
            ..
        } = self.nearest;
        let pose = self.last.see(seen)?.to_vec();
        self.recent.push(seen.secs, extractor.of_poses(pose)?);
        if let Some((at, reading)) = &self.answered
            && seen.secs < at + settings.stride_secs
        {
            return Ok(reading.clone());
        }
        let primitives = vocabulary.primitives().len();
        let window = shaped(self.recent.window(), extractor.dims(), settings.shape);
        let found = windows.find(&window, primitives, settings.temperature)?;
        let reading = Reading {
            posterior: found.posterior,
            place: None,
            novelty: found.novelty,
        };
        self.answered = Some((seen.secs, reading.clone()));
        Ok(reading)
    }
}

/// A whole movement as it is compared.
fn clip(features: &[f64], motion: &Motion, settings: &NearestDtwSettings) -> Vec<f64> {
    let dims = features.len() / motion.frames();
    let places = places(settings.samples);
    let frames = shaped(resample(features, dims, &places), dims, settings.shape);
    if !settings.route {
        return frames;
    }
    let travelled: Vec<f64> = motion.travelled().into_iter().flatten().collect();
    let route = resample(&travelled, ROUTE_DIMS, &places);
    let pairs = frames.chunks(dims).zip(route.chunks(ROUTE_DIMS));
    pairs.flat_map(|(f, r)| [f, r].concat()).collect()
}

/// Evenly spaced places from 0 to 1.
fn places(samples: usize) -> Vec<f64> {
    (0..samples)
        .map(|k| k as f64 / (samples - 1) as f64)
        .collect()
}

/// A movement less this share of its mean posture.
fn shaped(mut frames: Vec<f64>, dims: usize, share: f64) -> Vec<f64> {
    let count = (frames.len() / dims) as f64;
    for d in 0..dims {
        let mean = frames.iter().skip(d).step_by(dims).sum::<f64>() / count;
        for v in frames.iter_mut().skip(d).step_by(dims) {
            *v -= share * mean;
        }
    }
    frames
}
