//! Manifests: from labelled files and spans of files to exemplars.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kineme::{Exemplar, Motion, Provenance, Skeleton};
use kineme_formats::input::Entry;
use kineme_formats::manifest::{self, Labelled};
use kineme_formats::{FormatError, Place};

use crate::args::ReadArgs;
use crate::failure::{Failure, complain};
use crate::source::{Read, Source, print_warnings};
use crate::vocabularies::read_bytes;

/// A manifest and where its files lie.
pub struct Manifest {
    name: String,
    /// The rows that are looked at.
    rows: Vec<Labelled>,
    root: PathBuf,
}

/// An exemplar and what the manifest says of it.
pub struct Example {
    /// The primitive that it belongs to; empty for a negative.
    pub label: String,
    /// The movement.
    pub exemplar: Exemplar,
    /// The row, as messages name it: `labels.csv:7`.
    pub place: String,
}

/// What came of a file: exemplars with the index of their row.
struct Taken {
    examples: Vec<(usize, Exemplar)>,
    failures: Vec<Failure>,
    motion: String,
    warnings: Vec<String>,
}

impl Manifest {
    /// Reads a manifest for its exemplars; its files lie in `root`, else beside it. Rows without a label are passed over.
    pub fn open(path: &Path, root: Option<&Path>) -> Result<Self, Failure> {
        let mut manifest = Self::open_with_negatives(path, root)?;
        let all = manifest.rows.len();
        manifest.rows.retain(|row| row.label.is_some());
        if manifest.rows.is_empty() {
            let found = format!("{all} rows without a label");
            let expected = "labels: the names of primitives";
            return Err(FormatError::new(&manifest.name, Place::File, found, expected).into());
        }
        match all - manifest.rows.len() {
            0 => {}
            1 => complain("note: 1 row has no label: a negative, no exemplar, and ignored here"),
            n => complain(&format!(
                "note: {n} rows have no label: negatives, no exemplars, and ignored here"
            )),
        }
        Ok(manifest)
    }

    /// As [`Self::open`], with the rows that have no label.
    pub fn open_with_negatives(path: &Path, root: Option<&Path>) -> Result<Self, Failure> {
        let (name, bytes) = read_bytes(path, "a readable manifest")?;
        let rows = manifest::parse(&name, &bytes)?;
        let beside = || path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self {
            name,
            rows,
            root: root.map_or_else(beside, Path::to_owned),
        })
    }

    /// The labels, in the order in which they first appear.
    pub fn labels(&self) -> Vec<&str> {
        let mut labels: Vec<&str> = Vec::new();
        for label in self.rows.iter().filter_map(|r| r.label.as_deref()) {
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        labels
    }

    /// The rows of a label.
    pub fn rows_of<'a>(&'a self, label: &'a str) -> impl Iterator<Item = &'a Labelled> {
        let of = move |row: &&Labelled| row.label.as_deref() == Some(label);
        self.rows.iter().filter(of)
    }

    /// How messages name a row.
    pub fn place(&self, row: &Labelled) -> String {
        format!("{}:{}", self.name, row.line)
    }

    /// Reads every file once, on all threads, and cuts its exemplars out, in the order of the rows.
    pub fn examples(
        &self,
        body: &Arc<Skeleton>,
        args: &ReadArgs,
    ) -> Result<Read<Example>, Failure> {
        let files = self.files();
        let paths: Vec<(PathBuf, Option<f64>)> = files
            .iter()
            .map(|rows| {
                let row = &self.rows[rows[0]];
                (self.located(&row.file), row.rate_hz)
            })
            .collect();
        let (source, entries) = Source::one_by_one(&paths, args)?;
        let mut read = source.each(&entries, "reading", |i, entry| {
            self.taken(&files[i], entry, &source, body, args.keep_going)
        });
        print_warnings(
            read.items
                .iter()
                .map(|t| (t.motion.as_str(), t.warnings.as_slice())),
        );
        let mut cut = Vec::new();
        for taken in std::mem::take(&mut read.items) {
            cut.extend(taken.examples);
            read.failures.extend(taken.failures);
        }
        cut.sort_by_key(|(row, _)| *row);
        let examples = cut.into_iter().map(|(row, exemplar)| {
            let row = &self.rows[row];
            Example {
                label: row.label.clone().unwrap_or_default(),
                exemplar,
                place: self.place(row),
            }
        });
        read.with(examples.collect(), self.rows.len())
            .unless_failed()
    }

    /// The rows of each file, in the order in which files first appear.
    fn files(&self) -> Vec<Vec<usize>> {
        let mut of: BTreeMap<&str, usize> = BTreeMap::new();
        let mut files: Vec<Vec<usize>> = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let file = *of.entry(&row.file).or_insert_with(|| {
                files.push(Vec::new());
                files.len() - 1
            });
            files[file].push(i);
        }
        files
    }

    /// Where a file lies, without `.` and doubled separators, as inputs are named.
    fn located(&self, file: &str) -> PathBuf {
        self.root.join(file).components().collect()
    }

    /// The exemplars of one file; the first failure, or all of them beside the exemplars where work is to go on.
    fn taken(
        &self,
        rows: &[usize],
        entry: &Result<Entry, FormatError>,
        source: &Source,
        body: &Arc<Skeleton>,
        keep_going: bool,
    ) -> Result<Taken, Failure> {
        let at = |row: usize| self.place(&self.rows[row]);
        let read = || {
            let entry = entry.as_ref().map_err(|e| Failure::from(e.clone()))?;
            let (recording, blake3) = source.read_hashed(entry)?;
            let (motion, warnings) = source.retarget(&recording, body)?;
            Ok((motion, blake3, warnings))
        };
        let (motion, blake3, warnings) = read().map_err(|f: Failure| f.at(&at(rows[0])))?;
        let mut taken = Taken {
            examples: Vec::new(),
            failures: Vec::new(),
            motion: self.rows[rows[0]].file.clone(),
            warnings,
        };
        for &i in rows {
            let row = &self.rows[i];
            let cut = self
                .frames(row, &motion)
                .map_err(Failure::from)
                .and_then(|frames| Ok(exemplar(row, &motion, frames, &blake3)?));
            match cut {
                Ok(exemplar) => taken.examples.push((i, exemplar)),
                Err(failure) if keep_going => taken.failures.push(failure),
                Err(failure) => return Err(failure),
            }
        }
        Ok(taken)
    }

    /// The frames that a row speaks of.
    fn frames(&self, row: &Labelled, motion: &Motion) -> Result<Range<usize>, FormatError> {
        let rate = motion.rate_hz();
        let lasts = motion.frames() as f64 / rate;
        let (start, end) = row.span_secs.unwrap_or((0.0, lasts));
        let frames = (start * rate).round() as usize..(end * rate).round() as usize;
        if end > lasts + 1.0 / rate || frames.start >= motion.frames() {
            return Err(FormatError::new(
                &self.name,
                Place::Line(row.line),
                format!("{start} s to {end} s"),
                format!("a span of `{}`, which lasts {lasts:.3} s", row.file),
            ));
        }
        let frames = frames.start..frames.end.min(motion.frames());
        if frames.len() < 2 {
            return Err(FormatError::new(
                &self.name,
                Place::Line(row.line),
                format!("{} frames of `{}` at {rate} Hz", frames.len(), row.file),
                "a movement: at least two frames",
            ));
        }
        Ok(frames)
    }
}

/// The exemplar that a row makes of a motion. It is named as the manifest names it, wherever that lies.
fn exemplar(
    row: &Labelled,
    motion: &Motion,
    frames: Range<usize>,
    blake3: &str,
) -> kineme::Result<Exemplar> {
    let rate = motion.rate_hz();
    let part = motion.slice(frames.clone())?;
    Ok(Exemplar {
        motion: Motion::new(
            row.file.as_str(),
            Arc::clone(motion.skeleton()),
            rate,
            part.poses().to_vec(),
            part.roots().to_vec(),
        )?,
        provenance: Provenance {
            motion: row.file.clone(),
            start_secs: frames.start as f64 / rate,
            end_secs: frames.end as f64 / rate,
            blake3: Some(blake3.into()),
        },
        adverbs: (!row.parameters.is_empty()).then(|| row.parameters.clone()),
    })
}
