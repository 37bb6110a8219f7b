//! [`calibrated`]: what recognisers learn of a vocabulary by leaving exemplars out, fitted and kept with it.

use super::encoding::Encoder;
use crate::error::Result;
use crate::primitive::{Calibration, Primitive, Vocabulary};

/// The vocabulary with what every recogniser learns of it, fitted by leaving exemplars out.
///
/// `before` is the vocabulary that it was made from. A primitive with the same exemplars and the same fit, whatever its
/// name, keeps its numbers; those of others and those of the whole are fitted anew. Where all primitives stayed, nothing
/// is fitted. A recogniser that cannot watch the body learns nothing.
///
/// # Errors
/// When a recogniser cannot be fitted.
pub fn calibrated(vocabulary: Vocabulary, before: Option<&Vocabulary>) -> Result<Vocabulary> {
    if vocabulary.primitives().is_empty() {
        return Ok(vocabulary);
    }
    let mut learned = Vec::new();
    if Encoder::can_watch(vocabulary.body()) {
        learned.push(learn("encoder", Encoder::calibration, &vocabulary, before)?);
    }
    let mut all = learned.into_iter();
    all.try_fold(vocabulary, Vocabulary::calibrated)
}

/// How a recogniser learns; empty rows of what is kept are of primitives that changed.
type Learn = fn(&Vocabulary, Option<&Calibration>) -> Result<Calibration>;

/// What a recogniser learns of a vocabulary beyond what it knew before.
fn learn(
    recogniser: &str,
    learn: Learn,
    vocabulary: &Vocabulary,
    before: Option<&Vocabulary>,
) -> Result<Calibration> {
    let known = before.and_then(|b| Some((b, b.calibration(recogniser)?)));
    let Some((before, known)) = known else {
        return learn(vocabulary, None);
    };
    let places = places(vocabulary, before);
    let of = |place: &Option<usize>| place.map_or(Vec::new(), |i| known.primitives[i].clone());
    let kept = Calibration {
        primitives: places.iter().map(of).collect(),
        ..known.clone()
    };
    let count = before.primitives().len();
    let all_stayed = places.iter().copied().eq((0..count).map(Some))
        && vocabulary.transitions() == before.transitions();
    if all_stayed {
        return Ok(kept);
    }
    learn(vocabulary, Some(&kept))
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
