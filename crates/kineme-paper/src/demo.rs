//! The demo: a choreographed session goes in, a vocabulary comes out, and it is judged by what was choreographed.
//!
//! The session stands in `choreography/session.toml`, which movement is when in `session-movements.csv` beside it. The
//! derivation sees the motions alone.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::choreography::perform;
use kineme::derivation::{Cut, Derivation, Derived, Segment, Stage};
use kineme::math::statistics::{agreement, noise_as_singletons};
use kineme::perception::calibrated;
use kineme::segmentation::Segmenter;
use kineme::{Motion, Vocabulary, body};
use kineme_formats::output::{self, Existing};
use kineme_formats::tables::body_angles;
use kineme_formats::{FormatError, Place, script, vocabulary};

use crate::figures::{Report, summary};
use crate::sets::Result;
use crate::show::{Act, PLANS, Show, show};

const SESSION: &str = include_str!("../../../choreography/session.toml");
const SESSION_FILE: &str = "choreography/session.toml";
const MOVEMENTS: &str = include_str!("../../../choreography/session-movements.csv");
const MOVEMENTS_FILE: &str = "choreography/session-movements.csv";

/// The vocabulary among the files of the demo.
pub const VOCABULARY: &str = "session.kineme";

/// The written vocabularies among them, all movements and boxing alone, and who is sparred with.
pub const MOVEMENTS_KNOWN: &str = "movements.kineme";
/// See [`MOVEMENTS_KNOWN`].
pub const BOXING: &str = "boxing.kineme";
const ATTACKER: &str = "attacker.csv";

/// Frames a second at which the session is performed.
const RATE_HZ: f64 = 60.0;

/// What was found in the session.
#[derive(Debug, Clone)]
pub struct Found {
    /// The session's motions, of Ares.
    pub motions: Vec<Motion>,
    /// What was derived from them.
    pub derived: Derived,
    /// The vocabulary of it.
    pub vocabulary: Vocabulary,
    /// How well groups match the strokes that were choreographed, such as `jab out`.
    pub strokes: Match,
    /// How well behaviors match the movements that were choreographed, such as `jab`.
    pub movements: Match,
    /// For each group the stroke that most of its segments are, with how many.
    pub names: Vec<(String, usize)>,
}

/// The demo.
#[derive(Debug, Clone)]
pub struct Demo {
    /// What was found in the session.
    pub found: Found,
    /// What bodies did with written primitives.
    pub show: Show,
}

/// What the demo is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Deriving.
    Deriving(Stage),
    /// The show.
    Showing(Act),
}

impl Step {
    /// As a line of progress says it.
    pub fn name(self) -> &'static str {
        match self {
            Step::Deriving(stage) => stage.name(),
            Step::Showing(act) => act.name(),
        }
    }
}

/// How well what was found matches what was choreographed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Kinds choreographed.
    pub kinds: usize,
    /// Share of the segments in groups that are of their group's most frequent kind.
    pub purity: f64,
    /// Adjusted Rand index over all segments, one in no group counting as a group of its own.
    pub ari: f64,
}

/// A stroke of a movement, as choreographed.
#[derive(Debug, Clone, PartialEq)]
struct Stroke {
    recording: String,
    start_secs: f64,
    end_secs: f64,
    movement: String,
    stroke: String,
}

/// Finds what is in the session, and puts the show on; `watch` hears of every step as it begins.
///
/// # Errors
/// As [`find`] and [`show`].
pub fn run(seed: u64, watch: &mut dyn FnMut(Step)) -> Result<Demo> {
    Ok(Demo {
        found: find(seed, &mut |stage| watch(Step::Deriving(stage)))?,
        show: show(seed, &mut |act| watch(Step::Showing(act)))?,
    })
}

/// Performs the session and derives its vocabulary; `watch` hears of every stage as it begins.
///
/// # Errors
/// When the embedded session is not sound, or a step of the derivation fails.
pub fn find(seed: u64, watch: &mut dyn FnMut(Stage)) -> Result<Found> {
    let motions = session()?;
    let truth = strokes()?;
    let mut settings = Derivation::new(Cut::Segmenter {
        segmenter: Segmenter::default(),
        target_secs: None,
    });
    settings.seed = seed;
    let derived = settings.run(&motions, watch)?;
    let vocabulary = derived.vocabulary(&motions, &kineme::Modelling::default(), &|_| None)?;
    let vocabulary = calibrated(vocabulary, None)?;

    let of_segment: Vec<Option<&Stroke>> = derived
        .segments
        .iter()
        .map(|s| longest_shared(s, &motions[s.motion], &truth))
        .collect();
    let stroke = |s: &Stroke| format!("{} {}", s.movement, s.stroke);
    let strokes: Vec<Option<String>> = of_segment.iter().map(|s| s.map(stroke)).collect();
    let movements: Vec<Option<String>> = of_segment
        .iter()
        .map(|s| s.map(|s| s.movement.clone()))
        .collect();
    let behaviors: Vec<Option<usize>> = derived
        .labels
        .iter()
        .map(|label| label.map(|g| derived.behaviors.of_group[g]))
        .collect();
    Ok(Found {
        strokes: matched(&derived.labels, &strokes),
        movements: matched(&behaviors, &movements),
        names: most_frequent(&derived.labels, &strokes),
        motions,
        derived,
        vocabulary,
    })
}

impl Demo {
    /// Writes the vocabulary and the page with its figures into a folder, which is made; returns the page's path.
    ///
    /// # Errors
    /// When a file exists and is to be kept, or cannot be written.
    pub fn write(&self, folder: &Path, existing: Existing) -> kineme_formats::Result<PathBuf> {
        let bytes = vocabulary::write(&self.found.vocabulary, VOCABULARY)?;
        output::write_bytes(&folder.join(VOCABULARY), existing, &bytes)?;
        for (file, made) in [
            (MOVEMENTS_KNOWN, &self.show.movements),
            (BOXING, &self.show.boxing),
        ] {
            let bytes = vocabulary::write(made, file)?;
            output::write_bytes(&folder.join(file), existing, &bytes)?;
        }
        for (file, text) in PLANS {
            output::write_bytes(&folder.join(file), existing, text.as_bytes())?;
        }
        let seen = self.show.attacker.seen.motion();
        let bytes = body_angles::table(seen).write(ATTACKER)?;
        output::write_bytes(&folder.join(ATTACKER), existing, &bytes)?;
        let mut paragraphs = vec![
            "Written exemplars became primitives; by these, two bodies performed a routine and one of them sparred, and \
             what was seen was read back by the same primitives. Sliders below ask them for movements that nobody wrote."
                .to_string(),
            "A choreographed session of eight movements was cut into segments, and segments that are alike were \
             grouped. Nobody told the procedure what the movements are."
                .to_string(),
        ];
        paragraphs.extend(summary(&self.found.derived, &self.found.motions));
        paragraphs.push(format!(
            "Against what was choreographed: {:.0} % of the grouped segments are of their group's most frequent \
             stroke (adjusted Rand index {:.2}), and {:.0} % of their behavior's most frequent movement ({:.2}).",
            100.0 * self.found.strokes.purity,
            self.found.strokes.ari,
            100.0 * self.found.movements.purity,
            self.found.movements.ari
        ));
        let title = "One vocabulary, two directions";
        let report = Report::of(
            &self.found.derived,
            &self.found.motions,
            &self.found.vocabulary,
            Some(&self.show),
            (title, &paragraphs),
        );
        let refused = |e: kineme::Error| {
            FormatError::new(
                VOCABULARY,
                Place::File,
                e.to_string(),
                "a vocabulary to show",
            )
        };
        report.map_err(refused)?.write(folder, existing)
    }

    /// The names of the files that [`Self::write`] writes.
    pub fn files() -> Vec<&'static str> {
        let mut names = vec![VOCABULARY, MOVEMENTS_KNOWN, BOXING, ATTACKER];
        names.extend(PLANS.map(|(file, _)| file));
        names.extend(Report::names());
        names
    }
}

/// The session's motions.
fn session() -> Result<Vec<Motion>> {
    let script = script::parse(SESSION_FILE, SESSION.as_bytes())?;
    let body = Arc::new(body(&script.body)?);
    let motions = script
        .animations
        .iter()
        .map(|a| Ok(perform(&a.name, &a.keys, &body, RATE_HZ)?));
    motions.collect()
}

/// The strokes that were choreographed.
fn strokes() -> Result<Vec<Stroke>> {
    let mut table = csv::Reader::from_reader(MOVEMENTS.as_bytes());
    let mut strokes = Vec::new();
    for (i, row) in table.records().enumerate() {
        let row = row?;
        let wrong = || {
            FormatError::new(
                MOVEMENTS_FILE,
                Place::Line(i + 2),
                row.iter().collect::<Vec<_>>().join(","),
                "recording,start,end,movement,stroke",
            )
        };
        let cell = |i: usize| row.get(i).map(str::to_string).ok_or_else(wrong);
        let secs = |i: usize| cell(i)?.parse::<f64>().map_err(|_| wrong());
        strokes.push(Stroke {
            recording: cell(0)?,
            start_secs: secs(1)?,
            end_secs: secs(2)?,
            movement: cell(3)?,
            stroke: cell(4)?,
        });
    }
    Ok(strokes)
}

/// The stroke with which a segment shares the most time; `None` where it shares none.
fn longest_shared<'a>(
    segment: &Segment,
    motion: &Motion,
    truth: &'a [Stroke],
) -> Option<&'a Stroke> {
    let secs = |frame: usize| frame as f64 / motion.rate_hz();
    let (start, end) = (secs(segment.frames.start), secs(segment.frames.end));
    truth
        .iter()
        .filter(|s| s.recording == motion.name())
        .map(|s| (end.min(s.end_secs) - start.max(s.start_secs), s))
        .filter(|(shared, _)| *shared > 0.0)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, s)| s)
}

/// How often each kind occurs in each group; segments of no kind count as a kind of their own.
fn tally<'a>(
    labels: &[Option<usize>],
    kinds: &'a [Option<String>],
) -> Vec<BTreeMap<&'a str, usize>> {
    let groups = labels.iter().flatten().max().map_or(0, |m| m + 1);
    let mut counts = vec![BTreeMap::new(); groups];
    for (label, kind) in labels.iter().zip(kinds) {
        if let Some(g) = label {
            let kind = kind.as_deref().unwrap_or("nothing choreographed");
            *counts[*g].entry(kind).or_insert(0) += 1;
        }
    }
    counts
}

fn most_frequent(labels: &[Option<usize>], kinds: &[Option<String>]) -> Vec<(String, usize)> {
    let best = |counts: BTreeMap<&str, usize>| {
        // Of equal counts the first by name.
        let best = counts.into_iter().rev().max_by_key(|(_, n)| *n);
        best.map_or((String::new(), 0), |(kind, n)| (kind.to_string(), n))
    };
    tally(labels, kinds).into_iter().map(best).collect()
}

fn matched(labels: &[Option<usize>], kinds: &[Option<String>]) -> Match {
    let grouped = labels.iter().flatten().count();
    let of_best: usize = most_frequent(labels, kinds).iter().map(|(_, n)| n).sum();
    let mut numbers: BTreeMap<&Option<String>, usize> = BTreeMap::new();
    let truth: Vec<usize> = kinds
        .iter()
        .map(|kind| {
            let next = numbers.len();
            *numbers.entry(kind).or_insert(next)
        })
        .collect();
    Match {
        kinds: numbers.keys().filter(|kind| kind.is_some()).count(),
        purity: of_best as f64 / grouped.max(1) as f64,
        ari: agreement(&noise_as_singletons(labels), &truth).ari,
    }
}
