//! The third data set: the motion capture of a corpus, and what of it leaves the set because it shows a behaviour.

use std::path::Path;
use std::sync::Arc;

use kineme::Skeleton;

use super::clip::Clip;
use crate::sets::{IndexRow, Result, index, load};

/// Archives of markers without a skeleton: no whole bodies.
const MARKERS: [&str; 1] = ["c3d.zip"];
/// The formats of files that hold no motion.
const NO_MOTION: [&str; 2] = ["asf", "c3d"];
/// A clip of zeros, as published.
pub(crate) const ALL_ZERO: &str = "a13_s09_e02";
/// The skeleton for recordings of CMU subjects that come without one.
const ASF: &str = "cmu-asfamc.zip/cmu-asfamc/02/02.asf";

/// What a recording shows that a behaviour may be: then it is no negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Showing {
    /// Punches, boxing, strikes; martial arts, whose forms are full of them.
    Striking,
    /// Waving.
    Waving,
}

/// What the corpus' label says that a recording shows. Labels are the corpus', given before anything was recognised; a
/// kick, a throw, a swing of a racket or of a sword and a hammer's blow are no blows of the hand.
pub fn shows(label: &str) -> Option<Showing> {
    let has = |words: &[&str]| words.iter().any(|w| label.contains(w));
    if has(&["punch", "boxing", "martial-arts"]) {
        Some(Showing::Striking)
    } else if has(&["wave"]) {
        Some(Showing::Waving)
    } else {
        None
    }
}

/// The whole-body recordings of a corpus.
#[derive(Debug, Clone, Default)]
pub struct Captured {
    /// The third data set.
    pub negatives: Vec<Clip>,
    /// Recordings that left it, with the archive and the label of each, and what they show.
    pub left: Vec<(Clip, String, Showing)>,
}

impl Captured {
    /// Frames of the third set.
    pub fn frames(&self) -> usize {
        self.negatives.iter().map(|c| c.truth.len()).sum()
    }
}

/// Every whole-body recording of a corpus on a body, one in `every`.
///
/// # Errors
/// When the corpus has no index, lacks a file, or a file cannot be read or retargeted.
pub fn recorded(corpus: &Path, body: &Arc<Skeleton>, every: usize) -> Result<Captured> {
    let rows = index(corpus)?;
    let whole = |r: &&IndexRow| {
        !MARKERS.contains(&r.archive.as_str())
            && !NO_MOTION.contains(&r.format.as_str())
            && !r.file.contains(ALL_ZERO)
    };
    let rows: Vec<&IndexRow> = rows.iter().filter(whole).step_by(every.max(1)).collect();
    let lacking = |r: &&IndexRow| r.archive == "cmu-asfamc.zip";
    let asf = rows.iter().any(lacking).then_some(ASF);
    let set = load(corpus, &rows, body, asf, &|r| r.label.clone())?;
    let mut captured = Captured::default();
    for (row, motion) in rows.iter().zip(set.motions) {
        let clip = Clip::negative(&row.file, motion);
        match shows(&row.label) {
            None => captured.negatives.push(clip),
            Some(showing) => {
                let archive = row.archive.trim_end_matches(".zip");
                let kind = format!("{archive}, {}", row.label);
                captured.left.push((clip, kind, showing));
            }
        }
    }
    Ok(captured)
}
