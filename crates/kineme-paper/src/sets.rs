//! Labelled sets of recordings: their classes come from the corpus' index, never from the motion.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use kineme::retargeting::retarget;
use kineme::{Motion, Skeleton};
use kineme_formats::input::{Entry, Inputs, ReadOptions};
use kineme_formats::{FormatError, Place};
use rayon::prelude::*;

/// Motions of one body with their classes.
#[derive(Debug, Clone)]
pub struct LabelledSet {
    /// The motions.
    pub motions: Vec<Motion>,
    /// The class of each motion, an index into `classes`.
    pub labels: Vec<usize>,
    /// Names of the classes, in alphabetical order.
    pub classes: Vec<String>,
}

/// One row of the corpus' index.
#[derive(Debug, Clone)]
pub struct IndexRow {
    /// The archive that holds the file.
    pub archive: String,
    /// The file's path inside it.
    pub file: String,
    /// Its format.
    pub format: String,
    /// Who moves, or in which style.
    pub subject: String,
    /// Its class.
    pub label: String,
    /// Remarks, among them `content=...`.
    pub notes: String,
}

impl IndexRow {
    /// The value of `content=` in the notes, else the label.
    pub fn content(&self) -> &str {
        let note = self.notes.split(';').map(str::trim);
        note.filter_map(|n| n.strip_prefix("content="))
            .next()
            .unwrap_or(&self.label)
    }
}

/// Whatever a corpus cannot give.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// The index of a corpus folder: `index.csv`.
///
/// # Errors
/// When the file is missing or lacks a column.
pub fn index(corpus: &Path) -> Result<Vec<IndexRow>> {
    let path = corpus.join("index.csv");
    let shown = path.display().to_string();
    let mut reader = csv::Reader::from_path(&path).map_err(|e| {
        FormatError::new(&shown, Place::File, e.to_string(), "the index of a corpus")
    })?;
    let headers = reader.headers()?.clone();
    let column = |name: &str| {
        headers.iter().position(|h| h == name).ok_or_else(|| {
            let found: Vec<&str> = headers.iter().collect();
            let wanted = format!("a column `{name}`");
            FormatError::new(&shown, Place::Line(1), found.join(","), wanted)
        })
    };
    let columns = [
        column("archive")?,
        column("file")?,
        column("format")?,
        column("subject")?,
        column("label")?,
        column("notes")?,
    ];
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        let [archive, file, format, subject, label, notes] =
            columns.map(|c| record.get(c).unwrap_or_default().to_string());
        rows.push(IndexRow {
            archive,
            file,
            format,
            subject,
            label,
            notes,
        });
    }
    Ok(rows)
}

/// The motions of these rows, retargeted to `body`, with the class that `class` reads off each row. `asf` serves AMC
/// files that have no skeleton beside them.
///
/// # Errors
/// When a file is not in the corpus, cannot be read or cannot be retargeted.
pub fn load(
    corpus: &Path,
    rows: &[&IndexRow],
    body: &Arc<Skeleton>,
    asf: Option<&str>,
    class: &(dyn Fn(&IndexRow) -> String + Sync),
) -> Result<LabelledSet> {
    let options = ReadOptions {
        asf: asf.map(|a| corpus.join(a)),
        ..ReadOptions::default()
    };
    let mut archives: Vec<&str> = rows.iter().map(|r| r.archive.as_str()).collect();
    archives.sort_unstable();
    archives.dedup();
    let paths: Vec<_> = archives.iter().map(|a| corpus.join(a)).collect();
    let inputs = Inputs::resolve(&paths, &options)?;
    let entries: BTreeMap<&str, &Entry> = inputs
        .entries
        .iter()
        .filter_map(|e| Some((e.name().split_once(".zip/")?.1, e)))
        .collect();
    let read = |row: &&IndexRow| -> Result<(Motion, String)> {
        let entry = entries.get(row.file.as_str()).ok_or_else(|| {
            FormatError::new(
                &row.file,
                Place::File,
                "no such file",
                "the file in its archive",
            )
        })?;
        Ok((retarget(&entry.read()?, body, None)?.motion, class(row)))
    };
    let loaded: Vec<(Motion, String)> = rows.par_iter().map(read).collect::<Result<_>>()?;
    let mut classes: BTreeMap<String, usize> = BTreeMap::new();
    for (_, class) in &loaded {
        classes.entry(class.clone()).or_default();
    }
    for (i, value) in classes.values_mut().enumerate() {
        *value = i;
    }
    let (motions, names): (Vec<Motion>, Vec<String>) = loaded.into_iter().unzip();
    Ok(LabelledSet {
        labels: names.iter().map(|n| classes[n]).collect(),
        classes: classes.into_keys().collect(),
        motions,
    })
}
