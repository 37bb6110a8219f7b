//! An encoder at work in the paper's way.

use std::sync::Arc;

use super::encoded::Course;
use super::encoder::{Encoder, Seen};
use super::literal::Literal;
use super::paths::{Chains, EffectorPaths};
use super::result::{EncodedSpan, Encoding, best_two, decisions, rmse_m};
use crate::error::Result;
use crate::motion::Motion;
use crate::primitive::Posterior;
use crate::skeleton::Root;

/// An unlikeness (square metres) at which likeness has fallen to 1/e: effectors 30 cm off.
const UNLIKE: f64 = 0.09;

impl Encoder<'_> {
    /// Encodes as the paper does: the primitive that takes the most time is the label, nothing is rejected.
    pub(super) fn literally(
        &self,
        name: &str,
        paths: &EffectorPaths,
        seen: &Seen,
        literal: &Literal,
    ) -> Result<Encoding> {
        let s = &self.settings;
        let body = self.vocabulary.body();
        let chains = Chains::of(body, &s.effectors)?;
        let usual_m = [self.usual_unit_m(seen), self.usual_row_m()];
        let factor = usual_m[1] / usual_m[0];
        let course = Course {
            vocabulary: self.vocabulary,
            rows: &self.rows,
            settings: s,
            instants: &seen.instants,
            unit_m: &|row| seen.unit_m(row),
            usual_m,
        };
        let mut poses = vec![course.start()];
        let primitives = self.vocabulary.primitives().len();
        let mut sums = vec![0.0; primitives];
        let mut time = vec![0.0; primitives];
        let mut spans: Vec<EncodedSpan> = Vec::new();
        for (first, span) in decisions(seen.instants.len()) {
            let last = (first + s.horizon().max(span)).min(seen.instants.len() - 1);
            let ahead = seen.instants[first..=last].iter();
            let ahead: Vec<Vec<_>> = ahead
                .map(|points| points.iter().map(|p| p.map(|p| factor * p)).collect())
                .collect();
            let Some(decision) = literal.decide(&chains, &poses[first], &ahead, span, s)? else {
                break;
            };
            let secs = span as f64 * s.sample_secs();
            let alike = |cost: f64| (-cost / UNLIKE).exp();
            let [best, second] = best_two(&decision.costs, Some(decision.winner)).map(alike);
            time[decision.winner] += secs;
            for (sum, cost) in sums.iter_mut().zip(&decision.costs) {
                *sum += secs * alike(*cost);
            }
            let start = first as f64 * s.sample_secs();
            poses.extend(decision.poses);
            match spans.last_mut() {
                // Means over what the span has become.
                Some(last) if last.primitive == Some(decision.winner) => {
                    let old = last.end_secs - last.start_secs;
                    let mean = |a: f64, b: f64| (old * a + secs * b) / (old + secs);
                    last.similarity = mean(last.similarity, best);
                    last.margin = mean(last.margin, best - second);
                    last.end_secs = start + secs;
                }
                _ => spans.push(EncodedSpan {
                    start_secs: start,
                    end_secs: start + secs,
                    primitive: Some(decision.winner),
                    similarity: best,
                    margin: best - second,
                    confidence: 1.0,
                }),
            }
        }
        let all: f64 = time.iter().sum();
        if let Some(last) = spans.last_mut() {
            last.end_secs = paths.duration_secs();
        }
        let roots = vec![Root::ORIGIN; poses.len()];
        let rate = 1.0 / s.sample_secs();
        let motion = Motion::new(name, Arc::clone(body), rate, poses.concat(), roots)?;
        let factors = vec![factor; seen.instants.len()];
        Ok(Encoding {
            rmse_m: rmse_m(&motion, seen, &factors, 1, s)?,
            motion,
            scores: sums.iter().map(|sum| sum / all.max(1e-9)).collect(),
            posterior: Posterior {
                primitives: time.iter().map(|t| t / all.max(1e-9)).collect(),
                rest: 0.0,
                // A single posture is no movement of anything.
                none: if all > 0.0 { 0.0 } else { 1.0 },
            },
            novelty: 0.0,
            spans,
        })
    }
}
