//! What is asked: which motions of the corpus resemble which set of primitives, or none.

use std::path::Path;

use kineme::{Motion, Vocabulary};

use crate::recognition::exercises::Exercises;
use crate::sets::{IndexRow, Result, index, load};
use crate::table1::ALL_ZERO;

/// The four sets of primitives, named after scripts of `choreography/`. The paper names the first three; Figure 2 shows the
/// fourth. Horizontal waving has those of `greeting.toml` as well: a hand that greets goes from side to side, but on the
/// arc of a forearm or an arm held up, which waves led across the body do not know.
pub const SETS: [&str; 4] = ["vertical-waving", "punching", "twist", "horizontal-waving"];

/// What a motion resembles best: an index into [`SETS`], or none of them.
pub type Truth = Option<usize>;

const VERTICAL: Truth = Some(0);
const PUNCHING: Truth = Some(1);
const TWIST: Truth = Some(2);
pub(super) const HORIZONTAL: Truth = Some(3);

/// Which labels of the corpus resemble which set, written down before anything was encoded: archive, label or content,
/// set. What is not listed is not asked, for people could argue about it (a throw ends like a punch, an arm circle goes
/// up and down, a jumping jack does both).
pub const RESEMBLING: [(&str, &str, Truth); 33] = [
    // An arm goes up and comes down again, before the body or at its side.
    ("bandai-namco-2", "raise-up-right-hand", VERTICAL),
    ("bandai-namco-2", "raise-up-left-hand", VERTICAL),
    ("bandai-namco-2", "raise-up-both-hands", VERTICAL),
    // A fist is thrust forward and drawn back.
    ("utd-mhad", "boxing", PUNCHING),
    ("msr-action3d", "forward-punch", PUNCHING),
    ("msr-action3d", "side-boxing", PUNCHING),
    ("bandai-namco-1", "punch", PUNCHING),
    ("deepmimic", "punch", PUNCHING),
    ("cmu-mb", "punch", PUNCHING),
    // The trunk turns from side to side, the arms carried along; annotated spans of CMU subject 13.
    (EXERCISES, "Twist", TWIST),
    // The hand goes from side to side: before the body, or raised beside and over the head as in greeting.
    ("msr-action3d", "horizontal-arm-wave", HORIZONTAL),
    ("msr-action3d", "high-arm-wave", HORIZONTAL),
    ("msr-action3d", "two-hand-wave", HORIZONTAL),
    ("utd-mhad", "wave", HORIZONTAL),
    ("utd-mhad", "swipe-left", HORIZONTAL),
    ("utd-mhad", "swipe-right", HORIZONTAL),
    ("bandai-namco-1", "bye", HORIZONTAL),
    ("bandai-namco-1", "byebye", HORIZONTAL),
    ("bandai-namco-2", "wave-right-hand", HORIZONTAL),
    ("bandai-namco-2", "wave-left-hand", HORIZONTAL),
    ("bandai-namco-2", "wave-both-hands", HORIZONTAL),
    // The legs move, or the whole body goes down; the arms do none of the above.
    ("utd-mhad", "walk", None),
    ("utd-mhad", "jog", None),
    ("utd-mhad", "squat", None),
    ("utd-mhad", "sit-to-stand", None),
    ("utd-mhad", "stand-to-sit", None),
    ("utd-mhad", "lunge", None),
    ("msr-action3d", "bend", None),
    ("msr-action3d", "forward-kick", None),
    ("msr-action3d", "jogging", None),
    ("hdm05", "sneak", None),
    ("hdm05", "hop", None),
    ("hdm05", "kick", None),
];

/// The annotated exercises of CMU subject 13, which are cut into repetitions.
const EXERCISES: &str = "cmu-asfamc, 13";

/// Contents of motions of the left hand alone. The primitives are of the right; where whole recordings are judged, these
/// are asked in the mirror.
const LEFT_HANDED: [&str; 2] = ["raise-up-left-hand", "wave-left-hand"];
/// A motion that is asked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// The motions of its kind: archive and label.
    pub kind: String,
    /// What it resembles.
    pub truth: Truth,
    /// Its number within its kind, from 0 in the order of the index.
    pub number: usize,
}

impl Question {
    /// Whether it belongs to the half on which settings were chosen: every second one of its kind, the first among them.
    pub fn tuned(&self) -> bool {
        self.number.is_multiple_of(2)
    }
}

/// A motion that is asked, as it was recorded.
pub(super) struct Asked {
    pub question: Question,
    pub left_handed: bool,
    pub motion: Motion,
}

/// The motions that are asked, with what they resemble.
pub(super) fn asked(corpus: &Path, vocabulary: &Vocabulary, every: usize) -> Result<Vec<Asked>> {
    let rows = index(corpus)?;
    let mut picked: Vec<&IndexRow> = Vec::new();
    let mut questions = Vec::new();
    for (archive, label, truth) in RESEMBLING {
        let file = format!("{archive}.zip");
        let of = |r: &&IndexRow| {
            let named = [r.content(), r.label.as_str()].contains(&label);
            r.archive == file && named && !r.file.contains(ALL_ZERO)
        };
        for (number, row) in rows.iter().filter(of).step_by(every.max(1)).enumerate() {
            picked.push(row);
            let kind = format!("{archive}, {label}");
            let question = Question {
                kind,
                truth,
                number,
            };
            questions.push((question, LEFT_HANDED.contains(&label)));
        }
    }
    let set = load(corpus, &picked, vocabulary.body(), None, &|r| {
        r.label.clone()
    })?;
    let pairs = questions.into_iter().zip(set.motions);
    let mut asked: Vec<Asked> = pairs
        .map(|((question, left_handed), motion)| Asked {
            question,
            left_handed,
            motion,
        })
        .collect();
    let exercises = Exercises::read(corpus, vocabulary.body())?.pieces;
    for (archive, label, truth) in RESEMBLING.iter().filter(|(a, ..)| *a == EXERCISES) {
        let class = exercises.classes.iter().position(|c| c == label);
        let pieces = exercises.motions.iter().zip(&exercises.labels);
        let own = pieces.filter(|(_, l)| Some(**l) == class);
        for (number, (motion, _)) in own.step_by(every.max(1)).enumerate() {
            let question = Question {
                kind: format!("{archive}, {label}"),
                truth: *truth,
                number,
            };
            asked.push(Asked {
                question,
                left_handed: false,
                motion: motion.clone(),
            });
        }
    }
    Ok(asked)
}
