//! The tables of `docs/model.md`: primitives of real people, judged on exemplars that were left out.

use std::path::Path;
use std::sync::Arc;

use kineme::primitive::{FlowSettings, Modelling};
use rayon::prelude::*;

use crate::flow_table::{Followed, follow, write_flow};
use crate::interpolation_table::write_interpolation;
use crate::models::{Fold, Judged, folds, judge, learn};
use crate::out_and_back::out_and_back_table;
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
        watch(&format!(
            "{name}: {} clips left out in turn",
            set.motions.len()
        ));
        let (judged, followed) = left_out(&set, &folds(&set))?;
        write_interpolation(&mut out, name, &set.classes, &judged)?;
        write_flow(&mut out, name, &set.classes, &followed)?;
    }
    watch("out and back");
    out_and_back_table(&mut out)?;
    Ok(out)
}

/// Learns the primitive of each fold, several at a time, and judges it by the clip that was left out.
///
/// # Errors
/// When a model cannot be made, or a clip not registered to it.
pub fn left_out(set: &LabelledSet, folds: &[Fold]) -> Result<(Vec<Judged>, Vec<Followed>)> {
    let one = |fold: &Fold| {
        let primitive = learn(set, fold, &Modelling::default())?;
        let judged = judge(set, fold, &primitive)?;
        Ok((
            judged,
            follow(set, fold, &primitive, &FlowSettings::default())?,
        ))
    };
    let both: Vec<(Judged, Followed)> = folds.par_iter().map(one).collect::<Result<_>>()?;
    Ok(both.into_iter().unzip())
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
