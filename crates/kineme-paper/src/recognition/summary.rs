//! The table of aims: what was wanted beside what was reached.

use std::fmt::Write as _;

use kineme::evaluation::Estimate;

use super::answers::mean;
use super::peers::Peers;
use crate::sets::Result;

/// What was wanted of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aim {
    /// At least so much.
    pub value: f64,
    /// What 1NN-DTW had on the split for which the aim was set, where that is known: another than ours.
    pub baseline: Option<f64>,
}

impl Aim {
    /// An aim, set where 1NN-DTW had so much.
    pub const fn beside(value: f64, baseline: f64) -> Self {
        Self {
            value,
            baseline: Some(baseline),
        }
    }

    /// An aim of which it is not known what 1NN-DTW had.
    pub const fn alone(value: f64) -> Self {
        Self {
            value,
            baseline: None,
        }
    }

    fn shown(self) -> String {
        let there = self
            .baseline
            .map_or(String::new(), |b| format!(" ({b:.3})"));
        format!("{:.2}{there}", self.value)
    }
}

/// A row of the table of aims.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// What is measured, and on what.
    pub row: String,
    /// Our recogniser.
    pub ours: Estimate,
    /// 1NN-DTW on the same clips and exemplars.
    pub baseline: Estimate,
    /// Ours less the baseline's, both drawn together.
    pub difference: Estimate,
    /// What was wanted.
    pub aim: Option<Aim>,
}

impl Line {
    /// A row of two recognisers' values, one an item, the items the same; intervals over `blocks` of items.
    ///
    /// # Errors
    /// When there are no values, or not as many of each.
    pub fn of(
        row: &str,
        ours: &[f64],
        baseline: &[f64],
        blocks: usize,
        aim: Option<Aim>,
    ) -> Result<Self> {
        if ours.len() != baseline.len() {
            return Err(format!("{row}: {} values beside {}", ours.len(), baseline.len()).into());
        }
        let differences: Vec<f64> = ours.iter().zip(baseline).map(|(a, b)| a - b).collect();
        Ok(Self {
            row: row.into(),
            ours: mean(ours, blocks)?,
            baseline: mean(baseline, blocks)?,
            difference: mean(&differences, blocks)?,
            aim,
        })
    }
}

/// A value and its interval.
pub fn shown(e: &Estimate) -> String {
    format!("{:.3} ({:.3} to {:.3})", e.value, e.low, e.high)
}

/// A difference and its interval.
pub fn signed(e: &Estimate) -> String {
    format!("{:+.3} ({:+.3} to {:+.3})", e.value, e.low, e.high)
}

/// `met` or `missed`, `-` without an aim.
pub fn verdict(value: f64, aim: Option<f64>) -> &'static str {
    match aim {
        None => "-",
        Some(aim) if value >= aim => "met",
        Some(_) => "**missed**",
    }
}

/// Writes rows of `method` beside the baseline, MiniRocket and the aims, and what must hold of them.
///
/// # Errors
/// When it cannot be written.
pub fn write_lines(
    out: &mut String,
    method: &str,
    baseline: &str,
    lines: &[Line],
    peers: &Peers,
) -> Result<()> {
    writeln!(
        out,
        "\n| row | {method} | {baseline} | difference | MiniRocket | aim ({baseline} where it was set) | |\n| --- | --- | --- | --- | --- | --- | --- |"
    )?;
    for l in lines {
        let peer = peers
            .value(&l.row)
            .map_or("-".into(), |v| format!("{v:.3}"));
        let aim = l.aim.map_or("-".into(), Aim::shown);
        writeln!(
            out,
            "| {} | {} | {} | {} | {peer} | {aim} | {} |",
            l.row,
            shown(&l.ours),
            shown(&l.baseline),
            signed(&l.difference),
            verdict(l.ours.value, l.aim.map(|a| a.value))
        )?;
    }
    let below: Vec<&str> = lines
        .iter()
        .filter(|l| l.difference.high < 0.0)
        .map(|l| l.row.as_str())
        .collect();
    let gain = lines.iter().map(|l| l.difference.value).sum::<f64>() / lines.len().max(1) as f64;
    let met = lines
        .iter()
        .filter(|l| l.aim.is_some_and(|a| l.ours.value >= a.value));
    let aims = lines.iter().filter(|l| l.aim.is_some()).count();
    let gains: Vec<bool> = lines
        .iter()
        .filter_map(|l| {
            let aim = l.aim?;
            Some(l.difference.value >= aim.value - aim.baseline?)
        })
        .collect();
    let held = match below.as_slice() {
        [] => "on no row below it by more than the interval".to_string(),
        rows => format!(
            "**below it by more than the interval: {}**",
            rows.join("; ")
        ),
    };
    writeln!(
        out,
        "\nMust, against {baseline}: {held}; {gain:+.3} in the mean of the rows{}. Aims met: {} of {aims}; as far above {baseline} as aimed: {} of {}.",
        if gain > 0.0 { "" } else { " (**missed**)" },
        met.count(),
        gains.iter().filter(|g| **g).count(),
        gains.len()
    )?;
    Ok(())
}
