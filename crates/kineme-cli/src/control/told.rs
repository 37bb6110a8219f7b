//! What `kineme control` says of what was done.

use std::fmt::Write as _;
use std::path::Path;

use kineme::Vocabulary;
use kineme::control::Place;
use kineme::interaction::Performance;
use kineme_report::Table;
use serde::Serialize;

use crate::table::{Side, aligned};

const HEADER: [(&str, Side); 5] = [
    ("start", Side::Right),
    ("end", Side::Right),
    ("primitive", Side::Left),
    ("joints", Side::Left),
    ("", Side::Left),
];

/// A performance, as `--json` tells it.
#[derive(Serialize)]
pub struct Told {
    body: String,
    dof: usize,
    physics: bool,
    seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    real_time_factor: Option<f64>,
    tracking_rms_rad: f64,
    tracking_max_rad: f64,
    saturated_fraction: f64,
    behaviors: Vec<ToldRun>,
    noticed: Vec<ToldNotice>,
}

#[derive(Serialize)]
struct ToldRun {
    start: f64,
    end: f64,
    primitive: String,
    joints: String,
    rule: bool,
    completed: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    miss: Option<f64>,
}

/// What was noticed from then on; nothing where `primitive` is null.
#[derive(Serialize)]
struct ToldNotice {
    time: f64,
    primitive: Option<String>,
}

impl Told {
    pub fn of(
        performance: &Performance,
        vocabulary: &Vocabulary,
        physics: bool,
        real_time_factor: Option<f64>,
    ) -> Self {
        let body = performance.done.skeleton();
        let name = |k: usize| vocabulary.primitives()[k].name().to_owned();
        let effort = performance.effort;
        let behaviors = performance.ran.iter().map(|ran| ToldRun {
            start: ran.start_secs,
            end: ran.end_secs,
            primitive: ran.primitive.clone(),
            joints: ran.joints.join(" "),
            rule: matches!(ran.planned, Place::Rule(_)),
            completed: ran.completed,
            miss: ran.miss_m,
        });
        let noticed = performance.noticed.iter().map(|n| ToldNotice {
            time: n.secs,
            primitive: n.primitive.map(name),
        });
        Self {
            body: body.name().into(),
            dof: body.dof(),
            physics,
            seconds: performance.done.frames() as f64 / performance.done.rate_hz(),
            real_time_factor,
            tracking_rms_rad: performance.tracking.rms_rad,
            tracking_max_rad: performance.tracking.max_rad,
            saturated_fraction: effort.saturated as f64 / effort.torques.max(1) as f64,
            behaviors: behaviors.collect(),
            noticed: noticed.collect(),
        }
    }

    /// The same for people.
    pub fn text(&self, written: [Option<&Path>; 2]) -> String {
        let mut text = String::new();
        let rows: Vec<Vec<String>> = self.behaviors.iter().map(ToldRun::row).collect();
        if rows.is_empty() {
            text.push_str("No behavior ran: the body stood still.\n");
        } else {
            text.push_str(&aligned(&HEADER, &rows));
        }
        let seen: Vec<String> = self
            .noticed
            .iter()
            .filter_map(|n| Some(format!("{} at {:.2} s", n.primitive.as_ref()?, n.time)))
            .collect();
        if !seen.is_empty() {
            let _ = writeln!(text, "\nnoticed: {}", seen.join(", "));
        }
        let _ = writeln!(text, "\n{}", self.tracking());
        if let Some(factor) = self.real_time_factor {
            let _ = writeln!(text, "{:.1} s took {factor:.1} times less", self.seconds);
        }
        for path in written.into_iter().flatten() {
            let _ = writeln!(text, "written: {}", path.display());
        }
        text
    }

    /// How near the body came to what it was told, in a sentence.
    pub fn tracking(&self) -> String {
        let body = format!("{} ({} degrees of freedom)", self.body, self.dof);
        if !self.physics {
            return format!("{body} was moved without physics: it is where it was told to be");
        }
        format!(
            "{body} came within {} degrees of what it was told (root mean square; {} at most), with {:.2} % of its \
             torques at their limit",
            few(self.tracking_rms_rad.to_degrees()),
            few(self.tracking_max_rad.to_degrees()),
            100.0 * self.saturated_fraction
        )
    }

    /// What ran, as a table of a page.
    pub fn table(&self) -> Table {
        Table {
            caption: "Behaviors as they ran, seconds.".into(),
            header: HEADER.map(|(name, _)| name.to_owned()).to_vec(),
            rows: self.behaviors.iter().map(ToldRun::row).collect(),
        }
    }
}

impl ToldRun {
    fn row(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.rule {
            notes.push("an answer".to_owned());
        }
        if let Some(miss) = self.miss {
            notes.push(format!("{:.1} cm from its target", 100.0 * miss));
        }
        if !self.completed {
            notes.push("not completed".to_owned());
        }
        vec![
            format!("{:.2}", self.start),
            format!("{:.2}", self.end),
            self.primitive.clone(),
            self.joints.clone(),
            notes.join(", "),
        ]
    }
}

/// Two digits that count.
fn few(value: f64) -> String {
    match value {
        v if v >= 0.1 => format!("{v:.1}"),
        v if v >= 0.01 => format!("{v:.2}"),
        v if v > 0.0 => format!("{v:.0e}"),
        _ => "0".into(),
    }
}
