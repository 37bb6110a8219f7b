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
use kineme_report::{Figure, Page, Section};

use crate::figures::{Findings, Report, summary};
use crate::paper_figures::{CAPTIONS, NAMES, draw};
use crate::scene::{CardBudget, HOW_TO_READ, cards, takes_of_show};
use crate::sets::Result;
use crate::show::{Act, PLANS, Show, show};
use crate::table1::{MovementSettings, Row, embedded, table};

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
/// The movement of who is sparred with.
pub const ATTACKER: &str = "attacker.csv";

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
    /// Table I, as far as no corpus is needed.
    pub table: Vec<Row>,
    /// Figures 1 to 7 as SVG.
    pub figures: [String; 7],
}

/// How much the demo does.
#[derive(Debug, Clone, PartialEq)]
pub struct DemoSettings {
    /// Seed of everything that is drawn.
    pub seed: u64,
    /// Plans of the first set of Table I, movements of each, and one in how many animations is judged.
    pub table: [usize; 3],
}

impl Default for DemoSettings {
    fn default() -> Self {
        Self {
            seed: 0,
            table: [4, 10, 6],
        }
    }
}

/// What the demo is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Deriving.
    Deriving(Stage),
    /// The show.
    Showing(Act),
    /// Table I.
    Judging,
    /// The figures.
    Drawing,
}

impl Step {
    /// As a line of progress says it.
    pub fn name(self) -> &'static str {
        match self {
            Step::Deriving(stage) => stage.name(),
            Step::Showing(act) => act.name(),
            Step::Judging => "judging the classifiers",
            Step::Drawing => "drawing",
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

/// Finds what is in the session, puts the show on, and makes the paper's table and figures again; `watch` hears of every
/// step as it begins.
///
/// # Errors
/// As [`find`], [`show`], [`embedded`] and [`draw`].
pub fn run(settings: &DemoSettings, watch: &mut dyn FnMut(Step)) -> Result<Demo> {
    let seed = settings.seed;
    let found = find(seed, &mut |stage| watch(Step::Deriving(stage)))?;
    let show = show(seed, &mut |act| watch(Step::Showing(act)))?;
    watch(Step::Judging);
    let [clips, movements, every] = settings.table;
    let sets = MovementSettings {
        clips,
        movements,
        seed,
    };
    let table = embedded(&show.boxing, &sets, every)?;
    watch(Step::Drawing);
    Ok(Demo {
        figures: draw(&found, &mut |_| {})?,
        found,
        show,
        table,
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
        let report = self.report().map_err(|e| {
            FormatError::new(
                VOCABULARY,
                Place::File,
                e.to_string(),
                "a vocabulary to show",
            )
        });
        report?.write(folder, existing)
    }

    /// The page: what was performed and recognised, the primitives that did it, what was found in the session, and
    /// what the paper shows.
    fn report(&self) -> kineme::Result<Report> {
        let (show, found) = (&self.show, &self.found);
        let mut page = Page {
            title: "One vocabulary, two directions".into(),
            summary: vec![
                "A primitive is a function f(p, τ) from parameters and phase to posture, made of a few exemplars. Run \
                 forward it moves the bodies below; run backward it says what they do, how far into it, and whether it \
                 is anything known."
                    .into(),
            ],
            ..Page::default()
        };
        page.scene.takes = takes_of_show(&mut page.scene, show);
        let budget = CardBudget {
            bytes: CardBudget::default().bytes / 2,
            ..CardBudget::default()
        };
        page.scene.primitives = cards(&mut page.scene, &show.movements, &budget)?.0;
        page.sections.push(Section {
            title: "Primitives".into(),
            text: vec![format!(
                "{} primitives of exemplars that were written by hand: they moved the bodies above and recognised them. \
                 {HOW_TO_READ}",
                show.movements.primitives().len()
            )],
            cards: 0..page.scene.primitives.len(),
            ..Section::default()
        });
        let findings = Findings {
            derived: &found.derived,
            motions: &found.motions,
            vocabulary: &found.vocabulary,
            known: &found.known(),
        };
        let titles = ["Found by itself", "How it was found"];
        let figures = findings.put_on(&mut page, titles, &self.told(), &budget)?;
        page.sections.push(Section {
            title: "Table I".into(),
            tables: vec![table(&self.table)],
            ..Section::default()
        });
        let drawn = NAMES.iter().zip(CAPTIONS).zip(&self.figures);
        page.sections.push(Section {
            title: "Figures 1 to 7".into(),
            text: vec![
                "The figures of the paper, each drawn from what this program computes on the movements that come with \
                 it."
                .into(),
            ],
            figures: drawn
                .map(|((name, caption), svg)| Figure {
                    title: name.replace("figure", "Figure "),
                    caption: caption.into(),
                    svg: svg.clone(),
                })
                .collect(),
            ..Section::default()
        });
        Ok(Report::new(&page, figures))
    }

    /// What was found in the session, in paragraphs.
    fn told(&self) -> Vec<String> {
        let mut paragraphs = vec![
            "A choreographed session of eight movements (the takes after the first three) was cut into segments, and \
             segments that are alike and lead to the like were grouped. Nobody told the procedure what the movements are; \
             each group became a primitive."
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
        paragraphs
    }

    /// The names of the files that [`Self::write`] writes.
    pub fn files() -> Vec<&'static str> {
        let mut names = vec![VOCABULARY, MOVEMENTS_KNOWN, BOXING, ATTACKER];
        names.extend(PLANS.map(|(file, _)| file));
        names.extend(Report::names());
        names
    }
}

impl Found {
    /// What each group is, with how many of its segments are that.
    fn known(&self) -> Vec<String> {
        let groups = self.derived.groups.iter().zip(&self.names);
        groups
            .map(|(group, (stroke, count))| match group.segments.len() {
                all if all == *count => stroke.clone(),
                all => format!("{stroke}, {count} of {all}"),
            })
            .collect()
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
