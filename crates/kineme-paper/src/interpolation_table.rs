//! The interpolation tables of `docs/model.md`: exemplars that were left out, predicted from the others.

use std::fmt::Write as _;

use kineme::interpolation::Method;

use crate::intervals::{average, interval};
use crate::models::{Judged, Rival};
use crate::sets::Result;

/// Classes with fewer clips are listed and not averaged.
pub const LEAST_CLIPS: usize = 8;

/// What is measured: a heading and the place in [`crate::postures::Errors::values`].
const MEASURES: [(&str, usize); 3] = [
    ("joint error, degrees", 0),
    ("wrist error, cm", 1),
    ("landmark error, cm", 2),
];

/// Writes the tables of judged folds.
///
/// # Errors
/// Never: writing to a string does not fail.
pub fn write_interpolation(
    out: &mut String,
    name: &str,
    classes: &[String],
    judged: &[Judged],
) -> Result<()> {
    for (measure, place) in MEASURES {
        write!(
            out,
            "\n### {name}, interpolation: {measure}\n\n| class | clips |"
        )?;
        for rival in Rival::ALL {
            write!(out, " {} |", rival.name())?;
        }
        writeln!(out, "\n|{}", " --- |".repeat(2 + Rival::ALL.len()))?;
        // values[rival][class][clip]
        let values: Vec<Vec<Vec<f64>>> = (0..Rival::ALL.len())
            .map(|r| {
                let of_class = |class: usize| {
                    let own = judged.iter().filter(|j| j.class == class);
                    own.map(|j| j.errors[r].values()[place]).collect()
                };
                (0..classes.len()).map(of_class).collect()
            })
            .collect();
        for (c, class) in classes.iter().enumerate() {
            let cyclic = judged.iter().any(|j| j.class == c && j.cyclic);
            let mark = if cyclic { " (cycle)" } else { "" };
            write!(out, "| {class}{mark} | {} |", values[0][c].len())?;
            for rival in &values {
                write!(out, " {:.1} |", average(&rival[c]))?;
            }
            writeln!(out)?;
        }
        let large = |rival: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let enough = |c: &&Vec<f64>| c.len() >= LEAST_CLIPS;
            rival.iter().filter(enough).cloned().collect()
        };
        write!(out, "| **mean over classes** | |")?;
        for rival in &values {
            let i = interval(&large(rival));
            write!(out, " **{:.2}** ({:.2} to {:.2}) |", i.mean, i.low, i.high)?;
        }
        write!(out, "\n| less than this, chosen has | |")?;
        let chosen = &values[Rival::ALL.len() - 1];
        for rival in &values[..Rival::ALL.len() - 1] {
            let less: Vec<Vec<f64>> = rival
                .iter()
                .zip(chosen)
                .map(|(r, c)| r.iter().zip(c).map(|(r, c)| r - c).collect())
                .collect();
            let i = interval(&large(&less));
            write!(out, " {:.2} ({:.2} to {:.2}) |", i.mean, i.low, i.high)?;
        }
        writeln!(out, " |")?;
    }
    choices(out, classes, judged)
}

/// Which interpolators were chosen, class by class.
fn choices(out: &mut String, classes: &[String], judged: &[Judged]) -> Result<()> {
    writeln!(
        out,
        "\n| class | chosen: exact | with a nugget | Shepard | parameters | of another structure, left out |\n| --- | --- | --- | --- | --- | --- |"
    )?;
    for (c, class) in classes.iter().enumerate() {
        let own: Vec<&Judged> = judged.iter().filter(|j| j.class == c).collect();
        let count = |f: &dyn Fn(&Judged) -> bool| own.iter().filter(|j| f(j)).count();
        let exact =
            count(&|j| matches!(j.method, Method::Cardinal { nugget, .. } if nugget == 0.0));
        let shepard = count(&|j| matches!(j.method, Method::Shepard { .. }));
        let mean = |f: &dyn Fn(&Judged) -> usize| {
            average(&own.iter().map(|j| f(j) as f64).collect::<Vec<_>>())
        };
        writeln!(
            out,
            "| {class} | {exact} | {} | {shepard} | {:.1} | {:.1} |",
            own.len() - exact - shepard,
            mean(&|j| j.dims),
            mean(&|j| j.foreign)
        )?;
    }
    Ok(())
}
