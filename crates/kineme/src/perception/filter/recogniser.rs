//! [`Filter`]: the default recogniser.

use super::emission::Emission;
use super::evidence::{Evidence, evidence};
use super::features::{Feature, Moment};
use super::learned::{Learned, NAME, classes, scores, unit};
use super::learning::learn;
use super::model::Model;
use super::outline::Outlines;
use super::patterns::Patterns;
use super::route::Routes;
use super::shape::Shapes;
use super::sight::Sight;
use super::stream::Stream;
use super::track::Network;
use crate::error::Result;
use crate::perception::checked::{counts, not_negative, positive};
use crate::perception::parts::same_body;
use crate::perception::spans::spans;
use crate::primitive::{
    Calibration, Listener, Observations, Posterior, Reading, Recogniser, Recognition, Vocabulary,
};

/// Rows in all, whatever a primitive may have.
const MOST_ROWS: usize = 2500;
/// Spans of clips are told with so much hindsight, and last at least so long.
const HINDSIGHT_SECS: f64 = 0.25;
const DWELL_SECS: f64 = 0.2;
/// Neither rest nor none is surer than this of a clip, so that who rules them out still hears which primitive is likeliest.
const CERTAIN: f64 = 1.0 - 1e-6;

/// How the filter listens.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterSettings {
    /// How much the hands count: squared distances a second. Evidence of successive moments, and of the numbers of
    /// one, is far from independent: the likelihood is tempered.
    pub hands_trust: f64,
    /// The same of the whole body.
    pub body_trust: f64,
    /// Directions of the whitened features that are kept of the hands, and of the body: those in which the vocabulary
    /// varies most.
    pub directions: usize,
    /// Rows a primitive at most: exemplars, and courses between them where parameters have a meaning.
    pub rows: usize,
    /// Moments a second that are looked at; frames between are answered from the last. Four times as many where
    /// parameters have a meaning, so that bodies can follow the primitives themselves.
    pub clock_hz: f64,
    /// Seconds by which an answer may lag, that what followed may speak for it: 0 answers at once.
    pub lag_secs: f64,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            hands_trust: 4.0,
            body_trust: 3.0,
            directions: 20,
            rows: 64,
            clock_hz: 30.0,
            lag_secs: 0.0,
        }
    }
}

/// Follows a stream over primitive, parameters and phase, beside rest and movement of no known kind (the paper's V-A as
/// a filter: Bayes' rule at every moment, phase that goes on at a plausible pace, primitives that compete).
#[derive(Debug)]
pub struct Filter<'v> {
    pub(super) vocabulary: &'v Vocabulary,
    pub(super) settings: FilterSettings,
    /// What whole clips are compared with, and what streams are.
    pub(super) clips: Model,
    pub(super) stream: Model,
    /// What complete clips are compared by.
    complete: Emission,
    /// Where the rows of clips lead.
    routes: Option<Routes>,
    /// How they go as a whole.
    shapes: Option<Shapes>,
    /// How much their parts move when, and where.
    outlines: Option<Outlines>,
    pub(super) patterns: Patterns,
    pub(super) network: Network,
    /// The same where movements are carried out exactly.
    pub(super) exact_network: Network,
    pub(super) learned: Learned,
}

impl<'v> Filter<'v> {
    /// A filter over a vocabulary, with what it has learned of it where that is kept ([`Vocabulary::calibration`]).
    ///
    /// # Errors
    /// When a setting is out of its range.
    pub fn new(vocabulary: &'v Vocabulary, settings: &FilterSettings) -> Result<Self> {
        positive(&[
            ("hands_trust", settings.hands_trust),
            ("body_trust", settings.body_trust),
            ("clock_hz", settings.clock_hz),
        ])?;
        not_negative(&[("lag_secs", settings.lag_secs)])?;
        counts(&[
            ("directions", settings.directions, 1, 1000),
            ("rows", settings.rows, 1, 1000),
        ])?;
        let primitives = vocabulary.primitives().len();
        let settings = FilterSettings {
            rows: settings.rows.min((MOST_ROWS / primitives.max(1)).max(1)),
            ..settings.clone()
        };
        let clips = Model::new(vocabulary, &settings, true)?;
        let stream = Model::new(vocabulary, &settings, false)?;
        let kept = vocabulary.calibration(NAME).and_then(Learned::of);
        Ok(Self {
            complete: clips.without(&[])?,
            routes: Routes::new(vocabulary, &clips.rows)?,
            shapes: Shapes::new(
                vocabulary,
                &clips.rows,
                &clips.layout,
                clips.posture_parts(),
            )?,
            outlines: Outlines::new(vocabulary, &clips.rows, &clips.layout, settings.clock_hz)?,
            patterns: Patterns::new(&stream)?,
            network: Network::new(vocabulary, &stream.rows, false, stream.lasting.is_some()),
            exact_network: Network::new(vocabulary, &stream.rows, true, false),
            learned: kept.unwrap_or_else(|| Learned::usual(primitives)),
            vocabulary,
            settings,
            clips,
            stream,
        })
    }

    /// What the filter learns of a vocabulary by leaving its exemplars out: for [`Vocabulary::calibrated`]. Primitives
    /// with numbers in `kept` (in the order of the vocabulary) keep them.
    ///
    /// # Errors
    /// Of no valid vocabulary.
    pub fn calibration(vocabulary: &Vocabulary, kept: &[Option<Vec<f64>>]) -> Result<Calibration> {
        let filter = Filter::new(vocabulary, &FilterSettings::default())?;
        let limit = |numbers: &Option<Vec<f64>>| numbers.as_ref()?.first().copied();
        let kept: Vec<Option<f64>> = kept.iter().map(limit).collect();
        Ok(learn(&filter, &kept)?.calibration())
    }

    /// Whether numbers that a vocabulary keeps mean what they mean to this filter.
    pub(in crate::perception) fn understands(calibration: &Calibration) -> bool {
        Learned::of(calibration).is_some()
    }

    /// The evidence of a clip.
    pub(super) fn evidence(&self, seen: &Observations) -> Result<Evidence> {
        let model = &self.clips;
        let mut sight = Sight::new(model);
        let frames = self.looked_at(seen);
        let moments: Vec<Moment> = frames.map(|f| sight.see(&seen.at(f))).collect();
        let postures: Vec<f64> = moments.iter().flat_map(|m| m.posture.clone()).collect();
        let features = model.of_clip(moments);
        let unknown = lasting(&features);
        let posture_is_unknown = model.layout.still().into_iter().zip(&unknown);
        let complete = !posture_is_unknown.into_iter().any(|(still, u)| still && *u);
        let marginal: Emission;
        let emission = match unknown.contains(&true) {
            true => {
                marginal = model.without(&unknown)?;
                &marginal
            }
            false => &self.complete,
        };
        let moments = features.iter().map(|(f, dt)| (f, *dt));
        let mut evidence = evidence(&model.rows, emission, moments);
        let routes = self.routes.as_ref();
        evidence.routes = routes.and_then(|r| r.distances(seen.motion()));
        if let Some(shapes) = &self.shapes {
            let still = model.layout.still().into_iter().zip(unknown);
            let unknown: Vec<bool> = still.filter(|(s, _)| *s).map(|(_, u)| u).collect();
            evidence.shapes = Some(shapes.distances(&postures, &unknown)?);
        }
        // What was not seen leaves no outline to compare.
        if let Some(outlines) = self.outlines.as_ref().filter(|_| complete) {
            evidence.outlines = Some(outlines.distances(&postures, model.layout.posture_dims()));
        }
        Ok(evidence)
    }

    /// The frames that the filter's clock looks at.
    fn looked_at(&self, seen: &Observations) -> impl Iterator<Item = usize> + use<> {
        let motion = seen.motion();
        let every = (motion.rate_hz() / self.settings.clock_hz).round() as usize;
        (0..motion.frames()).step_by(every.max(1))
    }

    /// How probable each answer is for a clip as a whole, its novelty, and the parameters of the leading primitive.
    fn judged(&self, seen: &Observations, share: &Share) -> Result<(Posterior, f64, Vec<f64>)> {
        let evidence = self.evidence(seen)?;
        let rows = &self.clips.rows;
        let weighed = evidence.weighed(self.learned.trusts);
        let classes = classes(self, &weighed, &vec![false; rows.len()]);
        let shares = self
            .learned
            .shares(&classes, unit(&classes, evidence.lasts()));
        let scores = scores(&classes, &evidence, &self.learned.limits);
        let odds = self.learned.unknown(&scores);
        // What no primitive explains from moment to moment is none of them, however alike the whole is to one.
        let none_at = |odds: f64| {
            (1.0 / (1.0 + (-odds).exp()))
                .max(share.unknown)
                .min(CERTAIN)
        };
        let none = none_at(self.learned.moderated(&scores));
        let resting = share.resting.min(CERTAIN);
        let known = (1.0 - resting) * (1.0 - none);
        let posterior = Posterior {
            primitives: shares.iter().map(|s| s * known).collect(),
            rest: resting,
            none: (1.0 - resting) * none,
        };
        let leading = posterior.leading().map_or(0, |(k, _)| k);
        let own = || {
            let pairs = rows.iter().zip(&weighed);
            pairs.filter(|(row, _)| row.primitive == leading)
        };
        let best = own().map(|(_, e)| *e).fold(f64::NEG_INFINITY, f64::max);
        let dims = self.vocabulary.primitives()[leading].parameters().dims();
        let temperature = self.learned.heat(&classes, &evidence);
        let (mut total, mut parameters) = (0.0, vec![0.0; dims]);
        for (row, e) in own() {
            let w = ((e - best) / temperature).exp();
            total += w;
            for (sum, p) in parameters.iter_mut().zip(&row.parameters) {
                *sum += w * p;
            }
        }
        for p in &mut parameters {
            *p /= total;
        }
        // Twice the probability where that tells, and the odds' logarithm beyond, so that no two clips look alike. How far
        // odds can be trusted is no matter of how novel a clip is.
        let plain = 2.0 * none_at(odds);
        let novelty = match odds < 0.0 {
            true => plain,
            false => (1.0 + odds).max(plain),
        };
        Ok((posterior, novelty, parameters))
    }
}

/// A share of unknown moments decides once hardly anything else is left: people who differ from the exemplars have
/// moments like that too.
fn decided(share: f64) -> f64 {
    ((share - 0.9) / 0.1).clamp(0.0, 1.0)
}

/// How much of a clip was rest, and whether what else it holds is of no known kind.
struct Share {
    resting: f64,
    unknown: f64,
}

impl Share {
    fn of(readings: &[Reading]) -> Self {
        let sum = |of: &dyn Fn(&Posterior) -> f64| -> f64 {
            readings.iter().map(|r| of(&r.posterior)).sum()
        };
        let moving = sum(&|p| 1.0 - p.rest);
        // As far as its liveliest moment is at rest, the whole is.
        let rests = readings.iter().map(|r| r.posterior.rest);
        Self {
            resting: rests.fold(1.0, f64::min),
            unknown: match moving > 0.0 {
                true => decided(sum(&|p| p.none) / moving),
                false => 0.0,
            },
        }
    }
}

/// Numbers that are unknown most of the time are unknown for good; what is missing now and then was bridged.
fn lasting(features: &[(Feature, f64)]) -> Vec<bool> {
    let dims = features.first().map_or(0, |(f, _)| f.values.len());
    let count = |i: usize| {
        let unknown = features
            .iter()
            .filter(|(f, _)| f.unknown.get(i) == Some(&true));
        unknown.count()
    };
    (0..dims).map(|i| 2 * count(i) > features.len()).collect()
}

impl Recogniser for Filter<'_> {
    fn vocabulary(&self) -> &Vocabulary {
        self.vocabulary
    }

    fn listen(&self) -> Box<dyn Listener + '_> {
        Box::new(Stream::new(self, self.settings.lag_secs))
    }

    fn recognise(&self, seen: &Observations) -> Result<Recognition> {
        let motion = seen.motion();
        same_body(self.vocabulary, motion.skeleton())?;
        let mut hindsight = Stream::new(self, HINDSIGHT_SECS);
        let readings = hindsight.all(seen)?;
        let (posterior, novelty, parameters) = self.judged(seen, &Share::of(&readings))?;
        Ok(Recognition {
            posterior,
            parameters,
            novelty,
            spans: spans(&readings, motion.rate_hz(), DWELL_SECS, false),
        })
    }
}
