//! Zip archives as folders: listed when they are met, their entries unpacked one at a time.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::detect::{Kind, by_extension};
use crate::error::{FormatError, Place, Result};

/// Motion as text shrinks 3 to 30 times; what claims to shrink more than this and is large is a bomb.
const MOST_SHRINKING: u64 = 200;
/// What an entry may unpack to however small it is, bytes.
const ALWAYS_ALLOWED: u64 = 16 << 20;
/// Archives kept open between reads.
const KEPT_OPEN: usize = 16;

/// A file in an archive.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    /// Its path inside, with `/`.
    pub(super) path: String,
    index: usize,
}

/// An archive and the files in it, sorted by path.
#[derive(Debug)]
pub(super) struct Archive {
    path: PathBuf,
    pub(super) files: Vec<Packed>,
    /// Which of them are ASF skeletons.
    pub(super) skeletons: Vec<usize>,
}

type Handle = (PathBuf, ZipArchive<BufReader<File>>);

/// Archives that are open, so that readers on many threads need not list them again.
#[derive(Debug, Default)]
pub(super) struct Handles(Mutex<Vec<Handle>>);

impl Archive {
    /// Lists an archive.
    pub(super) fn list(path: &Path, shown: &str, handles: &Handles) -> Result<Self> {
        let mut files: Vec<Packed> = handles.with(path, shown, |zip| {
            Ok(zip
                .file_names()
                .enumerate()
                .filter(|(_, name)| !name.ends_with('/'))
                .map(|(index, name)| Packed {
                    path: name.replace('\\', "/"),
                    index,
                })
                .collect())
        })?;
        files.sort_by(|a, b| a.path.cmp(&b.path));
        let skeletons = (0..files.len())
            .filter(|&i| by_extension(&files[i].path) == Some(Kind::Asf))
            .collect();
        Ok(Self {
            path: path.into(),
            files,
            skeletons,
        })
    }

    /// Unpacks a file, or its first `most` bytes.
    pub(super) fn unpack(
        &self,
        file: &Packed,
        shown: &str,
        most: Option<u64>,
        handles: &Handles,
    ) -> Result<Vec<u8>> {
        let (bytes, allowed) = handles.with(&self.path, shown, |zip| {
            let entry = zip.by_index(file.index)?;
            let allowed = entry
                .compressed_size()
                .saturating_mul(MOST_SHRINKING)
                .max(ALWAYS_ALLOWED);
            let mut bytes = Vec::new();
            entry
                .take(most.unwrap_or(allowed.saturating_add(1)))
                .read_to_end(&mut bytes)?;
            Ok((bytes, allowed))
        })?;
        if bytes.len() as u64 > allowed {
            return Err(FormatError::new(
                shown,
                Place::File,
                format!("an entry that unpacks to more than {allowed} bytes"),
                format!("at most {MOST_SHRINKING} times its packed size"),
            ));
        }
        Ok(bytes)
    }
}

impl Handles {
    fn with<T>(
        &self,
        path: &Path,
        shown: &str,
        work: impl FnOnce(&mut ZipArchive<BufReader<File>>) -> std::result::Result<T, ZipError>,
    ) -> Result<T> {
        let failed = |e: ZipError| {
            let found = match &e {
                ZipError::Io(e) => crate::told(e),
                // Its table of contents stands at its end.
                ZipError::InvalidArchive(_) => "an archive that is damaged or was cut off".into(),
                other => other.to_string(),
            };
            FormatError::new(shown, Place::File, found, "a readable zip archive")
        };
        let kept = {
            let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let at = open.iter().position(|(p, _)| p == path);
            at.map(|at| open.swap_remove(at).1)
        };
        let mut zip = match kept {
            Some(zip) => zip,
            None => {
                let file = File::open(path).map_err(|e| failed(e.into()))?;
                ZipArchive::new(BufReader::new(file)).map_err(failed)?
            }
        };
        let done = work(&mut zip).map_err(failed)?;
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if open.len() >= KEPT_OPEN {
            open.remove(0);
        }
        open.push((path.into(), zip));
        Ok(done)
    }
}
