//! The trajectory encoding test (paper, section V-C): captured motions, seen by the hands alone, applied to four sets of
//! primitives. Which set is each encoded by?

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use kineme::perception::calibrated;
use kineme::perception::encoding::{Encoder, EncodingMethod, EncodingSettings};
use kineme::primitive::{Observations, Posterior, Primitive, Recogniser, Transitions};
use kineme::{Motion, Vocabulary};
use rayon::prelude::*;

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

/// Contents of motions of the left hand alone. The primitives are of the right; these are asked in the mirror.
const LEFT_HANDED: [&str; 2] = ["raise-up-left-hand", "wave-left-hand"];

/// What was answered to a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The motions of its kind: archive and label.
    pub kind: String,
    /// What it resembles.
    pub truth: Truth,
    /// The likeliest set, whether or not it was refused.
    pub leading: usize,
    /// Whether it was refused: rest or none is at least as probable.
    pub refused: bool,
}

impl Answer {
    /// What is answered where the primitives of the vocabulary are of these sets.
    pub fn of(kind: &str, truth: Truth, posterior: &Posterior, sets: &[usize]) -> Self {
        let mut shares = [0.0; SETS.len()];
        for (p, &set) in posterior.primitives.iter().zip(sets) {
            shares[set] += p;
        }
        let mut leading = 0;
        for set in 1..SETS.len() {
            if shares[set] > shares[leading] {
                leading = set;
            }
        }
        Self {
            kind: kind.into(),
            truth,
            leading,
            refused: posterior.rest.max(posterior.none) >= shares[leading],
        }
    }

    /// The answer: refused is none.
    pub fn set(&self) -> Truth {
        (!self.refused).then_some(self.leading)
    }
}

/// A way of encoding and its answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    /// Answers, in the order of [`RESEMBLING`].
    pub answers: Vec<Answer>,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodingTest {
    /// The paper's method and ours.
    pub methods: Vec<Method>,
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
    let methods = [
        ("paper", EncodingMethod::Paper),
        ("hypotheses", EncodingMethod::Hypotheses),
    ];
    let mut done = Vec::new();
    for (name, method) in methods {
        watch(&format!("encoding: {name}"));
        let settings = EncodingSettings {
            method,
            ..EncodingSettings::default()
        };
        let encoder = Encoder::new(&vocabulary, &settings)?;
        let ask = |(kind, truth, motion): &(String, Truth, Motion)| -> Result<Answer> {
            let seen = Observations::complete(motion.clone());
            let answer = encoder.recognise(&seen)?;
            Ok(Answer::of(kind, *truth, &answer.posterior, &sets))
        };
        let answers = motions.par_iter().map(ask).collect::<Result<_>>()?;
        done.push(Method { name, answers });
    }
    Ok(EncodingTest { methods: done })
}

/// The motions that are asked, with what they resemble.
fn asked(
    corpus: &Path,
    vocabulary: &Vocabulary,
    every: usize,
) -> Result<Vec<(String, Truth, Motion)>> {
    let rows = index(corpus)?;
    let mut picked: Vec<&IndexRow> = Vec::new();
    let mut kinds = Vec::new();
    for (archive, label, truth) in RESEMBLING {
        let file = format!("{archive}.zip");
        let of = |r: &&IndexRow| {
            let named = [r.content(), r.label.as_str()].contains(&label);
            r.archive == file && named && !r.file.contains(ALL_ZERO)
        };
        for row in rows.iter().filter(of).step_by(every.max(1)) {
            picked.push(row);
            kinds.push((
                format!("{archive}, {label}"),
                truth,
                LEFT_HANDED.contains(&label),
            ));
        }
    }
    let set = load(corpus, &picked, vocabulary.body(), None, &|r| {
        r.label.clone()
    })?;
    let mut asked = Vec::new();
    for ((kind, truth, left), motion) in kinds.into_iter().zip(set.motions) {
        let motion = if left { motion.mirrored()? } else { motion };
        asked.push((kind, truth, motion));
    }
    let exercises = Exercises::read(corpus, vocabulary.body())?.pieces;
    for (archive, label, truth) in RESEMBLING.iter().filter(|(a, ..)| *a == EXERCISES) {
        let class = exercises.classes.iter().position(|c| c == label);
        let pieces = exercises.motions.iter().zip(&exercises.labels);
        let own = pieces.filter(|(_, l)| Some(**l) == class);
        for (motion, _) in own.step_by(every.max(1)) {
            asked.push((format!("{archive}, {label}"), *truth, motion.clone()));
        }
    }
    Ok(asked)
}

impl Method {
    /// Of the motions that resemble a set: how many were encoded by it, with refusals counting as wrong; how many have it
    /// as their likeliest, refused or not; and how many there are.
    pub fn right(&self) -> (usize, usize, usize) {
        let fitting = || self.answers.iter().filter(|a| a.truth.is_some());
        let answered = fitting().filter(|a| a.set() == a.truth).count();
        let leading = fitting().filter(|a| Some(a.leading) == a.truth).count();
        (answered, leading, fitting().count())
    }

    /// Of the motions that fit none: how many were refused, and how many there are.
    pub fn refused(&self) -> (usize, usize) {
        let foreign = || self.answers.iter().filter(|a| a.truth.is_none());
        (foreign().filter(|a| a.refused).count(), foreign().count())
    }
}

impl EncodingTest {
    /// The counts with their intervals, the confusions, and every kind of motion, as Markdown.
    ///
    /// # Errors
    /// Never; writing to a string cannot fail.
    pub fn markdown(&self) -> Result<String> {
        let mut out = String::from(
            "\n## Trajectory encoding\n\nMotions to their set: *answered*, refusals counting as wrong; *likeliest*, refused or \
             not. Shares in hundred with the Wilson interval.\n\n| method | answered | likeliest | fit none, refused | asked: 95 |\n\
             | --- | --- | --- | --- | --- |\n",
        );
        let told = |part: usize, whole: usize| {
            let (low, high) = wilson(part, whole);
            format!(
                "{part} of {whole}: {:.1} [{:.1}, {:.1}]",
                100.0 * part as f64 / whole.max(1) as f64,
                100.0 * low,
                100.0 * high
            )
        };
        for method in &self.methods {
            let (answered, leading, all) = method.right();
            let (refused, foreign) = method.refused();
            let verdict = match 100 * answered >= 95 * all {
                true => "met",
                false => "**missed**",
            };
            writeln!(
                out,
                "| {} | {} | {} | {} | {verdict} |",
                method.name,
                told(answered, all),
                told(leading, all),
                told(refused, foreign)
            )?;
        }
        for method in &self.methods {
            writeln!(
                out,
                "\n### Which set: {}\n\n| resembles | {} | refused |\n| --- {}| --- |",
                method.name,
                SETS.join(" | "),
                "| --- ".repeat(SETS.len())
            )?;
            for truth in (0..SETS.len()).map(Some).chain([None]) {
                let own = || method.answers.iter().filter(|a| a.truth == truth);
                let count = |answer: Truth| own().filter(|a| a.set() == answer).count();
                let cells: Vec<String> = (0..SETS.len())
                    .map(|s| count(Some(s)).to_string())
                    .collect();
                writeln!(
                    out,
                    "| {} | {} | {} |",
                    truth.map_or("none", |t| SETS[t]),
                    cells.join(" | "),
                    count(None)
                )?;
            }
        }
        self.kinds(&mut out)?;
        Ok(out)
    }

    fn kinds(&self, out: &mut String) -> Result<()> {
        let names: Vec<&str> = self.methods.iter().map(|m| m.name).collect();
        writeln!(
            out,
            "\n### Which motions resemble which, and how many were answered so\n\n| motions | resemble | clips | {} |\n| --- | --- | --- {}|",
            names.join(" | "),
            "| --- ".repeat(names.len())
        )?;
        for (archive, label, truth) in RESEMBLING {
            let kind = format!("{archive}, {label}");
            let own = |m: &Method| -> Vec<bool> {
                let own = m.answers.iter().filter(|a| a.kind == kind);
                own.map(|a| a.set() == truth).collect()
            };
            let counts: Vec<Vec<bool>> = self.methods.iter().map(own).collect();
            let all = counts.first().map_or(0, Vec::len);
            if all == 0 {
                continue;
            }
            let cells: Vec<String> = counts
                .iter()
                .map(|c| c.iter().filter(|right| **right).count().to_string())
                .collect();
            writeln!(
                out,
                "| {kind} | {} | {all} | {} |",
                truth.map_or("none", |t| SETS[t]),
                cells.join(" | ")
            )?;
        }
        Ok(())
    }

    /// Every answer as CSV.
    ///
    /// # Errors
    /// Never; writing to memory cannot fail.
    pub fn csv(&self) -> Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(["method", "motions", "resembles", "likeliest", "refused"])?;
        for method in &self.methods {
            for a in &method.answers {
                writer.write_record([
                    method.name,
                    &a.kind,
                    a.truth.map_or("none", |t| SETS[t]),
                    SETS[a.leading],
                    if a.refused { "yes" } else { "no" },
                ])?;
            }
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }
}
