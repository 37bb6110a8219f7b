//! Settings within their ranges.

use crate::error::{Error, Result};

/// Refuses counts outside of their ranges: name, value, least, most.
pub(super) fn counts(all: &[(&str, usize, usize, usize)]) -> Result<()> {
    for &(name, value, least, most) in all {
        if !(least..=most).contains(&value) {
            return Err(Error::invalid(format!(
                "{name} must lie in {least} to {most}, found {value}"
            )));
        }
    }
    Ok(())
}

/// Refuses numbers that are not finite and positive.
pub(super) fn positive(all: &[(&str, f64)]) -> Result<()> {
    let wrong = all.iter().find(|(_, v)| !(v.is_finite() && *v > 0.0));
    wrong.map_or(Ok(()), |(name, v)| {
        Err(Error::invalid(format!(
            "{name} must be positive, found {v}"
        )))
    })
}

/// Refuses numbers that are not finite or negative.
pub(super) fn not_negative(all: &[(&str, f64)]) -> Result<()> {
    let wrong = all.iter().find(|(_, v)| !(v.is_finite() && *v >= 0.0));
    wrong.map_or(Ok(()), |(name, v)| {
        Err(Error::invalid(format!(
            "{name} must be 0 or more, found {v}"
        )))
    })
}
