//! [`EncodingSettings`]: how effectors are compared with what primitives predict.

use super::cost::LANES;
use crate::error::{Error, Result};

/// Instants of a decision at which prediction and observation are compared.
pub(super) const SAMPLES: usize = 3;
/// Cells of a row between two such instants: a row's rates are multiples of a cell a decision.
const CELLS: usize = 2;
/// The reach of a body in units: 1.3 is about the length of a torso, in which the costs were measured.
pub(super) const REACH_UNITS: f64 = 1.3;

/// How movements are encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EncodingMethod {
    /// A hypothesis for every exemplar, phase and pace, followed through time.
    #[default]
    Hypotheses,
    /// As section V-B of the paper words it: one encoded posture is carried on, the memoryless flowfield of each
    /// primitive predicts from it, the best match takes all, and nothing is rejected.
    Paper,
}

/// What a movement is taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extent {
    /// A clip, unless it lasts more than twice as long as every exemplar.
    #[default]
    Automatic,
    /// One movement from its beginning to its end.
    Clip,
    /// Movements that follow one another, begun anywhere, cut off anywhere.
    Stream,
}

/// The matching operator of [`EncodingMethod::Paper`]: the likeness of a predicted and an observed path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Matching {
    /// Squared distance of the effectors (the paper's).
    #[default]
    Position,
    /// Squared distance of their displacements since the decision began: a different posture at the start cancels.
    Displacement,
    /// Cosine between the velocities, times the ratio of the speeds.
    Velocity,
    /// Squared distance after warping the time of one path to the other's.
    Warped,
}

/// How effectors are compared with what primitives predict. Lengths are in units of the reach over 1.3, times in
/// seconds; the defaults are those that recognised people best who were not learned from.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodingSettings {
    /// What is looked at: names of effectors of the body.
    pub effectors: Vec<String>,
    /// How it is encoded.
    pub method: EncodingMethod,
    /// What is encoded.
    pub extent: Extent,
    /// Seconds that a decision stands for.
    pub decision_secs: f64,
    /// Seconds over which predictions are compared, from a third of a decision to eight decisions.
    pub horizon_secs: f64,
    /// The distance of the stretched-out hand from between the shoulders of whoever is observed, metres, where that is
    /// known; `None` takes each motion's own, which only a motion that is known whole has.
    pub reach_m: Option<f64>,
    /// Width over which the heading of the shoulders is smoothed, seconds; 0 takes it frame by frame.
    pub heading_secs: f64,
    /// What a distance of positions costs.
    pub position: f64,
    /// What a distance of displacements since the start of a decision costs.
    pub displacement: f64,
    /// What a difference of soft directions v / (|v| + softness) of displacements costs.
    pub direction: f64,
    /// The length below which a displacement has no direction.
    pub softness: f64,
    /// Paces at which exemplars may be taken, as multiples of their own.
    pub rates: Vec<f64>,
    /// What a pace costs a decision, times the size of its logarithm.
    pub rate_cost: f64,
    /// What beginning late in an exemplar costs, times the phase.
    pub entry_cost: f64,
    /// The latest phase at which an exemplar may be begun.
    pub entry_phase: f64,
    /// What ending early costs a clip, times the share of the exemplar that is left.
    pub end_cost: f64,
    /// What going over to another movement costs a path.
    pub switch_cost: f64,
    /// Temperature of the soft minimum over the exemplars of a primitive; the closer to 0, the more the best one counts.
    pub temperature: f64,
    /// Hypotheses of an exemplar that cost so much more than its best one are given up.
    pub row_beam: f64,
    /// Hypotheses of a path with switching that are kept, at least.
    pub beam: usize,
    /// Exemplars that are followed, at most, evenly chosen.
    pub most_rows: usize,
    /// The matching operator of the paper's method.
    pub matching: Matching,
}

impl Default for EncodingSettings {
    fn default() -> Self {
        Self {
            effectors: vec!["left_hand".into(), "right_hand".into()],
            method: EncodingMethod::Hypotheses,
            extent: Extent::Automatic,
            decision_secs: 0.2,
            horizon_secs: 0.4,
            reach_m: None,
            heading_secs: 0.3,
            position: 0.4,
            displacement: 1.0,
            direction: 0.4,
            softness: 0.5,
            rates: vec![0.5, 2.0 / 3.0, 1.0, 1.5, 2.0],
            rate_cost: 0.05,
            entry_cost: 0.5,
            entry_phase: 0.3,
            end_cost: 0.5,
            switch_cost: 0.3,
            temperature: 0.05,
            row_beam: 1.0,
            beam: 1000,
            most_rows: 1024,
            matching: Matching::Position,
        }
    }
}

impl EncodingSettings {
    /// Seconds between two cells of a row.
    pub(super) fn cell_secs(&self) -> f64 {
        self.sample_secs() / CELLS as f64
    }

    /// Seconds between two instants that are compared.
    pub(super) fn sample_secs(&self) -> f64 {
        self.decision_secs / SAMPLES as f64
    }

    /// Instants that are compared, from the start of a decision on.
    pub(super) fn horizon(&self) -> usize {
        ((self.horizon_secs / self.sample_secs()).round() as usize).max(1)
    }

    /// Cells that pass in so many samples at a pace.
    pub(super) fn cells(&self, rate: f64, samples: usize) -> f64 {
        rate * (samples * CELLS) as f64
    }

    /// Cells beyond the end of a row that predictions may look at.
    pub(super) fn padding(&self) -> usize {
        let fastest = self.rates.iter().copied().fold(1.0, f64::max);
        let ahead = self.cells(fastest, self.horizon().max(SAMPLES));
        ahead.ceil() as usize + 2 * LANES
    }

    pub(super) fn check(&self) -> Result<()> {
        let wrong = |what: String| Err(Error::invalid(format!("encoding: {what}")));
        if !(self.decision_secs.is_finite() && (0.02..=5.0).contains(&self.decision_secs)) {
            return wrong(format!(
                "decisions of {} s, not 0.02 to 5 s",
                self.decision_secs
            ));
        }
        let horizon = self.horizon_secs / self.decision_secs;
        if !(0.33..=8.0).contains(&horizon) {
            return wrong(format!(
                "a horizon of {} s for decisions of {} s: a third of a decision to eight decisions are possible",
                self.horizon_secs, self.decision_secs
            ));
        }
        if self.rates.is_empty() || self.rates.iter().any(|r| !(0.1..=10.0).contains(r)) {
            return wrong(format!("paces of {:?}, not 0.1 to 10", self.rates));
        }
        let costs = [
            self.position,
            self.displacement,
            self.direction,
            self.rate_cost,
            self.entry_cost,
            self.end_cost,
            self.switch_cost,
            self.heading_secs,
        ];
        if costs.iter().any(|c| !(c.is_finite() && *c >= 0.0)) {
            return wrong("costs and widths are 0 or more".into());
        }
        let positive = [self.softness, self.temperature, self.row_beam];
        if positive.iter().any(|c| !(c.is_finite() && *c > 0.0)) {
            return wrong("softness, temperature and beam are more than 0".into());
        }
        if self.reach_m.is_some_and(|r| !(r.is_finite() && r > 0.0)) {
            return wrong(format!("a reach of {:?} m", self.reach_m));
        }
        if !(0.0..=1.0).contains(&self.entry_phase) || self.beam == 0 || self.most_rows == 0 {
            return wrong("phases lie in [0, 1]; a beam and the rows are one at least".into());
        }
        Ok(())
    }
}
