//! The trajectory encoding test (paper, section V-C): captured motions, seen by the hands alone, applied to four sets of
//! primitives. Which set is each encoded by, and inside its own set, does each decision go the way the hand goes?

mod answers;
mod movement;
mod questions;
mod strokes;
mod tables;

use std::path::Path;
use std::sync::Arc;

use kineme::Vocabulary;
use kineme::motion::Motion;
use kineme::perception::calibrated;
use kineme::perception::encoding::{Encoder, EncodingMethod, EncodingSettings};
use kineme::primitive::{Observations, Primitive, Recogniser, Transitions};
use kineme::skeleton::Skeleton;
use rayon::prelude::*;

pub use answers::{Answer, Costs, limit, refused, right, wilson};
pub use movement::{Hand, Movement, costs, enlarged, knuckled, one_handed, one_handed_paper};
pub use questions::{Question, RESEMBLING, SETS, Truth};
pub use strokes::{RISING, Taken, Told, coordinate, strokes, tally};

use self::questions::{Asked, HORIZONTAL, asked};
use crate::choreographies::{GREETING, SCRIPTS, choreography};
use crate::sets::Result;

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

/// The primitives of the four sets as one vocabulary of a body, and the set of each.
///
/// # Errors
/// When the scripts cannot be performed by the body.
pub fn vocabulary(body: &Arc<Skeleton>) -> Result<(Vocabulary, Vec<usize>)> {
    let mut primitives: Vec<Primitive> = Vec::new();
    let mut sets = Vec::new();
    for (k, set) in SETS.iter().enumerate() {
        let own = SCRIPTS.iter().filter(|(name, _)| name == set);
        for (name, text) in own.chain((Some(k) == HORIZONTAL).then_some(&GREETING)) {
            for primitive in choreography(name, text, body)?.primitives() {
                primitives.push(primitive.clone());
                sets.push(k);
            }
        }
    }
    let transitions = Transitions::none(primitives.len());
    let body = Arc::clone(body);
    Ok((
        Vocabulary::new(body, primitives, Vec::new(), transitions)?,
        sets,
    ))
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
    let body = Arc::new(kineme::ares()?);
    let (vocabulary, sets) = self::vocabulary(&body)?;
    let vocabulary = calibrated(vocabulary, None)?;
    let knuckled = Arc::new(knuckled(&body)?);
    let (of_movements, _) = self::vocabulary(&knuckled)?;
    watch("reading motions that resemble them, or none");
    let motions = asked(corpus, &vocabulary, every)?;
    let of_wrists = |a: &Asked| -> Result<(Question, Movement)> {
        Ok((a.question.clone(), Movement::of(&a.motion)?))
    };
    let of_knuckles = |a: &Asked| -> Result<(Question, Movement)> {
        let m = &a.motion;
        let (poses, roots) = (m.poses().to_vec(), m.roots().to_vec());
        let m = Motion::new(m.name(), Arc::clone(&knuckled), m.rate_hz(), poses, roots)?;
        Ok((a.question.clone(), Movement::of(&m)?))
    };
    let parts: Vec<_> = motions.par_iter().map(of_knuckles).collect::<Result<_>>()?;
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
        answers: by_the_paper(&of_movements, &sets, &parts)?,
    });
    methods.push(Method {
        name: HYPOTHESES,
        part: Part::Movement,
        answers: by_hypotheses(&of_movements, &sets, &parts)?,
    });
    watch("encoding strokes");
    let parts: Vec<_> = motions.par_iter().map(of_wrists).collect::<Result<_>>()?;
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
    let ask = |(question, part): &(Question, Movement)| -> Result<(Question, Option<Costs>)> {
        Ok((question.clone(), costs(&encoder, part, sets)?))
    };
    let costs: Vec<_> = parts.par_iter().map(ask).collect::<Result<_>>()?;
    let limit = limit(&costs);
    let answers = costs.iter();
    Ok(answers
        .map(|(question, costs)| Answer::cheapest(question, costs.as_ref(), limit))
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
        let (own, rising) = strokes::own(vocabulary, sets, set);
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
            for hand in part.hands.iter().map(|h| &h.away) {
                let taken = match literally {
                    true => strokes::by_the_paper(&papers[set], hand, own)?,
                    false => strokes::by_hypotheses(&free, hand, own)?,
                };
                let more = tally(hand, set, rising, &taken);
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
