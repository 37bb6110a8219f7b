//! What a derivation found, for people and for scripts.

use std::collections::BTreeMap;

use kineme::Motion;
use kineme::derivation::{Derived, Segment};
use kineme::math::statistics::median;
use kineme_paper::figures::counted;
use serde::Serialize;

use crate::failure::Failure;
use crate::table::{Side, aligned};

/// Letters that the sources of a group's line may take, beyond the first.
const NAMES_WIDTH: usize = 44;

/// A derivation and the motions that it was given.
pub struct Findings<'a> {
    /// What was found.
    pub derived: &'a Derived,
    /// Where.
    pub motions: &'a [Motion],
    /// How long it took, where that was asked for.
    pub seconds: Option<Seconds>,
}

/// Measured times of the steps, seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Seconds {
    /// Reading and retargeting.
    pub reading: f64,
    /// Cutting.
    pub segmentation: f64,
    /// Warping.
    pub distances: f64,
    /// Graph, geodesics, scaling.
    pub embedding: f64,
    /// Groups and behaviors.
    pub clustering: f64,
    /// Making primitives of groups.
    pub primitives: f64,
    /// Fitting what recognisers learn of them.
    pub calibration: f64,
    /// All of it.
    pub total: f64,
}

#[derive(Serialize)]
struct Document<'a> {
    segments: Vec<SegmentLine<'a>>,
    groups: Vec<GroupLine<'a>>,
    behaviors: Vec<BehaviorLine<'a>>,
    embedding: EmbeddingLine,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<Seconds>,
}

#[derive(Serialize)]
struct SegmentLine<'a> {
    motion: &'a str,
    start: f64,
    end: f64,
    group: Option<&'a str>,
    behavior: Option<&'a str>,
}

#[derive(Serialize)]
struct GroupLine<'a> {
    name: &'a str,
    segments: usize,
    coherence: Option<f64>,
}

#[derive(Serialize)]
struct BehaviorLine<'a> {
    name: &'a str,
    groups: &'a [String],
}

#[derive(Serialize)]
struct EmbeddingLine {
    dimension: usize,
    residual_variance: Vec<f64>,
}

/// To the microsecond: beyond it a time is rounding.
fn rounded(seconds: f64) -> f64 {
    (1e6 * seconds).round() / 1e6
}

impl Findings<'_> {
    /// The document of `derive --json`.
    pub fn json(&self) -> Result<String, Failure> {
        let derived = self.derived;
        let segments = derived.segments.iter().zip(&derived.labels);
        let document = Document {
            segments: segments
                .map(|(segment, label)| {
                    let behavior = label.map(|g| derived.behaviors.of_group[g]);
                    let (start, end) = self.span(segment);
                    SegmentLine {
                        motion: self.motions[segment.motion].name(),
                        start: rounded(start),
                        end: rounded(end),
                        group: label.map(|g| derived.groups[g].name.as_str()),
                        behavior: behavior.map(|b| derived.behaviors.items[b].name.as_str()),
                    }
                })
                .collect(),
            groups: derived
                .groups
                .iter()
                .map(|g| GroupLine {
                    name: &g.name,
                    segments: g.segments.len(),
                    coherence: g.coherence,
                })
                .collect(),
            behaviors: derived
                .behaviors
                .items
                .iter()
                .map(|b| BehaviorLine {
                    name: &b.name,
                    groups: &b.primitives,
                })
                .collect(),
            embedding: EmbeddingLine {
                dimension: derived.embedding.dimension,
                residual_variance: self.residual_variance(),
            },
            seconds: self.seconds,
        };
        let text = serde_json::to_string(&document).map_err(|e| Failure::failed(e.to_string()))?;
        Ok(format!("{text}\n"))
    }

    /// The same for people.
    pub fn text(&self) -> String {
        let derived = self.derived;
        let grouped = derived.labels.iter().flatten().count();
        let segments = derived.segments.len();
        let mut text = format!(
            "{} (median {:.2} s) in {}: {grouped} in {}, {} in none\n",
            counted(segments, "segment"),
            self.median_secs(0..segments),
            counted(self.motions.len(), "motion"),
            counted(derived.groups.len(), "group"),
            segments - grouped
        );
        if !derived.groups.is_empty() {
            text.push('\n');
            text.push_str(&self.groups());
        }
        let merged = self.behaviors();
        if !merged.is_empty() {
            text.push('\n');
            text.push_str(&merged);
        }
        text.push('\n');
        text.push_str(&self.method());
        for note in &derived.notes {
            text.push_str(&format!("note: {note}\n"));
        }
        if let Some(s) = &self.seconds {
            text.push_str(&format!(
                "seconds: reading {:.2}, segmentation {:.2}, distances {:.2}, embedding {:.2}, clustering {:.2}, \
                 primitives {:.2}, calibration {:.2}, total {:.2}\n",
                s.reading,
                s.segmentation,
                s.distances,
                s.embedding,
                s.clustering,
                s.primitives,
                s.calibration,
                s.total
            ));
        }
        text
    }

    fn groups(&self) -> String {
        let names: Vec<&str> = self.motions.iter().map(Motion::name).collect();
        let names = kineme_report::short_names(&names);
        let rows: Vec<Vec<String>> = self
            .derived
            .groups
            .iter()
            .map(|group| {
                vec![
                    group.name.clone(),
                    group.segments.len().to_string(),
                    group.coherence.map_or("-".into(), |c| format!("{c:.2}")),
                    format!("{:.2}", self.median_secs(group.segments.iter().copied())),
                    self.sources(&group.segments, &names),
                ]
            })
            .collect();
        let header = [
            ("group", Side::Left),
            ("segments", Side::Right),
            ("coherence", Side::Right),
            ("seconds", Side::Right),
            ("from", Side::Left),
        ];
        aligned(&header, &rows)
    }

    /// The motions that most of these segments come from.
    fn sources(&self, segments: &[usize], names: &[String]) -> String {
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        for &s in segments {
            *counts.entry(self.derived.segments[s].motion).or_default() += 1;
        }
        let mut counts: Vec<(usize, usize)> = counts.into_iter().collect();
        counts.sort_by_key(|&(motion, count)| (std::cmp::Reverse(count), motion));
        let named = counts.iter().map(|&(motion, count)| match count {
            1 => names[motion].clone(),
            n => format!("{} x{n}", names[motion]),
        });
        let mut text = String::new();
        let mut left = counts.len();
        for name in named {
            if !text.is_empty() && text.chars().count() + name.chars().count() > NAMES_WIDTH {
                break;
            }
            text.push_str(if text.is_empty() { "" } else { ", " });
            text.push_str(&name);
            left -= 1;
        }
        match left {
            0 => text,
            n => format!("{text}, {n} more"),
        }
    }

    /// Behaviours of several groups.
    fn behaviors(&self) -> String {
        let several = self.derived.behaviors.items.iter();
        let rows: Vec<Vec<String>> = several
            .filter(|b| b.primitives.len() > 1)
            .map(|b| vec![b.name.clone(), b.primitives.join(" ")])
            .collect();
        if rows.is_empty() {
            return String::new();
        }
        aligned(&[("behavior", Side::Left), ("groups", Side::Left)], &rows)
    }

    fn method(&self) -> String {
        let derived = self.derived;
        let variance = self.residual_variance();
        let shown: Vec<String> = variance.iter().take(6).map(|v| format!("{v:.3}")).collect();
        let sweep = &derived.sweep;
        let noise = sweep.labels.iter().filter(|l| l.is_none()).count();
        format!(
            "embedding: {}; residual variance with 1, 2, ...: {}\n\
             sweep-and-prune beside it: {}, {} in none, width {:.3}, stability {:.2}\n",
            counted(derived.embedding.dimension, "dimension"),
            shown.join(" "),
            counted(
                sweep.labels.iter().flatten().max().map_or(0, |m| m + 1),
                "group"
            ),
            counted(noise, "segment"),
            sweep.width,
            sweep.stability
        )
    }

    /// Up to the first that is no number, where geodesics are all alike.
    fn residual_variance(&self) -> Vec<f64> {
        let values = &self.derived.embedding.residual_variance;
        values
            .iter()
            .copied()
            .take_while(|v| v.is_finite())
            .collect()
    }

    fn span(&self, segment: &Segment) -> (f64, f64) {
        let rate = self.motions[segment.motion].rate_hz();
        let seconds = |frame: usize| frame as f64 / rate;
        (seconds(segment.frames.start), seconds(segment.frames.end))
    }

    fn median_secs(&self, segments: impl Iterator<Item = usize>) -> f64 {
        let lengths: Vec<f64> = segments
            .map(|s| self.span(&self.derived.segments[s]))
            .map(|(start, end)| end - start)
            .collect();
        median(&lengths).unwrap_or(0.0)
    }
}
