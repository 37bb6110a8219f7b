//! [`Explained`]: how well some of the primitives, following one another, say what was seen.

use super::chains::FAR;
use super::cost::Block;
use super::encoder::Encoder;
use super::extrapolation::held;
use super::paths::EffectorPaths;
use super::rows::Row;
use super::track::{Leg, Tracker};
use crate::error::{Error, Result};

/// The cheapest path through some of the primitives. Nothing is refused: it says which, and at what cost, not whether.
#[derive(Debug, Clone, PartialEq)]
pub struct Explained {
    /// Mean cost of a decision, in units ([`super::EncodingSettings`]); what the settings charge for beginning, going
    /// over and ending is in it.
    pub cost: f64,
    /// The primitive of each decision, an index into the vocabulary; `None` where nothing was seen.
    pub decisions: Vec<Option<usize>>,
}

impl Encoder<'_> {
    /// Mean cost of a decision of predicting that nothing moves, in units: how much there is to say of paths. 0 where they
    /// have no decision.
    ///
    /// # Errors
    /// When the paths are of other effectors than the encoder's.
    pub fn held(&self, paths: &EffectorPaths) -> Result<f64> {
        let seen = self.seen(paths)?;
        let unit_m = self.usual_unit_m(&seen);
        Ok(held(&seen.instants, &seen.blocks, unit_m, &self.settings))
    }

    /// Follows paths through the primitives of `among` alone, each as often as it likes, without rest and without a
    /// refusal. What two sets of primitives cost can be compared: the lower cost resembles more.
    ///
    /// # Errors
    /// When the paths are of other effectors than the encoder's, are shorter than a sample, or `among` names no
    /// primitive of the vocabulary.
    pub fn explained(&self, paths: &EffectorPaths, among: &[usize]) -> Result<Explained> {
        let seen = self.seen(paths)?;
        let own = |row: &&Row| among.contains(&row.primitive);
        let rows: Vec<Row> = self.rows.iter().filter(own).cloned().collect();
        if rows.is_empty() {
            return Err(Error::invalid(format!(
                "no primitive among {among:?}: the vocabulary has {}",
                self.vocabulary.primitives().len()
            )));
        }
        let all: f64 = seen.blocks.iter().map(|b| b.weight).sum();
        if all <= 0.0 {
            return Err(Error::invalid(format!(
                "paths of {:.3} s have no decision",
                paths.duration_secs()
            )));
        }
        let mut tracker = Tracker::new(&rows, &self.settings, FAR, true);
        let mut cost = 0.0;
        for block in &seen.blocks {
            tracker.step(block, false, |row| seen.unit_m(row));
            cost += tracker.last_cost();
        }
        let told = |(leg, block): (Leg, &Block)| match leg {
            Leg::Along { row, .. } if !block.is_blind() => Some(rows[row].primitive),
            _ => None,
        };
        let legs = tracker.path(false).into_iter();
        Ok(Explained {
            cost: cost / all,
            decisions: legs.zip(&seen.blocks).map(told).collect(),
        })
    }
}
