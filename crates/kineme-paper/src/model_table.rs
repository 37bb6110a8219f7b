//! The tables of `docs/model.md`: primitives of real people, judged on exemplars that were left out.

use std::path::Path;
use std::sync::Arc;

use crate::interpolation_table::interpolation_tables;
use crate::sets::{IndexRow, LabelledSet, Result, index, load};

/// The sets whose classes are judged: name, archive, format, and whether the class is the finer content.
const SETS: [(&str, &str, &str, bool); 2] = [
    ("HDM05", "hdm05.zip", "amc", false),
    ("Bandai-Namco 2", "bandai-namco-2.zip", "bvh", true),
];

/// Judges every class of both sets and writes what came of it, as Markdown. `watch` is told what is being done.
///
/// # Errors
/// When the corpus lacks a file or a model cannot be made.
pub fn model_tables(corpus: &Path, watch: &mut dyn FnMut(&str)) -> Result<String> {
    let mut out = String::new();
    for (name, set) in sets(corpus, watch)? {
        watch(&format!("{name}: interpolation"));
        interpolation_tables(&mut out, name, &set)?;
    }
    Ok(out)
}

/// The sets that are judged, every file a clip of the body `ares`.
///
/// # Errors
/// When the corpus lacks a file.
pub fn sets(
    corpus: &Path,
    watch: &mut dyn FnMut(&str),
) -> Result<Vec<(&'static str, LabelledSet)>> {
    let rows = index(corpus)?;
    let body = Arc::new(kineme::ares()?);
    let mut sets = Vec::new();
    for (name, archive, format, content) in SETS {
        watch(name);
        let of = |r: &&IndexRow| r.archive == archive && r.format == format;
        let picked: Vec<&IndexRow> = rows.iter().filter(of).collect();
        let class = |r: &IndexRow| match content {
            true => r.content().to_string(),
            false => r.label.clone(),
        };
        sets.push((name, load(corpus, &picked, &body, None, &class)?));
    }
    Ok(sets)
}
