//! [`calibrated`]: what recognisers learn of a vocabulary by leaving exemplars out, fitted and kept with it.

use super::encoding::Encoder;
use super::filter::Filter;
use crate::error::Result;
use crate::primitive::{Calibration, Primitive, Vocabulary};

/// The vocabulary with what every recogniser learns of it, fitted by leaving exemplars out.
///
/// `before` is the vocabulary that it was made from. A primitive with the same exemplars and the same fit, whatever its
/// name, keeps its numbers; those of others and those of the whole are fitted anew. Where all primitives stayed, nothing
/// is fitted. Numbers that an earlier build kept, and that mean something else by now, are fitted anew. A recogniser that
/// cannot watch the body learns nothing.
///
/// # Errors
/// When a recogniser cannot be fitted.
pub fn calibrated(vocabulary: Vocabulary, before: Option<&Vocabulary>) -> Result<Vocabulary> {
    if vocabulary.primitives().is_empty() {
        return Ok(vocabulary);
    }
    let known = |recogniser: &str| Some((before?, before?.calibration(recogniser)?));
    let of_filter = known("filter").filter(|(_, c)| Filter::understands(c));
    let mut learned = vec![learn(Filter::calibration, &vocabulary, of_filter)?];
    if Encoder::can_watch(vocabulary.body()) {
        let of_encoder = known("encoder").filter(|(_, c)| Encoder::understands(c));
        learned.push(learn(Encoder::calibration, &vocabulary, of_encoder)?);
    }
    let mut all = learned.into_iter();
    all.try_fold(vocabulary, Vocabulary::calibrated)
}

/// How a recogniser learns, with numbers of primitives that it is to keep.
type Learn = fn(&Vocabulary, &[Option<Vec<f64>>]) -> Result<Calibration>;

/// What a recogniser learns of a vocabulary beyond what it knew of the one before.
fn learn(
    learn: Learn,
    vocabulary: &Vocabulary,
    known: Option<(&Vocabulary, &Calibration)>,
) -> Result<Calibration> {
    let Some((before, known)) = known else {
        return learn(vocabulary, &[]);
    };
    let places = places(vocabulary, before);
    let all = 0..before.primitives().len();
    let all_stayed = places.iter().copied().eq(all.map(Some));
    if all_stayed && vocabulary.transitions() == before.transitions() {
        return Ok(known.clone());
    }
    let numbers = |place: &Option<usize>| place.map(|i| known.primitives[i].clone());
    let kept: Vec<Option<Vec<f64>>> = places.iter().map(numbers).collect();
    learn(vocabulary, &kept)
}

/// Where each primitive was before, under its own name if it can be; `None` for those that changed.
fn places(vocabulary: &Vocabulary, before: &Vocabulary) -> Vec<Option<usize>> {
    let place = |p: &Primitive| {
        let stayed = |q: &Primitive| p.exemplars() == q.exemplars() && p.fitted() == q.fitted();
        let old = before.primitives();
        let named = old.iter().position(|q| q.name() == p.name() && stayed(q));
        named.or_else(|| old.iter().position(stayed))
    };
    vocabulary.primitives().iter().map(place).collect()
}
