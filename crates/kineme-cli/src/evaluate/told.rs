//! What came of it, for people and for scripts.

use kineme::Vocabulary;
use kineme::evaluation::{Bootstrap, Confusion, Estimate, Scores};
use serde::Serialize;

use super::clips::Clip;
use super::methods::can_reject;
use super::{Outcome, class, name};
use crate::args::EvaluateArgs;
use crate::failure::Failure;
use crate::json::{InOrder, line};
use crate::table::{Side, aligned};

#[derive(Serialize)]
struct Document {
    clips: usize,
    negatives: usize,
    /// Clips that are exemplars of the vocabulary, or overlap them.
    on_exemplars: usize,
    methods: InOrder<MethodLine>,
    /// Of the first method: truth, answer, clips.
    confusion: InOrder<InOrder<usize>>,
}

#[derive(Serialize)]
struct MethodLine {
    accuracy: [f64; 3],
    balanced_accuracy: [f64; 3],
    macro_f1: [f64; 3],
    auroc: Option<f64>,
    unknowns_found: Option<f64>,
    ece: Option<f64>,
    /// Mean and 95th percentile of the error that exactly right probabilities would show.
    ece_by_chance: Option<[f64; 2]>,
    log_loss: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    decision_us: Option<[f64; 2]>,
}

/// The document of `--json`.
pub(super) fn document(
    vocabulary: &Vocabulary,
    clips: &[Clip],
    outcomes: &[Outcome],
) -> Result<String, Failure> {
    let triple = |e: Estimate| [e.value, e.low, e.high];
    let value = |e: Option<Estimate>| e.map(|e| e.value);
    let method = |o: &Outcome| {
        let s = &o.scores;
        let line = MethodLine {
            accuracy: triple(s.accuracy),
            balanced_accuracy: triple(s.balanced_accuracy),
            macro_f1: triple(s.macro_f1),
            auroc: value(s.auroc),
            unknowns_found: value(s.unknowns_found),
            ece: value(s.calibration_error),
            ece_by_chance: o.by_chance.map(|c| [c.mean, c.high]),
            log_loss: value(s.log_loss),
            decision_us: o.decision_us,
        };
        (name(o.method), line)
    };
    let mut confusion = Vec::new();
    for (truth, answers) in mistakes(vocabulary, outcomes)? {
        let answers = answers.into_iter();
        let answers = answers.map(|(a, n)| (class(vocabulary, a).to_owned(), n));
        confusion.push((
            class(vocabulary, truth).to_owned(),
            InOrder(answers.collect()),
        ));
    }
    let document = Document {
        clips: clips.len(),
        negatives: clips.iter().filter(|c| c.truth.is_none()).count(),
        on_exemplars: clips.iter().filter(|c| c.is_exemplar).count(),
        methods: InOrder(outcomes.iter().map(method).collect()),
        confusion: InOrder(confusion),
    };
    line(&document)
}

/// A class and how often each class was answered for it; the commonest answer first.
type Answered = (Option<usize>, Vec<(Option<usize>, usize)>);

/// What the first method answered for each class that is present.
fn mistakes(vocabulary: &Vocabulary, outcomes: &[Outcome]) -> Result<Vec<Answered>, Failure> {
    let primitives = vocabulary.primitives().len();
    let judged = outcomes.first().map_or(&[][..], |o| &o.judged);
    let confusion = Confusion::new(primitives, judged)?;
    let classes: Vec<Option<usize>> = (0..primitives).map(Some).chain([None]).collect();
    let rows = classes.iter().map(|&truth| {
        let answers = classes.iter().map(|&a| (a, confusion.count(truth, a)));
        let mut answers: Vec<_> = answers.filter(|(_, n)| *n > 0).collect();
        answers.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        (truth, answers)
    });
    Ok(rows.filter(|(_, answers)| !answers.is_empty()).collect())
}

/// A number from 0 to 1, or a difference of such.
fn number(value: f64) -> String {
    format!("{value:.3}").replace("-0.000", "0.000")
}

fn cell(estimate: Option<Estimate>) -> String {
    estimate.map_or("-".into(), |e| {
        format!(
            "{} ({} to {})",
            number(e.value),
            number(e.low),
            number(e.high)
        )
    })
}

/// Tables, and what to do next.
pub(super) fn tables(
    vocabulary: &Vocabulary,
    clips: &[Clip],
    outcomes: &[Outcome],
    bootstrap: &Bootstrap,
    args: &EvaluateArgs,
) -> Result<String, Failure> {
    let negatives = clips.iter().filter(|c| c.truth.is_none()).count();
    let mut text = format!(
        "{} on {} clips, {negatives} of them negatives; {} primitives\n\n",
        args.vocabulary.display(),
        clips.len(),
        vocabulary.primitives().len()
    );
    text.push_str(&answers(outcomes, args.timings));
    text.push('\n');
    text.push_str(&rejection(outcomes));
    text.push_str(&format!(
        "In brackets: {:.0} % of {} drawings of as many clips. Balanced: each class counts alike, and none is one. AUROC:\n\
         how often a negative is more novel than a positive. Found: negatives more novel than 95 % of the positives.\n\
         By chance: the calibration error of exactly right probabilities on so few clips, in the mean (to what it rarely exceeds).\n",
        100.0 * bootstrap.level,
        bootstrap.draws
    ));
    text.push_str(&compared(outcomes));
    let mistakes = mistakes(vocabulary, outcomes)?;
    if let Some(first) = outcomes.first() {
        text.push_str(&format!("\nAnswers of {}:\n", name(first.method)));
    }
    text.push_str(&confusion(vocabulary, &mistakes));
    text.push_str(&next(vocabulary, &mistakes, negatives, outcomes, args));
    Ok(text)
}

fn answers(outcomes: &[Outcome], timings: bool) -> String {
    let mut header = vec![
        ("method", Side::Left),
        ("accuracy", Side::Right),
        ("balanced", Side::Right),
        ("macro F1", Side::Right),
    ];
    if timings {
        header.extend([("us a frame", Side::Right), ("99 %", Side::Right)]);
    }
    let rows: Vec<Vec<String>> = outcomes
        .iter()
        .map(|o| {
            let s = &o.scores;
            let mut row = vec![name(o.method)];
            row.extend([s.accuracy, s.balanced_accuracy, s.macro_f1].map(|e| cell(Some(e))));
            row.extend(o.decision_us.iter().flatten().map(|us| format!("{us:.0}")));
            row
        })
        .collect();
    aligned(&header, &rows)
}

fn rejection(outcomes: &[Outcome]) -> String {
    let header = [
        ("method", Side::Left),
        ("calibration error", Side::Right),
        ("by chance", Side::Right),
        ("log loss", Side::Right),
        ("AUROC", Side::Right),
        ("found", Side::Right),
    ];
    let rows: Vec<Vec<String>> = outcomes
        .iter()
        .map(|o| {
            let s: &Scores = &o.scores;
            let chance = o.by_chance.map_or("-".into(), |c| {
                format!("{} (to {})", number(c.mean), number(c.high))
            });
            let mut row = vec![name(o.method), cell(s.calibration_error), chance];
            row.extend([s.log_loss, s.auroc, s.unknowns_found].map(cell));
            row
        })
        .collect();
    aligned(&header, &rows)
}

/// How much better the first method is than the others.
fn compared(outcomes: &[Outcome]) -> String {
    let [first, others @ ..] = outcomes else {
        return String::new();
    };
    if others.is_empty() {
        return String::new();
    }
    let title = format!("{} less", name(first.method));
    let header = [
        (title.as_str(), Side::Left),
        ("accuracy", Side::Right),
        ("balanced", Side::Right),
        ("macro F1", Side::Right),
    ];
    let rows: Vec<Vec<String>> = others
        .iter()
        .map(|o| {
            let d = &o.behind;
            let mut row = vec![name(o.method)];
            row.extend([d.accuracy, d.balanced_accuracy, d.macro_f1].map(|e| cell(Some(e))));
            row
        })
        .collect();
    format!("\n{}", aligned(&header, &rows))
}

fn confusion(vocabulary: &Vocabulary, mistakes: &[Answered]) -> String {
    let header = [
        ("label", Side::Left),
        ("clips", Side::Right),
        ("right", Side::Right),
        ("answered instead", Side::Left),
    ];
    let rows: Vec<Vec<String>> = mistakes
        .iter()
        .map(|(truth, answers)| {
            let right = answers.iter().filter(|(a, _)| a == truth);
            let wrong: Vec<String> = answers
                .iter()
                .filter(|(a, _)| a != truth)
                .map(|(a, n)| format!("{} {n}", class(vocabulary, *a)))
                .collect();
            vec![
                class(vocabulary, *truth).to_owned(),
                answers.iter().map(|(_, n)| n).sum::<usize>().to_string(),
                right.map(|(_, n)| n).sum::<usize>().to_string(),
                wrong.join(", "),
            ]
        })
        .collect();
    aligned(&header, &rows)
}

/// What a person might do about it.
fn next(
    vocabulary: &Vocabulary,
    mistakes: &[Answered],
    negatives: usize,
    outcomes: &[Outcome],
    args: &EvaluateArgs,
) -> String {
    let shown = args.vocabulary.display();
    let mut text = String::from("\n");
    let first = outcomes.first().map(|o| o.method);
    if negatives == 0 {
        text.push_str(
            "No negatives: rows with an empty label would show whether strange movements are told from known ones.\n",
        );
    } else if let Some(method) = first.filter(|m| !can_reject(*m)) {
        text.push_str(&format!(
            "{} always names a primitive: every negative is a mistake, and only its novelty tells.\n",
            name(method)
        ));
    }
    let wrong = |(truth, answers): &&Answered| -> usize {
        let wrong = answers.iter().filter(|(a, _)| a != truth);
        wrong.map(|(_, n)| n).sum()
    };
    // Of equal ones the first.
    let primitives = mistakes.iter().rev().filter(|(truth, _)| truth.is_some());
    match primitives.max_by_key(wrong).filter(|m| wrong(m) > 0) {
        Some((truth, _)) => {
            let worst = class(vocabulary, *truth);
            text.push_str(&format!(
                "Most mistaken: {worst}. `kineme show {shown} {worst}` tells what it was learned from;\n\
                 `kineme edit {shown} -o OUT --add MANIFEST.csv` gives it more exemplars.\n"
            ));
        }
        None => text.push_str(
            "Every primitive was recognised: try other people, or movements that are more alike.\n",
        ),
    }
    text
}
