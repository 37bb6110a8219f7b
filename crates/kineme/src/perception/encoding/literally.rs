//! An encoder at work in the paper's way.

use std::sync::Arc;

use super::encoder::{Encoder, Seen};
use super::literal::Literal;
use super::paths::EffectorPaths;
use super::result::{EncodedSpan, Encoding, rmse_m};
use crate::error::Result;
use crate::motion::Motion;
use crate::primitive::Posterior;
use crate::skeleton::Root;

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
        let (decided, poses) = self.decided(seen, literal, self.course(seen).start())?;
        let primitives = self.vocabulary.primitives().len();
        let mut sums = vec![0.0; primitives];
        let mut time = vec![0.0; primitives];
        let mut spans: Vec<EncodedSpan> = Vec::new();
        for decision in &decided {
            let secs = decision.instants() as f64 * s.sample_secs();
            let winner = decision.winner;
            let alike = decision.similarities.iter();
            let others = alike.clone().enumerate().filter(|(k, _)| *k != winner);
            let second = others.map(|(_, a)| *a).fold(0.0, f64::max);
            let best = decision.similarities[winner];
            time[winner] += secs;
            for (sum, alike) in sums.iter_mut().zip(alike) {
                *sum += secs * alike;
            }
            match spans.last_mut() {
                // Means over what the span has become.
                Some(last) if last.primitive == Some(winner) => {
                    let old = last.end_secs - last.start_secs;
                    let mean = |a: f64, b: f64| (old * a + secs * b) / (old + secs);
                    last.similarity = mean(last.similarity, best);
                    last.margin = mean(last.margin, best - second);
                    last.end_secs = decision.end_secs;
                }
                _ => spans.push(EncodedSpan {
                    start_secs: decision.start_secs,
                    end_secs: decision.end_secs,
                    primitive: Some(winner),
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
        let factor = self.usual_row_m() / self.usual_unit_m(seen);
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
