//! [`Table`], and the [`Row`]s that it consists of.

use kineme::evaluation::Estimate;

use super::clip::Altered;
use super::measures::{MEASURES, Measure, garwood, measures};
use super::mode::Mode;
use super::tally::Tally;
use crate::sets::Result;

/// One row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The data set.
    pub set: String,
    /// How was decided.
    pub mode: Mode,
    /// What was altered before.
    pub altered: Altered,
    /// Its clips, frames and hours.
    pub clips: usize,
    /// Frames.
    pub frames: u64,
    /// Hours.
    pub hours: f64,
    /// False alarms.
    pub alarms: u64,
    /// Movements shown, and those never affirmed.
    pub spans: u64,
    /// Movements never affirmed.
    pub missed: u64,
    /// In the order of [`MEASURES`].
    pub measures: [Option<Estimate>; MEASURES.len()],
}

impl Row {
    /// A row of these clips' tallies.
    ///
    /// # Errors
    /// Without clips.
    pub fn of(set: &str, mode: Mode, altered: Altered, tallies: &[Tally]) -> Result<Self> {
        let sum = |of: fn(&Tally) -> u64| tallies.iter().map(of).sum::<u64>();
        Ok(Self {
            set: set.into(),
            mode,
            altered,
            clips: tallies.len(),
            frames: sum(|t| t.frames),
            hours: tallies.iter().map(|t| t.secs).sum::<f64>() / 3600.0,
            alarms: sum(|t| t.alarms),
            spans: sum(|t| t.spans),
            missed: sum(|t| t.missed),
            measures: measures(tallies)?,
        })
    }

    /// One of its measures.
    pub fn measure(&self, which: Measure) -> Option<Estimate> {
        let at = MEASURES.iter().position(|(m, _)| *m == which)?;
        self.measures[at]
    }

    /// False alarms an hour with their interval.
    pub fn alarms_an_hour(&self) -> [f64; 3] {
        let (low, high) = garwood(self.alarms);
        [self.alarms as f64, low, high].map(|n| n / self.hours)
    }
}

/// How long decisions take, microseconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// How is decided.
    pub mode: Mode,
    /// Frames that were timed.
    pub frames: usize,
    /// The median of all five decisions of a frame.
    pub median_us: f64,
    /// What 99 in 100 stay below.
    pub p99_us: f64,
}

/// All of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The names of the behaviours.
    pub behaviors: Vec<String>,
    /// Whether Ares was simulated.
    pub physics: bool,
    /// The table: the three sets, each way of deciding.
    pub rows: Vec<Row>,
    /// The same decided as the paper and exactly, with other numbers of postures and strides; of the third set a part.
    pub grid: Vec<Row>,
    /// Sets two and three with other joints altered.
    pub altered: Vec<Row>,
    /// The first set with noise and lost joints.
    pub damaged: Vec<(String, Row)>,
    /// Movements cut out, played backward, and hybrids: in which share of the frames any behaviour is affirmed.
    pub impossible: Vec<(String, Mode, f64, usize)>,
    /// Recordings that left the third set, by archive and label: in how many of their clips a behaviour is affirmed.
    pub left: Vec<(String, Mode, usize, usize)>,
    /// The files among them.
    pub left_files: Vec<String>,
    /// Times of decisions, where asked for.
    pub timings: Vec<Timing>,
}
