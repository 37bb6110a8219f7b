//! Chains: a row followed through a whole motion, and what the rows of a primitive say together.

use super::cost::Block;
use super::rows::Row;
use super::settings::EncodingSettings;

/// A cost that nothing reaches; finite, for differences of it must be numbers.
pub(super) const FAR: f64 = 1e12;

/// What a chain may look like at its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    /// It begins early in the row, and what is left of the row at the end counts.
    Whole,
    /// It begins and ends anywhere: the motion was cut out of a longer one.
    Free,
}

/// What a row costs at best, `unit_m` of the observation being a unit of the row: the mean over the blocks, and the missing end (Viterbi 1967).
pub(super) fn chain(
    row: &Row,
    (blocks, unit_m): (&[Block], f64),
    ends: Ends,
    s: &EncodingSettings,
) -> f64 {
    let all: f64 = blocks.iter().map(|b| b.weight).sum();
    let mut costs = Vec::new();
    let mut reached: Vec<f64> = (0..row.cells())
        .map(|c| match row.share(c) {
            _ if ends == Ends::Free => 0.0,
            share if share <= s.entry_phase => s.entry_cost * share,
            _ => FAR,
        })
        .collect();
    let mut next = vec![FAR; row.cells()];
    for block in blocks {
        next.fill(FAR);
        advance(
            row,
            (block, unit_m),
            &reached,
            s,
            &mut costs,
            |to, cost, _, _| {
                next[to] = next[to].min(cost);
            },
        );
        std::mem::swap(&mut reached, &mut next);
        let best = reached.iter().copied().fold(FAR, f64::min);
        for cost in &mut reached {
            if *cost > best + s.row_beam {
                *cost = FAR;
            }
        }
    }
    let end = if ends == Ends::Whole { s.end_cost } else { 0.0 };
    let at_end = reached.iter().enumerate();
    let totals = at_end.map(|(c, cost)| cost / all.max(1e-9) + end * row.missing(c));
    totals.fold(FAR, f64::min)
}

/// Takes the hypotheses of a row (`reached`: what each cell costs, [`FAR`] where none is) over a block. Each way is told:
/// the cell that it comes to, what it costs there, the cell that it comes from, the number of its pace.
pub(super) fn advance(
    row: &Row,
    (block, unit_m): (&Block, f64),
    reached: &[f64],
    s: &EncodingSettings,
    costs: &mut Vec<f32>,
    mut way: impl FnMut(usize, f64, usize, usize),
) {
    let Some(first) = reached.iter().position(|c| *c < FAR) else {
        return;
    };
    let end = reached
        .iter()
        .rposition(|c| *c < FAR)
        .map_or(first, |c| c + 1);
    block.costs(row, first..end, unit_m, s, costs);
    let width = costs.len() / s.rates.len();
    for (r, &rate) in s.rates.iter().enumerate() {
        let ahead = s.cells(rate, block.span).round() as usize;
        let pace = s.rate_cost * rate.ln().abs();
        for cell in first..end {
            if reached[cell] < FAR {
                let own = f64::from(costs[r * width + cell - first]) + pace;
                way(
                    row.after(cell, ahead),
                    reached[cell] + block.weight * own,
                    cell,
                    r,
                );
            }
        }
    }
}

/// The cost of each primitive: the soft minimum -T ln mean exp(-J / T) over its rows, of those that `counts` admits;
/// [`FAR`] where there are none.
pub(super) fn class_costs(
    rows: &[Row],
    costs: &[f64],
    primitives: usize,
    temperature: f64,
    counts: impl Fn(usize) -> bool,
) -> Vec<f64> {
    let own = || (0..rows.len()).filter(|&r| counts(r));
    let mut least = vec![FAR; primitives];
    for r in own() {
        let best = &mut least[rows[r].primitive];
        *best = best.min(costs[r]);
    }
    let mut sums = vec![(0.0, 0.0); primitives];
    for r in own() {
        let (sum, count) = &mut sums[rows[r].primitive];
        *sum += (-(costs[r] - least[rows[r].primitive]) / temperature).exp();
        *count += 1.0;
    }
    let pairs = least.into_iter().zip(sums);
    pairs
        .map(|(least, (sum, count))| match count > 0.0 {
            true => least - temperature * (sum / count).ln(),
            false => FAR,
        })
        .collect()
}

/// Shares exp(-cost / temperature), normalised; of what is [`FAR`] nothing.
pub(super) fn shares(costs: &[f64], temperature: f64) -> Vec<f64> {
    let least = costs.iter().copied().fold(FAR, f64::min);
    let raw: Vec<f64> = costs
        .iter()
        .map(|c| match *c < FAR {
            true => (-(c - least) / temperature).exp(),
            false => 0.0,
        })
        .collect();
    let sum: f64 = raw.iter().sum();
    raw.iter()
        .map(|r| if sum > 0.0 { r / sum } else { 0.0 })
        .collect()
}
