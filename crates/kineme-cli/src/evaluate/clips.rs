//! The clips that are judged.

use std::collections::BTreeMap;

use kineme::primitive::Observations;
use kineme::{Error, Primitive, Provenance, Vocabulary};

use crate::args::EvaluateArgs;
use crate::failure::{Failure, complain};
use crate::labelled::Manifest;
use crate::source::Read;

/// A motion, or a span of one, and what it is.
pub(super) struct Clip {
    /// The primitive; `None`: none of them.
    pub truth: Option<usize>,
    pub seen: Observations,
    /// Whether it is, or overlaps, an exemplar of the vocabulary.
    pub is_exemplar: bool,
}

/// Reads the clips of the manifest; labels are those of the vocabulary.
pub(super) fn clips(vocabulary: &Vocabulary, args: &EvaluateArgs) -> Result<Read<Clip>, Failure> {
    let manifest = Manifest::open_with_negatives(&args.manifest, args.root.as_deref())?;
    let names: Vec<&str> = vocabulary
        .primitives()
        .iter()
        .map(Primitive::name)
        .collect();
    let unknown: Vec<&str> = manifest
        .labels()
        .into_iter()
        .filter(|label| !names.contains(label))
        .collect();
    if let Some(&label) = unknown.first() {
        check_unknown(&manifest, &names, label, args.unknown_as_negative)?;
        let quoted: Vec<String> = unknown.iter().map(|label| format!("`{label}`")).collect();
        let list = quoted.join(", ");
        complain(&format!(
            "note: taken as negatives, as none of the primitives: {list}"
        ));
    }
    let mut read = manifest.examples(vocabulary.body(), &args.read)?;
    let exemplars = Exemplars::of(vocabulary);
    let mut tested = Vec::new();
    let examples = std::mem::take(&mut read.items);
    let clips: Vec<Clip> = examples
        .into_iter()
        .map(|example| {
            let is_exemplar = exemplars.overlap(&example.exemplar.provenance);
            if is_exemplar {
                tested.push(example.place);
            }
            Clip {
                truth: names.iter().position(|name| *name == example.label),
                seen: Observations::complete(example.exemplar.motion),
                is_exemplar,
            }
        })
        .collect();
    if let Some(first) = tested.first() {
        complain(&format!(
            "warning: {} of {} clips are exemplars of the vocabulary or overlap them, {first} for one: \
             to recognise what was learned is no achievement",
            tested.len(),
            clips.len()
        ));
    }
    let of = read.of;
    Ok(read.with(clips, of))
}

/// Refuses a label that is no primitive, unless it is to be a negative.
fn check_unknown(
    manifest: &Manifest,
    names: &[&str],
    label: &str,
    as_negative: bool,
) -> Result<(), Failure> {
    if as_negative {
        return Ok(());
    }
    let error = Error::unknown_name("primitive", label, names.iter().copied());
    let failure = Failure::failed(error.to_string())
        .hint("an empty label means none of these, a negative; --unknown-as-negative takes such labels so");
    let row = manifest.rows_of(label).next();
    Err(match row {
        Some(row) => failure.at(&manifest.place(row)),
        None => failure,
    })
}

/// Where a vocabulary's exemplars come from: spans (seconds) of files, by the BLAKE3 of these.
struct Exemplars<'a>(BTreeMap<&'a str, Vec<(f64, f64)>>);

impl<'a> Exemplars<'a> {
    fn of(vocabulary: &'a Vocabulary) -> Self {
        let mut spans: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
        for exemplar in vocabulary
            .primitives()
            .iter()
            .flat_map(Primitive::exemplars)
        {
            let from = &exemplar.provenance;
            if let Some(hash) = &from.blake3 {
                let span = (from.start_secs, from.end_secs);
                spans.entry(hash).or_default().push(span);
            }
        }
        Self(spans)
    }

    fn overlap(&self, clip: &Provenance) -> bool {
        let spans = clip.blake3.as_deref().and_then(|hash| self.0.get(hash));
        let overlaps = |&(start, end): &(f64, f64)| start < clip.end_secs && clip.start_secs < end;
        spans.is_some_and(|spans| spans.iter().any(overlaps))
    }
}
