//! The figures of a derivation, and the page that shows them.

use std::ops::Range;
use std::path::{Path, PathBuf};

use kineme::derivation::{Derived, Group};
use kineme::skeleton::Skeleton;
use kineme::{Motion, Vocabulary};
use kineme_formats::output::{self, Existing};
use kineme_report::scene::{Excerpt, Scene, Take};
use kineme_report::{Figure, GroupPaths, Listing, Page, Row, Section, Span};
use rayon::prelude::*;

use crate::scene::{CardBudget, HOW_TO_READ, Shape, Shown, cards, take_of_derived};

/// The page among the files of a report.
pub const PAGE: &str = "report.html";
const TIMELINE: &str = "timeline.svg";
const TRANSITIONS: &str = "transitions.svg";

/// A report: file names and texts.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Each file's name and content; [`PAGE`] is one of them.
    pub files: Vec<(&'static str, String)>,
}

/// What was derived, to be put on a page.
pub(crate) struct Findings<'a> {
    pub derived: &'a Derived,
    pub motions: &'a [Motion],
    pub vocabulary: &'a Vocabulary,
    /// What each group is, where somebody knows it; else empty.
    pub known: &'a [String],
}

impl Report {
    /// What was derived from `motions` and the vocabulary made of it, moving and as figures, on a page with this title
    /// and these paragraphs. `file` is where the vocabulary is, as a command line names it.
    ///
    /// # Errors
    /// When a primitive refuses its own parameters.
    pub fn of(
        derived: &Derived,
        motions: &[Motion],
        vocabulary: &Vocabulary,
        (title, summary): (&str, &[String]),
        file: &str,
    ) -> kineme::Result<Self> {
        let (first, more) = summary.split_at(summary.len().min(1));
        let mut page = Page {
            title: title.into(),
            summary: first.to_vec(),
            ..Page::default()
        };
        let findings = Findings {
            derived,
            motions,
            vocabulary,
            known: &[],
        };
        let budget = CardBudget::default();
        let text = [&[HOW_TO_READ.to_owned()], more].concat();
        let figures = findings.put_on(&mut page, ["Primitives", "Figures"], &text, &budget)?;
        page.scene.vocabulary = file.into();
        Ok(Self::new(&page, figures))
    }

    /// A page, and the figures that are files of their own, too.
    pub(crate) fn new(page: &Page, figures: [(&'static str, Figure); 5]) -> Self {
        let mut files = vec![(PAGE, page.html())];
        files.extend(figures.map(|(name, figure)| (name, figure.svg)));
        Self { files }
    }

    /// The names of the files that every report has.
    pub fn names() -> [&'static str; 6] {
        [
            PAGE,
            "hand-paths.svg",
            "embedding.svg",
            TIMELINE,
            TRANSITIONS,
            "residual-variance.svg",
        ]
    }

    /// Writes the files into a folder, which is made; returns the page's path.
    ///
    /// # Errors
    /// When a file exists and is to be kept, or cannot be written.
    pub fn write(&self, folder: &Path, existing: Existing) -> kineme_formats::Result<PathBuf> {
        for (name, content) in &self.files {
            output::write_bytes(&folder.join(name), existing, content.as_bytes())?;
        }
        Ok(folder.join(PAGE))
    }
}

/// Bytes of page for the motions that were cut.
const TAKES_BYTES: usize = 3_500_000;

impl Findings<'_> {
    /// Puts the motions with their groups over time on the stage of a page, and below a section of the groups as
    /// primitives, with this text, and one of figures, which it returns as well.
    ///
    /// # Errors
    /// When a primitive refuses its own parameters.
    pub(crate) fn put_on(
        &self,
        page: &mut Page,
        titles: [&str; 2],
        text: &[String],
        budget: &CardBudget,
    ) -> kineme::Result<[(&'static str, Figure); 5]> {
        let first_take = page.scene.takes.len();
        let mut notes = self.takes(&mut page.scene);
        let takes = first_take..page.scene.takes.len();
        let (mut found, left_out) = cards(&mut page.scene, self.vocabulary, budget)?;
        for (card, what) in found.iter_mut().zip(self.known) {
            card.facts
                .insert(0, ["choreographed as".into(), what.clone()]);
        }
        if left_out > 0 {
            let all = self.vocabulary.primitives().len();
            notes.push(format!(
                "The first {} of {all} primitives are shown moving.",
                all - left_out
            ));
        }
        for source in found.iter_mut().flat_map(|card| &mut card.sources) {
            let motion = self.motions.iter().position(|m| m.name() == source.motion);
            source.take = motion.and_then(|m| takes.clone().nth(m));
        }
        let first = page.scene.primitives.len();
        page.scene.primitives.extend(found);
        page.sections.push(Section {
            title: titles[0].into(),
            text: [text, &notes].concat(),
            cards: first..page.scene.primitives.len(),
            listings: self.left_over(takes).into_iter().collect(),
            ..Section::default()
        });
        let figures = figures(self.derived, self.motions);
        let told = figures.iter().filter(|(file, _)| self.tells(file));
        page.sections.push(Section {
            title: titles[1].into(),
            figures: told.map(|(_, f)| f.clone()).collect(),
            ..Section::default()
        });
        Ok(figures)
    }

    /// The segments in no group.
    fn left_over(&self, takes: Range<usize>) -> Option<Listing> {
        let segments = self.derived.segments.iter().zip(&self.derived.labels);
        let excerpts: Vec<Excerpt> = segments
            .filter(|(_, label)| label.is_none())
            .map(|(segment, _)| {
                let motion = &self.motions[segment.motion];
                Excerpt {
                    motion: motion.name().into(),
                    start: segment.frames.start as f64 / motion.rate_hz(),
                    end: segment.frames.end as f64 / motion.rate_hz(),
                    take: takes.clone().nth(segment.motion),
                }
            })
            .collect();
        let title = match excerpts.len() {
            0 => return None,
            1 => "One segment is in no group".into(),
            n => format!("{n} segments are in no group"),
        };
        Some(Listing { title, excerpts })
    }

    /// Whether a figure says something of these motions: where each is one movement, nothing follows anything.
    fn tells(&self, figure: &str) -> bool {
        let followed = chains(self.derived, self.motions.len());
        match figure {
            TIMELINE => followed.iter().any(|chain| chain.len() > 1),
            TRANSITIONS => counts(self.derived).iter().flatten().any(|&n| n > 0.0),
            _ => true,
        }
    }

    /// As many of the motions as there is room for, and what had to be left out.
    fn takes(&self, scene: &mut Scene) -> Vec<String> {
        let points = Shape::of(self.vocabulary.body()).body.points;
        let size = |m: &Motion| (m.duration_secs(), points);
        let sizes: Vec<(f64, usize)> = self.motions.iter().map(size).collect();
        let shown = Shown::within(TAKES_BYTES, &sizes);
        let names: Vec<&str> = self.motions.iter().map(|m| m.name()).collect();
        let names = kineme_report::short_names(&names);
        for (i, name) in names.into_iter().take(shown.takes).enumerate() {
            let take = take_of_derived(scene, self.derived, self.motions, i, shown.rate_hz);
            scene.takes.push(Take { name, ..take });
        }
        if shown.takes == self.motions.len() {
            return Vec::new();
        }
        vec![format!(
            "To keep this page small, the first {} of {} motions play on it, {} frames a second of each.",
            shown.takes,
            self.motions.len(),
            shown.rate_hz
        )]
    }
}

/// The five figures in the order of the page, each with its file's name.
fn figures(derived: &Derived, motions: &[Motion]) -> [(&'static str, Figure); 5] {
    let names: Vec<String> = derived.groups.iter().map(|g| g.name.clone()).collect();
    let residual = &derived.embedding.residual_variance;
    let several = chains(derived, motions.len())
        .iter()
        .any(|chain| chain.len() > 1);
    let merged = derived
        .behaviors
        .items
        .iter()
        .any(|b| b.primitives.len() > 1);
    let figure = |name, title: &str, caption: &str, svg| {
        let figure = Figure {
            title: title.into(),
            caption: caption.into(),
            svg,
        };
        (name, figure)
    };
    [
        figure(
            "hand-paths.svg",
            "Hand paths of each group",
            "Where the wrists go in each group, seen in the thorax frame: the paper's Figure 1. A group whose thin \
             lines follow its bold one is a primitive; one whose lines cross is a group that nobody meant.",
            kineme_report::hand_paths(&paths(derived, motions)),
        ),
        figure(
            "embedding.svg",
            "Embedding of the segments",
            &format!(
                "Every segment is a point; segments that are alike and lead to the like lie together.{}",
                if several {
                    " Faint lines join what followed in a recording."
                } else {
                    ""
                }
            ),
            embedding(derived, motions, &names),
        ),
        figure(
            TIMELINE,
            "Time line of the recordings",
            &format!(
                "When each group occurs.{}",
                if merged {
                    " Brackets are behaviors: primitives that alternate, such as out and back."
                } else {
                    ""
                }
            ),
            kineme_report::timeline(&rows(derived, motions), &names),
        ),
        figure(
            TRANSITIONS,
            "Transitions between groups",
            "How often each group (row) was followed by each other one (column).",
            kineme_report::transitions(&names, &counts(derived)),
        ),
        figure(
            "residual-variance.svg",
            "Residual variance by dimension",
            "What the geodesic distances still hold that an embedding of this dimension does not show.",
            kineme_report::residual_variance(residual, derived.embedding.dimension),
        ),
    ]
}

/// The wrists' paths of each group's segments.
fn paths(derived: &Derived, motions: &[Motion]) -> Vec<GroupPaths> {
    let of_group = |group: &Group| {
        let hands = group.segments.iter().map(|&s| {
            let segment = &derived.segments[s];
            wrists(&motions[segment.motion], segment.frames.clone())
        });
        let (left, right) = hands.map(|[l, r]| (l, r)).unzip();
        GroupPaths {
            name: group.name.clone(),
            coherence: group.coherence,
            right,
            left,
        }
    };
    derived.groups.par_iter().map(of_group).collect()
}

/// Paths of the left and the right wrist in the thorax frame, metres; empty for a body without arms.
pub(crate) fn wrists(motion: &Motion, frames: std::ops::Range<usize>) -> [Vec<[f64; 3]>; 2] {
    let body = motion.skeleton();
    let mut paths = [Vec::new(), Vec::new()];
    let [Some(left), Some(right)] = ["left_hand", "right_hand"].map(|name| effector(body, name))
    else {
        return paths;
    };
    for f in frames {
        let placed = motion.frames_at(f);
        let Some(thorax) = body.thorax(&placed) else {
            continue;
        };
        for (path, effector) in paths.iter_mut().zip([left, right]) {
            let effector = &body.effectors()[effector];
            let place = placed[effector.joint].place(&effector.point);
            path.push(thorax.local(&place).into());
        }
    }
    paths
}

fn effector(body: &Skeleton, name: &str) -> Option<usize> {
    body.effectors().iter().position(|e| e.name == name)
}

fn embedding(derived: &Derived, motions: &[Motion], names: &[String]) -> String {
    let mut points = vec![Vec::new(); derived.segments.len()];
    for (row, &item) in derived.embedding.items.iter().enumerate() {
        points[item] = derived.embedding.point(row).to_vec();
    }
    // An item that was left out of the embedding has no place.
    for point in points.iter_mut().filter(|p| p.is_empty()) {
        *point = vec![f64::NAN];
    }
    kineme_report::embedding(&kineme_report::Embedding {
        points: &points,
        groups: &derived.labels,
        names,
        recordings: &chains(derived, motions.len()),
    })
}

/// For each motion its segments in the order in which they follow one another.
fn chains(derived: &Derived, motions: usize) -> Vec<Vec<usize>> {
    let mut of_motion = vec![Vec::new(); motions];
    for (i, segment) in derived.segments.iter().enumerate() {
        of_motion[segment.motion].push(i);
    }
    for chain in &mut of_motion {
        chain.sort_by_key(|&i| (derived.segments[i].frames.start, i));
    }
    of_motion
}

fn rows(derived: &Derived, motions: &[Motion]) -> Vec<Row> {
    let chains = chains(derived, motions.len());
    let names: Vec<&str> = motions.iter().map(|m| m.name()).collect();
    let names = kineme_report::short_names(&names);
    let row = |((motion, name), chain): ((&Motion, String), Vec<usize>)| {
        let span = |i: usize| {
            let group = derived.labels[i];
            let frames = &derived.segments[i].frames;
            let behavior = group.map(|g| &derived.behaviors.items[derived.behaviors.of_group[g]]);
            Span {
                start: frames.start as f64 / motion.rate_hz(),
                end: frames.end as f64 / motion.rate_hz(),
                group,
                // A behavior of one group would only repeat its name.
                behavior: behavior
                    .filter(|b| b.primitives.len() > 1)
                    .map(|b| b.name.clone()),
            }
        };
        Row {
            name,
            spans: chain.into_iter().map(span).collect(),
        }
    };
    motions.iter().zip(names).zip(chains).map(row).collect()
}

fn counts(derived: &Derived) -> Vec<Vec<f64>> {
    let n = derived.transitions.n;
    let row = |from| (0..n).map(move |to| f64::from(derived.transitions.count(from, to)));
    (0..n).map(|from| row(from).collect()).collect()
}

/// How many of something, in words that fit the number.
pub fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// What was found, in paragraphs for the page.
pub fn summary(derived: &Derived, motions: &[Motion]) -> Vec<String> {
    let segments = derived.segments.len();
    let grouped = derived.labels.iter().flatten().count();
    let merged = derived.behaviors.items.iter();
    let merged = merged.filter(|b| b.primitives.len() > 1).count();
    let mut paragraphs = vec![format!(
        "{} of {} {} {}; {} {}",
        counted(segments, "segment"),
        counted(motions.len(), "motion"),
        if segments == 1 {
            "falls into"
        } else {
            "fall into"
        },
        counted(derived.groups.len(), "group"),
        match segments - grouped {
            0 => "none is left over.".to_string(),
            1 => "one belongs to none.".to_string(),
            n => format!("{n} belong to none."),
        },
        match merged {
            0 => "No groups alternate.".to_string(),
            1 => "Groups that alternate make one behavior.".to_string(),
            n => format!("Groups that alternate make {n} behaviors."),
        }
    )];
    let doubtful: Vec<&str> = derived
        .groups
        .iter()
        .filter(|g| {
            g.coherence
                .is_some_and(|c| c < kineme_report::LOW_COHERENCE)
        })
        .map(|g| g.name.as_str())
        .collect();
    if !doubtful.is_empty() {
        paragraphs.push(format!(
            "Of low coherence (below {}), and perhaps mixtures of several movements: {}.",
            kineme_report::LOW_COHERENCE,
            doubtful.join(", ")
        ));
    }
    paragraphs.extend(derived.notes.iter().map(|note| format!("Note: {note}.")));
    paragraphs
}
