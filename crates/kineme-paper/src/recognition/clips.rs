//! Whole clips of people, or in styles, that were not learned from.

use std::fmt::Write as _;

use kineme::evaluation::{Bootstrap, Estimate, Judged, calibration_by_chance, scores};

use super::answers::{among_known, answers, as_recorded, rights};
use super::calibration::by_chance;
use super::corpora::{BANDAI_NAMCO, Corpus, HDM05, MSR, UTD};
use super::known::{Known, Method};
use super::summary::{Aim, Line, shown};
use crate::sets::Result;

/// Methods that see the whole body, then those that see the hands.
pub const METHODS: [Method; 9] = [
    Method::Filter,
    Method::Frame,
    Method::Paper,
    Method::Dtw,
    Method::DtwRoute,
    Method::Posture,
    Method::Constant,
    Method::Encode,
    Method::DtwHands,
];

/// Answers of each method to every clip asked, all splits of a set together.
#[derive(Debug, Clone)]
pub struct Asked {
    /// The methods.
    pub methods: Vec<Method>,
    /// As they answered, one a clip, of each method.
    pub judged: Vec<Vec<Judged>>,
}

impl Asked {
    /// Learns every split of a set and asks these methods.
    ///
    /// # Errors
    /// When a primitive cannot be learned or a clip not be recognised.
    pub fn of(corpus: &Corpus, methods: &[Method]) -> Result<Self> {
        let mut judged: Vec<Vec<Judged>> = vec![Vec::new(); methods.len()];
        for split in &corpus.splits {
            let known = Known::learn(&corpus.set, &split.train)?;
            for (all, method) in judged.iter_mut().zip(methods) {
                let recogniser = method.over(&known.vocabulary)?;
                let of = answers(&*recogniser, &known, &corpus.set, &split.test, &as_recorded)?;
                all.extend(of);
            }
        }
        Ok(Self {
            methods: methods.to_vec(),
            judged,
        })
    }

    /// The answers of a method, one a clip.
    ///
    /// # Errors
    /// When the method was not asked.
    pub fn of_method(&self, method: Method) -> Result<&[Judged]> {
        let asked = self.methods.iter().position(|m| *m == method);
        Ok(&self.judged[asked.ok_or("a method that was not asked")?])
    }

    /// Whether each clip was answered rightly, rest and none ruled out.
    ///
    /// # Errors
    /// When the method was not asked.
    pub fn rights(&self, method: Method) -> Result<Vec<f64>> {
        let judged = self.of_method(method)?;
        Ok(rights(&among_known(judged, method == Method::Paper)))
    }
}

/// The aims for whole clips: all joints, and hands alone.
fn aims(name: &str) -> [Option<Aim>; 2] {
    let aim = |value, baseline| Some(Aim::beside(value, baseline));
    match name {
        UTD => [aim(0.95, 0.905), aim(0.96, 0.942)],
        MSR => [aim(0.87, 0.774), aim(0.83, 0.749)],
        HDM05 => [aim(0.99, 1.0), None],
        BANDAI_NAMCO => [aim(0.98, 0.933), None],
        _ => [None, None],
    }
}

/// The rows of a set in the tables of aims: `filter`, and `encode`.
///
/// # Errors
/// When a method was not asked.
pub fn lines(corpus: &Corpus, asked: &Asked) -> Result<[Line; 2]> {
    let [all, hands] = aims(corpus.name);
    let line = |row: &str, ours: Method, baseline: Method, aim| {
        Line::of(row, &asked.rights(ours)?, &asked.rights(baseline)?, 1, aim)
    };
    Ok([
        line(corpus.name, Method::Filter, Method::Dtw, all)?,
        line(
            &format!("{}, hands", corpus.name),
            Method::Encode,
            Method::DtwHands,
            hands,
        )?,
    ])
}

/// The row of a set whose classes differ in where they lead: beside the baseline that is told, too. The set's aim stands
/// with the row before it.
///
/// # Errors
/// When a method was not asked.
pub fn line_beside_route(corpus: &Corpus, asked: &Asked) -> Result<Line> {
    let row = format!("{}, beside 1NN-DTW with the route", corpus.name);
    let (ours, baseline) = (
        asked.rights(Method::Filter)?,
        asked.rights(Method::DtwRoute)?,
    );
    Line::of(&row, &ours, &baseline, 1, None)
}

/// Writes the table of a set: a row a method.
///
/// # Errors
/// When there are no clips.
pub fn write_clips(out: &mut String, corpus: &Corpus, asked: &Asked) -> Result<()> {
    writeln!(
        out,
        "\n### {}: {} clips asked, {} classes\n\n| method | accuracy | macro-F1 | ECE (by chance) | with rest and none: accuracy | ECE (by chance) | log loss |\n| --- | --- | --- | --- | --- | --- | --- |",
        corpus.name,
        asked.judged[0].len(),
        corpus.set.classes.len()
    )?;
    let bootstrap = Bootstrap::default();
    for (method, judged) in asked.methods.iter().zip(&asked.judged) {
        let known = among_known(judged, *method == Method::Paper);
        let (closed, open) = (scores(&known, &bootstrap)?, scores(judged, &bootstrap)?);
        let plain = |e: Option<Estimate>| e.map_or("-".into(), |e| format!("{:.3}", e.value));
        let error = |e: Option<Estimate>, judged: &[Judged]| -> Result<String> {
            let alone: Vec<&[Judged]> = judged.chunks(1).collect();
            Ok(match calibration_by_chance(&alone, &bootstrap)? {
                Some(chance) => format!("{} ({})", plain(e), by_chance(&chance)),
                None => "-".into(),
            })
        };
        writeln!(
            out,
            "| {} | {} | {:.3} | {} | {:.3} | {} | {} |",
            method.name(),
            shown(&closed.accuracy),
            closed.macro_f1.value,
            error(closed.calibration_error, &known)?,
            open.accuracy.value,
            error(open.calibration_error, judged)?,
            plain(open.log_loss)
        )?;
    }
    Ok(())
}
