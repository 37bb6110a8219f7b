//! `--input-rate HZ` and `--input-rate FORMAT=HZ,...`.

use std::str::FromStr;

use kineme::Error;

use crate::detect::Kind;

/// Formats without a time base of their own.
const RATELESS: [Kind; 3] = [Kind::Amc, Kind::Positions, Kind::Msr];

/// Frames a second of the formats that do not say it themselves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InputRates {
    every: Option<f64>,
    by_kind: Vec<(Kind, f64)>,
}

impl InputRates {
    /// The rate given for a format, Hz; `None` where none was, or where files of it say their own.
    pub fn of(&self, kind: Kind) -> Option<f64> {
        if !RATELESS.contains(&kind) {
            return None;
        }
        let own = self.by_kind.iter().rev().find(|(k, _)| *k == kind);
        own.map(|(_, hz)| *hz).or(self.every)
    }
}

impl FromStr for InputRates {
    type Err = Error;

    /// Reads `HZ`, or `FORMAT=HZ` separated by commas with the formats `amc`, `positions` and `msr`.
    fn from_str(text: &str) -> kineme::Result<Self> {
        let hertz = |word: &str| {
            let value: Option<f64> = word.trim().parse().ok();
            value
                .filter(|hz| hz.is_finite() && *hz > 0.0)
                .ok_or_else(|| {
                    Error::invalid(format!("`{word}` is no rate: expected hertz above zero"))
                })
        };
        let mut rates = Self::default();
        for part in text.split(',') {
            match part.split_once('=') {
                None => rates.every = Some(hertz(part)?),
                Some((name, value)) => {
                    let name = name.trim().to_ascii_lowercase();
                    let kind =
                        RATELESS
                            .into_iter()
                            .find(|k| k.name() == name)
                            .ok_or_else(|| {
                                let known = RATELESS.map(Kind::name);
                                Error::unknown_name("format without a time base", &name, known)
                            })?;
                    rates.by_kind.push((kind, hertz(value)?));
                }
            }
        }
        Ok(rates)
    }
}
