//! [`Filter`]: the default recogniser.

use std::sync::Arc;

use super::evidence::{Evidence, evidence};
use super::features::Moment;
use super::model::Model;
use crate::error::Result;
use crate::primitive::{Observations, Vocabulary};

/// How the filter listens.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterSettings {
    pub hands_trust: f64,
    pub body_trust: f64,
    pub directions: usize,
    pub rows: usize,
    pub clock_hz: f64,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            hands_trust: 3.0,
            body_trust: 0.6,
            directions: 40,
            rows: 64,
            clock_hz: 30.0,
        }
    }
}

pub struct Filter {
    vocabulary: Arc<Vocabulary>,
    clips: Model,
    settings: FilterSettings,
}

impl Filter {
    pub fn new(vocabulary: Arc<Vocabulary>, settings: &FilterSettings) -> Result<Self> {
        Ok(Self {
            clips: Model::new(&vocabulary, settings, true)?,
            vocabulary,
            settings: settings.clone(),
        })
    }
    pub fn evidence(&self, seen: &Observations) -> (Vec<f64>, f64, f64) {
        let m = seen.motion();
        let every = ((m.rate_hz() / self.settings.clock_hz).round() as usize).max(1);
        let moments: Vec<Moment> = (0..m.frames())
            .step_by(every)
            .map(|f| Moment {
                secs: f as f64 / m.rate_hz(),
                posture: self.clips.layout.posture(m.pose(f)),
                unknown: Vec::new(),
                root: Some(*m.root(f)),
            })
            .collect();
        let features = self.clips.of_clip(moments);
        let Evidence { rows, broad, secs } = evidence(
            &self.clips.rows,
            &self.clips.emission,
            features.iter().map(|(f, dt)| (f, *dt)),
        );
        (rows, broad, secs)
    }
    pub fn classes(&self, rows: &[f64]) -> Vec<f64> {
        (0..self.vocabulary.primitives().len())
            .map(|k| {
                let own: Vec<f64> = self
                    .clips
                    .rows
                    .iter()
                    .zip(rows)
                    .filter(|(r, _)| r.primitive == k)
                    .map(|(_, e)| *e)
                    .collect();
                let most = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                most + (own.iter().map(|e| (e - most).exp()).sum::<f64>() / own.len() as f64).ln()
            })
            .collect()
    }
}
