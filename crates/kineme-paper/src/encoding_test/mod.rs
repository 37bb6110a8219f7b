//! The trajectory encoding test (paper, section V-C): captured motions, seen by the hands alone, applied to four sets of
//! primitives. Which set is each encoded by, and inside its own set, which of the two primitives is each decision?

mod movement;
mod strokes;
mod tables;

use std::path::Path;
use std::sync::Arc;

use kineme::math::statistics::quantile;
use kineme::perception::calibrated;
use kineme::perception::encoding::{Encoder, EncodingMethod, EncodingSettings};
use kineme::primitive::{Observations, Posterior, Primitive, Recogniser, Transitions};
use kineme::{Motion, Vocabulary};
use rayon::prelude::*;

pub use movement::{Movement, costs, one_handed, one_handed_paper};
pub use strokes::{RISING, Taken, Told, coordinate, strokes, tally};

use crate::choreographies::{SCRIPTS, choreography};
use crate::recognition::exercises::Exercises;
use crate::sets::{IndexRow, Result, index, load};
use crate::table1::ALL_ZERO;

/// The four sets of primitives: scripts of `choreography/`. The paper names the first three; Figure 2 shows the fourth.
pub const SETS: [&str; 4] = ["vertical-waving", "punching", "twist", "horizontal-waving"];

/// What a motion resembles best: an index into [`SETS`], or none of them.
pub type Truth = Option<usize>;

const VERTICAL: Truth = Some(0);
const PUNCHING: Truth = Some(1);
const TWIST: Truth = Some(2);
const HORIZONTAL: Truth = Some(3);

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
/// The share of the fitting motions of the tuning half that the limit of the refusal keeps.
const KEPT: f64 = 0.95;

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

/// What was answered to a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The motion.
    pub question: Question,
    /// The likeliest set, whether or not it was refused.
    pub leading: usize,
    /// Whether it was refused: rest or none is at least as probable, or the cost is above the limit.
    pub refused: bool,
}

impl Answer {
    /// What is answered where the primitives of the vocabulary are of these sets.
    pub fn of(question: &Question, posterior: &Posterior, sets: &[usize]) -> Self {
        let mut shares = [0.0; SETS.len()];
        for (p, &set) in posterior.primitives.iter().zip(sets) {
            shares[set] += p;
        }
        let leading = least(&shares.map(|s| -s));
        Self {
            question: question.clone(),
            leading,
            refused: posterior.rest.max(posterior.none) >= shares[leading],
        }
    }

    /// The set that costs least, refused above a limit. Without costs no hand moves, and it is refused.
    pub fn cheapest(question: &Question, costs: Costs, limit: f64) -> Self {
        let leading = costs.map_or(0, |c| least(&c));
        Self {
            question: question.clone(),
            leading,
            refused: costs.is_none_or(|c| c[leading] > limit),
        }
    }

    /// The answer: refused is none.
    pub fn set(&self) -> Truth {
        (!self.refused).then_some(self.leading)
    }

    /// Whether the answer is the truth.
    pub fn is_right(&self) -> bool {
        self.set() == self.question.truth
    }
}

/// What each set costs a movement, in units of the encoder; `None` where no hand moves.
pub type Costs = Option<[f64; SETS.len()]>;

/// The first least of the values.
fn least(values: &[f64; SETS.len()]) -> usize {
    let mut best = 0;
    for k in 1..SETS.len() {
        if values[k] < values[best] {
            best = k;
        }
    }
    best
}

/// The limit above which a cost is refused: what 95 in 100 motions of the tuning half that resemble a set stay below.
pub fn limit(asked: &[(Question, Costs)]) -> f64 {
    let own = asked.iter().filter(|(q, _)| q.tuned() && q.truth.is_some());
    let costs: Vec<f64> = own.filter_map(|(_, c)| c.map(|c| c[least(&c)])).collect();
    quantile(&costs, KEPT).unwrap_or(f64::INFINITY)
}

/// A way of encoding and its answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    /// Whether it judges the movement or the whole recording.
    pub part: Part,
    /// Answers, in the order of [`RESEMBLING`].
    pub answers: Vec<Answer>,
}

/// What of a recording is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Whole,
    /// The movement alone ([`Movement`]).
    Movement,
}

impl Part {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Whole => "whole recording",
            Self::Movement => "the movement",
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodingTest {
    /// Which set: the paper's method and ours, on whole recordings and on the movement.
    pub methods: Vec<Method>,
    /// Stroke by stroke inside its own set: a method's name, and what it said of each motion that resembles a set.
    pub strokes: Vec<(&'static str, Vec<Told>)>,
}

/// The interval of 95 in 100 for a share of which `part` of `whole` was drawn (Wilson 1927).
pub fn wilson(part: usize, whole: usize) -> (f64, f64) {
    const Z: f64 = 1.959_963_984_540_054;
    if whole == 0 {
        return (0.0, 1.0);
    }
    let n = whole as f64;
    let p = part as f64 / n;
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    ((middle - half).max(0.0), (middle + half).min(1.0))
}

/// The primitives of the four sets as one vocabulary, and the set of each.
///
/// # Errors
/// Never for the embedded scripts.
pub fn vocabulary() -> Result<(Vocabulary, Vec<usize>)> {
    let body = Arc::new(kineme::ares()?);
    let mut primitives: Vec<Primitive> = Vec::new();
    let mut sets = Vec::new();
    for (k, set) in SETS.iter().enumerate() {
        let script = SCRIPTS.iter().find(|(name, _)| name == set);
        let (name, text) = script.ok_or("no such script")?;
        for primitive in choreography(name, text, &body)?.primitives() {
            primitives.push(primitive.clone());
            sets.push(k);
        }
    }
    let transitions = Transitions::none(primitives.len());
    let all = Vocabulary::new(body, primitives, Vec::new(), transitions)?;
    Ok((calibrated(all, None)?, sets))
}

/// Asks every motion of a corpus that resembles a set or none, one in `every` of each kind.
///
/// # Errors
/// When the corpus lacks a file, or a motion cannot be encoded.
pub fn encoding_test(
    corpus: &Path,
    every: usize,
    watch: &mut dyn FnMut(&str),
) -> Result<EncodingTest> {
    watch("learning the four sets of primitives");
    let (vocabulary, sets) = vocabulary()?;
    watch("reading motions that resemble them, or none");
    let motions = asked(corpus, &vocabulary, every)?;
    let part = |a: &Asked| -> Result<(Question, Movement)> {
        Ok((a.question.clone(), Movement::of(&a.motion)?))
    };
    let parts: Vec<_> = motions.par_iter().map(part).collect::<Result<_>>()?;
    let mut methods = Vec::new();
    for (name, method) in METHODS {
        watch(&format!("encoding whole recordings: {name}"));
        let settings = EncodingSettings {
            method,
            ..EncodingSettings::default()
        };
        let encoder = Encoder::new(&vocabulary, &settings)?;
        let ask = |asked: &Asked| -> Result<Answer> {
            let motion = match asked.left_handed {
                true => asked.motion.mirrored()?,
                false => asked.motion.clone(),
            };
            let answer = encoder.recognise(&Observations::complete(motion))?;
            Ok(Answer::of(&asked.question, &answer.posterior, &sets))
        };
        methods.push(Method {
            name,
            part: Part::Whole,
            answers: motions.par_iter().map(ask).collect::<Result<_>>()?,
        });
    }
    watch("encoding movements");
    methods.push(Method {
        name: PAPER,
        part: Part::Movement,
        answers: by_the_paper(&vocabulary, &sets, &parts)?,
    });
    methods.push(Method {
        name: HYPOTHESES,
        part: Part::Movement,
        answers: by_hypotheses(&vocabulary, &sets, &parts)?,
    });
    watch("encoding strokes");
    Ok(EncodingTest {
        methods,
        strokes: stroke_by_stroke(&vocabulary, &sets, &parts)?,
    })
}

const PAPER: &str = "paper";
const HYPOTHESES: &str = "hypotheses";
const METHODS: [(&str, EncodingMethod); 2] = [
    (PAPER, EncodingMethod::Paper),
    (HYPOTHESES, EncodingMethod::Hypotheses),
];

/// A motion that is asked, as it was recorded.
struct Asked {
    question: Question,
    left_handed: bool,
    motion: Motion,
}

type Parts = [(Question, Movement)];

fn by_the_paper(vocabulary: &Vocabulary, sets: &[usize], parts: &Parts) -> Result<Vec<Answer>> {
    let settings = EncodingSettings {
        method: EncodingMethod::Paper,
        ..EncodingSettings::default()
    };
    let encoder = Encoder::new(vocabulary, &settings)?;
    let ask = |(question, part): &(Question, Movement)| -> Result<Answer> {
        let posterior = movement::posterior(&encoder, part)?;
        Ok(Answer::of(question, &posterior, sets))
    };
    parts.par_iter().map(ask).collect()
}

fn by_hypotheses(vocabulary: &Vocabulary, sets: &[usize], parts: &Parts) -> Result<Vec<Answer>> {
    let encoder = Encoder::new(vocabulary, &one_handed())?;
    let ask = |(question, part): &(Question, Movement)| -> Result<(Question, Costs)> {
        Ok((question.clone(), costs(&encoder, part, sets)?))
    };
    let costs: Vec<_> = parts.par_iter().map(ask).collect::<Result<_>>()?;
    let limit = limit(&costs);
    let answers = costs.iter();
    Ok(answers
        .map(|(question, costs)| Answer::cheapest(question, *costs, limit))
        .collect())
}

/// Inside its own set, each motion that resembles one.
fn stroke_by_stroke(
    vocabulary: &Vocabulary,
    sets: &[usize],
    parts: &Parts,
) -> Result<Vec<(&'static str, Vec<Told>)>> {
    let free = Encoder::new(vocabulary, &one_handed())?;
    let mut alone = Vec::new();
    for set in 0..SETS.len() {
        let (own, rising) = strokes::own(vocabulary, sets, set)?;
        let primitives = own.iter().map(|p| vocabulary.primitives()[*p].clone());
        let transitions = Transitions::none(own.len());
        let body = Arc::clone(vocabulary.body());
        let two = Vocabulary::new(body, primitives.collect(), Vec::new(), transitions)?;
        alone.push((two, own, rising));
    }
    let papers = alone
        .iter()
        .map(|(two, ..)| Encoder::new(two, &one_handed_paper()))
        .collect::<std::result::Result<Vec<_>, _>>()?;
    let ask = |literally: bool| -> Result<Vec<Told>> {
        let ask = |(question, part): &(Question, Movement)| -> Result<Option<Told>> {
            let Some(set) = question.truth else {
                return Ok(None);
            };
            let (_, own, rising) = &alone[set];
            let mut counts = [[0; 2]; 2];
            for hand in &part.hands {
                let taken = match literally {
                    true => strokes::by_the_paper(&papers[set], hand, own)?,
                    false => strokes::by_hypotheses(&free, hand, own)?,
                };
                let more = tally(hand, set, *rising, &taken);
                for (sum, more) in counts.iter_mut().flatten().zip(more.iter().flatten()) {
                    *sum += more;
                }
            }
            let question = question.clone();
            Ok(Some(Told { question, counts }))
        };
        let told: Vec<_> = parts.par_iter().map(ask).collect::<Result<_>>()?;
        Ok(told.into_iter().flatten().collect())
    };
    Ok(vec![(PAPER, ask(true)?), (HYPOTHESES, ask(false)?)])
}

/// The motions that are asked, with what they resemble.
fn asked(corpus: &Path, vocabulary: &Vocabulary, every: usize) -> Result<Vec<Asked>> {
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

/// Of the answers to motions that resemble a set: how many were answered by it, with refusals counting as wrong; how many
/// have it as their likeliest, refused or not; and how many there are.
pub fn right<'a>(answers: impl Iterator<Item = &'a Answer>) -> (usize, usize, usize) {
    let (mut answered, mut leading, mut all) = (0, 0, 0);
    for a in answers.filter(|a| a.question.truth.is_some()) {
        answered += usize::from(a.is_right());
        leading += usize::from(Some(a.leading) == a.question.truth);
        all += 1;
    }
    (answered, leading, all)
}

/// Of the answers to motions that fit none: how many are refusals, and how many there are.
pub fn refused<'a>(answers: impl Iterator<Item = &'a Answer>) -> (usize, usize) {
    let (mut refused, mut all) = (0, 0);
    for a in answers.filter(|a| a.question.truth.is_none()) {
        refused += usize::from(a.refused);
        all += 1;
    }
    (refused, all)
}
