//! The labelled sets on which recognition is judged, and who of them is learned from.

use std::path::Path;
use std::sync::Arc;

use kineme::Skeleton;

use crate::sets::{IndexRow, LabelledSet, Result, index, load};

/// Which clips are learned from and which are asked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Split {
    /// Indices of the clips learned from.
    pub train: Vec<usize>,
    /// Indices of the clips asked: of other people or in other styles.
    pub test: Vec<usize>,
}

/// A labelled set and its splits.
#[derive(Debug, Clone)]
pub struct Corpus {
    /// Its name in the tables.
    pub name: &'static str,
    /// Its clips, motions of `ares`.
    pub set: LabelledSet,
    /// Who moves in each clip, or in which style.
    pub subjects: Vec<String>,
    /// Its splits; no clip is asked in two of them.
    pub splits: Vec<Split>,
    /// Splits of as many people or styles as those, in which every clip is asked equally often: for what needs more
    /// answers than one split gives. None where `splits` are all there are.
    pub pooled: Vec<Split>,
}

/// How much of a set is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Classes, in the order of the index.
    pub classes: usize,
    /// Clips of each subject in each class.
    pub clips: usize,
}

impl Part {
    /// All of it.
    pub const WHOLE: Part = Part {
        classes: usize::MAX,
        clips: usize::MAX,
    };
}

/// The published zeros of MSR-Action3D: a clip without a posture.
const ALL_ZERO: &str = "a13_s09_e02";

/// Splits that are pooled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pool {
    /// Those of the rows.
    AsAsked,
    /// Every choice of so many subjects is learned from, the others are asked.
    EveryChoice(usize),
    /// So many successive subjects of a ring, in the order of their names, are learned from, beginning at each; the others
    /// are asked.
    InTurn(usize),
}

/// Where a set is, and who is learned from: pairs of subjects learned from and asked.
struct Plan {
    name: &'static str,
    archive: &'static str,
    format: &'static str,
    content: bool,
    splits: &'static [(&'static [&'static str], &'static [&'static str])],
    pool: Pool,
}

/// Styles of Bandai-Namco 2, in two halves.
const STYLES: [&[&str]; 2] = [
    &["style:elderly", "style:feminine", "style:normal"],
    &[
        "style:active",
        "style:exhausted",
        "style:masculine",
        "style:youthful",
    ],
];

const PLANS: [Plan; 4] = [
    Plan {
        name: UTD,
        archive: "utd-mhad.zip",
        format: "joints-csv",
        content: false,
        splits: &[(&["s1", "s3"], &["s5", "s7"])],
        pool: Pool::EveryChoice(2),
    },
    Plan {
        name: MSR,
        archive: "msr-action3d.zip",
        format: "msr-txt",
        content: false,
        splits: &[(&["s01", "s03", "s05"], &["s07", "s09"])],
        pool: Pool::EveryChoice(3),
    },
    Plan {
        name: HDM05,
        archive: "hdm05.zip",
        format: "amc",
        content: false,
        splits: &[
            (&["bk", "dg"], &["bd"]),
            (&["bd", "dg"], &["bk"]),
            (&["bd", "bk"], &["dg"]),
        ],
        pool: Pool::AsAsked,
    },
    Plan {
        name: BANDAI_NAMCO,
        archive: "bandai-namco-2.zip",
        format: "bvh",
        content: true,
        splits: &[(STYLES[0], STYLES[1]), (STYLES[1], STYLES[0])],
        pool: Pool::InTurn(3),
    },
];

/// UTD-MHAD: 27 actions, Kinect, 30 Hz; two people learned from, two asked.
pub const UTD: &str = "UTD-MHAD";
/// MSR-Action3D: 20 actions, an early depth camera, 15 Hz; three people learned from, two asked.
pub const MSR: &str = "MSR-Action3D";
/// HDM05: 11 classes of optical capture, 120 Hz; each of three actors asked once.
pub const HDM05: &str = "HDM05";
/// Bandai-Namco 2: 10 contents, 30 Hz; one half of the styles asked, then the other.
pub const BANDAI_NAMCO: &str = "Bandai-Namco 2";

/// The sets of these names, or a part of each, from a corpus folder.
///
/// # Errors
/// For an unknown name, and when the corpus lacks a file.
pub fn corpora(
    corpus: &Path,
    body: &Arc<Skeleton>,
    names: &[&str],
    part: Part,
) -> Result<Vec<Corpus>> {
    let rows = index(corpus)?;
    let of = |name: &&str| {
        let plan = PLANS.iter().find(|p| p.name == *name);
        read(corpus, body, &rows, plan.ok_or("no such set")?, part)
    };
    names.iter().map(of).collect()
}

fn read(
    corpus: &Path,
    body: &Arc<Skeleton>,
    rows: &[IndexRow],
    plan: &Plan,
    part: Part,
) -> Result<Corpus> {
    let class = |r: &IndexRow| match plan.content {
        true => r.content().to_string(),
        false => r.label.clone(),
    };
    let mut picked: Vec<&IndexRow> = Vec::new();
    let mut classes: Vec<String> = Vec::new();
    for r in rows {
        if r.archive != plan.archive || r.format != plan.format || r.file.contains(ALL_ZERO) {
            continue;
        }
        if !classes.contains(&class(r)) {
            classes.push(class(r));
        }
        let alike = |p: &&&IndexRow| p.subject == r.subject && class(p) == class(r);
        let read = classes.iter().take(part.classes).any(|c| *c == class(r));
        if read && picked.iter().filter(alike).count() < part.clips {
            picked.push(r);
        }
    }
    let subjects: Vec<String> = picked.iter().map(|r| r.subject.clone()).collect();
    let of = |who: &[&str]| -> Vec<usize> {
        let is = |i: &usize| who.contains(&subjects[*i].as_str());
        (0..subjects.len()).filter(is).collect()
    };
    let splits = plan.splits.iter().map(|(train, test)| Split {
        train: of(train),
        test: of(test),
    });
    Ok(Corpus {
        name: plan.name,
        set: load(corpus, &picked, body, None, &class)?,
        splits: splits.collect(),
        pooled: pooled(plan.pool, &subjects),
        subjects,
    })
}

/// The splits of a pool, by who moves in each clip.
fn pooled(pool: Pool, subjects: &[String]) -> Vec<Split> {
    let mut all: Vec<&str> = subjects.iter().map(String::as_str).collect();
    all.sort_unstable();
    all.dedup();
    let chosen: Vec<Vec<bool>> = match pool {
        Pool::AsAsked => Vec::new(),
        Pool::EveryChoice(learned) => (0..1_u32 << all.len())
            .filter(|bits| bits.count_ones() as usize == learned)
            .map(|bits| (0..all.len()).map(|s| bits >> s & 1 == 1).collect())
            .collect(),
        Pool::InTurn(learned) => (0..all.len())
            .map(|first| {
                let place = |s: usize| (s + all.len() - first) % all.len();
                (0..all.len()).map(|s| place(s) < learned).collect()
            })
            .collect(),
    };
    let split = |chosen: Vec<bool>| {
        let is_learned = |i: &usize| {
            all.iter()
                .zip(&chosen)
                .any(|(s, c)| *c && *s == subjects[*i])
        };
        let (train, test) = (0..subjects.len()).partition(is_learned);
        Split { train, test }
    };
    chosen.into_iter().map(split).collect()
}
