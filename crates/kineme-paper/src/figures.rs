//! The figures of a derivation, and the page that shows them.

use std::path::{Path, PathBuf};

use kineme::derivation::{Derived, Group};
use kineme::skeleton::Skeleton;
use kineme::{Motion, Vocabulary};
use kineme_formats::output::{self, Existing};
use kineme_report::scene::Scene;
use kineme_report::{Figure, GroupPaths, Page, Row, Span};
use rayon::prelude::*;

use crate::scene::{CardBudget, Shape, Shown, cards, take_of_derived, takes_of_show};
use crate::show::Show;

/// The page among the files of a report.
pub const PAGE: &str = "index.html";

/// A report: file names and texts.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Each file's name and content; [`PAGE`] is one of them.
    pub files: Vec<(&'static str, String)>,
}

impl Report {
    /// What was derived from `motions` and the vocabulary made of it, moving and as figures, on a page with this title
    /// and these paragraphs; before it a show, where there is one.
    ///
    /// # Errors
    /// When a primitive refuses its own parameters.
    pub fn of(
        derived: &Derived,
        motions: &[Motion],
        vocabulary: &Vocabulary,
        show: Option<&Show>,
        (title, summary): (&str, &[String]),
    ) -> kineme::Result<Self> {
        let figures = figures(derived, motions);
        let (scene, notes) = scene(derived, motions, vocabulary, show)?;
        let page = Page {
            title: title.into(),
            summary: [summary, &notes].concat(),
            scene,
            tables: Vec::new(),
            figures: figures.iter().map(|(_, f)| f.clone()).collect(),
        };
        let mut files = vec![(PAGE, page.html())];
        files.extend(figures.map(|(name, figure)| (name, figure.svg)));
        Ok(Self { files })
    }

    /// The names of the files that every report has.
    pub fn names() -> [&'static str; 6] {
        [
            PAGE,
            "hand-paths.svg",
            "embedding.svg",
            "timeline.svg",
            "transitions.svg",
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

/// The motions with their groups over time, the groups as primitives, and what had to be left out.
fn scene(
    derived: &Derived,
    motions: &[Motion],
    vocabulary: &Vocabulary,
    show: Option<&Show>,
) -> kineme::Result<(Scene, Vec<String>)> {
    let mut scene = Scene::default();
    let mut budget = CardBudget::default();
    if let Some(show) = show {
        budget.bytes /= 2;
        scene.takes = takes_of_show(&mut scene, show);
        scene.primitives = cards(&mut scene, &show.movements, &budget)?.0;
    }
    let points = Shape::of(vocabulary.body()).body.points;
    let sizes: Vec<(f64, usize)> = motions
        .iter()
        .map(|m| (m.duration_secs(), points))
        .collect();
    let shown = Shown::within(TAKES_BYTES, &sizes);
    for i in 0..shown.takes {
        let take = take_of_derived(&mut scene, derived, motions, i, shown.rate_hz);
        scene.takes.push(take);
    }
    let (found, left_out) = cards(&mut scene, vocabulary, &budget)?;
    scene.primitives.extend(found);
    let mut notes = Vec::new();
    if shown.takes < motions.len() {
        notes.push(format!(
            "To keep this page small, the first {} of {} motions play on it, {} frames a second of each.",
            shown.takes,
            motions.len(),
            shown.rate_hz
        ));
    }
    if left_out > 0 {
        notes.push(format!(
            "The first {} of {} primitives are shown moving.",
            vocabulary.primitives().len() - left_out,
            vocabulary.primitives().len()
        ));
    }
    Ok((scene, notes))
}

/// The five figures in the order of the page, each with its file's name.
fn figures(derived: &Derived, motions: &[Motion]) -> [(&'static str, Figure); 5] {
    let names: Vec<String> = derived.groups.iter().map(|g| g.name.clone()).collect();
    let residual = &derived.embedding.residual_variance;
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
            "Every segment is a point; segments that are alike and lead to the like lie together. Faint lines \
             join what followed in a recording.",
            embedding(derived, motions, &names),
        ),
        figure(
            "timeline.svg",
            "Time line of the recordings",
            "When each group occurs. Brackets are behaviors: primitives that alternate, such as out and back.",
            kineme_report::timeline(&rows(derived, motions), &names),
        ),
        figure(
            "transitions.svg",
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
        *point = vec![f64::NAN; 2];
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
    let row = |(motion, chain): (&Motion, Vec<usize>)| {
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
            name: motion.name().into(),
            spans: chain.into_iter().map(span).collect(),
        }
    };
    motions.iter().zip(chains).map(row).collect()
}

fn counts(derived: &Derived) -> Vec<Vec<f64>> {
    let n = derived.transitions.n;
    let row = |from| (0..n).map(move |to| f64::from(derived.transitions.count(from, to)));
    (0..n).map(|from| row(from).collect()).collect()
}

/// What was found, in paragraphs for the page.
pub fn summary(derived: &Derived, motions: &[Motion]) -> Vec<String> {
    let segments = derived.segments.len();
    let grouped = derived.labels.iter().flatten().count();
    let merged = derived.behaviors.items.iter();
    let merged = merged.filter(|b| b.primitives.len() > 1).count();
    let mut paragraphs = vec![format!(
        "{segments} segments of {} motions fall into {} groups; {} {}",
        motions.len(),
        derived.groups.len(),
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
            "Of low coherence, and perhaps groups that nobody meant: {}.",
            doubtful.join(", ")
        ));
    }
    paragraphs.extend(derived.notes.iter().map(|note| format!("Note: {note}.")));
    paragraphs
}
