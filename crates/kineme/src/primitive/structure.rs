//! What kind of movement a group is: a stroke or a cycle, and which exemplars are of another kind.

use super::exemplar::Exemplar;
use super::modelling::{Modelling, Used};
use crate::alignment::Registered;
use crate::error::Result;

pub(super) fn cycles(
    _name: &str,
    _exemplars: &[Exemplar],
    _landmarks: &[Vec<f64>],
    trimmed: Vec<Used>,
    modelling: &Modelling,
    _notes: &mut Vec<String>,
) -> Result<(bool, Vec<Used>)> {
    Ok((modelling.cyclic.unwrap_or(false), trimmed))
}

pub(super) fn mismatched(
    _exemplars: &[Exemplar],
    _sequences: &[Vec<f64>],
    _registered: &Registered,
    _cyclic: bool,
) -> Vec<(usize, String)> {
    Vec::new()
}
