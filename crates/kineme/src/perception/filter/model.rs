//! The model that listens: rows of every primitive, their features, and how observations differ from them.

use std::sync::Arc;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::emission::{Emission, Part};
use super::features::{Feature, Layout, Moment, Recent, offset};
use super::noise::covariance;
use super::recogniser::FilterSettings;
use super::rows::{Row, rows};
use crate::error::Result;
use crate::primitive::Vocabulary;

/// Rows and what is needed to compare moments with them.
#[derive(Debug, Clone)]
pub(super) struct Model {
    pub layout: Layout,
    pub rows: Vec<Row>,
    /// Half of the first moments' posture is taken off: people differ in how they stand.
    offset: bool,
    /// Features of all rows' moments, one after the other.
    features: Vec<f64>,
    covariance: DMatrix<f64>,
    parts: Vec<Part>,
    /// For complete observations.
    pub emission: Emission,
}

impl Model {
    pub fn new(vocabulary: &Vocabulary, settings: &FilterSettings, offset: bool) -> Result<Self> {
        let layout = Layout::of(vocabulary.body());
        let rows = rows(vocabulary, settings.rows)?;
        let dims = layout.dims();
        let features: Vec<Vec<f64>> = rows
            .par_iter()
            .map(|row| Ok(layout.of_row(row, &row.path(vocabulary)?, offset)))
            .collect::<Result<_>>()?;
        let features = features.concat();
        let covariance = covariance(vocabulary, &rows, &features, dims);
        let [hands, body] = layout.parts();
        let trusts = [settings.hands_trust, settings.body_trust];
        let parts: Vec<Part> = [hands, body]
            .into_iter()
            .zip(trusts)
            .filter(|(range, _)| !range.is_empty())
            .map(|(range, trust_per_sec)| Part {
                covariance: covariance
                    .view((range.start, range.start), (range.len(), range.len()))
                    .into_owned(),
                range,
                trust_per_sec,
                directions: settings.directions,
            })
            .collect();
        Ok(Self {
            emission: Emission::new(&parts, &features, dims, &[])?,
            layout,
            rows,
            offset,
            features,
            covariance,
            parts,
        })
    }

    /// The same without the numbers that are unknown: the Gaussian's marginal.
    pub fn without(&self, unknown: &[bool]) -> Result<Emission> {
        Emission::new(&self.parts, &self.features, self.layout.dims(), unknown)
    }

    /// Features of a clip's moments, each with the seconds since the one before.
    pub fn of_clip(&self, moments: Vec<Moment>) -> Vec<(Feature, f64)> {
        let offset = self.offset.then(|| offset(&moments));
        let mut recent = Recent::default();
        let usual = match moments.as_slice() {
            [first, .., last] => (last.secs - first.secs) / (moments.len() - 1) as f64,
            _ => 1.0 / 30.0,
        };
        let mut before = None;
        let mut features = Vec::with_capacity(moments.len());
        for moment in moments {
            let secs = moment.secs;
            recent.push(moment);
            if let (Some(now), Some(then)) = (recent.now(), recent.then()) {
                let dt = before.map_or(usual, |b| secs - b);
                features.push((self.layout.feature(now, &then, offset.as_deref()), dt));
            }
            before = Some(secs);
        }
        features
    }

    /// The covariance of features about their row.
    pub fn covariance(&self) -> &DMatrix<f64> {
        &self.covariance
    }
}

/// A vocabulary that is shared.
pub(super) type Shared = Arc<Vocabulary>;
