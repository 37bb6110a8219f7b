//! Figures of others' programs on the same splits, computed once by `peers/minirocket.py`.

use crate::sets::Result;

/// What the script printed: row, measure, value, versions and date.
const MINIROCKET: &str = include_str!("../../peers/minirocket.csv");

/// Figures of MiniRocket (Dempster, Schmidt and Webb 2021).
#[derive(Debug, Clone, PartialEq)]
pub struct Peers {
    rows: Vec<(String, f64)>,
    /// Versions and date of the run.
    pub made_by: String,
}

impl Peers {
    /// The figures that are kept with the sources.
    ///
    /// # Errors
    /// When the table lacks a column or a number.
    pub fn kept() -> Result<Self> {
        let mut reader = csv::Reader::from_reader(MINIROCKET.as_bytes());
        let mut peers = Self {
            rows: Vec::new(),
            made_by: String::new(),
        };
        for record in reader.records() {
            let record = record?;
            let cell = |i: usize| record.get(i).ok_or("a row of the peers' table is short");
            peers.rows.push((cell(0)?.to_string(), cell(1)?.parse()?));
            peers.made_by = cell(2)?.to_string();
        }
        Ok(peers)
    }

    /// The figure of a row, named as in our tables.
    pub fn value(&self, row: &str) -> Option<f64> {
        let found = self.rows.iter().find(|(name, _)| name == row);
        found.map(|(_, value)| *value)
    }
}
