//! The inverse law as a table: what a written primitive makes is recognised as it.

use std::fmt::Write as _;
use std::sync::Arc;

use kineme::perception::{Filter, FilterSettings, calibrated};

use crate::choreographies::{SCRIPTS, choreography};
use crate::inverse::{Recovered, inverse};
use crate::sets::Result;

/// Places drawn in each primitive.
const PLACES: usize = 200;
/// How far off phase and parameters may be.
const PHASE: f64 = 0.05;
const PARAMETERS: f64 = 0.1;

/// Writes the shares of drawn places at which label, phase and parameters are right, on both bodies.
///
/// # Errors
/// When places cannot be drawn.
pub fn write_law(out: &mut String) -> Result<()> {
    writeln!(
        out,
        "\n### The inverse law: {PLACES} places drawn in each primitive of the paper's movements, streamed from its start\n\nShares of places, \
         inside each vocabulary: label right (asked: .99) / phase within {PHASE} / parameters within {PARAMETERS} where the \
         posture tells them.\n\n| primitive | Adonis | Ares |\n| --- | --- | --- |"
    )?;
    let bodies = [Arc::new(kineme::adonis()?), Arc::new(kineme::ares()?)];
    for (name, text) in SCRIPTS {
        let mut columns = Vec::new();
        for body in &bodies {
            let vocabulary = calibrated(choreography(name, text, body)?, None)?;
            let filter = Filter::new(&vocabulary, &FilterSettings::default())?;
            let found = inverse(&filter, PLACES, 0)?;
            let names = vocabulary.primitives().iter().map(|p| p.name().to_owned());
            columns.push((names.collect::<Vec<_>>(), found));
        }
        for (k, primitive) in columns[0].0.iter().enumerate() {
            let cells: Vec<String> = columns.iter().map(|(_, found)| shares(&found[k])).collect();
            writeln!(out, "| {primitive} | {} |", cells.join(" | "))?;
        }
    }
    Ok(())
}

fn shares(found: &[Recovered]) -> String {
    let share = |right: usize, of: usize| match of {
        0 => "-".into(),
        _ => format!("{:.3}", right as f64 / of as f64),
    };
    let told: Vec<f64> = found.iter().filter_map(|f| f.parameters).collect();
    format!(
        "{} / {} / {}",
        share(found.iter().filter(|f| f.label).count(), found.len()),
        share(
            found.iter().filter(|f| f.phase <= PHASE).count(),
            found.len()
        ),
        share(
            told.iter().filter(|off| **off <= PARAMETERS).count(),
            told.len()
        )
    )
}
