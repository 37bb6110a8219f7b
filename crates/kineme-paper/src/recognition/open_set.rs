//! Clips of classes that were never learned: how well they are told from those that were.

use std::fmt::Write as _;

use kineme::evaluation::{Bootstrap, Judged, scores};

use super::answers::{answers, as_recorded, mean};
use super::corpora::{Corpus, HDM05, UTD};
use super::known::{Known, Method, primitives};
use super::summary::{Aim, Line, shown};
use super::trials::halves;
use crate::sets::Result;

/// Rejection over one half of the classes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rejection {
    /// Area under the curve.
    pub auroc: f64,
    /// Unknowns found where 95 % of the known are kept, the limit known in hindsight.
    pub found: f64,
    /// Unknowns answered as rest or none.
    pub refused: f64,
    /// Clips of known classes answered as rest or none.
    pub lost: f64,
}

/// Rejection of each method in every half, halves in order.
///
/// # Errors
/// When a primitive cannot be learned or a clip not be recognised.
pub fn rejections(corpus: &Corpus, methods: &[Method]) -> Result<Vec<Vec<Rejection>>> {
    let learn = |split: &super::corpora::Split| primitives(&corpus.set, &split.train);
    let learned = corpus
        .splits
        .iter()
        .map(learn)
        .collect::<Result<Vec<_>>>()?;
    let mut all = vec![Vec::new(); methods.len()];
    for (k, split) in halves(corpus).splits.iter().enumerate() {
        // A primitive is the same whoever else is known.
        let mut half = learned[k % learned.len()].clone();
        for (class, primitive) in half.iter_mut().enumerate() {
            if !split.train.iter().any(|&i| corpus.set.labels[i] == class) {
                *primitive = None;
            }
        }
        let known = Known::of(half)?;
        for (of, method) in all.iter_mut().zip(methods) {
            let recogniser = method.over(&known.vocabulary)?;
            let judged = answers(&*recogniser, &known, &corpus.set, &split.test, &as_recorded)?;
            of.push(rejection(&judged)?);
        }
    }
    Ok(all)
}

fn rejection(judged: &[Judged]) -> Result<Rejection> {
    let bootstrap = Bootstrap {
        draws: 1,
        ..Bootstrap::default()
    };
    let scores = scores(judged, &bootstrap)?;
    let refused = |known: bool| {
        let of: Vec<&Judged> = judged
            .iter()
            .filter(|j| j.truth.is_some() == known)
            .collect();
        of.iter().filter(|j| j.answer().is_none()).count() as f64 / of.len() as f64
    };
    Ok(Rejection {
        auroc: scores.auroc.ok_or("no unknown clips")?.value,
        found: scores.unknowns_found.ok_or("no unknown clips")?.value,
        refused: refused(false),
        lost: refused(true),
    })
}

/// Writes the table of a set and gives its rows among the aims: the first two methods compared.
///
/// # Errors
/// Without halves.
pub fn write_rejections(
    out: &mut String,
    corpus: &Corpus,
    methods: &[Method],
    all: &[Vec<Rejection>],
) -> Result<Vec<Line>> {
    writeln!(
        out,
        "\n### {}, half of the classes unknown\n\n| method | AUROC | unknowns found, 95 % of knowns kept (hindsight) | unknowns refused as answered | knowns refused |\n| --- | --- | --- | --- | --- |",
        corpus.name
    )?;
    let values =
        |m: usize, of: fn(&Rejection) -> f64| -> Vec<f64> { all[m].iter().map(of).collect() };
    for (m, method) in methods.iter().enumerate() {
        let shown = |of: fn(&Rejection) -> f64| {
            Ok::<_, Box<dyn std::error::Error + Send + Sync>>(shown(&mean(&values(m, of), 1)?))
        };
        writeln!(
            out,
            "| {} | {} | {} | {} | {} |",
            method.name(),
            shown(|r| r.auroc)?,
            shown(|r| r.found)?,
            shown(|r| r.refused)?,
            shown(|r| r.lost)?
        )?;
    }
    let aims = match corpus.name {
        UTD => [Some(Aim::beside(0.92, 0.794)), Some(Aim::alone(0.6))],
        HDM05 => [Some(Aim::beside(0.99, 0.995)), Some(Aim::alone(0.6))],
        _ => [None, None],
    };
    let row = halves(corpus).row;
    let line = |measure: &str, of: fn(&Rejection) -> f64, aim| {
        Line::of(
            &format!("{row}, {measure}"),
            &values(0, of),
            &values(1, of),
            1,
            aim,
        )
    };
    Ok(vec![
        line("AUROC", |r| r.auroc, aims[0])?,
        line("found", |r| r.found, aims[1])?,
    ])
}
