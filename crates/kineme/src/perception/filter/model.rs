//! The model that listens: rows of every primitive, their features, and how observations differ from them.

use std::ops::Range;

use rayon::prelude::*;

use super::emission::{Emission, Part};
use super::exact::{Exact, Tangents};
use super::features::{Feature, Layout, Moment, Recent, offset};
use super::noise::covariance;
use super::recogniser::FilterSettings;
use super::rows::{Row, rows};
use super::tangents::tangents;
use crate::error::Result;
use crate::primitive::{Primitive, Vocabulary};

/// A joint this far beyond where any exemplar had it cannot be believed, radians.
const TOLERANCE_RAD: f64 = 0.5;

/// A number of a posture that varies by less among the rows is not moved, metres.
const MOVED_M: f64 = 1e-3;

/// In a stream of people, none of whose movements goes round, evidence counts so much of what the settings say: how
/// somebody differs from the exemplars lasts, so that a moment tells little that the one before it did not.
const LASTING: f64 = 0.14;

/// Rows and what is needed to compare moments with them.
#[derive(Debug, Clone)]
pub(super) struct Model {
    pub layout: Layout,
    pub rows: Vec<Row>,
    /// Where the rows have the joints.
    pub bounds: Bounds,
    /// Which numbers of a posture the rows differ in.
    pub moved: Vec<bool>,
    /// Half of the first moments' posture is taken off: people differ in how they stand.
    offset: bool,
    /// Features of all rows' moments, one after the other.
    features: Vec<f64>,
    parts: Vec<Part>,
    /// What varies around the rows' moments, where that is known.
    tangents: Option<Tangents>,
    /// How much evidence counts of what the settings say; `None`: all, as nobody's manner of moving lasts in it.
    pub lasting: Option<f64>,
}

impl Model {
    pub fn new(vocabulary: &Vocabulary, settings: &FilterSettings, offset: bool) -> Result<Self> {
        let layout = Layout::of(vocabulary.body());
        let rows = rows(vocabulary, settings.rows, !offset)?;
        let dims = layout.dims();
        let of = |row: &Row| {
            let path = row.path(vocabulary)?;
            let poses = row.progress.iter().map(|&p| path.sample(p).pose);
            Ok((layout.of_row(row, &path, offset), Bounds::of(poses)))
        };
        let sampled: Vec<(Vec<f64>, Bounds)> = rows.par_iter().map(of).collect::<Result<_>>()?;
        let mut features = Vec::new();
        let mut bounds = Bounds::default();
        for (own, range) in sampled {
            features.extend(own);
            bounds.join(&range);
        }
        let still = layout.still();
        let moved = |i: usize| {
            let values = features.chunks_exact(dims).map(|f| f[i]);
            let range = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            });
            range[1] - range[0] > MOVED_M
        };
        let moved = (0..dims).filter(|&i| still[i]).map(moved).collect();
        let covariance = covariance(vocabulary, &rows, &features, &still);
        // Half of the first moments' posture taken off, a body is not where the manifold has it.
        let tangents = match offset {
            true => None,
            false => tangents(vocabulary, &rows, &features, dims)?,
        };
        // Evidence of clips gets its temperature as a whole; that of the manifold itself is no matter of people.
        // Where one cycle goes over into the next, no beginning and no end tells, and cool evidence is late.
        let cycles = vocabulary.primitives().iter().any(Primitive::is_cyclic);
        let lasting = (!offset && tangents.is_none() && !cycles).then_some(LASTING);
        let share = lasting.unwrap_or(1.0);
        let [hands, body] = layout.parts();
        let trusts = [settings.hands_trust, settings.body_trust].map(|t| share * t);
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
            tangents,
            lasting,
            layout,
            rows,
            bounds,
            moved,
            offset,
            features,
            parts,
        })
    }

    /// The parts of postures alone, without displacements: ranges are of a posture's numbers.
    pub fn posture_parts(&self) -> Vec<Part> {
        let still = self.layout.still();
        let mut end = 0;
        let of = |part: &Part| {
            let own: Vec<usize> = (0..part.range.len())
                .filter(|i| still[part.range.start + i])
                .collect();
            let start = end;
            end += own.len();
            Part {
                range: start..end,
                covariance: part.covariance.select_rows(&own).select_columns(&own),
                ..part.clone()
            }
        };
        self.parts.iter().map(of).collect()
    }

    /// How well moments fit the rows without the numbers that are unknown: the Gaussian's marginal.
    pub fn without(&self, unknown: &[bool]) -> Result<Emission> {
        Emission::new(&self.parts, &self.features, self.layout.dims(), unknown)
    }

    /// How well moments fit the manifold itself when certain numbers are unknown, where that can be told.
    pub fn exact(&self, unknown: &[bool]) -> Result<Option<Exact>> {
        let still = self.layout.still();
        let of = |tangents| Exact::new(&self.features, tangents, &still, unknown);
        Ok(self.tangents.as_ref().map(of).transpose()?.flatten())
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
}

/// Least and greatest value of each coordinate.
#[derive(Debug, Clone, Default)]
pub(super) struct Bounds(Vec<[f64; 2]>);

impl Bounds {
    fn of(poses: impl Iterator<Item = Vec<f64>>) -> Self {
        let mut bounds = Self::default();
        for pose in poses {
            bounds.join(&Self(pose.into_iter().map(|v| [v, v]).collect()));
        }
        bounds
    }

    fn join(&mut self, other: &Self) {
        if self.0.is_empty() {
            self.0.clone_from(&other.0);
        }
        for (own, [low, high]) in self.0.iter_mut().zip(&other.0) {
            *own = [own[0].min(*low), own[1].max(*high)];
        }
    }

    /// Whether these coordinates of a pose are where the rows have them, give or take what people differ by.
    pub fn contain(&self, mut coordinates: Range<usize>, pose: &[f64]) -> bool {
        coordinates.all(|c| {
            let [low, high] = self.0[c];
            pose[c] >= low - TOLERANCE_RAD && pose[c] <= high + TOLERANCE_RAD
        })
    }
}
