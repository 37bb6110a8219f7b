//! INPUT of every verb: files, folders and archives, as an ordered list of motions.
//!
//! `-` is standard input, read once. Folders are walked depth first, their names in byte order, without hidden files; `.zip` archives act as folders,
//! and `set.zip/inner/walk.bvh` names one motion in one. What is no motion format is ignored and counted. What
//! means to be a motion and cannot be read becomes an entry whose reading tells why, so that callers decide whether
//! to stop.

mod archive;
mod rates;
mod walk;

pub use rates::InputRates;

use std::collections::BTreeSet;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use archive::{Archive, Handles};
use kineme::{Recording, Skeleton};
use walk::Walk;

use crate::detect::{self, Kind};
use crate::error::{FormatError, Place, Result};
use crate::tables::observed::{self, Observed};

/// What people say about input that files do not.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// The skeleton of AMC files that find none beside them; may lie in an archive.
    pub asf: Option<PathBuf>,
    /// Rates of formats without a time base.
    pub rates: InputRates,
}

/// The motions of INPUT, in order.
#[derive(Debug)]
pub struct Inputs {
    /// What can be read, or tells why not.
    pub entries: Vec<Entry>,
    /// Files met in folders and archives that are no motion format.
    pub ignored: usize,
    /// What had to be assumed, one sentence a format.
    pub warnings: Vec<String>,
}

/// One motion; reading it touches nothing that other threads use.
#[derive(Debug, Clone)]
pub struct Entry {
    name: String,
    kind: Option<Kind>,
    place: Location,
    skeleton: Option<(String, Location)>,
    rate_hz: Option<f64>,
    handles: Arc<Handles>,
}

/// Where bytes are.
#[derive(Debug, Clone)]
enum Location {
    File(PathBuf),
    Packed(Arc<Archive>, usize),
    /// In memory: standard input.
    Held(Arc<[u8]>),
    /// Nowhere: why.
    Lost(FormatError),
}

impl Entry {
    /// The motion's name, as given or as found: `set.zip/inner/a.bvh`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its format; `None` when it is not even known.
    pub fn kind(&self) -> Option<Kind> {
        self.kind
    }

    /// Reads the motion.
    ///
    /// # Errors
    /// When the file cannot be read or is no sound motion, naming file and place.
    pub fn read(&self) -> Result<Recording> {
        self.parse(&self.place.bytes(&self.name, None, &self.handles)?)
    }

    /// Reads the motion, and tells the BLAKE3 of its file: 64 lower-case hexadecimal digits.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_hashed(&self) -> Result<(Recording, String)> {
        let bytes = self.place.bytes(&self.name, None, &self.handles)?;
        let hash = blake3::hash(&bytes).to_hex().to_string();
        Ok((self.parse(&bytes)?, hash))
    }

    /// Reads a joint-angle table of this body, with what was missing in it; `None` of everything else.
    ///
    /// # Errors
    /// When the file cannot be read or is no sound table, naming file and place.
    pub fn read_observed(&self, body: &Arc<Skeleton>) -> Result<Option<Observed>> {
        if self.kind != Some(Kind::Angles) {
            return Ok(None);
        }
        let bytes = self.place.bytes(&self.name, None, &self.handles)?;
        observed::parse(&self.name, &bytes, body)
    }

    fn parse(&self, bytes: &[u8]) -> Result<Recording> {
        let Some(kind) = self.kind else {
            let (found, expected) = detect::unknown(bytes);
            return Err(FormatError::new(&self.name, Place::File, found, expected));
        };
        let skeleton = match (&self.skeleton, kind) {
            (Some((name, place)), _) => Some(crate::asf::parse(
                name,
                &place.bytes(name, None, &self.handles)?,
            )?),
            (None, Kind::Amc) => {
                return Err(FormatError::new(
                    &self.name,
                    Place::File,
                    "no ASF for it beside it",
                    "its skeleton: same name, a name that begins its own, the only one there, or one given with `--asf`",
                ));
            }
            (None, _) => None,
        };
        detect::parse(kind, &self.name, bytes, self.rate_hz, skeleton.as_ref())
    }
}

impl Entry {
    /// Why nothing is there, where that is known before it is read.
    pub fn lost(&self) -> Option<&FormatError> {
        match &self.place {
            Location::Lost(why) => Some(why),
            _ => None,
        }
    }
}

impl Location {
    /// All bytes, or the first `most`.
    fn bytes(&self, shown: &str, most: Option<usize>, handles: &Handles) -> Result<Vec<u8>> {
        let most = most.map(|n| n as u64);
        match self {
            Location::File(path) => {
                let mut bytes = Vec::new();
                std::fs::File::open(path)
                    .and_then(|file| file.take(most.unwrap_or(u64::MAX)).read_to_end(&mut bytes))
                    .map_err(|e| lost(shown, crate::told(&e), "a readable file"))?;
                Ok(bytes)
            }
            Location::Packed(archive, file) => {
                archive.unpack(&archive.files[*file], shown, most, handles)
            }
            Location::Held(bytes) => {
                let most = most.map_or(bytes.len(), |n| bytes.len().min(n as usize));
                Ok(bytes[..most].to_vec())
            }
            Location::Lost(why) => Err(why.clone()),
        }
    }

    /// The last `most` bytes, or all where there are fewer.
    fn end(&self, shown: &str, most: usize, handles: &Handles) -> Result<Vec<u8>> {
        let Location::File(path) = self else {
            let mut bytes = self.bytes(shown, None, handles)?;
            return Ok(bytes.split_off(bytes.len().saturating_sub(most)));
        };
        let read = || {
            let mut file = std::fs::File::open(path)?;
            let length = file.metadata()?.len();
            file.seek(SeekFrom::Start(length.saturating_sub(most as u64)))?;
            let mut bytes = Vec::new();
            file.take(most as u64).read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        read().map_err(|e| lost(shown, crate::told(&e), "a readable file"))
    }
}

impl Inputs {
    /// Lists the motions of files, folders and archives, in the order given. Nothing is parsed yet; of files whose
    /// extension says nothing, the beginning is looked at.
    ///
    /// # Errors
    /// When the skeleton of `options` is not there. Everything else that is wrong belongs to an entry.
    pub fn resolve<P: AsRef<Path>>(paths: &[P], options: &ReadOptions) -> Result<Self> {
        let mut walk = Walk::default();
        let given = match &options.asf {
            Some(path) => Some(walk.skeleton_given(path)?),
            None => None,
        };
        for path in paths {
            walk.input(path.as_ref());
        }
        let mut assumed = BTreeSet::new();
        for entry in &mut walk.entries {
            if entry.kind == Some(Kind::Amc) && entry.skeleton.is_none() {
                entry.skeleton.clone_from(&given);
            }
            if let Some((kind, default)) = entry.kind.and_then(|k| Some((k, k.default_rate_hz()?)))
            {
                let said = options.rates.of(kind);
                if said.is_none() {
                    assumed.insert(kind);
                }
                entry.rate_hz = said.or(Some(default));
            }
        }
        let warnings = assumed
            .into_iter()
            .filter_map(|kind| {
                let (name, hz) = (kind.name(), kind.default_rate_hz()?);
                Some(format!(
                    "{name} files say no frame rate: {hz} Hz assumed (`--input-rate {name}=HZ` sets another)"
                ))
            })
            .collect();
        Ok(Self {
            entries: walk.entries,
            ignored: walk.ignored,
            warnings,
        })
    }
}

fn lost(shown: &str, found: String, expected: &str) -> FormatError {
    FormatError::new(shown, Place::File, found, expected)
}
