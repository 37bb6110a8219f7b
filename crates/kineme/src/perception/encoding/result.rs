//! [`Encoding`]: what an encoder says of a motion.

use nalgebra::Vector3;

use super::chains::{FAR, shares};
use super::encoded::Course;
use super::encoder::{Encoder, Seen, Verdict};
use super::paths::EffectorPaths;
use super::settings::{EncodingSettings, SAMPLES};
use super::track::Leg;
use crate::error::Result;
use crate::motion::Motion;
use crate::primitive::{Observations, Posterior, Recognition, Span};

/// A part of a motion and the primitive that encodes it.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodedSpan {
    /// Its beginning, seconds.
    pub start_secs: f64,
    /// Its end, seconds: the next one's beginning.
    pub end_secs: f64,
    /// The primitive; `None` for rest and for the unknown.
    pub primitive: Option<usize>,
    /// Likeness of the primitive's prediction, or where there is none of the likest one's, in [0, 1].
    pub similarity: f64,
    /// How much that is more than the likeness of the next best primitive's; in a vocabulary of one, the likeness itself.
    pub margin: f64,
    /// Probability of the primitive among all.
    pub confidence: f64,
}

/// A motion, encoded.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoding {
    /// What the whole is; sums to one with rest and none.
    pub posterior: Posterior,
    /// Likeness of each primitive to the whole, in [0, 1].
    pub scores: Vec<f64>,
    /// How unlike everything known the whole is: 1 at the limit of what the primitive's own exemplars are.
    pub novelty: f64,
    /// What was done when, without gaps or overlaps.
    pub spans: Vec<EncodedSpan>,
    /// The motion in the joints of the vocabulary's body: what the winners do, joined without a jump; at rest the posture
    /// is held, and where a movement is unknown, the effectors are followed.
    pub motion: Motion,
    /// Root mean square distance of its effectors from those observed, these scaled to the body, metres; `None` where
    /// nothing was seen.
    pub rmse_m: Option<f64>,
}

impl Encoding {
    /// The primitive that the whole is; `None` for rest and for the unknown.
    pub fn label(&self) -> Option<usize> {
        self.posterior.best()
    }
}

/// The likeness of a cost in units.
pub(super) fn likeness(cost: f64) -> f64 {
    if cost < FAR { (-cost).exp() } else { 0.0 }
}

impl Encoder<'_> {
    /// What the winners of an observation are to be joined from.
    pub(super) fn course<'a>(&'a self, seen: &'a Seen) -> Course<'a> {
        Course {
            vocabulary: self.vocabulary,
            rows: &self.rows,
            settings: &self.settings,
            seen,
            usual_m: [self.usual_unit_m(seen), self.usual_row_m()],
        }
    }

    /// Encodes paths.
    ///
    /// # Errors
    /// When the paths are of other effectors than the encoder's.
    pub fn encode(&self, name: &str, paths: &EffectorPaths) -> Result<Encoding> {
        let seen = self.seen(paths)?;
        match &self.literal {
            Some(literal) => self.literally(name, paths, &seen, literal),
            None => self.by_hypotheses(name, paths, &seen),
        }
    }

    fn by_hypotheses(&self, name: &str, paths: &EffectorPaths, seen: &Seen) -> Result<Encoding> {
        let verdict = self.judge(seen);
        let legs = self.kept(&verdict);
        let course = self.course(seen);
        let (motion, factors) = course.motion(name, &legs)?;
        let every = self.settings.cells(1.0, 1) as usize;
        let at_instants: Vec<f64> = factors.into_iter().step_by(every).collect();
        Ok(Encoding {
            rmse_m: rmse_m(&motion, seen, &at_instants, every, &self.settings)?,
            motion,
            spans: self.spans(&verdict, seen, paths.duration_secs()),
            scores: verdict.costs.iter().map(|c| likeness(*c)).collect(),
            novelty: verdict.novelty,
            posterior: verdict.posterior,
        })
    }

    /// The legs of a path, without those of movements that were rejected after all.
    fn kept(&self, verdict: &Verdict) -> Vec<Leg> {
        let mut legs = verdict.legs.clone();
        for stretch in verdict
            .stretches
            .iter()
            .filter(|s| s.primitive.is_none() && !s.rest)
        {
            legs[stretch.blocks.clone()].fill(Leg::None);
        }
        legs
    }

    pub(super) fn spans(&self, verdict: &Verdict, seen: &Seen, secs: f64) -> Vec<EncodedSpan> {
        let decision = self.settings.decision_secs;
        let last = seen.blocks.len();
        let clip = self.is_clip(seen.duration_secs);
        let mut spans: Vec<EncodedSpan> = verdict
            .stretches
            .iter()
            .map(|stretch| {
                let best = best_two(&stretch.costs, stretch.primitive);
                let known = match clip {
                    true => self.rejection.confidence.shares(&stretch.costs),
                    false => shares(&stretch.costs, self.rejection.temperature),
                };
                EncodedSpan {
                    start_secs: stretch.blocks.start as f64 * decision,
                    end_secs: match stretch.blocks.end == last {
                        true => secs,
                        false => stretch.blocks.end as f64 * decision,
                    },
                    primitive: stretch.primitive,
                    similarity: likeness(best[0]),
                    margin: likeness(best[0]) - likeness(best[1]),
                    confidence: match stretch.primitive {
                        Some(k) => known[k],
                        None if stretch.rest => 1.0,
                        None => verdict.posterior.none,
                    },
                }
            })
            .collect();
        if spans.is_empty() {
            spans.push(EncodedSpan {
                start_secs: 0.0,
                end_secs: secs,
                primitive: None,
                similarity: 0.0,
                margin: 0.0,
                confidence: 1.0,
            });
        }
        spans
    }

    /// What the whole of an observed motion of the body is.
    pub(super) fn recognised(&self, seen: &Observations) -> Result<Recognition> {
        let s = &self.settings;
        let paths = EffectorPaths::of_observations(seen, &s.effectors, s.heading_secs)?;
        let spans = |spans: Vec<EncodedSpan>| {
            let span = |s: EncodedSpan| Span {
                start_secs: s.start_secs,
                end_secs: s.end_secs,
                primitive: s.primitive,
                confidence: s.confidence,
            };
            spans.into_iter().map(span).collect()
        };
        if self.literal.is_some() {
            let encoding = self.encode(seen.motion().name(), &paths)?;
            return Ok(Recognition {
                posterior: encoding.posterior,
                parameters: Vec::new(),
                novelty: encoding.novelty,
                spans: spans(encoding.spans),
            });
        }
        let ready = self.seen(&paths)?;
        let verdict = self.judge(&ready);
        let leading = verdict.posterior.leading().filter(|(_, p)| *p > 0.0);
        Ok(Recognition {
            parameters: leading.map_or(Vec::new(), |(k, _)| self.parameters(&verdict, k)),
            spans: spans(self.spans(&verdict, &ready, paths.duration_secs())),
            novelty: verdict.novelty,
            posterior: verdict.posterior,
        })
    }

    /// The parameters of a primitive: those of the exemplars that the path went along, by how long.
    fn parameters(&self, verdict: &Verdict, primitive: usize) -> Vec<f64> {
        let known = &self.vocabulary.primitives()[primitive];
        let mut sum = vec![0.0; known.parameters().dims()];
        let mut count = 0.0;
        for leg in &verdict.legs {
            let Leg::Along { row, .. } = *leg else {
                continue;
            };
            let row = &self.rows[row];
            if row.primitive == primitive {
                for (s, p) in sum.iter_mut().zip(known.point(row.exemplar)) {
                    *s += p;
                }
                count += 1.0;
            }
        }
        match count > 0.0 {
            true => sum.into_iter().map(|s| s / count).collect(),
            false => known.middle(),
        }
    }
}

/// The cost of a primitive, or of the best one, and of the best of the others.
fn best_two(costs: &[f64], primitive: Option<usize>) -> [f64; 2] {
    let at = |k: &usize| costs[*k];
    let best = primitive.or_else(|| (0..costs.len()).min_by(|a, b| at(a).total_cmp(&at(b))));
    let others = (0..costs.len()).filter(|k| Some(*k) != best);
    [
        best.map_or(FAR, |k| at(&k)),
        others.map(|k| at(&k)).fold(FAR, f64::min),
    ]
}

/// Root mean square distance between the effectors of a motion, `every` so many frames, and those seen times factors; both
/// in the heading that is smoothed alike.
pub(super) fn rmse_m(
    motion: &Motion,
    seen: &Seen,
    factors: &[f64],
    every: usize,
    s: &EncodingSettings,
) -> Result<Option<f64>> {
    let made = EffectorPaths::of_motion(motion, &s.effectors, s.heading_secs)?;
    let (mut sum, mut count) = (0.0, 0.0);
    for ((points, factor), f) in seen.instants.iter().zip(factors).zip((0..).step_by(every)) {
        if f >= motion.frames() {
            break;
        }
        for (seen, made) in points.iter().zip(made.at(f)) {
            if let (Some(seen), Some(made)) = (seen, made) {
                let gap: Vector3<f64> = *factor * seen - made;
                sum += gap.norm_squared();
                count += 1.0;
            }
        }
    }
    Ok((count > 0.0).then(|| f64::sqrt(sum / count)))
}

/// Blocks of a motion in instants: where each begins and how many it spans.
pub(super) fn decisions(instants: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..instants.saturating_sub(1))
        .step_by(SAMPLES)
        .map(move |first| (first, SAMPLES.min(instants - 1 - first)))
}
